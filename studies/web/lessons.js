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

  /**
   * Shows a lesson's card. `predicted`: number of a choice, 'none' if the answer is wanted without one, null if nothing
   * was chosen yet; `on_answer` gets it once it is there.
   */
  function draw(lesson, predicted, on_answer) {
    byId('card').hidden = !lesson;
    if (!lesson) return;
    byId('card-title').textContent = say(lesson.id + '.name');
    byId('question').textContent = say(lesson.id + (asks(lesson) ? '.question' : '.see'));
    const form = byId('prediction'), see = byId('see');
    form.replaceChildren();
    form.hidden = !asks(lesson);
    see.hidden = asks(lesson);
    byId('card').className = asks(lesson) ? '' : 'intro';
    see.replaceChildren(next_of(lesson));
    if (!asks(lesson)) return;
    const choices = choices_of(lesson);
    choices.forEach((choice, i) => {
      const input = Panel.make('input', {type: 'radio', name: 'prediction', value: i});
      input.addEventListener('change', () => {
        form.querySelector('.show').disabled = false;
      });
      form.append(Panel.make('label', {}, input, ' ' + choice));
    });
    const show = Panel.make('button', {type: 'submit', class: 'show', disabled: ''}, say('predict.show'));
    const skip = Panel.make('button', {type: 'button', class: 'skip-prediction'}, say('predict.skip'));
    form.append(Panel.make('p', {class: 'buttons'}, show, ' ', skip));
    const answer = (chosen) => {
      const is_right = chosen === String(lesson.right), plain = (i) => choices[i]?.replace(/\.$/, '');
      const verdict = is_right ? 'predict.right' : choices[chosen] ? 'predict.wrong' : 'predict.none';
      see.replaceChildren(
          Panel.make(
              'p', {class: 'verdict ' + (is_right ? 'right' : 'wrong')},
              say(verdict, {answer: plain(lesson.right), choice: plain(chosen)})),
          Panel.make('p', {}, say(lesson.id + '.see')), next_of(lesson));
      byId('card').className = 'answered';
      see.hidden = false;
      form.hidden = true;
      on_answer(chosen);
    };
    const answer_now = (chosen) => {
      answer(chosen);
      see.focus();
    };
    form.onsubmit = (event) => {
      event.preventDefault();
      const chosen = form.querySelector('input:checked');
      if (chosen) answer_now(chosen.value);
    };
    skip.addEventListener('click', () => answer_now('none'));
    if (predicted !== null) answer(predicted);
  }

  /** A link to the lesson after this one. */
  function next_of(lesson) {
    const next = list[list.indexOf(lesson) + 1];
    return next ? Panel.make(
                      'a', {class: 'next', href: Link.write({lesson: next.id})},
                      say('next', {lesson: say(next.id + '.name')})) :
                  '';
  }

  const asks = (lesson) => Boolean(lesson && Words.has(lesson.id + '.question'));

  return {list, of, draw, asks};
})();
