'use strict';
/** The page: what it opens, and what its controls change. */
const Page = (() => {
  const {say} = Words;
  const METHODS = Scenes.METHODS, VIEWS = ['cost', 'knob', 'steps', 'contact'];
  const byId = (id) => document.getElementById(id);
  const about = JSON.parse(byId('about').textContent);

  async function address() {
    const values = {
      lesson: State.scene.lesson?.id,
      predicted: State.predicted,
      response: State.shown.response,
      by: State.shown.parameter,
      shown: State.shown.derivative ? 'derivative' : null,
      view: State.shown.view,
      drawn: State.shown.drawn,
      accuracy: State.shown.accuracy,
      knob: State.scene.knob
    };
    if (!State.scene.lesson)
      values[State.scene.source.edited ? 'scene' : 'file'] =
          State.scene.source.edited ? await Link.pack(State.scene.source.text) : State.scene.source.path;
    for (const control of Object.values(State.scene.controls))
      if (control.value !== control.initial) values['c.' + control.name] = control.value;
    return Link.write(values);
  }

  /** A control was moved. */
  function changed() {
    Panel.show_values(byId('controls'), State.scene);
    Ask.solve();
  }

  /** Another response, parameter or view of the same answers. */
  function choose(more) {
    const derivative = State.shown.derivative, parameter = State.shown.parameter;
    Object.assign(State.shown, more);
    if (State.shown.derivative !== derivative || State.shown.parameter !== parameter || more.response) State.trail = [];
    if (State.shown.derivative && (!derivative || State.shown.parameter !== parameter)) Ask.solve();
    show_switches();
    Show.all();
    Show.after_change();
  }

  /** Whether steps have derivatives of responses: an adjoint has those of objectives alone. */
  const has_derivatives = (document) =>
      document.sensitivity?.mode !== 'adjoint' && Derivative.movable(document).length > 0;

  function show_switches() {
    const options = (select, names, chosen) => {
      select.replaceChildren(...names.map((name) => Panel.make('option', {value: name}, name)));
      select.value = chosen;
    };
    options(byId('response'), Object.keys(State.scene.document.responses ?? {}), State.shown.response);
    const parameters = Derivative.movable(State.scene.document);
    options(byId('parameter'), parameters, State.shown.parameter);
    byId('by').hidden = !State.shown.derivative;
    for (const input of document.querySelectorAll('[name="shown"]')) {
      input.checked = (input.value === 'derivative') === State.shown.derivative;
      input.disabled = !has_derivatives(State.scene.document);
    }
    byId('views').setAttribute('aria-label', say('view'));
    byId('views').replaceChildren(...VIEWS.map((view) => {
      const input = Panel.make('input', {type: 'radio', name: 'view', value: view});
      input.checked = view === State.shown.view;
      input.addEventListener('change', () => choose({view}));
      return Panel.make('label', {}, input, ' ' + say('view.' + view));
    }));
  }

  /** The content of a scene file, which may have comments. */
  const without_comments = (text) => JSON.parse(
      text.replace(/"(?:\\.|[^"\\])*"|\/\/[^\n]*|\/\*[^]*?\*\//g, (part) => part[0] === '"' ? part : ''));

  /** A scene of an address: its own text if it has lines, else one that can be read. */
  function as_written(text) {
    const content = without_comments(text);
    return text.includes('\n') ? text : JSON.stringify(content, null, 1);
  }

  /** Shows a scene: reads it, makes its controls, solves. `given`: of the address. */
  async function open(source, lesson, given = {}) {
    // (A lesson's scene has no fault and is small: it is solved at once.)
    const answer = lesson ? {document: without_comments(source.text)} :
                            await Editor.check(source.text, source.path.split('/').at(-1));
    if (!answer) return;
    if (!lesson && (!answer.document || !Editor.bears(answer.size))) {
      Editor.set(source.text);
      Editor.open(true);
      Editor.show(answer);
      return;
    }
    State.scene = Scenes.make(source, lesson, answer.document, answer.size);
    State.scene.every = lesson || !Scenes.is_long(answer.size) ? 1 : 0;
    const number = (text) => Number.isFinite(Number(text)) ? Number(text) : null;
    if (given.knob !== undefined) State.scene.knob = number(given.knob);
    for (const control of Object.values(State.scene.controls)) {
      const value = number(given['c.' + control.name] ?? 'none');
      if (value === null) continue;
      const [from, to] = control.choices ? [0, control.choices.length - 1] : [control.from, control.to];
      control.value = Math.min(to, Math.max(from, control.choices ? Math.round(value) : value));
    }
    const responses = Object.keys(answer.document.responses ?? {}), parameters = Derivative.movable(answer.document);
    const among = (names, ...wanted) => wanted.find((name) => names.includes(name)) ?? names[0];
    State.shown = {
      response: among(responses, given.response, lesson?.response),
      parameter: among(parameters, given.by, lesson?.parameter, 'mu'),
      derivative: (given.shown ?? lesson?.shown) === 'derivative' && has_derivatives(answer.document),
      view: among(VIEWS, given.view, lesson?.view),
      drawn: among(METHODS, given.drawn, lesson?.drawn, 'monolithic_al'),
      accuracy: number(given.accuracy ?? -3) ?? -3,
      step: null
    };
    State.results = {};
    State.reference = {key: '', answer: null};
    State.trail = [];
    State.sweep = [];
    State.sweeping = null;
    State.predicted = given.predicted ?? null;
    State.answered = !Lessons.asks(lesson);
    byId('sweep').textContent = say('sweep');
    byId('lesson').value = lesson?.id ?? '';
    byId('accuracy').value = State.shown.accuracy;
    byId('verdict').textContent = '';
    byId('scene-title').textContent = answer.document.title ?? (lesson ? say(lesson.id + '.scene') : source.path);
    Charts.clear(byId('chart'));
    Editor.set(source.text);
    byId('arrow').hidden = true;
    byId('picture').replaceChildren();
    Panel.draw_columns(
        byId('columns'), State.shown.drawn, (method) => choose({drawn: method}), (method) => Solver.stop(method));
    Panel.draw_controls(byId('controls'), State.scene, changed);
    Panel.show_values(byId('controls'), State.scene);
    show_switches();
    Ask.solve();
    show_answered();
    Lessons.draw(lesson, State.predicted, (predicted) => {
      State.predicted = predicted;
      State.answered = true;
      show_answered();
    });
  }

  /** Nothing can be moved before the prediction is made. */
  function show_answered() {
    document.body.classList.toggle('unanswered', !State.answered);
    byId('controls').inert = byId('time').inert = !State.answered;
    if (!State.answered) return;
    if (State.scene.lesson?.sweep && !State.sweep.length) Ask.start_sweep();
    Show.all();
    Show.after_change();
  }

  const open_lesson = (id, given) => {
    const lesson = Lessons.of(id) ?? Lessons.list[0];
    return open({path: lesson.scene, text: Scenes.shipped[lesson.scene], edited: false}, lesson, given);
  };

  /** Shows what the address asks for. */
  async function open_address() {
    const given = Link.read();
    let own = null;
    try {
      if (given.scene) own = await Link.unpack(given.scene);
      else if (given.json) own = as_written(given.json);
    } catch {
      await open_lesson('play');
      Editor.open(true);
      Editor.show({faults: [{text: say('link.damaged')}]});
      return;
    }
    if (own !== null) return open({path: 'scene.json', text: own, edited: true}, null, given);
    if (given.file && Scenes.shipped[given.file])
      return open({path: given.file, text: Scenes.shipped[given.file], edited: false}, null, given);
    return open_lesson(given.lesson ?? 'play', given);
  }

  function start() {
    Words.fill();
    const lesson = byId('lesson');
    for (const one of Lessons.list) lesson.append(Panel.make('option', {value: one.id}, say(one.id + '.name')));
    lesson.append(Panel.make('option', {value: '', hidden: ''}, say('editor.title')));
    lesson.addEventListener('change', () => {
      location.hash = Link.write({lesson: lesson.value});  // opens it, and the way back leads here
    });
    byId('response').addEventListener('change', (event) => choose({response: event.target.value}));
    byId('parameter').addEventListener('change', (event) => choose({parameter: event.target.value}));
    byId('shown').addEventListener('change', (event) => choose({derivative: event.target.value === 'derivative'}));
    byId('accuracy').addEventListener('input', (event) => choose({accuracy: Number(event.target.value)}));
    byId('step').addEventListener('input', (event) => {
      State.shown.step = Number(event.target.value) === Number(event.target.max) ? null : Number(event.target.value);
      Show.all();
    });
    byId('sweep').addEventListener('click', Ask.start_sweep);
    byId('print').addEventListener('click', () => print());
    byId('copy-link').addEventListener('click', async () => {
      const url = location.href.replace(/#.*/, '') + await address();
      try {
        history.replaceState(null, '', url);
      } catch { /* a page that was opened from a file may not change its address */
      }
      byId('live').textContent =
          await navigator.clipboard.writeText(url).then(() => say('link.copied'), () => say('link.failed'));
      byId('copy-link').textContent = say(byId('live').textContent === say('link.copied') ? 'link.done' : 'link.not');
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
    const meanings = Object.keys(Words.shipped).filter((key) => key.startsWith('what.')).map(Words.explained);
    byId('meanings').append(
        ...meanings.flatMap(([term, words]) => [Panel.make('dt', {}, term), Panel.make('dd', {}, words)]));
    byId('footer').append(
        Panel.make('p', {}, say('reference.words')), Panel.make('p', {}, say('footer', about)), notices);
    Editor.start(async (source) => {
      try {
        history.pushState(null, '', location.href);  // the way back leads to what was there before
      } catch { /* a file:// page in a browser that forbids it */
      }
      await open(source, null, {knob: State.scene.knob ?? undefined});
      byId('scene-title').scrollIntoView();
      byId('scene-title').focus();
    });
    setInterval(Show.progress, 250);
    addEventListener('hashchange', open_address);
    document.querySelector('.skip').addEventListener('click', (event) => {
      event.preventDefault();  // the part of the address behind # is the state of the page
      byId('scene-title').focus();
    });
    addEventListener('resize', Show.all);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => State.scene && Show.all());
    Solver.compiled.catch((error) => {
      byId('scene-title').textContent = say('failed.browser', {why: error.message});
    });
    open_address();
  }

  Solver.warm(...METHODS);
  addEventListener('DOMContentLoaded', start);

  return {changed, address};
})();
