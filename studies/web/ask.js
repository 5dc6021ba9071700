'use strict';
/** What the solver is asked: the three methods, their reference, runs beside them and for comparison, a sweep. */
const Ask = (() => {
  const {say} = Words;
  const METHODS = Scenes.METHODS, REFERENCE = 10;  // the scale of the monolithic method that errors are against
  const byId = (id) => document.getElementById(id);

  const request = (method, knob, more) => ({
    scene: State.scene.source.text,
    file: State.scene.source.path.split('/').at(-1),
    method,
    set: [...knob, ...Scenes.overrides(State.scene, more)],
    every: State.scene.every,
  });

  /** Solves by the three methods what the controls say. */
  function solve() {
    const now = ++State.version;
    solve_reference();
    const {key} = State.reference;
    for (const method of METHODS) {
      if (Solver.age(method) > 1) Solver.stop(method);
      Solver
          .ask(
              method, 'main', request(method, Scenes.knob(State.scene, method)),
              (done, steps) => {
                (State.results[method] ??= {}).progress = {done, steps};
              })
          .then((got) => {
            if (got) take(method, got, now, key);
          });
    }
    solve_beside();
    Show.after_change();
  }

  /** A lesson may show the other choice of a control for comparison. */
  async function solve_beside() {
    const control = State.scene.controls[State.scene.lesson?.beside], now = State.version;
    State.beside = null;
    if (!control) return;
    const other = 1 - control.value, method = 'monolithic_al';
    const more = Object.entries(control.choices[other]).map(([pointer, value]) => [pointer, JSON.stringify(value)]);
    const got = await Solver.ask(
        method, 'beside', request(method, Scenes.knob(State.scene, method), Object.fromEntries(more)));
    if (!got || State.version !== now) return;
    State.beside = {name: say('beside', {choice: say(`choice.${control.name}.${other}`)}), answer: got.answer};
    Show.all();
  }

  /** The reference depends on all controls but stiffness and scale. */
  async function solve_reference() {
    const asked = request('monolithic_al', [`${Scenes.knob_of('monolithic_al')}=${REFERENCE}`]),
          key = JSON.stringify(asked);
    if (State.reference.key === key) return;
    State.reference = {key, answer: null};
    State.sweep = [];
    State.sweeping = null;
    byId('sweep').textContent = say('sweep');
    await null;  // after the answer itself
    const got = await Solver.ask('monolithic_al', 'reference', asked);
    if (!got || State.reference.key !== key) return;
    State.reference.answer = got.answer;
    Show.all();
  }

  /** Takes an answer of a method; where derivatives are shown, asks for the two runs beside it. */
  async function take(method, got, asked, key) {
    if (asked < (State.results[method]?.version ?? 0)) return;
    State.results[method] = {...got, version: asked, knob: State.scene.knob, key, error: State.results[method]?.error};
    const point = key === State.reference.key ? Answers.point_of(method, got.answer) : null;
    if (point && asked === State.version) State.trail.push({kind: 'trail', method, ...point});
    if (State.trail.length > 300) State.trail.splice(0, State.trail.length - 300);
    Show.all();
    const parameter = State.shown.parameter;
    if (!State.shown.derivative || !parameter || !got.answer.result || asked !== State.version) return;
    const {step} = Derivative.step_of(got.answer.document, parameter, State.scene.lesson?.difference?.[parameter]);
    const run = (name, by) => Solver.ask(
        method, name,
        request(method, Scenes.knob(State.scene, method), Derivative.moved(got.answer.document, parameter, by)));
    const [less, more] = await Promise.all([run('less', -step), run('more', step)]);
    if (!less || !more || State.results[method].version !== asked) return;
    Object.assign(State.results[method], {less: less.answer, more: more.answer, of: parameter});
    Show.all();
  }

  /** Solves with many stiffnesses and scales, one after the other. */
  async function start_sweep() {
    const [from, to] = State.scene.knob_range, powers = [];
    for (let power = Math.ceil(from); power <= to; ++power) powers.push(power);
    const mine = State.sweeping = {};
    State.sweep = [];
    let done = 0;
    const all = powers.length * METHODS.length;
    await Promise.all(METHODS.map(async (method) => {
      for (const power of powers) {
        const got =
            await Solver.ask(method, 'sweep', {...request(method, Scenes.knob(State.scene, method, power)), every: 0});
        if (State.sweeping !== mine) return;
        byId('sweep').textContent = say('sweeping', {done: ++done, all});
        if (got?.code === 0) State.sweep.push({method, power, answer: got.answer});
        Show.chart();
      }
    }));
    if (State.sweeping === mine) {
      State.sweeping = null;
      byId('sweep').textContent = say('sweep');
    }
  }

  return {solve, start_sweep};
})();
