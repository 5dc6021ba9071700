'use strict';
/** What the page is about, for all scripts. */
const State = {
  scene: null,     // of Scenes.make()
  shown: {},       // response, parameter, derivative, view, drawn, accuracy, step
  answered: true,  // whether the lesson's prediction was made
  predicted: null, // number of the choice of the lesson's prediction, 'none', or null before
  results: {},     // by method: {answer, code, version, key of its reference, less, more: the two runs beside it}
  reference: {key: '', answer: null},
  beside: null,    // {name, answer} of the other choice of a lesson's control, or null
  trail: [],       // rows of the chart, where the points have been
  sweep: [],       // {method, power, answer}
  sweeping: null,  // the sweep under way
  version: 0,      // counts what was asked
};
