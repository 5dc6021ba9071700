'use strict';
/** The scene as a drawing: bodies, obstacles, contact points with their states and tractions, and handles. */
const Picture = (() => {
  const NS = 'http://www.w3.org/2000/svg', WIDTH = 560, HEIGHT = 300, MARGIN = 26;
  const MASS = 13, REST = 84;  // half a mass, a spring at rest
  const STATES = ['stick', 'slip', 'closed', 'open'];
  const SHADES = [
    '#f4f1de', '#d9e4a8', '#a8d483', '#6cbf80', '#3ba387', '#2a848c', '#31648c', '#3d4287', '#43176a'
  ];                 // the report's
  let frame = null;  // {window, scale, ...} of the scene that is shown
  let moving = null;

  const element = (name, attributes = {}, ...inside) => {
    const made = document.createElementNS(NS, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...inside);
    return made;
  };
  const plus = (a, b) => [a[0] + b[0], a[1] + b[1]];

  /** Where a point of an obstacle is: moved and turned as the scene says. */
  function carried(moved, [x, y]) {
    if (!moved) return [x, y];
    if (!moved.center) return plus([x, y], moved.by);
    const angle = moved.degrees * Math.PI / 180, dx = x - moved.center[0], dy = y - moved.center[1];
    const [c, s] = moved.finite ? [Math.cos(angle), Math.sin(angle)] : [1, angle];
    return plus(plus(moved.center, [c * dx - s * dy, s * dx + c * dy]), moved.by);
  }

  /** The picture of a step: the last one, or a frame. */
  const at_step = (picture, step) => {
    const frames = picture.frames ?? [], chosen = frames.find((one) => one.step === step);
    return chosen ? {...picture, ...chosen} : picture;
  };

  const lumped = (picture) => picture.elements.every((nodes) => nodes.length === 2);

  /** How many times as large displacements are drawn: 1 if they are seen anyway, or matter. */
  function magnification(picture, scene) {
    const has_offset =
        Object.values(scene.document.contacts ?? {}).some((contact) => contact.offset);  // which is not magnified
    if (picture.finite || lumped(picture) || has_offset) return 1;
    const [low, high] = box_of(picture.points), extent = Math.hypot(high[0] - low[0], high[1] - low[1]);
    const largest = Math.max(...picture.displacement.map((u) => Math.hypot(u[0], u[1])));
    if (!(largest > 0) || largest > 0.02 * extent) return 1;
    const wanted = 0.04 * extent / largest, power = 10 ** Math.floor(Math.log10(wanted));
    return [5, 2, 1].find((digit) => digit * power <= wanted) * power;
  }

  function box_of(points) {
    const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
    for (const p of points)
      for (const k of [0, 1]) {
        low[k] = Math.min(low[k], p[k]);
        high[k] = Math.max(high[k], p[k]);
      }
    return [low, high];
  }

  /** The window of a scene, in its lengths, and how long its arrows are. It is kept while the scene fits into it. */
  function make_frame(picture, scene) {
    const given = scene.lesson?.window, times = magnification(picture, scene), points = [...picture.points];
    for (const step of [picture, ...(picture.frames ?? [])])
      step.displacement.forEach(
          (u, n) => points.push([picture.points[n][0] + times * u[0], picture.points[n][1] + times * u[1]]));
    for (const obstacle of picture.obstacles) {
      if (obstacle.circle) {
        const [x, y] = obstacle.circle.center, r = obstacle.circle.radius;
        points.push([x - r, y - r], [x + r, y + r]);
      } else if (lumped(picture))
        points.push(...(obstacle.plane?.point.length === 2 ? [obstacle.plane.point] : (obstacle.polyline?.points ?? []).filter((p) => p)));
    }
    let [low, high] = given ? [given.slice(0, 2), given.slice(2)] : box_of(points);
    const size = Math.max(high[0] - low[0], high[1] - low[1]) || 1;
    if (!given) {
      const air = lumped(picture) ? 0.35 * size : 0.06 * size;
      low = [low[0] - air, low[1] - air];
      high = [high[0] + air, high[1] + air];
      if (high[1] - low[1] < 0.3 * size) {
        const middle = (low[1] + high[1]) / 2;
        low[1] = middle - 0.3 * size;
        high[1] = middle + 0.3 * size;
      }
    }
    const scale = Math.min((WIDTH - 2 * MARGIN) / (high[0] - low[0]), (HEIGHT - 2 * MARGIN) / (high[1] - low[1]));
    const middle = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2];
    const tractions = [picture, ...(picture.frames ?? [])].flatMap((step) => step.traction ?? []);
    const strongest = Math.max(0, ...tractions.map((t) => Math.hypot(t[0], t[1])));
    return {times, scale, middle, strongest};
  }

  /** Whether all of a scene is in the picture. */
  const holds = (places) => places.map(to_pixels).every(([x, y]) => x >= 0 && x <= WIDTH && y >= 0 && y <= HEIGHT);

  /** Pixels of a traction of 1: the longest arrow has 70, and none that begins in the picture ends beyond. */
  function pixels_of_traction(points, tractions) {
    let factor = 70 / frame.strongest;
    points.forEach(([x, y], p) => {
      const [tx, ty] = tractions[p];
      if (x < 0 || x > WIDTH || y < 0 || y > HEIGHT) return;
      const air = [tx > 0 ? x : WIDTH - x, ty > 0 ? HEIGHT - y : y];
      factor = Math.min(factor, (air[0] - 3) / Math.abs(tx), (air[1] - 3) / Math.abs(ty));
    });
    return factor;
  }

  const to_pixels =
      ([x, y]) => [WIDTH / 2 + (x - frame.middle[0]) * frame.scale, HEIGHT / 2 - (y - frame.middle[1]) * frame.scale];
  const text_of = (points) => points.map((p) => to_pixels(p).map((x) => x.toFixed(1)).join(',')).join(' ');

  function arrow(from, to, attributes) {
    const [dx, dy] = [to[0] - from[0], to[1] - from[1]], length = Math.hypot(dx, dy);
    if (length < 2) return element('g');
    const head = Math.min(7, length / 2), [ex, ey] = [dx / length, dy / length];
    const back = [to[0] - head * ex, to[1] - head * ey], wide = head / 2;
    const path = `M${from.map((x) => x.toFixed(1))}L${back.map((x) => x.toFixed(1))}M${to.map((x) => x.toFixed(1))}` +
                 `L${(back[0] - wide * ey).toFixed(1)},${(back[1] + wide * ex).toFixed(1)}L${
                     (back[0] + wide * ey).toFixed(1)},${(back[1] - wide * ex).toFixed(1)}Z`;
    return element('path', {d: path, ...attributes});
  }

  /** A mark of a state, as in the report. */
  function mark(state, [x, y], size = 1) {
    if (state === 'unknown') return element('g');
    if (state === 'stick')
      return element(
          'rect', {x: x - 3.5 * size, y: y - 3.5 * size, width: 7 * size, height: 7 * size, class: 'state stick'});
    if (state === 'slip')
      return element('path', {
        d: `M${x},${y - 5 * size}L${x + 4.5 * size},${y + 3 * size}L${x - 4.5 * size},${y + 3 * size}Z`,
        class: 'state slip'
      });
    return element('circle', {cx: x, cy: y, r: 3 * size, class: 'state ' + state});
  }

  /** Hatched lines of an obstacle, on its solid side. */
  function draw_obstacle(obstacle) {
    const group = element('g', {class: 'obstacle'});
    const edge = (from, to) => {  // solid on the right of the way
      const a = to_pixels(from), b = to_pixels(to), length = Math.hypot(b[0] - a[0], b[1] - a[1]);
      const e = [(b[0] - a[0]) / length, (b[1] - a[1]) / length], into = [-e[1], e[0]];
      let hatch = '';
      for (let s = 4; s < length; s += 9)
        hatch += `M${(a[0] + s * e[0]).toFixed(1)},${(a[1] + s * e[1]).toFixed(1)}l${
            (7 * (into[0] - 0.7 * e[0])).toFixed(1)},${(7 * (into[1] - 0.7 * e[1])).toFixed(1)}`;
      group.append(element('path', {d: hatch, class: 'hatch'}), element('path', {d: `M${a}L${b}`}));
    };
    const [kind, shape] = Object.entries(obstacle)[0];
    if (shape.normal?.length > 2) return group;  // of space, where all is seen along z
    const place = (p) => carried(shape.moved, p);
    if (kind === 'plane') {
      const p = place(shape.point), n = shape.normal, far = 2 * (WIDTH + HEIGHT) / frame.scale,
            length = Math.hypot(...n);
      const along = [n[1] / length * far, -n[0] / length * far];
      const p0 = [p[0] - along[0], p[1] - along[1]], p1 = plus(p, along);
      edge(p0, p1);
    } else if (kind === 'circle') {
      const [x, y] = to_pixels(place(shape.center));
      group.append(
          element('circle', {cx: x, cy: y, r: shape.radius * frame.scale, class: shape.inside ? 'cup' : 'solid'}));
    } else if (kind === 'polyline') {
      const points = shape.points.map((p) => p && place(p));  // null: between two pieces
      for (let i = 0; i + 1 < points.length; ++i)
        if (points[i] && points[i + 1]) edge(points[i], points[i + 1]);
    }
    return group;
  }

  function draw_spring(a, b) {
    const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
    if (length < 1) return element('g');
    const e = [(b[0] - a[0]) / length, (b[1] - a[1]) / length], n = [-e[1], e[0]];
    let path = `M${a}`;
    for (let i = 1; i < 14; ++i) {
      const s = length * (0.12 + 0.76 * (i - 1) / 12), w = i === 1 || i === 13 ? 0 : i % 2 ? 6 : -6;
      path += `L${(a[0] + s * e[0] + w * n[0]).toFixed(1)},${(a[1] + s * e[1] + w * n[1]).toFixed(1)}`;
    }
    return element('path', {d: path + `L${b}`, class: 'spring'});
  }

  /** By how many pixels a mass is drawn off its node, {node: [x, y]}: it stands beside the plane that it touches. */
  function stands_of(scene, picture) {
    const stands = {};
    for (const point of picture.contact) {
      const master = scene.document.contacts[point.name]?.master, plane = scene.document.obstacles?.[master]?.plane;
      if (!plane || plane.normal.length > 2) continue;
      const length = Math.hypot(...plane.normal);
      stands[point.node] = [MASS * plane.normal[0] / length, -MASS * plane.normal[1] / length];
    }
    return stands;
  }

  /** Where the far end of a spring is drawn: at rest it is beside the mass, on the side that it is pulled to. */
  const rest_of = (scene) =>
      (scene.document.supports ?? []).some((support) => support.on?.endsWith('.anchor')) ? REST : -REST;

  function draw_bodies(picture, places, stands, rest) {
    const group = element('g', {class: 'bodies'}), most = Math.max(...picture.von_mises.map((s) => s ?? 0));
    let path = null, shade_of_path = null;  // elements of one shade that follow one another: the nearest comes last
    picture.elements.forEach((nodes, e) => {
      const corners = {9: 4, 8: 4, 6: 3}[nodes.length] ?? nodes.length, at = nodes.slice(0, corners).map((n) => places[n]);
      if (corners === 2) {
        const same = picture.points[nodes[0]].every((x, k) => x === picture.points[nodes[1]][k]);
        if (!same) {
          group.append(element('polyline', {points: text_of(at), class: 'bar'}));
          return;
        }
        const [x, y] = plus(to_pixels(at[0]), stands[nodes[0]] ?? [0, 0]),
                 [ax, ay] = plus(to_pixels(at[1]), plus(stands[nodes[0]] ?? [0, 0], [rest, 0]));
        group.append(
            draw_spring([x, y], [ax, ay]), element('circle', {cx: ax, cy: ay, r: 4, class: 'anchor'}),
            element('rect', {x: x - MASS, y: y - MASS, width: 2 * MASS, height: 2 * MASS, rx: 3, class: 'mass'}));
        return;
      }
      const shade = most > 0 ?
                        SHADES[Math.min(SHADES.length - 1, Math.floor(SHADES.length * picture.von_mises[e] / most))] :
                        SHADES[0];
      const d = 'M' + at.map((p) => to_pixels(p).map((x) => x.toFixed(1)).join(',')).join('L') + 'Z';
      if (shade === shade_of_path) {
        path.setAttribute('d', path.getAttribute('d') + d);
      } else {
        path = group.appendChild(element('path', {d, fill: shade, class: 'elements'}));
        shade_of_path = shade;
      }
    });
    return group;
  }

  /** A place that a control moves: dragged by the pointer, or moved by the arrow keys; none where it moves nothing. */
  function handle(drag, scene, picture, places, stands, rest, on_move) {
    const control = scene.controls[drag.control], length = 46;
    const span = Math.max(Math.abs(control.from), Math.abs(control.to)) || 1;
    let base = null, tip = null, per_pixel = 0;
    const direction = drag.axis === 0 ? [1, 0] : [0, -1];
    if (drag.kind === 'force') {
      const is_mass = lumped(picture), edge = is_mass ? MASS : 3;
      const place = plus(to_pixels(places[drag.node]), stands[drag.node] ?? [0, 0]),
            start = drag.above ? plus(place, [0, -MASS - 9]) : place, side = drag.push ? -drag.sign : drag.sign;
      const along = (way) => [start[0] + direction[0] * side * way, start[1] + direction[1] * side * way];
      base = along(edge);
      tip =
          along(edge + 8 + length * Math.abs(control.value) / span);  // where the hand is: behind a push, before a pull
      per_pixel = side * span / length;
    } else if (drag.kind === 'node') {
      // (After some steps the place is another multiple of the control's number.)
      const share = control.value === 0 ? 1 : picture.displacement[drag.node][drag.axis] / control.value;
      if (Math.abs(share) < 0.05) return element('g');
      tip = plus(to_pixels(places[drag.node]), plus(stands[drag.of] ?? [0, 0], [rest, 0]));
      per_pixel = 1 / (frame.scale * share);
    } else {
      const place = [...drag.place];
      place[drag.axis] = control.value;
      tip = to_pixels(place);
      per_pixel = 1 / frame.scale;
    }
    const group = element('g', {
      class: 'handle ' + drag.kind,
      tabindex: frame.key ? 0 : -1,
      role: 'slider',
      'aria-valuemin': control.from,
      'aria-valuemax': control.to,
      'aria-valuenow': control.value,
      'aria-label': Words.say('drag', {name: Panel.name_of(scene, control)})
    });
    if (base) group.append(drag.push ? arrow(tip, base, {class: 'force'}) : arrow(base, tip, {class: 'force'}));
    if (base && !drag.push) tip = plus(tip, [8 * Math.sign(tip[0] - base[0]), 8 * Math.sign(tip[1] - base[1])]);
    group.append(
        element('circle', {cx: tip[0], cy: tip[1], r: 16, class: 'reach'}),
        element('circle', {cx: tip[0], cy: tip[1], r: 7, class: 'grip'}));
    const set = (value) => {
      const stepped = Math.round((value - control.from) / control.step) * control.step + control.from;
      on_move(control, +Math.min(control.to, Math.max(control.from, stepped)).toPrecision(12));
    };
    group.addEventListener('pointerdown', (event) => {
      event.preventDefault();
      moving =
          {control: control.name, set, start: control.value, x: event.clientX, y: event.clientY, per_pixel, direction};
    });
    group.addEventListener('keydown', (event) => {
      const steps = {ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10}[event.key];
      if (!steps) return;
      event.preventDefault();
      set(control.value + steps * control.step);
      [...document.querySelectorAll('.handle')].find((one) => one.dataset.control === control.name)?.focus();
    });
    group.dataset.control = control.name;
    return group;
  }

  addEventListener('pointermove', (event) => {
    if (!moving) return;
    const box = document.querySelector('#picture svg')?.getBoundingClientRect();
    const ratio = box ? WIDTH / box.width : 1;
    const way =
        ((event.clientX - moving.x) * moving.direction[0] + (event.clientY - moving.y) * moving.direction[1]) * ratio;
    moving.set(moving.start + way * moving.per_pixel);
  });
  for (const end of ['pointerup', 'pointercancel'])
    addEventListener(end, () => {
      moving = null;
    });

  /**
   * Draws a scene into a place. `whole`: picture of the answer; `step`: which of its frames; `key`: whether its handles
   * can be moved; while it stays, the window stays too if it holds all.
   */
  function draw(place, scene, whole, step, key, words, on_move) {
    const picture = at_step(whole, step);
    if (!frame || frame.scene !== scene || frame.key !== key) frame = {...make_frame(whole, scene), scene, key};
    frame.times = magnification(whole, scene);
    const places = picture.points.map(
        (x, n) => [x[0] + frame.times * picture.displacement[n][0], x[1] + frame.times * picture.displacement[n][1]]);
    if (!moving && !scene.lesson?.window && !holds(places)) frame = {...make_frame(whole, scene), scene, key};
    frame.strongest = Math.max(frame.strongest, ...(picture.traction ?? []).map((t) => Math.hypot(t[0], t[1])));
    const focused = document.activeElement?.closest('.handle')?.dataset.control;
    const svg = element('svg', {viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: 'group', 'aria-label': words});
    const drawing = element('g', {'aria-hidden': 'true'});
    for (const obstacle of picture.obstacles) drawing.append(draw_obstacle(obstacle));
    const stands = lumped(picture) ? stands_of(scene, picture) : {};
    const rest = rest_of(scene);
    drawing.append(draw_bodies(picture, places, stands, rest));
    const arrows = element('g', {class: 'tractions'}), marks = element('g');
    const visible = picture.contact.map((c) => to_pixels(places[c.node]));
    const close =
        visible.length > 1 ?
            Math.min(
                1, Math.max(
                       0.45,
                       median(visible.slice(1).map((p, i) => Math.hypot(p[0] - visible[i][0], p[1] - visible[i][1]))) /
                           9)) :
            1.3;
    const factor = picture.traction?.length && frame.strongest > 0 ? pixels_of_traction(visible, picture.traction) : 0;
    picture.contact.forEach((c, p) => {
      const t = picture.traction?.[p], at = visible[p];
      if (factor) {
        arrows.append(arrow([at[0] - factor * t[0], at[1] + factor * t[1]], at, {class: 'traction'}));
      }
      marks.append(mark(c.state, at, close));
    });
    drawing.append(arrows, marks, draw_scale());
    svg.append(drawing);
    for (const drag of scene.drags) svg.append(handle(drag, scene, picture, places, stands, rest, on_move));
    place.replaceChildren(svg);
    if (focused) place.querySelector(`[data-control="${focused}"]`)?.focus({preventScroll: true});
    return frame.times;
  }

  /** A bar of a round length of the scene. */
  function draw_scale() {
    const most = 110 / frame.scale, power = 10 ** Math.floor(Math.log10(most));
    const length = [5, 2, 1].find((digit) => digit * power <= most) * power, end = 10 + length * frame.scale;
    return element(
        'g', {class: 'scale'}, element('path', {d: `M10,${HEIGHT - 14}v6h${end - 10}v-6`}),
        element('text', {x: end + 6, y: HEIGHT - 8}, Words.numeral(+length.toPrecision(1))));
  }

  const median = (values) => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];

  /** What marks and colours mean: those that a picture has. */
  function legend(place, picture) {
    place.replaceChildren();
    const names = Words.say('legend').split('|'), held = new Set(picture.contact.map((point) => point.state));
    const add = (width, drawing, words) => {
      const svg = element('svg', {width, height: 12, 'aria-hidden': 'true'}, ...drawing);
      place.append(svg, ' ' + words + '  ');
    };
    STATES.forEach((state, i) => {
      if (held.has(state)) add(12, [mark(state, [6, 6])], names[i]);
    });
    if (picture.traction?.length) add(26, [arrow([1, 6], [25, 6], {class: 'traction'})], names[4]);
    const most = lumped(picture) ? 0 : Math.max(...picture.von_mises);
    if (most > 0)
      add(
          7 * SHADES.length, SHADES.map((fill, i) => element('rect', {x: 7 * i, y: 1, width: 7, height: 10, fill})),
          Words.say('legend.stress', {most: Words.numeral(most, 3)}));
  }

  return {draw, legend, element, arrow};
})();
