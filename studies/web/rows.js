'use strict';
/** Rows of the charts. */
const Rows = (() => {
  const {say} = Words;
  const METHODS = Scenes.METHODS;

  function rows_of_cost() {
    const rows = [{kind: 'asked', y: 10 ** State.shown.accuracy}];
    for (const {method, power, answer} of State.sweep) {
      const point = Answers.point_of(method, answer);
      if (point)
        rows.push({kind: 'sweep', method, name: Answers.name_with(method, power), power, order: power, ...point});
    }
    rows.push(...State.trail);
    for (const method of METHODS) {
      const {answer, key} = State.results[method] ?? {},
                     point = key === State.reference.key ? Answers.point_of(method, answer) : null;
      if (point) rows.push({kind: 'now', method, name: say(method), power: State.results[method].knob, ...point});
    }
    return rows;
  }

  /** The same errors over the stiffness or scale. */
  const rows_of_knob = () => rows_of_cost()
                                 .filter((row) => row.kind === 'asked' || Number.isFinite(row.power))
                                 .map((row) => row.kind === 'asked' ? row : {...row, x: 10 ** row.power});

  /** What the chart over the steps has on its axes: responses, or time (null) and a derivative. */
  function axes_of_steps() {
    const {x = null, y} = State.scene.lesson ?? {}, {response, derivative} = State.shown;
    if (derivative || !x) return {x: null, y: response};
    return x !== response ? {x, y: response} : y ? {x, y} : {x: null, y: response};
  }

  function lines_of(answer, about) {
    const axes = axes_of_steps();
    return (answer?.result?.steps ?? [])
        .filter((step) => step.status.startsWith('converged'))
        .map((step, i) => ({
               ...about,
               x: axes.x ? step.responses?.[axes.x] : step.time,
               y: State.shown.derivative ? Derivative.read(step, axes.y, State.shown.parameter).value :
                                           step.responses?.[axes.y],
               order: i
             }))
        .filter((row) => Number.isFinite(row.x) && Number.isFinite(row.y));
  }

  function rows_of_steps() {
    const rows = [], {beside} = State;
    for (const method of METHODS) {
      if (Answers.is_stale(method)) continue;
      const line = lines_of(State.results[method]?.answer, {kind: 'line', method, name: say(method), tone: method});
      rows.push(...line);
      const here = method === State.shown.drawn && State.shown.step > 0 ? line[State.shown.step - 1] : null;
      if (here) rows.push({...here, kind: 'here'});
    }
    if (beside) rows.push(...lines_of(beside.answer, {kind: 'beside', name: beside.name, tone: 'ink'}));
    return rows;
  }

  const exact = {kind: 'exact', name: say('chart.exact'), tone: 'ink'};

  /** Pressure and the size of shear of Hertz, Cattaneo and Mindlin at the forces of a step. */
  function cattaneo(step, document) {
    const {press: P, pull: Q} = step?.responses ?? {};
    if (!(P > 0)) return [];
    const {E, nu} = document.bodies.upper.material.linear_elastic, mu = document.contacts.touch.friction;
    const R = document.bodies.upper.mesh.half_disk.radius / 2, stiffness = E / (2 * (1 - nu * nu));
    const b = Math.sqrt(4 * P * R / (Math.PI * stiffness)), peak = 2 * P / (Math.PI * b),
          c = b * Math.sqrt(Math.max(0, 1 - Math.abs(Q) / (mu * P)));
    const rows = [], half = (x, a) => Math.sqrt(Math.max(0, 1 - (x / a) ** 2));
    for (let i = -60; i <= 60; ++i) {
      const x = b * i / 60, p = peak * half(x, b), q = mu * (p - (Math.abs(x) < c ? c / b * peak * half(x, c) : 0));
      rows.push({...exact, line: 'p', x, y: p, order: x}, {...exact, line: 'q', x, y: q, order: x});
    }
    return rows;
  }

  /** What tractions are over: the arc length of the contact, or x, which a closed form goes along. */
  const along_contact = () => State.scene.lesson?.exact === 'cattaneo' ? 'x' : 'arc';

  /** Tractions after the step that is drawn. */
  function rows_of_contact() {
    const answer = State.results[State.shown.drawn]?.answer, rows = [], along = along_contact();
    const picture = answer?.picture, frame = picture?.frames?.[State.shown.step ?? picture.frames.length - 1];
    for (const [name, points] of Object.entries(picture?.interface ?? {})) {
      const tractions = (frame ?? picture).contact.filter((point) => point.name === name);
      points[along].forEach((x, i) => {
        const window = along === 'x' ? State.scene.lesson?.window : null, {normal, tangential} = tractions[i];
        if (window && (x < window[0] || x > window[2])) return;
        const point = {kind: 'point', x, order: x};
        rows.push({...point, name: say('chart.pressure'), tone: 'closed', line: name + ' p', y: -normal});
        if (tangential !== undefined)
          rows.push({...point, name: say('chart.shear'), tone: 'shear', line: name + ' q', y: -tangential});
      });
    }
    const step = frame ? answer.result.steps[frame.step - 1] : answer?.result?.steps.at(-1);
    if (rows.length && State.scene.lesson?.exact === 'cattaneo') {
      const side = Math.sign(rows.reduce((sum, row) => row.tone === 'shear' ? sum + row.y : sum, 0)) || 1;
      rows.push(
          ...cattaneo(step, answer.document).map((row) => row.line === 'q' ? {...row, y: side * row.y} : row));
    }
    if (rows.length && State.scene.lesson?.exact === 'lame')
      for (const {x} of [rows[0], rows.at(-1)])
        rows.push({...exact, line: 'p', x, y: Answers.lame(answer.document), order: x});
    return rows;
  }

  return {
    cost: rows_of_cost,
    knob: rows_of_knob,
    steps: rows_of_steps,
    contact: rows_of_contact,
    along_contact,
    axes_of_steps
  };
})();
