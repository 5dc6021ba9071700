'use strict';
/** The controls below the picture, and the three columns. */
const Panel = (() => {
  const {say, numeral} = Words;
  const make = (name, attributes = {}, ...inside) => {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...inside);
    return made;
  };

  const name_of = (scene, control) => {
    const own = `load.${scene.lesson?.id}`;
    if (control.name === 'load')
      return Words.has(own) ? say(own) : say(control.factor ? 'control.load.factor' : 'control.load');
    if (control.name === 'steps' && !control.pointers['/time/steps'])
      return say(control.pointers['/time/legs/0/1'] ? 'control.steps.first' : 'control.steps.last');
    return control.place ? say('control.place', {name: control.place}) : say('control.' + control.name);
  };

  /** A slider with its value; `on_input` gets the number. */
  function slider(id, label, {from, to, step, value}, shown, on_input) {
    const input = make('input', {type: 'range', id, min: from, max: to, step});
    input.value = value;
    const output = make('output', {for: id
    }, shown(value));
    input.addEventListener('input', () => on_input(Number(input.value)));
    return make('div', {class: 'control'}, make('label', {for: id
                }, label), input, output);
  }

  /** Puts the controls of a scene in their place. */
  function draw_controls(place, scene, changed) {
    place.replaceChildren();
    const [from, to] = scene.knob_range, at_auto = from - 1;
    const knob_words = (value) =>
        value < from ? say('control.knob.auto') : numeral(Number((10 ** value).toPrecision(3)), 3);
    place.append(slider(
        'control-knob', say('control.knob'), {from: at_auto, to, step: 0.25, value: scene.knob ?? at_auto}, knob_words,
        (value) => {
          scene.knob = value < from ? null : value;
          changed();
        }));
    for (const name
             of ['friction', 'load', 'steps',
                 ...Object.keys(scene.controls).filter((key) => !['friction', 'load', 'steps'].includes(key))]) {
      const control = scene.controls[name];
      if (!control) {
        place.append(make(
            'div', {class: 'control none'}, make('span', {class: 'label'}, say('control.' + name)),
            make('span', {class: 'note'}, say('control.none'))));
      } else if (control.choices) {
        const group = make('fieldset', {class: 'control'}, make('legend', {}, say('control.' + name)));
        control.choices.forEach((choice, i) => {
          const input = make('input', {type: 'radio', name: 'choice-' + name, value: i});
          input.checked = i === control.value;
          input.addEventListener('change', () => {
            control.value = i;
            changed();
          });
          group.append(make('label', {}, input, ' ' + say(`choice.${name}.${i}`)));
        });
        place.append(group);
      } else {
        place.append(slider(
            'control-' + name.replaceAll(' ', '-'), name_of(scene, control), control, (value) => numeral(value, 4),
            (value) => {
              control.value = value;
              changed();
            }));
      }
    }
  }

  /** Gives the sliders the values that the controls have. */
  function show_values(place, scene) {
    const set = (name, value, words) => {
      const input = document.getElementById('control-' + name.replaceAll(' ', '-'));
      if (!input) return;
      input.value = value;
      input.setAttribute('aria-valuetext', words);
      input.parentElement.querySelector('output').textContent = words;
    };
    set('knob', scene.knob ?? scene.knob_range[0] - 1,
        scene.knob === null ? say('control.knob.auto') : numeral(Number((10 ** scene.knob).toPrecision(3)), 3));
    for (const control of Object.values(scene.controls))
      if (!control.choices) set(control.name, control.value, numeral(control.value, 4));
  }

  /** Empty columns, one a method. */
  function draw_columns(place, drawn, choose, stop) {
    place.replaceChildren();
    for (const method of Scenes.METHODS) {
      const pick = make('input', {type: 'radio', name: 'drawn', value: method});
      pick.checked = method === drawn;
      pick.addEventListener('change', () => choose(method));
      const button = make('button', {type: 'button', class: 'stop', hidden: ''}, say('stop'));
      button.addEventListener('click', () => stop(method));
      place.append(make(
          'section', {class: 'column', 'data-method': method, 'aria-label': say(method)},
          make('h3', {}, make('span', {class: 'dot'}), say(method)), make('p', {class: 'status'}), make('dl'),
          make('p', {class: 'progress'}), button,
          make('label', {class: 'pick'}, pick, ' ' + say('draw'))));
    }
  }

  /** Rows [name, text, class] of a column. */
  function show_column(place, method, status, is_bad, rows) {
    const column = place.querySelector(`[data-method="${method}"]`);
    column.querySelector('.status').textContent = status;
    column.classList.toggle('bad', is_bad);
    column.querySelector('dl').replaceChildren(...rows.flatMap(
        ([name, text, kind = '']) =>
            [make('dt', Words.has('what.' + kind) ? {title: Words.explained('what.' + kind)[1]} : {}, name),
             make('dd', {class: kind + (text.includes(' ') ? ' words' : ''), 'data-value': kind}, text)]));
  }

  /** What methods say, {text: [method, ...]}: each text once. */
  function show_messages(place, messages) {
    place.replaceChildren(...Object.entries(messages).map(
        ([text, methods]) => make('p', {}, make('b', {}, methods.join(', ') + ': '), text)));
  }

  /** Whether the numbers of a column are those of former controls; returns whether that is new. */
  function show_stale(place, method, is_stale) {
    const column = place.querySelector(`[data-method="${method}"]`),
          changes = column.classList.contains('stale') !== is_stale;
    column.classList.toggle('stale', is_stale);
    return changes;
  }

  /** How far a method is; no text: it is done. */
  function show_progress(place, method, text) {
    const column = place.querySelector(`[data-method="${method}"]`);
    column.querySelector('.progress').textContent = text;
    column.querySelector('.stop').hidden = !text;
  }

  return {
    draw_controls,
    show_values,
    draw_columns,
    show_column,
    show_messages,
    show_stale,
    show_progress,
    name_of,
    make
  };
})();
