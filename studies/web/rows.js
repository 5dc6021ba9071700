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

  function rows_of_steps() {
    const rows = [], by = State.scene.lesson?.x;
    for (const method of METHODS) {
      if (Answers.is_stale(method)) continue;
      const steps =
          State.results[method]?.answer?.result?.steps.filter((step) => step.status.startsWith('converged')) ?? [];
      steps.forEach((step, i) => {
        const y = State.shown.derivative ? Derivative.read(step, State.shown.response, State.shown.parameter).value :
                                           step.responses?.[State.shown.response];
        const x = by && by !== State.shown.response ? step.responses?.[by] : step.time;
        if (Number.isFinite(x) && Number.isFinite(y)) rows.push({kind: 'line', method, x, y, order: i});
      });
      if (method === State.shown.drawn && State.shown.step !== null && State.shown.step > 0) {
        const here = rows.filter((row) => row.method === method)[State.shown.step - 1];
        if (here) rows.push({...here, kind: 'here'});
      }
    }
    return rows;
  }

  /** Pressure and the size of shear of Hertz, Cattaneo and Mindlin at the forces of an answer. */
  function cattaneo(answer) {
    const {press: P, pull: Q} = Answers.last_step(answer)?.responses ?? {}, {document} = answer;
    if (!(P > 0)) return [];
    const {E, nu} = document.bodies.upper.material.linear_elastic, mu = document.contacts.touch.friction;
    const R = document.bodies.upper.mesh.half_disk.radius / 2, stiffness = E / (2 * (1 - nu * nu));
    const b = Math.sqrt(4 * P * R / (Math.PI * stiffness)), peak = 2 * P / (Math.PI * b),
          c = b * Math.sqrt(Math.max(0, 1 - Math.abs(Q) / (mu * P)));
    const rows = [], half = (x, a) => Math.sqrt(Math.max(0, 1 - (x / a) ** 2));
    for (let i = -60; i <= 60; ++i) {
      const x = b * i / 60, p = peak * half(x, b), q = mu * (p - (Math.abs(x) < c ? c / b * peak * half(x, c) : 0));
      rows.push(
          {kind: 'exact', what: 'p', x, y: p, order: x},
          {kind: 'exact', what: 'q', x, y: q, order: x});
    }
    return rows;
  }

  /** What tractions are over: the arc length of the contact, or x, which a closed form goes along. */
  const along_contact = () => State.scene.lesson?.exact ? 'x' : 'arc';

  function rows_of_contact() {
    const answer = State.results[State.shown.drawn]?.answer, rows = [], along = along_contact();
    for (const [name, points] of Object.entries(answer?.picture?.interface ?? {})) {
      points[along].forEach((x, i) => {
        const window = along === 'x' ? State.scene.lesson?.window : null;
        if (window && (x < window[0] || x > window[2])) return;
        rows.push({kind: 'point', what: say('chart.pressure'), line: name + ' p', x, y: -points.normal[i], order: x});
        if (points.tangential[i] !== undefined)
          rows.push(
              {kind: 'point', what: say('chart.shear'), line: name + ' q', x, y: -points.tangential[i], order: x});
      });
    }
    if (State.scene.lesson?.exact === 'cattaneo' && answer) {
      const of_rows = rows.filter((row) => row.line.endsWith('q')).reduce((sum, row) => sum + row.y, 0);
      const side = Math.sign(of_rows) || 1;
      rows.push(...cattaneo(answer).map((row) => row.what === 'q' ? {...row, y: side * row.y} : row));
    }
    return rows;
  }

  return {cost: rows_of_cost, steps: rows_of_steps, contact: rows_of_contact, along_contact};
})();
