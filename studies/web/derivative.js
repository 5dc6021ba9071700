'use strict';
/** A derivative held against two further runs: an arrow in a small chart of response over parameter. */
const Derivative = (() => {
  const {say, numeral} = Words;

  /** Pointers of a parameter with their weights; none if no number of the scene stands behind it. */
  function pointers_of(document, name) {
    const given = document.parameters?.[name];
    if (typeof given === 'string') return {[given]: 1};
    return given && Object.values(given).every((weight) => typeof weight === 'number') ? given : null;
  }

  /** Parameters that a second run can move. */
  const movable = (document) =>
      Object.keys(document.parameters ?? {})
          .filter(
              (name) => pointers_of(document, name) &&
                        Object.keys(pointers_of(document, name))
                            .every((pointer) => typeof Scenes.at(document, pointer) === 'number'));

  /** The parameter's value, and by how much the two further runs move it. */
  function step_of(document, name, given) {
    const [[pointer, weight]] = Object.entries(pointers_of(document, name));
    const value = Scenes.at(document, pointer) / weight;
    return {value, step: given ?? (Math.abs(value) * 0.02 || 0.01)};
  }

  /** {pointer: value} of a run with the parameter moved. */
  const moved = (document, name, by) =>
      Object.fromEntries(Object.entries(pointers_of(document, name))
                             .map(([pointer, weight]) => [pointer, Scenes.at(document, pointer) + weight * by]));

  /** Derivatives of a response at a step of result.json: {value, sides: [below, above] or none}. */
  function read(step, response, parameter) {
    const value = step?.sensitivities?.[response]?.[parameter] ?? NaN;
    const sides = step?.one_sided?.[response]?.[parameter];
    const apart = sides && sides.every(Number.isFinite) &&
                  Math.abs(sides[0] - sides[1]) > 1e-9 * Math.max(...sides.map(Math.abs));
    return {value, sides: apart ? sides : null};
  }

  /** Draws the arrow. `at`: {value, step, response, less, more} of one method; `slope`: from read(). */
  function draw(place, at, slope, names) {
    const WIDTH = 250, HEIGHT = 116, left = 12, right = 238, top = 14, bottom = 92;
    const {element, arrow} = Picture, reach = 1.5 * at.step;
    const ends = slope.sides ? [[-reach, slope.sides[0]], [reach, slope.sides[1]]] : [[reach, slope.value]];
    const values =
        [at.response, at.less, at.more, ...ends.map(([by, s]) => at.response + by * s)].filter(Number.isFinite);
    let [low, high] = [Math.min(...values), Math.max(...values)];
    if (high - low <= 1e-12 * Math.max(Math.abs(low), Math.abs(high))) {
      const air = Math.abs(high) || 1;
      low -= 0.01 * air;
      high += 0.01 * air;
    }
    const x = (by) => left + (right - left) * (by + reach) / (2 * reach),
          y = (value) => bottom - (bottom - top) * (value - low) / (high - low);
    const svg = element('svg', {viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: 'img', 'aria-label': say('arrow.alt', names)});
    svg.append(element('path', {d: `M${left},${bottom + 6}H${right}`, class: 'axis'}));
    for (const [by, text] of [
             [-at.step, numeral(at.value - at.step, 3)], [0, numeral(at.value, 3)],
             [at.step, numeral(at.value + at.step, 3)]])
      svg.append(element('text', {x: x(by), y: bottom + 20, 'text-anchor': 'middle'}, text));
    svg.append(element(
        'text', {x: right, y: top, 'text-anchor': 'end', class: 'soft'}, `${names.response} / ${names.parameter}`));
    for (const [by, s] of ends)
      if (Number.isFinite(s))
        svg.append(arrow([x(0), y(at.response)], [x(by), y(at.response + by * s)], {class: 'slope'}));
    for (const [by, value] of [[-at.step, at.less], [at.step, at.more]])
      if (Number.isFinite(value)) svg.append(element('circle', {cx: x(by), cy: y(value), r: 4, class: 'run'}));
    svg.append(element('circle', {cx: x(0), cy: y(at.response), r: 4, class: 'here'}));
    const plus = (x) => (x >= 0 ? '+' : '') + numeral(x, 5);
    const words =
        !Number.isFinite(at.less) || !Number.isFinite(at.more) ?
            say('arrow.failed') :
        slope.sides ?
            say('arrow.sides', {
              ...names,
              below: numeral(slope.sides[0], 5),
              above: numeral(slope.sides[1], 5),
              step: plus(at.step),
              run: plus(at.more - at.response),
              other: plus(at.less - at.response)
            }) :
            say('arrow.words',
                {...names, step: plus(at.step), arrow: plus(slope.value * at.step), run: plus(at.more - at.response)});
    place.replaceChildren(svg, Panel.make('p', {class: 'note'}, words));
  }

  return {pointers_of, movable, step_of, moved, read, draw};
})();
