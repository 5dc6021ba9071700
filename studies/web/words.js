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

  /** A number: a power of ten below 0.001 and from 10000 on, as in the report. */
  function numeral(x, digits = 6) {
    if (!Number.isFinite(x)) return say('no-number');
    if (Number.isInteger(x) && Math.abs(x) < 1e7 && digits >= 6) return String(x).replace('-', '−');
    if (x === 0 || (Math.abs(x) >= 1e-3 && Math.abs(x) < 1e4)) return String(+x.toPrecision(digits)).replace('-', '−');
    const [mantissa, power] = x.toExponential(digits - 1).split('e');
    const factor = String(+mantissa).replace('-', '−');
    const raised = [...power.replace('+', '')].map((c) => c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[c]).join('');
    return (factor === '1' ? '' : factor === '−1' ? '−' : factor + '·') + '10' + raised;
  }

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
