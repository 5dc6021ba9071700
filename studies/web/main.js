'use strict';
/** The page: its state, what is asked of the solver, and what is shown of the answers. */
const Page = (() => {
  const {say, numeral} = Words;
  const byId = (id) => document.getElementById(id);
  const METHODS = Scenes.METHODS, REFERENCE = 10;  // the scale of the monolithic method that errors are against
  const settled = 500;  // milliseconds without a change before words are read and the address is written
  const about = JSON.parse(byId('about').textContent);

  let scene = null;
  let shown = {};       // response, parameter, derivative, view, drawn, accuracy, step
  let answered = true;  // whether the lesson's prediction was made
  let results = {};     // method: {answer, code, milliseconds, less, more}
  let reference = {key: '', answer: null};
  let trail = [], sweep = [], sweeping = null;
  let version = 0, timer = 0;

  // ---- what is asked ---------------------------------------------------------------------------------------------

  const request = (method, knob, more) => ({
    scene: scene.source.text,
    file: scene.source.path.split('/').at(-1),
    method,
    set: [...knob, ...Scenes.overrides(scene, more)],
    every: scene.every,
  });

  /** Solves by the three methods what the controls say. */
  function solve() {
    const now = ++version;
    solve_reference();
    const {key} = reference;
    for (const method of METHODS) {
      if (Solver.age(method) > 1) Solver.stop(method);
      Solver
          .ask(
              method, 'main', request(method, Scenes.knob(scene, method)),
              (done, steps) => {
                (results[method] ??= {}).progress = {done, steps};
              })
          .then((got) => {
            if (got) take(method, got, now, key);
          });
    }
    after_change();
  }

  /** The reference depends on all controls but stiffness and scale. */
  async function solve_reference() {
    const asked = request('monolithic_al', [`${Scenes.knob_of('monolithic_al')}=${REFERENCE}`]),
          key = JSON.stringify(asked);
    if (reference.key === key) return;
    reference = {key, answer: null};
    sweep = [];
    sweeping = null;
    byId('sweep').textContent = say('sweep');
    await null;  // after the answer itself
    const got = await Solver.ask('monolithic_al', 'reference', asked);
    if (!got || reference.key !== key) return;
    reference.answer = got.answer;
    show();
  }

  /** Takes an answer of a method; where derivatives are shown, asks for the two runs beside it. */
  async function take(method, got, asked, key) {
    if (asked < (results[method]?.version ?? 0)) return;
    results[method] = {...got, version: asked, knob: scene.knob, key, error: results[method]?.error};
    const point = key === reference.key ? point_of(method, got.answer) : null;
    if (point && asked === version) trail.push({kind: 'trail', method, ...point});
    if (trail.length > 300) trail.splice(0, trail.length - 300);
    show();
    const parameter = shown.parameter;
    if (!shown.derivative || !parameter || !got.answer.result || asked !== version) return;
    const {step} = Derivative.step_of(got.answer.document, parameter, scene.lesson?.difference);
    const run = (name, by) => Solver.ask(
        method, name,
        request(method, Scenes.knob(scene, method), Derivative.moved(got.answer.document, parameter, by)));
    const [less, more] = await Promise.all([run('less', -step), run('more', step)]);
    if (!less || !more || results[method].version !== asked) return;
    Object.assign(results[method], {less: less.answer, more: more.answer, of: parameter});
    show();
  }

  /** Solves with many stiffnesses and scales, one after the other. */
  async function start_sweep() {
    const [from, to] = scene.knob_range, powers = [];
    for (let power = Math.ceil(from); power <= Math.min(to, 10); ++power) powers.push(power);
    const mine = sweeping = {};
    sweep = [];
    let done = 0;
    const all = powers.length * METHODS.length;
    await Promise.all(METHODS.map(async (method) => {
      for (const power of powers) {
        const got =
            await Solver.ask(method, 'sweep', {...request(method, Scenes.knob(scene, method, power)), every: 0});
        if (sweeping !== mine) return;
        byId('sweep').textContent = say('sweeping', {done: ++done, all});
        if (got?.code === 0) sweep.push({method, power, answer: got.answer});
        show_chart();
      }
    }));
    if (sweeping === mine) {
      sweeping = null;
      byId('sweep').textContent = say('sweep');
    }
  }

  // ---- what the answers say --------------------------------------------------------------------------------------

  const last_step = (answer) => answer?.result?.status.startsWith('converged') ? answer.result.steps.at(-1) : null;

  /** The number that is judged: the response, or its derivative. */
  function judged(answer) {
    const step = last_step(answer);
    if (!step) return NaN;
    if (!shown.derivative) return step.responses?.[shown.response] ?? NaN;
    return Derivative.read(step, shown.response, shown.parameter).value;
  }

  const is_several = (answer) => answer?.result?.warnings.some((warning) => warning.code === 'non_unique');

  /** {error, words} of an answer against the reference; no error where there is none to state. */
  function error_of(answer) {
    const value = judged(answer), right = judged(reference.answer);
    if (!Number.isFinite(value)) return {words: say('no-number')};
    if (!Number.isFinite(right)) return {words: say('no-reference')};
    const step = last_step(answer);
    if (shown.derivative) {
      const [sides, true_sides] =
          [step, last_step(reference.answer)].map((one) => Derivative.read(one, shown.response, shown.parameter).sides);
      if (sides && true_sides) {
        const most = Math.max(...true_sides.map(Math.abs)),
              error = Math.max(...sides.map((side, i) => Math.abs(side - true_sides[i]))) / most;
        return {error, words: numeral(error, 2)};
      }
      if (sides || true_sides) return {words: say('not-compared')};
    }
    let size = Math.abs(right);
    if (size === 0) {
      size = answer.scales?.[shown.response] ?? 0;
      if (shown.derivative) size /= Math.abs(Derivative.step_of(answer.document, shown.parameter).value) || 1;
    }
    const error = value === right ? 0 : Math.abs(value - right) / size;
    if (error > 1e-2 && (is_several(answer) || is_several(reference.answer))) return {words: say('other-solution')};
    return {error, words: numeral(error, 2)};
  }

  const work_of = (answer) => {
    const {factorizations, backsolves, sensitivity_backsolves} = answer.result.cost.counts;
    return factorizations + (backsolves + (shown.derivative ? sensitivity_backsolves : 0)) / 30;
  };

  /** Where an answer stands in the chart of error against work. */
  function point_of(method, answer) {
    if (!last_step(answer)) return null;
    const {error} = error_of(answer);
    return error === undefined ? null :
                                 {x: Math.max(work_of(answer), 1 / 30), y: Math.max(error, Charts.GROUND), error};
  }

  // ---- what is shown ---------------------------------------------------------------------------------------------

  /** Whether a method solves for long already what the controls say, so that its old numbers are to be told apart. */
  const is_stale = (method) => results[method]?.version !== version && Solver.age(method) > 0.4;

  /** The error in words; while the answer or its reference is still to come, the last one that was known. */
  function error_words(method) {
    const result = results[method];
    if (is_stale(method)) return '…';
    if (result.key === reference.key && reference.answer) result.error = error_of(result.answer).words;
    return result.error ?? '…';
  }

  function show_columns() {
    for (const method of METHODS) {
      const {answer, code, less, more, of} = results[method] ?? {};
      if (!answer) continue;
      Panel.show_stale(byId('columns'), method, is_stale(method));
      if (!answer.result) {
        const status = answer.broken ? say('broken', {why: answer.broken}) :
                       code === 4    ? say('stopped') :
                                       say('faulty');
        const words =
            answer.cancelled ? say('stopped.words') : (answer.faults ?? []).map((fault) => fault.text).join(' ');
        Panel.show_column(byId('columns'), method, status, true, [], words);
        continue;
      }
      const {status, cost, steps, warnings, solutions, message} = answer.result;
      const step = last_step(answer), is_good = Boolean(step);
      const rows = [];
      if (shown.derivative) {
        const {value, sides} = Derivative.read(step, shown.response, shown.parameter);
        if (sides) rows.push([say('below'), numeral(sides[0]), 'value'], [say('above'), numeral(sides[1]), 'value']);
        else rows.push([say('derivative'), numeral(value), 'value']);
        const low = judged_response(less), high = judged_response(more);
        const difference =
            less && of === shown.parameter ?
                (high - low) / (2 * Derivative.step_of(answer.document, of, scene.lesson?.difference).step) :
                NaN;
        rows.push([say('difference'), less && of === shown.parameter ? numeral(difference) : '…', 'difference']);
      } else {
        rows.push([
          say('answer'),
          is_good ? numeral(step.responses[shown.response], 7) :
                    say('failed-at', {time: numeral(steps.at(-1)?.time ?? 0, 4)}),
          'value'
        ]);
      }
      rows.push([say('error'), error_words(method), 'error'], [say('newton'), numeral(cost.counts.newton), 'newton']);
      if (method === 'uzawa_al') rows.push([say('augmentations'), numeral(cost.counts.augmentations), 'augmentations']);
      rows.push(
          [say('factorisations'), numeral(cost.counts.factorizations), 'factorizations'],
          [say('milliseconds'), numeral(1000 * cost.seconds.total, 2), 'milliseconds']);
      const others = (solutions ?? []).map((other) => numeral(other.responses[shown.response], 4));
      const extra = warnings.some((warning) => warning.code === 'non_unique') ?
                        say('warning.non_unique', {others: others.join('; ')}) :
                    is_good ? '' :
                              message;
      Panel.show_column(byId('columns'), method, say('status.' + status), !is_good, rows, extra);
    }
  }

  const judged_response = (answer) => last_step(answer)?.responses[shown.response] ?? NaN;

  /** A picture before anything happened: what a learner predicts from. */
  const before = (picture) => ({
    ...picture,
    ...(picture.frames?.[0] && {obstacles: picture.frames[0].obstacles}),
    frames: [],
    traction: [],
    displacement: picture.displacement.map((u) => u.map(() => 0)),
    von_mises: picture.von_mises.map(() => 0),
    contact: picture.contact.map((point) => ({...point, state: 'open'})),
  });

  function show_picture() {
    const solved = results[shown.drawn]?.answer?.picture;
    if (!solved) return;
    const picture = answered ? solved : before(solved);
    const frames = picture.frames ?? [];
    byId('time').hidden = frames.length < 3;
    const step = byId('step');
    step.max = frames.length - 1;
    const index = shown.step === null ? frames.length - 1 : Math.min(shown.step, frames.length - 1);
    step.value = index;
    const frame = frames[index];
    if (frame)
      byId('step-words').textContent =
          say('time.at', {step: frame.step, steps: frames.at(-1).step, time: numeral(frame.time, 3)});
    const counts = {open: 0, stick: 0, slip: 0, closed: 0};
    for (const point of (frame ?? picture).contact) ++counts[point.state];
    const words = say('picture.alt', {method: say(shown.drawn), ...counts, slip: counts.slip + counts.closed});
    const times = Picture.draw(byId('picture'), scene, picture, frame?.step, answered, words, (control, value) => {
      if (control.value === value) return;
      control.value = value;
      changed();
    });
    Picture.legend(byId('legend'));
    if (answered)
      byId('legend').append(
          ' ' + say('drawn', {method: say(shown.drawn)}),
          times === 1 ? '' : ' ' + say('magnified', {times: numeral(times)}));
  }

  function show_arrow() {
    const {answer, less, more, of} = results[shown.drawn] ?? {};
    const fits = shown.derivative && less && of === shown.parameter && last_step(answer);
    byId('arrow').hidden = !fits;
    if (!fits) return;
    const {value, step} = Derivative.step_of(answer.document, of, scene.lesson?.difference);
    const slope = Derivative.read(last_step(answer), shown.response, of);
    Derivative.draw(
        byId('arrow'),
        {value, step, response: judged_response(answer), less: judged_response(less), more: judged_response(more)},
        slope, {response: shown.response, parameter: of});
  }

  const what = () => shown.derivative ? `d ${shown.response} / d ${shown.parameter}` : shown.response;
  const name_with = (method, power) =>
      say(method) + (power === null ? '' : ' ' + numeral(Number((10 ** power).toPrecision(3)), 3));

  function rows_of_cost() {
    const rows = [{kind: 'asked', y: 10 ** shown.accuracy}];
    for (const {method, power, answer} of sweep) {
      const point = point_of(method, answer);
      if (point) rows.push({kind: 'sweep', method, name: name_with(method, power), power, order: power, ...point});
    }
    rows.push(...trail);
    for (const method of METHODS) {
      const {answer, key} = results[method] ?? {}, point = key === reference.key ? point_of(method, answer) : null;
      if (point) rows.push({kind: 'now', method, name: say(method), power: results[method].knob, ...point});
    }
    return rows;
  }

  function rows_of_steps() {
    const rows = [], by = scene.lesson?.x;
    for (const method of METHODS) {
      if (is_stale(method)) continue;
      const steps = results[method]?.answer?.result?.steps.filter((step) => step.status.startsWith('converged')) ?? [];
      steps.forEach((step, i) => {
        const y = shown.derivative ? Derivative.read(step, shown.response, shown.parameter).value :
                                     step.responses?.[shown.response];
        const x = by && by !== shown.response ? step.responses?.[by] : step.time;
        if (Number.isFinite(x) && Number.isFinite(y)) rows.push({kind: 'line', method, x, y, order: i});
      });
      if (method === shown.drawn && shown.step !== null && shown.step > 0) {
        const here = rows.filter((row) => row.method === method)[shown.step - 1];
        if (here) rows.push({...here, kind: 'here'});
      }
    }
    return rows;
  }

  /** Pressure and shear of Hertz, Cattaneo and Mindlin at the forces of an answer. */
  function cattaneo(answer) {
    const {press: P, pull: Q} = last_step(answer)?.responses ?? {}, {document} = answer;
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
          {kind: 'exact', what: 'q', x, y: Math.sign(Q || 1) * q, order: x});
    }
    return rows;
  }

  function rows_of_contact() {
    const answer = results[shown.drawn]?.answer, rows = [];
    for (const [name, points] of Object.entries(answer?.picture?.interface ?? {})) {
      points.x.forEach((x, i) => {
        if (scene.lesson?.window && (x < scene.lesson.window[0] || x > scene.lesson.window[2])) return;
        rows.push({kind: 'point', what: say('chart.pressure'), line: name + ' p', x, y: -points.normal[i], order: x});
        if (points.tangential[i] !== undefined)
          rows.push(
              {kind: 'point', what: say('chart.shear'), line: name + ' q', x, y: -points.tangential[i], order: x});
      });
    }
    if (scene.lesson?.exact === 'cattaneo' && answer) {
      const exact = cattaneo(answer),
            of_rows = rows.filter((row) => row.line.endsWith('q')).reduce((sum, row) => sum + row.y, 0);
      const side = Math.sign(of_rows) || 1,
            of_exact = Math.sign(exact.filter((row) => row.what === 'q').reduce((sum, row) => sum + row.y, 0)) || 1;
      rows.push(...exact.map((row) => row.what === 'q' ? {...row, y: row.y * side * of_exact} : row));
    }
    return rows;
  }

  function show_verdict(rows) {
    const best = {};
    for (const row of rows.filter((row) => row.method && row.kind !== 'trail' && row.error <= 10 ** shown.accuracy))
      if (!best[row.method] || row.x < best[row.method].x) best[row.method] = row;
    const order = Object.values(best).sort((a, b) => a.x - b.x), accuracy = numeral(10 ** shown.accuracy);
    byId('accuracy-words').textContent = accuracy;
    if (!order.length) {
      byId('verdict').textContent = say('verdict.none', {accuracy});
      return;
    }
    const others = [
      ...order.slice(1).map((row) => say('verdict.other', {method: say(row.method), work: numeral(row.x, 3)})),
      ...METHODS.filter((method) => !best[method]).map((method) => say('verdict.not', {method: say(method)}))
    ];
    const knob =
        order[0].power === null ? say('control.knob.auto') : numeral(Number((10 ** order[0].power).toPrecision(3)), 3);
    byId('verdict').textContent =
        say('verdict',
            {accuracy, method: say(order[0].method), knob, work: numeral(order[0].x, 3), others: others.join(' ')});
  }

  function show_chart() {
    const name = shown.view, rows = {cost: rows_of_cost, steps: rows_of_steps, contact: rows_of_contact}[name]();
    const by = scene.lesson?.x && scene.lesson.x !== shown.response ? scene.lesson.x : say('chart.time');
    const titles = {
      cost: {x: say('chart.work'), y: say('chart.error', {what: what()})},
      steps: {x: by, y: what()},
      contact: {x: say('chart.place'), y: say('chart.traction')}
    }[name];
    byId('cost').hidden = name !== 'cost';
    if (name === 'cost') show_verdict(rows);
    const values = rows.filter((row) => row.kind === 'now')
                       .map((row) => `${row.name} ${numeral(row.x, 3)}, ${numeral(row.error, 2)}`);
    byId('chart').setAttribute('aria-label', say('chart.alt', {view: say('view.' + name), values: values.join('; ')}));
    if (answered && METHODS.every((method) => results[method]?.answer))
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
      if (answered)
        byId('live').textContent = METHODS
                                       .map((method) => {
                                         const {answer} = results[method] ?? {}, step = last_step(answer);
                                         if (!step)
                                           return say('live.failed', {
                                             method: say(method),
                                             status: say(answer?.result ? 'status.' + answer.result.status : 'stopped')
                                           });
                                         const {newton, factorizations} = answer.result.cost.counts;
                                         return say('live', {
                                           method: say(method),
                                           answer: `${what()} ${numeral(judged(answer))}`,
                                           error: error_of(answer).words,
                                           newton,
                                           factorisations: factorizations
                                         });
                                       })
                                       .join(' ');
      show_commands();
      const hash = await address();
      try {
        history.replaceState(null, '', hash);
      } catch { /* a file:// page in a browser that forbids it */
      }
    }, settled);
  }

  const quoted = (text) => /^[\w./=+-]+$/.test(text) ? text : `'${text}'`;

  function show_commands() {
    const lines = METHODS.map(
        (method) => ['build/release/stickslip run', scene.source.path, '-m', method,
                     ...[...Scenes.knob(scene, method), ...Scenes.overrides(scene)].map(
                         (one) => '--set ' + quoted(one))]
                        .join(' '));
    byId('save-first').hidden = !scene.source.edited;
    byId('commands').textContent = lines.join('\n');
    byId('file-name').textContent = say('terminal.file', {name: scene.source.path});
    byId('file').textContent = scene.source.text;
  }

  async function address() {
    const values = {
      lesson: scene.lesson?.id,
      response: shown.response,
      by: shown.parameter,
      shown: shown.derivative ? 'derivative' : null,
      view: shown.view,
      drawn: shown.drawn,
      accuracy: shown.accuracy,
      knob: scene.knob
    };
    if (!scene.lesson)
      values[scene.source.edited ? 'scene' : 'file'] =
          scene.source.edited ? await Link.pack(scene.source.text) : scene.source.path;
    for (const control of Object.values(scene.controls))
      if (control.value !== control.initial) values['c.' + control.name] = control.value;
    return Link.write(values);
  }

  // ---- what changes ----------------------------------------------------------------------------------------------

  /** A control was moved. */
  function changed() {
    Panel.show_values(byId('controls'), scene);
    solve();
  }

  /** Another response, parameter or view of the same answers. */
  function choose(more) {
    const derivative = shown.derivative, parameter = shown.parameter;
    Object.assign(shown, more);
    if (shown.derivative !== derivative || shown.parameter !== parameter || more.response) trail = [];
    if (shown.derivative && (!derivative || shown.parameter !== parameter)) solve();
    show_switches();
    show();
    after_change();
  }

  function show_switches() {
    const options = (select, names, chosen) => {
      select.replaceChildren(...names.map((name) => Panel.make('option', {value: name}, name)));
      select.value = chosen;
    };
    options(byId('response'), Object.keys(scene.document.responses ?? {}), shown.response);
    const parameters = Derivative.movable(scene.document);
    options(byId('parameter'), parameters, shown.parameter);
    byId('by').hidden = !shown.derivative;
    for (const input of document.querySelectorAll('[name="shown"]')) {
      input.checked = (input.value === 'derivative') === shown.derivative;
      input.disabled = parameters.length === 0;
    }
    byId('views').setAttribute('aria-label', say('view'));
    byId('views').replaceChildren(...['cost', 'steps', 'contact'].map((view) => {
      const input = Panel.make('input', {type: 'radio', name: 'view', value: view});
      input.checked = view === shown.view;
      input.addEventListener('change', () => choose({view}));
      return Panel.make('label', {}, input, ' ' + say('view.' + view));
    }));
  }

  /** Shows a scene: reads it, makes its controls, solves. `given`: of the address. */
  async function open(source, lesson, given = {}) {
    const answer =
        await Editor.check(source.text, source.path.split('/').at(-1), source.edited ? 'check' : 'monolithic_al');
    if (!answer) return;
    if (!answer.document || !Editor.bears(answer.size)) {
      Editor.set(source.text);
      Editor.open(true);
      Editor.show(answer);
      return;
    }
    scene = Scenes.make(source, lesson, answer.document, answer.size);
    scene.every = Scenes.length_of(answer.size) <= 30000 ? 1 : 0;
    const number = (text) => Number.isFinite(Number(text)) ? Number(text) : null;
    if (given.knob !== undefined) scene.knob = number(given.knob);
    for (const control of Object.values(scene.controls)) {
      const value = number(given['c.' + control.name] ?? 'none');
      if (value !== null) control.value = value;
    }
    const responses = Object.keys(answer.document.responses ?? {}), parameters = Derivative.movable(answer.document);
    const among = (names, ...wanted) => wanted.find((name) => names.includes(name)) ?? names[0];
    shown = {
      response: among(responses, given.response, lesson?.response),
      parameter: among(parameters, given.by, lesson?.parameter, 'mu'),
      derivative: (given.shown ?? lesson?.shown) === 'derivative' && parameters.length > 0,
      view: among(['cost', 'steps', 'contact'], given.view, lesson?.view),
      drawn: among(METHODS, given.drawn, 'monolithic_al'),
      accuracy: number(given.accuracy ?? -3) ?? -3,
      step: null
    };
    results = {};
    reference = {key: '', answer: null};
    trail = [];
    sweep = [];
    sweeping = null;
    answered = !Lessons.asks(lesson);
    byId('sweep').textContent = say('sweep');
    byId('lesson').value = lesson?.id ?? '';
    byId('accuracy').value = shown.accuracy;
    byId('scene-title').textContent = answer.document.title ?? (lesson ? say(lesson.id + '.name') : source.path);
    document.body.classList.toggle('unanswered', !answered);
    Lessons.draw(lesson, answered, () => {
      answered = true;
      document.body.classList.remove('unanswered');
      show();
      after_change();
    });
    Editor.set(source.text);
    byId('arrow').hidden = true;
    byId('picture').replaceChildren();
    Panel.draw_columns(
        byId('columns'), shown.drawn, (method) => choose({drawn: method}), (method) => Solver.stop(method));
    Panel.draw_controls(byId('controls'), scene, changed);
    Panel.show_values(byId('controls'), scene);
    show_switches();
    solve();
  }

  const open_lesson = (id, given) => {
    const lesson = Lessons.of(id) ?? Lessons.list[0];
    return open({path: lesson.scene, text: Scenes.shipped[lesson.scene], edited: false}, lesson, given);
  };

  /** Shows what the address asks for. */
  async function open_address() {
    const given = Link.read();
    if (given.scene) return open({path: 'scene.json', text: await Link.unpack(given.scene), edited: true}, null, given);
    if (given.json)
      return open(
          {path: 'scene.json', text: JSON.stringify(JSON.parse(given.json), null, 1), edited: true}, null, given);
    if (given.file && Scenes.shipped[given.file])
      return open({path: given.file, text: Scenes.shipped[given.file], edited: false}, null, given);
    return open_lesson(given.lesson ?? 'play', given);
  }

  /** Every quarter of a second: how far the methods are that take long. */
  function show_progress() {
    for (const method of scene ? METHODS : []) {
      const age = Solver.busy(method, 'main') ? Solver.age(method) : 0, {done, steps} = results[method]?.progress ?? {};
      const seconds = numeral(Math.floor(age));
      if (results[method]?.answer && Panel.show_stale(byId('columns'), method, is_stale(method))) show();
      Panel.show_progress(
          byId('columns'), method,
          age < 1 ? '' :
          done    ? say('solving', {done, steps, seconds}) :
                    say('waiting', {seconds}));
    }
  }

  function start() {
    Words.fill();
    const lesson = byId('lesson');
    for (const one of Lessons.list) lesson.append(Panel.make('option', {value: one.id}, say(one.id + '.name')));
    lesson.append(Panel.make('option', {value: '', hidden: ''}, say('editor.title')));
    lesson.addEventListener('change', () => open_lesson(lesson.value));
    byId('response').addEventListener('change', (event) => choose({response: event.target.value}));
    byId('parameter').addEventListener('change', (event) => choose({parameter: event.target.value}));
    byId('shown').addEventListener('change', (event) => choose({derivative: event.target.value === 'derivative'}));
    byId('accuracy').addEventListener('input', (event) => choose({accuracy: Number(event.target.value)}));
    byId('step').addEventListener('input', (event) => {
      shown.step = Number(event.target.value) === Number(event.target.max) ? null : Number(event.target.value);
      show();
    });
    byId('sweep').addEventListener('click', start_sweep);
    byId('print').addEventListener('click', () => print());
    byId('copy-link').addEventListener('click', async () => {
      const url = location.href.replace(/#.*/, '') + await address();
      try {
        history.replaceState(null, '', url);
      } catch { /* as above */
      }
      byId('live').textContent =
          await navigator.clipboard.writeText(url).then(() => say('link.copied'), () => say('link.failed'));
      byId('copy-link').textContent = byId('live').textContent;
      setTimeout(() => {
        byId('copy-link').textContent = say('link.copy');
      }, 2500);
    });
    for (const form of document.forms)
      if (form.id !== 'prediction') form.addEventListener('submit', (event) => event.preventDefault());
    const notices = Panel.make('details', {}, Panel.make('summary', {}, say('footer.licences')), Panel.make('pre'));
    notices.addEventListener('toggle', () => {
      notices.querySelector('pre').textContent = byId('notices').textContent;
    });
    byId('footer').append(
        Panel.make('p', {}, say('reference.words')), Panel.make('p', {}, say('footer', about)), notices);
    Editor.start((source) => open(source, null));
    setInterval(show_progress, 250);
    addEventListener('hashchange', open_address);
    addEventListener('resize', show);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => scene && show());
    Solver.compiled.catch((error) => {
      byId('scene-title').textContent = say('failed.browser', {why: error.message});
    });
    open_address();
  }

  Solver.warm(...METHODS);
  addEventListener('DOMContentLoaded', start);
  return {open_lesson};
})();
