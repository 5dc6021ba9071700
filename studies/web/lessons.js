'use strict';
/** The card of a lesson: its question, a prediction, and what to see. */
const Lessons = (() => {
  const {say} = Words;
  const list = JSON.parse(document.getElementById('lessons').textContent);
  const byId = (id) => document.getElementById(id);
  const of = (id) => list.find((lesson) => lesson.id === id);

  const choices_of = (lesson) => {
    const choices = [];
    while (Words.has(`${lesson.id}.${choices.length}`)) choices.push(say(`${lesson.id}.${choices.length}`));
    return choices;
  };

  /** Shows a lesson's card; `on_answer` is called once a prediction is made, or none is wanted. */
  function draw(lesson, answered, on_answer) {
    const asks = lesson && Words.has(lesson.id + '.question');
    byId('card').hidden = !asks;
    if (!asks) return;
    byId('card-title').textContent = say(lesson.id + '.name');
    byId('question').textContent = say(lesson.id + '.question');
    const form = byId('prediction'), see = byId('see');
    form.replaceChildren();
    see.hidden = true;
    choices_of(lesson).forEach((choice, i) => {
      const input = Panel.make('input', {type: 'radio', name: 'prediction', value: i});
      input.addEventListener('change', () => {
        form.querySelector('.show').disabled = false;
      });
      form.append(Panel.make('label', {}, input, ' ' + choice));
    });
    const show = Panel.make('button', {type: 'submit', class: 'show', disabled: ''}, say('predict.show'));
    const skip = Panel.make('button', {type: 'button', class: 'skip-prediction'}, say('predict.skip'));
    form.append(Panel.make('p', {class: 'buttons'}, show, ' ', skip));
    const answer = (predicted) => {
      const right = choices_of(lesson)[lesson.right];
      const verdict = predicted === null         ? 'predict.none' :
                      predicted === lesson.right ? 'predict.right' :
                                                   'predict.wrong';
      const mark = Panel.make(
          'p', {class: 'verdict ' + (predicted === lesson.right ? 'right' : 'wrong')},
          say(verdict, {answer: right.replace(/\.$/, '')}));
      see.replaceChildren(mark, Panel.make('p', {}, say(lesson.id + '.see')));
      see.hidden = false;
      form.hidden = true;
      on_answer();
    };
    form.hidden = false;
    form.onsubmit = (event) => {
      event.preventDefault();
      const chosen = form.querySelector('input:checked');
      if (chosen) answer(Number(chosen.value));
    };
    skip.addEventListener('click', () => answer(null));
    if (answered) answer(null);
  }

  const asks = (lesson) => Boolean(lesson && Words.has(lesson.id + '.question'));

  return {list, of, draw, asks};
})();
