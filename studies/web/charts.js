'use strict';
/** The chart below the columns: error against work, a response over the steps, tractions along the contact. */
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
      vega.expressionFunction('powered', (x) => numeral(x, 3));
      done();
    });
    return library;
  }

  const methods = Scenes.METHODS;
  const by_method = (channel, values) => ({
    field: 'method',
    type: 'nominal',
    legend: null,
    scale: {domain: methods, range: methods.map((method) => values[method])},
  });
  const axis = (title) => ({title, labelExpr: 'powered(datum.value)', labelOverlap: true, tickCount: 5});
  const kind = (name) => [{filter: `datum.kind === '${name}'`}];

  function cost(titles) {
    const x = {
      field: 'x',
      type: 'quantitative',
      title: titles.x,
      scale: {type: 'log', nice: false, padding: 80},
      axis: axis(titles.x)
    };
    const y = {
      field: 'y',
      type: 'quantitative',
      scale: {type: 'log', domain: [GROUND, 10], nice: false, clamp: true},
      axis: {
        ...axis(titles.y),
        values: [GROUND, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 1],
        labelExpr: `datum.value <= ${2 * GROUND} ? '${say('chart.zero')}' : powered(datum.value)`
      }
    };
    const color = by_method('color', colors()), shape = by_method('shape', SHAPES);
    const tooltip =
        [{field: 'name', title: say('lesson')}, {field: 'x', title: titles.x}, {field: 'y', title: titles.y}];
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
        mark: {type: 'text', dx: 10, align: 'left', fontSize: 12},
        encoding: {x, y, color, text: {field: 'name'}}
      },
    ];
  }

  function steps(titles) {
    const x = {field: 'x', type: 'quantitative', scale: {zero: false, nice: false, padding: 12}, axis: axis(titles.x)};
    const y = {field: 'y', type: 'quantitative', scale: {zero: false, padding: 12}, axis: axis(titles.y)};
    const color = by_method('color', colors());
    return [
      {
        transform: kind('line'),
        mark: {type: 'line', strokeWidth: 2},
        encoding: {x, y, color, order: {field: 'order'}, detail: {field: 'method'}}
      },
      {
        transform: kind('line'),
        mark: {type: 'point', filled: false, size: 20},
        encoding: {x, y, color, shape: by_method('shape', SHAPES)}
      },
      {transform: kind('here'), mark: {type: 'point', filled: true, size: 110}, encoding: {x, y, color}},
    ];
  }

  function contact(titles) {
    const x = {field: 'x', type: 'quantitative', scale: {zero: false, nice: false, padding: 12}, axis: axis(titles.x)};
    const y = {field: 'y', type: 'quantitative', axis: axis(titles.y)};
    const what = {
      field: 'what',
      type: 'nominal',
      legend: {title: null, orient: 'top-right'},
      scale: {domain: [say('chart.pressure'), say('chart.shear')], range: ['#5b616b', '#E69F00']}
    };
    return [
      {
        transform: kind('exact'),
        mark: {type: 'line', strokeWidth: 1.2, color: css('--ink')},
        encoding: {x, y, order: {field: 'order'}, detail: {field: 'what'}}
      },
      {
        transform: kind('point'),
        mark: {type: 'line', strokeWidth: 1, strokeDash: [2, 2]},
        encoding: {x, y, color: what, order: {field: 'order'}, detail: {field: 'line'}}
      },
      {
        transform: kind('point'),
        mark: {type: 'point', filled: true, size: 40, opacity: 1},
        encoding: {x, y, color: what}
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

  /** Draws rows {kind, x, y, ...} in a view: cost, steps, contact. */
  async function draw(place, name, titles, rows) {
    await load();
    const width = place.clientWidth, height = place.clientHeight;
    if (!width || !height) return;
    const wanted = JSON.stringify([name, titles, width, height, dark.matches]);
    if (wanted !== key) {
      key = wanted;
      const layers = {cost, steps, contact}[name](titles);
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
          {renderer: 'svg', container: place, logLevel: vega.Error});
      await view.runAsync();
    } else {
      await view.data('rows', rows).runAsync();
    }
  }

  dark.addEventListener('change', () => {
    key = '';
  });

  return {draw, GROUND};
})();
