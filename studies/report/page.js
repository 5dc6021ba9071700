'use strict';
// Draws each figure from the rows recorded beside it. Nothing is fetched; where this script fails, the plain pictures
// stay.
(() => {
  document.documentElement.classList.add('js');
  const dark = matchMedia('(prefers-color-scheme: dark)');
  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  /** Rows that pass every control: its field is among what is chosen, where the control speaks of the row. */
  function rowsShown(figure, rows) {
    const tests = [...figure.querySelectorAll('[data-field]')].map((control) => {
      const {field, whenField, when} = control.dataset;
      const values = control.matches('select') ?
          [control.value] : [...control.querySelectorAll('input:checked')].map((box) => box.value);
      return (row) => (whenField && row[whenField] !== when) || values.includes(row[field] ?? '');
    });
    return rows.filter((row) => tests.every((test) => test(row)));
  }

  const {numeral, powered} = Numerals;
  vega.expressionFunction('powered', (x) => powered(numeral(x)));
  const shown = (value) => typeof value === 'number' ? numeral(value) : String(value ?? '');

  /** Whether a row has a place along an axis. */
  const hasPlace = (row, axis) => Number.isFinite(row[axis.field]) && (!axis.log || row[axis.field] > 0);

  /** An axis in Vega-Lite; `ground` is where exact zeros stand on it, and `room` its length in pixels. */
  function channel(axis, rows, room, ground) {
    const values = rows.map((row) => row[axis.field]).filter((value) => value !== ground);
    let low = values.reduce((a, b) => Math.min(a, b), ground && !values.length ? ground : Infinity);
    let high = values.reduce((a, b) => Math.max(a, b), ground && !values.length ? ground : -Infinity);
    if (axis.log && high < 10 * low) {  // a decade at least
      const middle = Math.sqrt(low) * Math.sqrt(high);
      low = axis.bounded ? low : middle / Math.sqrt(10);
      high = 10 * low;
    } else if (low === high) {
      [low, high] = [low - (Math.abs(low) || 1), low + (Math.abs(low) || 1)];
    }
    const ticks = Math.max(2, Math.floor(room / 60)), decades = axis.log ? Math.floor(Math.log10(high / low)) : 0;
    const named = axis.log ? "datum.label === '' ? '' : powered(datum.value)" : 'powered(datum.value)';
    const title = axis.title.startsWith('{') ? rows[0]?.[axis.title.slice(1, -1)] ?? '' : axis.title;
    return {
      field: axis.field, type: 'quantitative', title: wrapped(title, room / 7),
      scale: {type: axis.log ? 'log' : 'linear', domain: [ground ?? low, high], nice: false, zero: false,
              padding: axis.bounded ? 0 : 18},
      axis: {labelExpr: ground ? `datum.value < ${5 * ground} ? '' : ${named}` : named, labelOverlap: true,
             labelSeparation: 6, tickCount: decades < 2 ? ticks : Math.min(ticks, decades),
             ...(axis.step && {tickMinStep: axis.step}), ...(ground && {minExtent: 64})},
    };
  }

  /** A text in lines of so many letters, broken between words. */
  function wrapped(text, letters) {
    const lines = [''];
    for (const word of text.split(' ')) {
      const line = lines.at(-1);
      if (line && line.length + 1 + word.length > letters) lines.push(word);
      else lines[lines.length - 1] = line ? line + ' ' + word : word;
    }
    return lines;
  }

  /**
   * The ends of the lines with the words that stand there: the name and the option's value, or the value alone. With
   * the runs that failed, and their values.
   */
  function endsOf(rows, words, failed) {
    const lines = new Map(), names = [], values = [];
    for (const row of words ? rows : []) lines.set(row.line, [...(lines.get(row.line) ?? []), row]);
    for (const line of lines.values()) {
      line.sort((a, b) => a.order - b.order);
      const first = line[0], last = line.at(-1), moves = first.shown !== last.shown && first[words.value] !== undefined;
      names.push({...last, words: moves ? `${last[words.name]}, ${last[words.value]}` : last[words.name]});
      if (moves) values.push({...first, words: first[words.value]});
    }
    const valued = words ? failed.filter((row) => row[words.value] !== undefined) : [];
    return [...names, ...values, ...valued.map((row) => ({...row, words: `${row[words.value]} fails`}))];
  }

  const INK = '#1b1d21';  // on paper, whatever the screen's scheme
  const inkOn = (paper) => paper ? INK : css('--ink');
  const colorOf = (series, paper) =>
      series.color === '$ink' ? inkOn(paper) : dark.matches && !paper ? series.dark : series.color;

  /** A chart of these rows in Vega-Lite; `data` is of its figure; on `paper` it has its legend, and the light scheme. */
  function specification(chart, data, rows, width, height, paper) {
    const names = new Set(rows.map((row) => row.series)), ink = inkOn(paper);
    const present = data.series.filter((s) => names.has(s.name));
    const longest = Math.max(...present.map((s) => s.name.length));  // letters, of some 6 pixels
    const columns = Math.max(1, Math.floor(width / (6 * longest + 40)));
    const legend = paper && present.length > 1 ? {orient: 'bottom', columns, labelLimit: width, symbolOpacity: 1} : null;
    const by = (type, range) => ({field: 'series', type, title: null, legend,
                                  scale: {type: 'ordinal', domain: present.map((s) => s.name), range: present.map(range)}});
    const color = by('nominal', (s) => colorOf(s, paper));
    const tooltip = chart.tips.map(([field, title]) => ({field, title}));
    const ground = rows.find((row) => row.zero)?.[chart.y.field];
    const x = channel(chart.x, rows, width - 110), y = channel(chart.y, rows, height, ground);
    const guides = rows.filter((row) => row.guide), curves = rows.filter((row) => !row.failed && !row.guide);
    const failed = rows.filter((row) => row.failed);
    const layer = (values, mark, encoding, more) => ({data: {values}, mark, encoding: {x, y, ...encoding}, ...more});
    const zeros = {y: {field: chart.y.field, type: 'quantitative'}};
    const layers = [
      layer(guides, {type: 'line', strokeDash: [3, 3], strokeWidth: 1, color: ink}, {detail: {field: 'line'}}),
      layer(guides.filter((row) => row.guide_tag), {type: 'text', align: 'right', dx: -6, dy: 13, color: ink, fontSize: 11},
            {text: {field: 'guide_tag'}}),
      layer(curves, {type: 'line', strokeWidth: 2},
            {color, strokeDash: by('ordinal', (s) => s.dash), detail: {field: 'line'},
             order: {field: 'order', type: 'quantitative'}}, {name: 'lines'}),
      layer(curves.filter((row) => row[chart.x.spread] > row[chart.x.field]), {type: 'rule', clip: true},
            {color, x2: {field: chart.x.spread || 'none'}}),
      layer(curves.filter((row) => !row.unmarked), {type: 'point', filled: false, opacity: 1},
            {color, shape: by('nominal', (s) => s.shape), size: by('ordinal', (s) => s.size), tooltip,
             strokeWidth: {condition: {param: 'near', empty: false, value: 4}, value: 2}},
            {name: 'points', params: [{name: 'near', select: {type: 'point', on: 'pointerover', clear: 'pointerout',
                                                              nearest: true}}]}),
      ...(failed.length === 0 ? [] : [
        layer(failed, {type: 'point', shape: data.failed, size: 4, strokeWidth: 2.5, opacity: 1}, {color, tooltip},
              {name: 'failed'})]),
      layer(endsOf(curves, chart.words, failed), {type: 'point', opacity: 0, size: 60}, {}, {name: 'ends'}),
    ];
    const words = {type: 'text', x: -6, align: 'right', text: 'exactly 0', color: ink, fontSize: 12};
    if (ground)
      for (const mark of [{type: 'rule', strokeDash: [1, 3], color: ink}, words])
        layers.unshift({data: {values: [{[chart.y.field]: ground}]}, mark, encoding: zeros});
    return {
      $schema: 'https://vega.github.io/schema/vega-lite/v6.json', description: chart.description,
      width: 'container', height, autosize: {type: 'fit-x', contains: 'padding'},
      padding: {left: 5, top: 5, right: 14, bottom: 5},  // room for the end of a tick's label
      layer: layers,
    };
  }

  /** Adds the words at the ends of lines, each where it covers no line, no marker and no other words. */
  function withWords(spec) {
    const marks = ['lines_pathgroup', 'points_marks', 'failed_marks'];
    spec.marks.push({
      type: 'text', name: 'words', from: {data: 'ends_marks'}, interactive: false,
      encode: {update: {text: {field: 'datum.words'}, fontSize: {value: 11},
                        fill: {signal: "scale('color', datum.datum.series)"}}},
      transform: [{type: 'label', size: {signal: '[width, height]'}, padding: 0,
                   avoidMarks: marks.filter((name) => spec.marks.some((mark) => mark.name === name)), offset: [4],
                   anchor: ['top-right', 'top-left', 'bottom-right', 'bottom-left', 'right', 'left', 'top', 'bottom']}],
    });
    return spec;
  }

  const switchedOff = new WeakMap();  // by figure, names of series

  /** A button for each series that is among the rows: it takes the series out of all panels and puts it back. */
  function drawLegend(figure, series, rows) {
    const names = new Set(rows.map((row) => row.series)), off = switchedOff.get(figure) ?? new Set();
    const marked = new Set(rows.filter((row) => !row.unmarked).map((row) => row.series));
    const place = figure.querySelector('.legend');
    place.replaceChildren();
    for (const s of series.length > 1 ? series.filter((s) => names.has(s.name)) : []) {
      const button = place.appendChild(document.createElement('button'));
      const color = colorOf(s);
      button.type = 'button';
      button.setAttribute('aria-pressed', !off.has(s.name));
      button.innerHTML = `<svg width="44" height="16" aria-hidden="true" fill="none" stroke="${color}" stroke-width="2">` +
          `<path d="M0,8H44" stroke-dasharray="${s.dash.at(-1) ? s.dash : 'none'}"/>` +
          (marked.has(s.name) ? `<path transform="translate(22,8)" d="${s.shape}"/></svg>` : '</svg>');
      button.append(s.name.replaceAll(/e-(?=\d)/g, 'e-\u2060'));  // not broken after its hyphen
      button.addEventListener('click', () => {
        off.has(s.name) ? off.delete(s.name) : off.add(s.name);
        switchedOff.set(figure, off);
        draw(figure).catch(console.error);
      });
    }
  }

  /** What the pointer is near to, numbers in the page's style. */
  function tooltipTable(value, sanitize) {
    const lines = Object.entries(value).map(([key, entry]) =>
        `<tr><td class="key">${sanitize(key)}</td><td class="value">${sanitize(shown(entry))}</td></tr>`);
    return `<table>${lines.join('')}</table>`;
  }

  function config(paper) {
    const ink = inkOn(paper), [soft, line] = paper ? ['#5b616b', '#d5d8dd'] : [css('--soft'), css('--line')];
    return {
      legend: {labelColor: ink, labelFontSize: 12},
      background: 'transparent',
      font: paper ? 'Helvetica, Arial, sans-serif' : 'system-ui, sans-serif',
      axis: {labelColor: ink, titleColor: ink, gridColor: line, domainColor: soft, tickColor: soft, labelFontSize: 12,
             titleFontSize: 12, titleFontWeight: 'normal', titleLimit: Math.min(420, innerWidth - 110)},
      view: {stroke: line},
    };
  }

  const dataOf = (figure) => JSON.parse(document.getElementById(figure.id + '-data').textContent);

  /** What an entry of a row says: of a field that holds texts, it is a place in their list. */
  const meant = (data, field, entry) => data.texts[field]?.[entry] ?? entry;

  /** The rows of a figure that are chosen, as objects. */
  const chosenRows = (figure, data) => rowsShown(figure, data.rows.map((values) => Object.fromEntries(
      data.fields.map((field, i) => [field, meant(data, field, values[i])]).filter(([, value]) => (value ?? null) !== null))));

  /** What is chosen, in a line for paper. */
  function tellChosen(figure) {
    const line = figure.querySelector('.chosen');
    if (!line) return;
    const selects = [...figure.querySelectorAll('.choices select')];
    line.textContent = selects.map((select) => select.parentElement.firstChild.data + select.value).join('; ');
  }

  const isOf = (chart) => (row) =>
      (!chart.only || row.panel === chart.only) && hasPlace(row, chart.x) && hasPlace(row, chart.y);

  /** Draws a figure: as wide as its place, or as wide as paper is. */
  async function draw(figure, paper) {
    tellChosen(figure);
    const data = dataOf(figure), all = chosenRows(figure, data), off = switchedOff.get(figure);
    const rows = off ? all.filter((row) => !off.has(row.series)) : all;
    const panels = figure.querySelectorAll('.panel');
    const inPanels = [];
    for (const [i, chart] of data.charts.entries()) {
      const panel = panels[i];
      if (panel.closest('details:not([open])')) continue;  // has no width yet; drawn when it is opened
      const own = all.filter(isOf(chart)), height = paper ? Math.min(chart.height, 220) :
          panel.clientWidth < 450 ? Math.max(chart.height, 280) : chart.height;  // a phone's chart is as high as wide
      panel.hidden = own.length === 0;
      if (panel.hidden) continue;
      inPanels.push(...own);
      const spec = specification(chart, data, rows.filter(isOf(chart)), paper ?? panel.clientWidth, height, paper);
      if (paper) spec.width = paper;
      await vegaEmbed(panel.querySelector('.vega'), spec, {
        mode: 'vega-lite', renderer: 'svg', config: config(paper), logLevel: vega.Error, patch: withWords,
        actions: {export: true, source: false, compiled: false, editor: false},
        tooltip: {theme: dark.matches ? 'dark' : 'light', formatTooltip: tooltipTable},
        downloadFileName: figure.id + '-' + i,
      });
      panel.querySelector('.static').hidden = true;
    }
    drawLegend(figure, data.series, inPanels);
  }

  /** The open charts of a figure as SVG files of that width in millimetres, with their legends. */
  async function saveAsSvg(figure, millimetres) {
    const data = dataOf(figure), rows = chosenRows(figure, data), width = millimetres * 96 / 25.4;
    for (const chart of data.charts.filter((chart) => !chart.folded)) {
      const spec = specification({...chart, words: null}, data, rows.filter(isOf(chart)), width, Math.min(0.6 * width, 300), true);
      Object.assign(spec, {width: width - 90, autosize: 'pad'});  // beside the axis; the whole is then scaled to its width
      const place = document.createElement('div');
      const {view} = await vegaEmbed(place, spec, {mode: 'vega-lite', renderer: 'svg', config: config(true),
                                                   actions: false, logLevel: vega.Error, patch: withWords});
      const svg = (await view.toSVG()).replace(/ width="[^"]*"/, ` width="${millimetres}mm"`).replace(/ height="[^"]*"/, '');
      save(new Blob([svg], {type: 'image/svg+xml'}), `${chart.file}-${millimetres}mm.svg`);
    }
  }

  function save(blob, name) {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
  }

  /** What a figure is in a paper: its width, LaTeX that takes the file beside the page, and an SVG. */
  function offerPaper(figure) {
    const data = dataOf(figure), place = document.createElement('details'), code = document.createElement('pre');
    place.className = 'paper';
    place.innerHTML = '<summary>For a paper</summary><p>Width in mm: <input type="number" min="40" max="400" value="85"> ' +
        '(85: one column, 170: two; in LaTeX no wider than the column) <button type="button">Save as SVG</button></p>';
    place.append(code);
    const width = place.querySelector('input');
    const write = () => {
      const wide = Number(width.value) > 120 ? '*' : '', charts = data.charts.filter((chart) => !chart.folded);
      const figures = [];  // one chart each, over two columns two
      while (charts.length > 0) figures.push(charts.splice(0, wide ? 2 : 1));
      const graphic = (chart, i, {length}) => length === 1 ? `  \\input{figures/${chart.file}.pgf}\n` :
          `  \\begin{minipage}{.49\\linewidth}\\input{figures/${chart.file}.pgf}\\end{minipage}` +
          (i === 0 ? '\\hspace{.01\\linewidth}%\n' : '\n');
      code.textContent = '% \\usepackage{pgf}\n' + figures.map((group, i) => `\\begin{figure${wide}}\n  \\centering\n` +
          `  \\ifdim\\linewidth>${width.value}mm \\setlength{\\linewidth}{${width.value}mm}\\fi\n${group.map(graphic).join('')}` +
          `  \\caption{${group.length === 1 ? group[0].caption : data.caption}}\n` +
          `  \\label{fig:${figure.id}${i > 0 ? `-${i + 1}` : ''}}\n\\end{figure${wide}}\n`).join('');
    };
    write();
    width.addEventListener('input', write);
    place.querySelector('button').addEventListener('click', () => saveAsSvg(figure, Number(width.value)).catch(console.error));
    figure.querySelector('details.data').before(place);
  }

  /** The rows that are chosen as a table, below the chart. */
  function tabulate(figure) {
    const place = figure.querySelector('details.data');
    place.querySelector('.wide')?.remove();
    if (!place.open) return;
    const data = dataOf(figure), rows = chosenRows(figure, data), table = document.createElement('table');
    const fields = data.columns.filter((field) => rows.some((row) => row[field] ?? false));
    table.createCaption().textContent = `${rows.length} rows, six digits; all rows and digits: figures/${figure.id}.csv`;
    const numeric = new Set(fields.filter((field) => rows.every((row) => typeof (row[field] ?? 0) === 'number')));
    const line = (parent, kind, entry) => {
      const row = parent.appendChild(document.createElement('tr'));
      for (const field of fields) {
        const cell = row.appendChild(document.createElement(kind));
        cell.textContent = shown(entry(field));
        if (numeric.has(field)) cell.className = 'n';
      }
    };
    line(table.createTHead(), 'th', (field) => field);
    const body = table.createTBody();
    for (const row of rows.slice(0, 2000)) line(body, 'td', (field) => row[field]);
    const wide = place.appendChild(document.createElement('div'));
    wide.className = 'wide';
    wide.append(table);
  }

  const figures = [...document.querySelectorAll('figure[data-chart]')];
  const drawn = new Set();
  const watch = new IntersectionObserver((entries) => {
    for (const {isIntersecting, target} of entries) {
      if (!isIntersecting) continue;
      watch.unobserve(target);
      drawn.add(target);
      draw(target).catch(console.error);
    }
  }, {rootMargin: '600px'});
  for (const figure of figures) {
    watch.observe(figure);
    figure.addEventListener('change', () => (tabulate(figure), draw(figure).catch(console.error)));
    figure.querySelector('details.data').addEventListener('toggle', () => tabulate(figure));
    offerPaper(figure);
    for (const folded of figure.querySelectorAll('details.panels-folded'))
      folded.addEventListener('toggle', () => folded.open && draw(figure).catch(console.error));
  }
  dark.addEventListener('change', () => drawn.forEach((figure) => draw(figure).catch(console.error)));

  // Paper has the short form (page.css) or, by the link, all of it without folds; licences, and the data of charts, stay
  // away.
  let unfolded = [];
  addEventListener('beforeprint', () => figures.forEach((figure) => draw(figure, 680).catch(console.error)));
  addEventListener('afterprint', () => {
    document.body.classList.remove('whole');
    unfolded.forEach((details) => (details.open = false));
    unfolded = [];
    figures.forEach((figure) => draw(figure).catch(console.error));
  });
  document.getElementById('print-all').addEventListener('click', async () => {
    document.body.classList.add('whole');
    unfolded = [...document.querySelectorAll(
        'details.fold:not([open]), details:not([open]):not(figure details):has(> .wide, > pre.wrap, > dl)')];
    unfolded.forEach((details) => (details.open = true));
    await Promise.all(figures.map((figure) => draw(figure, 680)));
    print();
  });

  // The slider of a run's steps: its pictures, and the tractions.
  const slider = document.querySelector('.slider input'), step = document.querySelector('#step-tractions select');
  if (step) step.parentElement.hidden = true;
  slider?.addEventListener('input', () => {
    const steps = [...document.querySelectorAll('.step')];
    steps.forEach((place, i) => (place.hidden = i !== Number(slider.value)));
    slider.nextElementSibling.textContent = steps[slider.value].dataset.words;
    if (!step) return;
    step.value = steps[slider.value].dataset.words;
    step.dispatchEvent(new Event('change', {bubbles: true}));
  });

  // Each table can be taken along.
  for (const table of document.querySelectorAll('table')) {
    const quoted = (cell) => '"' + cell.textContent.replaceAll('"', '""') + '"';
    const link = document.createElement('a');
    link.textContent = 'CSV';
    link.href = '#';
    link.download = table.caption.textContent.replace(/[^A-Za-z0-9]+/g, '-') + '.csv';
    link.addEventListener('click', () => {
      const text = [...table.rows].map((row) => [...row.cells].map(quoted).join(',')).join('\n');
      link.href = URL.createObjectURL(new Blob([text], {type: 'text/csv'}));
    });
    table.caption.prepend(link);
  }
})();
