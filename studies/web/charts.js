'use strict';
/** The chart below the columns: error against work or stiffness, a response over the steps, tractions at the contact. */
const Charts = (() => {
  const {say, numeral} = Words;
  const SHAPES = {penalty: 'circle', uzawa_al: 'square', monolithic_al: 'triangle-up'};
  const GROUND = 1e-18;  // where errors of exactly 0 stand
  const dark = matchMedia('(prefers-color-scheme: dark)');
  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const colors = () => Object.fromEntries(Scenes.METHODS.map((method) => [method, css('--' + method)]));
  let view = null, key = '', library = null;

  /** The chart library, read when the first chart is drawn. */
  function load() {
    library ??= new Promise((done) => {
      const script = document.createElement('script');
      script.textContent = document.getElementById('vega').textContent;
      document.head.append(script);
      vega.expressionFunction('powered', numeral);
      done();
    });
    return library;
  }

  const methods = Scenes.METHODS, log = {type: 'log', nice: false};
  const by_method = (channel, values) => ({
    field: 'method',
    type: 'nominal',
    legend: null,
    scale: {domain: methods, range: methods.map((method) => values[method])},
  });
  const axis = (title, digits = 3) =>
      ({title, labelExpr: `powered(datum.value, ${digits})`, labelOverlap: true, tickCount: 5});
  const by_name = (tones) => ({
    field: 'name',
    type: 'nominal',
    legend: {title: null, orient: 'top', symbolOpacity: 1, labelLimit: 400, labelFontSize: 12},
    scale: {domain: Object.keys(tones), range: Object.values(tones).map((tone) => css('--' + tone))},
  });
  const kind = (name) => [{filter: `datum.kind === '${name}'`}];
  const tooltip = {field: 'tip'};

  /** Digits that tell the ticks of an axis apart; a domain around values that differ by rounding alone. */
  function extent(rows, field) {
    const values = rows.map((row) => row[field]), low = Math.min(...values), high = Math.max(...values),
          size = Math.max(Math.abs(low), Math.abs(high));
    if (!values.length) return {};
    if (high - low <= 1e-9 * size) return {domain: [low - 0.1 * size || -1, high + 0.1 * size || 1]};
    return {digits: Math.max(3, 2 + Math.ceil(Math.log10(size / (high - low))))};
  }

  /** Errors over work or stiffness. Names stand on two sides, since Uzawa and Monolithic often lie together. */
  function errors(titles) {
    const x = {field: 'x', type: 'quantitative', scale: {...log, padding: 80}, axis: axis(titles.x)};
    const y = {
      field: 'y',
      type: 'quantitative',
      scale: {...log, domain: [GROUND, 10], clamp: true},
      axis: {
        ...axis(titles.y),
        values: [GROUND, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 1],
        labelExpr: `datum.value <= ${2 * GROUND} ? '${say('chart.zero')}' : powered(datum.value, 3)`
      }
    };
    const color = by_method('color', colors()), shape = by_method('shape', SHAPES);
    const on_left = (yes, no) => ({expr: `datum.method === 'monolithic_al' ? ${yes} : ${no}`});
    return [
      {transform: kind('asked'), mark: {type: 'rule', strokeDash: [3, 3]}, encoding: {y}},
      {transform: kind('trail'), mark: {type: 'point', filled: true, size: 14, opacity: 0.35}, encoding: {x, y, color}},
      {
        transform: kind('sweep'),
        mark: {type: 'line', strokeWidth: 1.5, opacity: 0.6},
        encoding: {x, y, color, order: {field: 'order'}, detail: {field: 'method'}}
      },
      {
        transform: kind('sweep'),
        mark: {type: 'point', filled: false, size: 36},
        encoding: {x, y, color, shape, tooltip}
      },
      {
        transform: kind('now'),
        mark: {type: 'point', filled: true, size: 150, opacity: 1},
        encoding: {x, y, color, shape, tooltip}
      },
      {
        transform: kind('now'),
        mark: {type: 'text', dx: on_left(-10, 10), align: on_left("'right'", "'left'"), fontSize: 12},
        encoding: {x, y, color, text: {field: 'name'}}
      },
    ];
  }

  /** An axis that is not logarithmic. */
  const plain = (field, title, {digits, domain}, more = {}) => ({
    field,
    type: 'quantitative',
    scale: {zero: false, padding: 12, ...more, ...(domain && {domain, nice: false, padding: 0})},
    axis: axis(title, digits)
  });

  function steps(titles, {x: of_x, y: of_y, tones}) {
    const x = plain('x', titles.x, of_x, {nice: false}), y = plain('y', titles.y, of_y);
    const color = by_name(tones), shape = by_method('shape', SHAPES);
    return [
      {
        transform: kind('beside'),
        mark: {type: 'line', strokeWidth: 1.2, strokeDash: [4, 3]},
        encoding: {x, y, color, order: {field: 'order'}}
      },
      {
        transform: kind('line'),
        mark: {type: 'line', strokeWidth: 2},
        encoding: {x, y, color, order: {field: 'order'}, detail: {field: 'method'}}
      },
      {
        transform: kind('line'),
        mark: {type: 'point', filled: false, size: 20},
        encoding: {x, y, color, shape, tooltip}
      },
      {transform: kind('here'), mark: {type: 'point', filled: true, size: 110}, encoding: {x, y, color, tooltip}},
    ];
  }

  function contact(titles, {x: of_x, tones}) {
    const x = plain('x', titles.x, of_x, {nice: false});
    const y = {field: 'y', type: 'quantitative', axis: axis(titles.y)};
    const color = by_name(tones);
    return [
      {
        transform: kind('exact'),
        mark: {type: 'line', strokeWidth: 1.2},
        encoding: {x, y, color, order: {field: 'order'}, detail: {field: 'line'}}
      },
      {
        transform: kind('point'),
        mark: {type: 'line', strokeWidth: 1, strokeDash: [2, 2]},
        encoding: {x, y, color, order: {field: 'order'}, detail: {field: 'line'}}
      },
      {
        transform: kind('point'),
        mark: {type: 'point', filled: true, size: 40, opacity: 1},
        encoding: {x, y, color, tooltip}
      },
    ];
  }

  function config() {
    const ink = css('--ink'), line = css('--line'), soft = css('--soft');
    return {
      background: 'transparent',
      font: 'system-ui, sans-serif',
      view: {stroke: line},
      rule: {color: ink},
      legend: {labelColor: ink},
      axis: {
        labelColor: ink,
        titleColor: ink,
        gridColor: line,
        domainColor: soft,
        tickColor: soft,
        labelFontSize: 12,
        titleFontSize: 12,
        titleFontWeight: 'normal'
      }
    };
  }

  /** What is under the pointer, beside it. */
  const tip = Panel.make('p', {id: 'tip', hidden: ''});
  function show_tip(handler, event, item, text) {
    tip.hidden = !text;
    if (!text) return;
    tip.textContent = text;
    document.body.append(tip);
    tip.style.left = `${Math.min(event.clientX + 14, innerWidth - tip.offsetWidth - 4)}px`;
    tip.style.top = `${event.clientY + 14}px`;
  }

  /** Draws rows {kind, x, y, name, ...} in a view: cost, knob, steps, contact. `titles`: of its axes, and short ones. */
  async function draw(place, name, titles, rows) {
    await load();
    const width = place.clientWidth, height = place.clientHeight;
    if (!width || !height) return;
    for (const row of rows)
      row.tip = `${row.name}: ${titles.short[0]} ${numeral(row.x, 4)}, ${titles.short[1]} ${numeral(row.y, 4)}`;
    const tones = Object.fromEntries(rows.map((row) => [row.name, row.tone]));
    const of_rows = name === 'steps' || name === 'contact' ? {x: extent(rows, 'x'), y: extent(rows, 'y'), tones} : {};
    const wanted = JSON.stringify([name, titles, width, height, dark.matches, of_rows]);
    if (wanted !== key) {
      key = wanted;
      const layers = {cost: errors, knob: errors, steps, contact}[name](titles, of_rows);
      const spec = {
        $schema: 'https://vega.github.io/schema/vega-lite/v6.json',
        width,
        height,
        autosize: {type: 'fit', contains: 'padding'},
        data: {name: 'rows', values: rows},
        layer: layers,
        config: config()
      };
      const quiet = {warn() {}, info() {}, debug() {}, error: console.error, level() { return this; }};
      view?.finalize();
      view = new vega.View(
          vega.parse(vegaLite.compile(spec, {logger: quiet}).spec),
          {renderer: 'svg', container: place, logLevel: vega.Error, tooltip: show_tip});
      await view.runAsync();
    } else {
      await view.data('rows', rows).runAsync();
    }
  }

  /** Takes the chart away: its scene has gone. */
  function clear(place) {
    view?.finalize();
    view = null;
    key = '';
    place.replaceChildren();
  }

  dark.addEventListener('change', () => {
    key = '';
  });

  return {draw, clear, GROUND};
})();
