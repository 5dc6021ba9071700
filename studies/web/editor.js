'use strict';
/** The editor: a scene as text, checked while it is typed. */
const Editor = (() => {
  const {say, numeral} = Words;
  const byId = (id) => document.getElementById(id);
  let timer = 0, last = null, given = '';

  /** Whether a browser should solve a scene of this size. */
  const bears = (size) =>
      size.displacements <= Scenes.MOST.displacements && Scenes.length_of(size) <= Scenes.MOST.length &&
      size.bytes <= Scenes.MOST.bytes;
  const too_large = (size) => say('editor.too-large', {
    ...size,
    megabytes: numeral(Math.round(size.bytes / 1e6)),
    most: numeral(Scenes.MOST.displacements),
    most_over_steps: numeral(Scenes.MOST.length),
    most_megabytes: numeral(Scenes.MOST.bytes / 1e6)
  });

  function select(line, column) {
    const text = byId('text'), lines = text.value.split('\n');
    const start = lines.slice(0, line - 1).reduce((sum, one) => sum + one.length + 1, 0) + Math.max(0, column - 1);
    text.focus();
    text.setSelectionRange(start, start + 1);
    text.scrollTop = (line - 5) * text.scrollHeight / lines.length;
  }

  /** Shows what is wrong with the text, located as in the terminal; true if nothing is. */
  function show(answer) {
    const place = byId('faults');
    place.replaceChildren();
    const {faults = [], notes = [], size, broken} = answer;
    if (broken) {
      place.append(Panel.make('p', {class: 'fault'}, say('broken', {why: broken})));
      return false;
    }
    if (faults.length) place.append(Panel.make('p', {}, say('editor.faults', {count: faults.length})));
    const list = place.appendChild(Panel.make('ul'));
    for (const fault of [...faults, ...notes]) {
      const item = list.appendChild(Panel.make('li'));
      if (fault.line) {
        const button = item.appendChild(Panel.make('button', {type: 'button', class: 'fault'}, fault.text));
        button.addEventListener('click', () => select(fault.line, fault.column));
      } else item.append(fault.text);
    }
    if (!faults.length && size)
      place.append(Panel.make(
          'p', {class: bears(size) ? 'fine' : 'fault'},
          bears(size) ?
              say('editor.fine',
                  {...size, displacements: numeral(size.displacements), contact_points: numeral(size.contact_points)}) +
                  (Scenes.is_long(size) ? ' ' + say('editor.slow') : '') :
              too_large(size)));
    return faults.length === 0 && Boolean(size) && bears(size);
  }

  /** Reads a text by the program's reader, in a worker; `name`: what messages call it. */
  async function check(text, name) {
    if (Solver.age('check') > 2) Solver.stop('check');
    const got = await Solver.ask('check', 'check', {scene: text, file: name, solve: false});
    return got?.answer ?? null;
  }

  async function check_now() {
    const answer = await check(byId('text').value, 'scene.json');
    if (!answer) return;
    last = show(answer);
    byId('run').disabled = !last;
  }

  /** Takes files: meshes lie beside the scene, a scene is shown. */
  async function take(files) {
    for (const file of files) {
      const text = await file.text();
      if (file.name.endsWith('.msh')) {
        Solver.add_file(file.name, text);
        byId('faults').replaceChildren(Panel.make('p', {class: 'fine'}, say('editor.mesh-added', {name: file.name})));
      } else byId('text').value = text;
    }
    open(true);
    check_now();
  }

  function open(shown) {
    byId('editor').hidden = !shown;
    byId('open-editor').textContent = say(shown ? 'editor.close' : 'editor.open');
    byId('open-editor').setAttribute('aria-expanded', shown);
    if (shown) byId('editor').scrollIntoView({block: 'start'});
  }

  /** `run`: gets {path, text, edited}. */
  function start(run) {
    const shipped = byId('shipped');
    shipped.append(Panel.make('option', {value: ''}, say('editor.choose')));
    for (const path of Object.keys(Scenes.shipped))
      shipped.append(Panel.make('option', {value: path}, path.split('/').at(-1)));
    shipped.addEventListener('change', () => {
      if (shipped.value) {
        set(Scenes.shipped[shipped.value]);
        check_now();
      }
    });
    byId('text').addEventListener('input', () => {
      clearTimeout(timer);
      timer = setTimeout(check_now, 250);
    });
    byId('run').addEventListener('click', async () => {
      await check_now();
      if (last) run({path: 'scene.json', text: byId('text').value, edited: true});
    });
    byId('open-file').addEventListener('change', (event) => take(event.target.files));
    byId('open-editor').addEventListener('click', () => {
      open(byId('editor').hidden);
      if (!byId('editor').hidden) {
        if (byId('text').value === given) set(Scenes.text_of(State.scene));  // as the controls say
        check_now();
        byId('text').focus({preventScroll: true});
      }
    });
    addEventListener('dragover', (event) => event.preventDefault());
    addEventListener('drop', (event) => {
      event.preventDefault();
      take(event.dataTransfer.files);
    });
  }

  const set = (text) => {
    byId('text').value = given = text;
  };

  return {start, set, show, check, open, bears, too_large};
})();
