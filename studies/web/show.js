'use strict';
/** What is shown of the answers. */
const Show = (() => {
  const {say, numeral} = Words;
  const METHODS = Scenes.METHODS;
  const settled = 500;  // milliseconds without a change before words are read and the address is written
  const byId = (id) => document.getElementById(id);
  let timer = 0;

  /** Why an answer has no result, in words. */
  const status_without_result = (answer) => answer?.broken ? say('broken', {why: answer.broken}) :
      answer?.faults?.length                               ? say('faulty') :
                                                             say('stopped');

  const is_several = (result) => result.warnings.some((warning) => warning.code === 'non_unique');

  /** How the contact points of a step are, in words. */
  function states_of(step) {
    const count = {stick: 0, slip: 0, open: 0};
    for (const contact of Object.values(step.contacts))
      for (const state of Object.keys(count)) count[state] += contact[state];
    const held = Object.keys(count).filter((state) => count[state]);
    return held.length === 1 && count[held[0]] === 1 ? say('state.' + held[0]) : say('states', count);
  }

  /** What a method has to say besides its numbers. */
  function message_of({result, cancelled, faults}) {
    if (!result) return cancelled ? say('stopped.words') : (faults ?? []).map((fault) => fault.text).join(' ');
    const step = result.steps.at(-1);
    if (!result.status.startsWith('converged')) return result.message;
    if (!is_several(result)) return '';
    const value = (one) => `${numeral(one.responses[State.shown.response], 4)} (${states_of(one)})`;
    const others = result.solutions.filter((other) => other.time === step.time).map(value);
    return others.length ? say('warning.non_unique', {own: value(step), others: others.join('; ')}) :
                           say('warning.non_unique.before');
  }

  /** An answer with as many digits as a card has room for. */
  const answer_words = (value) => numeral(value, Math.abs(value) < 1e-3 ? 4 : 7);

  /** Rows of the card of a method. */
  function rows_of(method) {
    const {answer, less, more, of} = State.results[method], {cost, steps} = answer.result;
    const step = Answers.last_step(answer), lesson = State.scene.lesson, rows = [];
    if (State.shown.derivative) {
      const {value, sides} = Derivative.read(step, State.shown.response, State.shown.parameter);
      if (sides) rows.push([say('below'), numeral(sides[0]), 'value'], [say('above'), numeral(sides[1]), 'value']);
      else rows.push([say('derivative'), numeral(value), 'value']);
      const low = Answers.response_of(less), high = Answers.response_of(more),
            is_there = less && of === State.shown.parameter;
      const difference =
          is_there ? (high - low) / (2 * Derivative.step_of(answer.document, of, lesson?.difference?.[of]).step) : NaN;
      rows.push([say('difference'), is_there ? numeral(difference) : '…', 'difference']);
    } else {
      rows.push([
        say(steps.length > 1 ? 'answer.end' : 'answer'),
        step ? answer_words(step.responses[State.shown.response]) :
               say('failed-at', {time: numeral(steps.at(-1)?.time ?? 0, 4)}),
        'value'
      ]);
      if (lesson?.exact === 'lame' && step && State.shown.response === lesson.response)
        rows.push([
          say('against-lame'),
          numeral(100 * (step.responses[lesson.response] / Answers.lame(answer.document) - 1), 2) + '\u00a0%', 'exact'
        ]);
    }
    rows.push(
        [say('error'), Answers.error_words(method), 'error'], [say('newton'), numeral(cost.counts.newton), 'newton']);
    if (method === 'uzawa_al') rows.push([say('augmentations'), numeral(cost.counts.augmentations), 'augmentations']);
    rows.push(
        [say('factorisations'), numeral(cost.counts.factorizations), 'factorizations'],
        [say('milliseconds'), numeral(1000 * cost.seconds.total, 2), 'milliseconds']);
    return rows;
  }

  function show_columns() {
    const messages = {};  // of methods, by text
    for (const method of METHODS) {
      const {answer} = State.results[method] ?? {};
      if (!answer) continue;
      Panel.show_stale(byId('columns'), method, Answers.is_stale(method));
      const status = answer.result ? say('status.' + answer.result.status) : status_without_result(answer);
      Panel.show_column(
          byId('columns'), method, status, !Answers.last_step(answer), answer.result ? rows_of(method) : []);
      const message = message_of(answer);
      if (message) (messages[message] ??= []).push(say(method));
    }
    Panel.show_messages(byId('messages'), messages);
    const {document, lesson} = State.scene, {response, derivative, parameter} = State.shown;
    byId('meaning').textContent = [
      Scenes.meaning(document, response), derivative ? Scenes.meaning_of_parameter(document, parameter) : '',
      lesson?.units ? say('units', {units: lesson.units}) : say('units.any')
    ].join(' ');
  }

  /** A picture before anything happened: what a learner predicts from, and where nothing converged. */
  const before = (picture) => ({
    ...picture,
    ...(picture.frames?.[0] && {obstacles: picture.frames[0].obstacles}),
    frames: [],
    traction: [],
    displacement: picture.displacement.map((u) => u.map(() => 0)),
    von_mises: picture.von_mises.map(() => 0),
    contact: picture.contact.map((point) => ({...point, state: 'unknown'})),
  });

  function show_picture() {
    const solved = State.results[State.shown.drawn]?.answer?.picture;
    if (!solved) return;
    const is_solved = Boolean(solved.traction), picture = State.answered && is_solved ? solved : before(solved);
    const frames = picture.frames ?? [];
    byId('time').hidden = frames.length < 3;
    const step = byId('step');
    step.max = frames.length - 1;
    const index = State.shown.step === null ? frames.length - 1 : Math.min(State.shown.step, frames.length - 1);
    step.value = index;
    const frame = frames[index];
    if (frame)
      byId('step-words').textContent =
          say('time.at', {step: frame.step, steps: frames.at(-1).step, time: numeral(frame.time, 3)}) +
          response_words(frame.step);
    const counts = {open: 0, stick: 0, slip: 0, closed: 0, unknown: 0};
    for (const point of (frame ?? picture).contact) ++counts[point.state];
    const words = say('picture.alt', {method: say(State.shown.drawn), ...counts, slip: counts.slip + counts.closed});
    const times =
        Picture.draw(byId('picture'), State.scene, picture, frame?.step, State.answered, words, (control, value) => {
          if (control.value === value) return;
          control.value = value;
          Page.changed();
        });
    Picture.legend(byId('legend'), picture);
    if (State.answered)
      byId('legend').append(byId('legend').childNodes.length ? '· ' : '', [
        say(is_solved ? 'drawn' : 'drawn.nothing', {method: say(State.shown.drawn)}),
        times === 1 ? '' : say('magnified', {times: numeral(times)}), State.scene.drags.length ? say('knobs') : ''
      ].join(' '));
  }

  /** The value of the response after a step, by the method that is drawn. */
  function response_words(step) {
    const {response, drawn} = State.shown;
    const value = State.results[drawn].answer.result.steps[step - 1]?.responses?.[response];
    return Number.isFinite(value) ? `, ${response} = ${numeral(value, 4)}` : '';
  }

  function show_arrow() {
    const {answer, less, more, of} = State.results[State.shown.drawn] ?? {};
    const fits = State.shown.derivative && less && of === State.shown.parameter && Answers.last_step(answer);
    byId('arrow').hidden = !fits;
    if (!fits) return;
    const {value, step} = Derivative.step_of(answer.document, of, State.scene.lesson?.difference?.[of]);
    const slope = Derivative.read(Answers.last_step(answer), State.shown.response, of);
    Derivative.draw(
        byId('arrow'), {
          value,
          step,
          response: Answers.response_of(answer),
          less: Answers.response_of(less),
          more: Answers.response_of(more)
        },
        slope, {response: State.shown.response, parameter: of});
  }

  function show_verdict(rows) {
    const best = {};
    for (const row of rows.filter(
             (row) => row.method && row.kind !== 'trail' && row.error <= 10 ** State.shown.accuracy))
      if (!best[row.method] || row.x < best[row.method].x) best[row.method] = row;
    const order = Object.values(best).sort((a, b) => a.x - b.x), accuracy = numeral(10 ** State.shown.accuracy);
    byId('accuracy-words').textContent = accuracy;
    if (!order.length) {
      byId('verdict').textContent = say('verdict.none', {accuracy});
      return;
    }
    const run = (row) => say('verdict.run', {
      method: say(row.method),
      knob: row.power === null ? say('control.knob.auto') :
                                 say('knob.' + row.method) + ' ' + Answers.knob_words(row.power),
      work: numeral(row.x, 3)
    });
    byId('verdict').textContent = [
      say('verdict', {accuracy, run: run(order[0])}),
      order.length > 1 ? say('verdict.then', {runs: order.slice(1).map(run).join('; ')}) : '',
      ...METHODS.filter((method) => !best[method]).map((method) => say('verdict.not', {method: say(method)}))
    ].join(' ');
  }

  function show_chart() {
    const name = State.shown.view, rows = Rows[name](), steps = Rows.axes_of_steps();
    const what = State.shown.derivative ? Answers.what() : steps.y, error = say('chart.error', {what: Answers.what()});
    const titles = {
      cost: {x: say('chart.work'), y: error, short: [say('chart.work.short'), say('chart.error.short')]},
      knob: {x: say('chart.knob'), y: error, short: [say('control.knob'), say('chart.error.short')]},
      steps: {x: steps.x ?? say('chart.time'), y: what, short: [steps.x ?? say('chart.time'), what]},
      contact: {
        x: say('chart.place.' + Rows.along_contact()),
        y: say('chart.traction'),
        short: [say('chart.place.short'), say('chart.traction')]
      }
    }[name];
    byId('cost').hidden = name !== 'cost' && name !== 'knob';
    if (!byId('cost').hidden) show_verdict(Rows.cost());
    const values = rows.filter((row) => row.kind === 'now')
                       .map((row) => `${row.name} ${numeral(row.x, 3)}, ${numeral(row.error, 2)}`);
    byId('chart').setAttribute('aria-label', say('chart.alt', {view: say('view.' + name), values: values.join('; ')}));
    if (State.answered && METHODS.every((method) => State.results[method]?.answer))
      Charts.draw(byId('chart'), name, titles, rows).catch(console.error);
  }

  let drawing = 0;
  /** Shows all once per frame of the screen, however many answers came. */
  function show() {
    if (drawing) return;
    drawing = requestAnimationFrame(() => {
      drawing = 0;
      show_columns();
      show_picture();
      show_arrow();
      show_chart();
    });
  }

  /** Words for those who hear the page, the address and the commands: once it is quiet. */
  function after_change() {
    clearTimeout(timer);
    timer = setTimeout(async () => {
      if (METHODS.some((method) => Solver.busy(method, 'main'))) {
        after_change();
        return;
      }
      if (State.answered)
        byId('live').textContent = METHODS
                                       .map((method) => {
                                         const {answer} = State.results[method] ?? {}, step = Answers.last_step(answer);
                                         if (!step)
                                           return say('live.failed', {
                                             method: say(method),
                                             status: answer?.result ? say('status.' + answer.result.status) :
                                                                      status_without_result(answer)
                                           });
                                         const {newton, factorizations} = answer.result.cost.counts;
                                         return say('live', {
                                           method: say(method),
                                           answer: `${Answers.what()} ${numeral(Answers.judged(answer))}`,
                                           error: Answers.error_of(answer).words,
                                           newton,
                                           factorisations: factorizations
                                         });
                                       })
                                       .join(' ');
      show_commands();
      const hash = await Page.address();
      try {
        history.replaceState(null, '', hash);
      } catch { /* a file:// page in a browser that forbids it */
      }
    }, settled);
  }

  const quoted = (text) => /^[\w./=+-]+$/.test(text) ? text : `'${text}'`;

  function show_commands() {
    const lines = METHODS.map(
        (method) => ['build/release/stickslip run', State.scene.source.path, '-m', method,
                     ...[...Scenes.knob(State.scene, method), ...Scenes.overrides(State.scene)].map(
                         (one) => '--set ' + quoted(one))]
                        .join(' '));
    byId('save-first').hidden = !State.scene.source.edited;
    byId('commands').textContent = lines.join('\n');
    byId('file-name').textContent = say('terminal.file', {name: State.scene.source.path});
    byId('file').textContent = State.scene.source.text;
  }

  /** Every quarter of a second: how far the methods are that take long. */
  function show_progress() {
    for (const method of State.scene ? METHODS : []) {
      const age = Solver.busy(method, 'main') ? Solver.age(method) : 0,
            {done, steps} = State.results[method]?.progress ?? {};
      const seconds = numeral(Math.floor(age));
      if (State.results[method]?.answer && Panel.show_stale(byId('columns'), method, Answers.is_stale(method))) show();
      Panel.show_progress(
          byId('columns'), method,
          age < 1 ? '' :
          done    ? say('solving', {done, steps, seconds}) :
                    say('waiting', {seconds}));
    }
  }

  return {all: show, chart: show_chart, progress: show_progress, after_change};
})();
