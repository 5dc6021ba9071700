'use strict';
/** The words of the page, all in words.LANGUAGE.json, and its numbers. */
const Words = (() => {
  const words = JSON.parse(document.getElementById('words').textContent);

  /** The words of a key, with values in place of {names}. */
  const say = (key, values = {}) => (words[key] ?? key).replace(/\{(\w+)\}/g, (all, name) => values[name] ?? all);
  const has = (key) => key in words;

  /** A term and what it means, of words "term: meaning". */
  const explained = (key) => {
    const cut = words[key].indexOf(': ');
    return [words[key].slice(0, cut), words[key].slice(cut + 2)];
  };

  /** A number as in the report, with the sign of a formula. */
  const numeral = (x, digits) =>
      Number.isFinite(x) ? Numerals.powered(Numerals.numeral(x, digits)).replace('-', '−') : say('no-number');

  /** Puts words where the page asks for them. */
  function fill(within = document) {
    for (const place of within.querySelectorAll('[data-word]')) place.textContent = say(place.dataset.word);
    for (const place of within.querySelectorAll('[data-label]'))
      place.setAttribute('aria-label', say(place.dataset.label));
    document.documentElement.lang = words.language;
    document.title = say('title');
  }

  return {say, has, explained, numeral, fill, shipped: words};
})();
