'use strict';
/** A scene with its controls: what a slider changes, and what it is called after --set. */
const Scenes = (() => {
  const shipped = JSON.parse(document.getElementById('scenes').textContent);  // path: text
  const METHODS = ['penalty', 'uzawa_al', 'monolithic_al'];
  const knob_of = (method) => `/method/${method}/${method === 'penalty' ? 'stiffness' : 'scale'}`;

  /** The value at a pointer of a document. */
  const at = (document, pointer) => pointer.split('/').slice(1).reduce(
      (value, key) => value?.[key.replaceAll('~1', '/').replaceAll('~0', '~')], document);
  const escaped = (key) => key.replaceAll('~', '~0').replaceAll('/', '~1');

  /** Without the digits that rounding leaves: a control's numbers have few. */
  const short = (x) => +x.toPrecision(12);

  /** Controls of any scene: friction of all contacts, all loads or motions together, the steps. */
  function controls_of(document, extent) {
    const controls = {};
    const friction = {};
    for (const [name, contact] of Object.entries(document.contacts ?? {})) {
      const base = `/contacts/${escaped(name)}/friction`, law = contact.friction;
      if (typeof law === 'number') friction[base] = law;
      else if (typeof law?.coulomb === 'number') friction[base + '/coulomb'] = law.coulomb;
    }
    const first = Object.values(friction).find((value) => value > 0);
    if (first) {
      const pointers = Object.fromEntries(Object.entries(friction).map(([pointer, value]) => [pointer, value / first]));
      controls.friction = {pointers, from: 0, to: Math.max(1, short(2 * first)), step: 0.01};
    }
    const loads = {}, add = (pointer, value) => {
      if (typeof value === 'number') {
        if (value !== 0) loads[pointer] = value;
      } else if (Array.isArray(value)) value.forEach((part, i) => add(`${pointer}/${i}`, part));
    };
    (document.loads ?? []).forEach((load, i) => {
      for (const kind of ['force', 'traction', 'pressure', 'body_force']) add(`/loads/${i}/${kind}`, load[kind]);
    });
    if (!Object.keys(loads).length)
      (document.supports ?? []).forEach((support, i) => {
        for (const [axis, value] of Object.entries(support.move ?? {}))
          if (Array.isArray(value)) value.forEach((row, k) => add(`/supports/${i}/move/${axis}/${k}/1`, row[1]));
      });
    if (Object.keys(loads).length) controls.load = {pointers: loads, from: 0, to: 2, step: 0.02, factor: true};
    const time = document.time ?? {};
    if (Number.isInteger(time.steps))
      controls.steps = {pointers: {'/time/steps': 1}, from: 1, to: Math.max(20, 2 * time.steps), step: 1};
    else if (Array.isArray(time.legs) && !time.control) {
      const least = Math.min(...time.legs.map((leg) => leg[1]));
      const pointers = Object.fromEntries(time.legs.map((leg, i) => [`/time/legs/${i}/1`, leg[1] / least]));
      controls.steps = {pointers, from: 1, to: Math.max(10, 2 * least), step: 1};
    }
    Object.assign(controls, places_of(document, extent));
    return controls;
  }

  /** Controls of the places of planes along their normals, and of circles, each with its handle. */
  function places_of(document, extent) {
    const places = {};
    for (const [name, obstacle] of Object.entries(document.obstacles ?? {})) {
      const base = `/obstacles/${escaped(name)}`, place = obstacle.plane?.point ?? obstacle.circle?.center;
      if (!place || place.length > 2 || !(extent > 0)) continue;
      const normal = obstacle.plane?.normal ?? [0, 1], axis = Math.abs(normal[0]) > Math.abs(normal[1]) ? 0 : 1;
      const pointer = `${base}/${obstacle.plane ? 'plane/point' : 'circle/center'}/${axis}`;
      const step = Number((10 ** Math.floor(Math.log10(extent / 100))).toPrecision(1));
      places['place ' + name] = {
        pointers: {[pointer]: 1},
        from: short(place[axis] - 30 * step),
        to: short(place[axis] + 30 * step),
        step,
        place: name,
        drag: {control: 'place ' + name, kind: 'obstacle', place, axis}
      };
    }
    return places;
  }

  /**
   * A scene that is ready: `source` {path, text, edited}, `lesson`: its entry of lessons.json, `document`: as read, `size`:
   * of it, but of no lesson.
   */
  function make(source, lesson, document, size) {
    const controls = {};
    for (const [name, given] of Object.entries(lesson?.controls ?? controls_of(document, size?.extent))) {
      const control = controls[name] = {name, ...given};
      if (control.choices) {
        control.value = control.initial = 0;
      } else {
        const [[pointer, weight]] = Object.entries(control.pointers);
        control.value = control.initial = short(at(document, pointer) / weight);
        control.to = Math.max(control.to, control.value);
        control.from = Math.min(control.from, control.value);
      }
    }
    for (const [name, value] of Object.entries(lesson?.set ?? {})) controls[name].value = value;
    const drags = lesson ? lesson.drags ?? [] : Object.values(controls).flatMap((control) => control.drag ?? []);
    return {
      source,
      lesson,
      document,
      controls,
      drags,
      knob: lesson?.knob?.value ?? null,
      knob_range: [lesson?.knob?.from ?? -3, lesson?.knob?.to ?? 8]
    };
  }

  /** "POINTER=VALUE" of every control that was moved. `more`: {pointer: value} on top. */
  function overrides(scene, more = {}) {
    const values = {};
    for (const override of scene.lesson?.overrides ?? []) {
      const cut = override.indexOf('=');
      values[override.slice(0, cut)] = override.slice(cut + 1);
    }
    for (const control of Object.values(scene.controls)) {
      if (control.value === control.initial) continue;
      if (control.choices)
        for (const [pointer, value] of Object.entries(control.choices[control.value]))
          values[pointer] = JSON.stringify(value);
      else
        for (const [pointer, weight] of Object.entries(control.pointers)) {
          const value = control.value * weight;
          values[pointer] = control.name === 'steps' ? Math.max(1, Math.round(value)) : short(value);
        }
    }
    Object.assign(values, more);
    return Object.entries(values).map(([pointer, value]) => `${pointer}=${value}`);
  }

  /** Where values of a scene file are: [from, to] by pointer. The file has no fault; it may have comments. */
  function spans_of(text) {
    const spans = {}, tokens = /\s+|\/\/[^\n]*|\/\*[^]*?\*\/|("(?:\\.|[^"\\])*"|[[\]{},:]|[^\s[\]{},:/"]+)/g;
    let token = null, end = 0;
    const next = () => {
      do token = tokens.exec(text);
      while (token && token[1] === undefined);
    };
    const read = (pointer) => {
      const from = token.index, closing = {'{': '}', '[': ']'}[token[0]];
      if (closing) {
        next();
        for (let i = 0; token[0] !== closing; ++i) {
          let key = i;
          if (closing === '}') {
            key = escaped(JSON.parse(token[0]));
            next();
            next();
          }
          read(`${pointer}/${key}`);
          if (token[0] === ',') next();
        }
      }
      end = tokens.lastIndex;
      spans[pointer] = [from, end];
      next();
    };
    next();
    read('');
    return spans;
  }

  /** The file of a scene with what its controls say. */
  function text_of(scene) {
    const spans = spans_of(scene.source.text), edits = overrides(scene).map((one) => {
      const cut = one.indexOf('=');
      return {span: spans[one.slice(0, cut)], value: one.slice(cut + 1)};
    });
    return edits.filter((edit) => edit.span).sort((a, b) => b.span[0] - a.span[0]).reduce(
        (text, {span, value}) => text.slice(0, span[0]) + value + text.slice(span[1]), scene.source.text);
  }

  /** What a response is: its kind, where it is taken, of what. */
  function meaning(document, name) {
    const [kind, given] = Object.entries(document.responses?.[name] ?? {})[0] ?? [];
    if (!kind) return '';
    const place = given.on ?? given.contact ?? (given.at && `(${given.at.join(', ')})`);
    const {say, has} = Words, words = has('kind.' + kind) ? say('kind.' + kind) : kind.replaceAll('_', ' ');
    const more = [given.component, given.take].filter(Boolean).map((one) => ', ' + one).join('');
    return `${name}: ${words}${place ? ' ' + say('kind.of', {place}) : ''}${more}.`;
  }
  const meaning_of_parameter = (document, name) =>
      Words.say('parameter.is', {name, pointers: Object.keys(Derivative.pointers_of(document, name)).join(', ')});

  /** The stiffness or scale of a method; none where it is automatic. */
  const knob = (scene, method, power = scene.knob) =>
      power === null ? [] : [`${knob_of(method)}=${Number((10 ** power).toPrecision(3))}`];

  /** How many displacements a solution has over all steps. */
  const length_of = (size) => size.displacements * Math.max(1, size.steps);

  /** Whether a run may take minutes. */
  const is_long = (size) => length_of(size) > 30000;

  /** What a browser bears: of displacements, and of displacements over all steps. */
  const MOST = {displacements: 20000, length: 400000, bytes: 1e9};

  return {
    shipped,
    METHODS,
    MOST,
    at,
    make,
    overrides,
    text_of,
    meaning,
    meaning_of_parameter,
    knob,
    knob_of,
    length_of,
    is_long
  };
})();
