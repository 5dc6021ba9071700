'use strict';
/** What the answers say: the number that is judged, its error, its work. */
const Answers = (() => {
  const {say, numeral} = Words;

  const last_step = (answer) => answer?.result?.status.startsWith('converged') ? answer.result.steps.at(-1) : null;

  /** The number that is judged: the response, or its derivative. */
  function judged(answer) {
    const step = last_step(answer);
    if (!step) return NaN;
    if (!State.shown.derivative) return step.responses?.[State.shown.response] ?? NaN;
    return Derivative.read(step, State.shown.response, State.shown.parameter).value;
  }

  const response_of = (answer) => last_step(answer)?.responses[State.shown.response] ?? NaN;

  const is_several = (answer) => answer?.result?.warnings.some((warning) => warning.code === 'non_unique');

  /** {error, words} of an answer against the reference; no error where there is none to state. */
  function error_of(answer) {
    const value = judged(answer), right = judged(State.reference.answer);
    if (!Number.isFinite(value)) return {words: say('no-number')};
    if (!Number.isFinite(right)) return {words: say('no-reference')};
    const step = last_step(answer);
    if (State.shown.derivative) {
      const [sides, true_sides] = [step, last_step(State.reference.answer)].map(
          (one) => Derivative.read(one, State.shown.response, State.shown.parameter).sides);
      if (sides && true_sides) {
        const most = Math.max(...true_sides.map(Math.abs)),
              error = Math.max(...sides.map((side, i) => Math.abs(side - true_sides[i]))) / most;
        return {error, words: numeral(error, 2)};
      }
      if (sides || true_sides) return {words: say('not-compared')};
    }
    let size = Math.abs(right);
    if (size === 0) {
      size = answer.scales?.[State.shown.response] ?? 0;
      if (State.shown.derivative)
        size /= Math.abs(Derivative.step_of(answer.document, State.shown.parameter).value) || 1;
    }
    const error = value === right ? 0 : Math.abs(value - right) / size;
    if (error > 1e-2 && (is_several(answer) || is_several(State.reference.answer)))
      return {words: say('other-solution')};
    return {error, words: numeral(error, 2)};
  }

  const work_of = (answer) => {
    const {factorizations, backsolves, sensitivity_backsolves} = answer.result.cost.counts;
    return factorizations + (backsolves + (State.shown.derivative ? sensitivity_backsolves : 0)) / 30;
  };

  /** Where an answer stands in the chart of error against work. */
  function point_of(method, answer) {
    if (!last_step(answer)) return null;
    const {error} = error_of(answer);
    return error === undefined ? null :
                                 {x: Math.max(work_of(answer), 1 / 30), y: Math.max(error, Charts.GROUND), error};
  }

  /** Whether a method solves for long already what the controls say, so that its old numbers are dimmed. */
  const is_stale = (method) => State.results[method]?.version !== State.version && Solver.age(method) > 0.4;

  /** The error in words; while the answer or its reference is still to come, the last one that was known. */
  function error_words(method) {
    const result = State.results[method];
    if (is_stale(method)) return '…';
    if (result.key === State.reference.key && State.reference.answer) result.error = error_of(result.answer).words;
    return result.error ?? '…';
  }

  const what = () =>
      State.shown.derivative ? `d ${State.shown.response} / d ${State.shown.parameter}` : State.shown.response;
  const knob_words = (power) => numeral(Number((10 ** power).toPrecision(3)), 3);
  const name_with = (method, power) => say(method) + (power === null ? '' : ' ' + knob_words(power));

  /** The pressure of two rings of one material that are pressed into each other, after Lamé. */
  function lame(document) {
    const [inner, outer] = ['inner', 'outer'].map((name) => document.bodies[name]);
    const {E, nu} = inner.material.linear_elastic, R = inner.mesh.ring.outer, Ri = inner.mesh.ring.inner,
          Ro = outer.mesh.ring.outer;
    const ring = (a, b) => (b * b + a * a) / (b * b - a * a);
    return -document.contacts.fit.offset / R * E / (1 - nu * nu) / (ring(R, Ro) + ring(Ri, R));
  }

  return {last_step, judged, response_of, error_of, point_of, is_stale, error_words, what, knob_words, name_with, lame};
})();
