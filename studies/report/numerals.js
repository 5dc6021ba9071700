'use strict';
/** The numbers of a report and of the page for learners, in the style of studies/io/numerals.hpp. */
const Numerals = (() => {
  /** So many significant digits; of six or more, whole numbers below 10⁷ keep theirs, but for thousands. */
  function numeral(x, digits = 6) {
    const rounded = +x.toPrecision(digits), size = Math.abs(rounded);
    if (size >= 10 ** digits && size < 1e4) return x.toFixed(0);
    if (size === 0 || (size >= 1e-3 && size < 1e4)) return String(rounded);
    return digits >= 6 && Number.isInteger(x) && size < 1e7 && x % 1000 ? String(x) :
        x.toExponential(digits - 1).replace(/\.?0*e\+?/, 'e');
  }

  /** A numeral with its power of ten as one writes it: "2·10⁻⁴" of "2e-4". */
  const powered = (text) => text.replace(/^(-?)(1?)(.*)e(-?)(\d+)$/, (all, sign, one, rest, minus, digits) =>
      sign + (one && !rest ? '' : one + rest + '·') + '10' + (minus && '⁻') + [...digits].map((d) => '⁰¹²³⁴⁵⁶⁷⁸⁹'[d]).join(''));

  return {numeral, powered};
})();
