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

  /** A number as everywhere on the page: a power of ten below 0.001 and from 10000 on. */
  function numeral(x) {
    if (x === 0 || (Math.abs(x) >= 1e-3 && Math.abs(x) < 1e4)) return String(+x.toPrecision(6));
    return Number.isInteger(x) && Math.abs(x) < 1e7 && x % 1000 ? String(x) :
        x.toExponential(5).replace(/\.?0*e\+?/, 'e');
  }
  const shown = (value) => typeof value === 'number' ? numeral(value) : String(value ?? '');

  /** The specification with the words $series, $colors, ... replaced by the series that occur in the rows. */
  function filled(spec, series, rows, width) {
    const names = new Set(rows.map((row) => row.series));
    const present = series.filter((s) => names.has(s.name));
    const ink = css('--ink');
    const words = new Map([
      ['$series', present.map((s) => s.name)],
      ['$colors', present.map((s) => s.color === '$ink' ? ink : s.color)],
      ['$shapes', present.map((s) => s.shape)],
      ['$dashes', present.map((s) => s.dash)],
      ['$sizes', present.map((s) => s.size)],
      ['$ink', ink],
    ]);
    const copy = JSON.parse(JSON.stringify(spec), (key, value) => words.has(value) ? words.get(value) : value);
    copy.datasets = {rows};
    placeGroundWords(copy, rows);
    for (const layer of copy.layer)
      for (const [name, room] of [['x', width - 110], ['y', copy.height]]) {
        const channel = layer.encoding?.[name];
        if (channel?.scale) fitAxis(channel, rows.filter((row) => !(row.zero && name === 'y')).map((row) => row[channel.field]));
        const ground = name === 'y' && rows.find((row) => row.zero)?.[channel?.field];
        if (channel?.scale && ground) addGround(channel, ground);
        if (channel?.axis && name === 'x') channel.axis.labelSeparation = 6;
        if (channel?.axis && !channel.axis.values) channel.axis.tickCount = Math.max(2, Math.floor(room / 60));
        if (channel?.title?.startsWith('{')) channel.title = rows[0]?.[channel.title.slice(1, -1)] ?? '';
        if (channel?.title) channel.title = wrapped(channel.title, room / 7);
      }
    return copy;
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

  /** Gives a logarithmic axis its ticks and at least a decade, and another axis of one single value a length. */
  function fitAxis(channel, values) {
    const log = channel.scale.type === 'log';
    const usable = values.filter((value) => Number.isFinite(value) && (!log || value > 0));
    if (!usable.length) return;
    let low = usable.reduce((a, b) => Math.min(a, b), Infinity);
    let high = usable.reduce((a, b) => Math.max(a, b), -Infinity);
    if (log && high < 10 * low && 'domainMin' in channel.scale) {
      channel.scale.domainMax = high = 10 * low;
    } else if (log && high < 10 * low) {
      const middle = Math.sqrt(low) * Math.sqrt(high);
      channel.scale.domain = [low, high] = [middle / Math.sqrt(10), middle * Math.sqrt(10)];
    }
    if (log) channel.axis.values = logTicks(Math.log10(low), Math.log10(high));
    if (low === high) channel.scale.domain = [low - (Math.abs(low) || 1), low + (Math.abs(low) || 1)];
  }

  /** The place of exact zeros, off the values that the axis names. */
  function addGround(channel, ground) {
    channel.axis.values = [ground, ...(channel.axis.values ?? []).filter((tick) => tick > 5 * ground)];
    channel.axis.labelExpr = `datum.value <= ${ground * 1.01} ? '0' : ${channel.axis.labelExpr}`;
    if (channel.scale.domain) channel.scale.domain = [ground, Math.max(...channel.scale.domain)];
  }

  /** Moves the words of the line of exact zeros to its right end, where a zero stands at the left one alone. */
  function placeGroundWords(spec, rows) {
    const words = spec.layer.flatMap((layer) => layer.layer ?? []).find((layer) => layer.mark.text === 'exactly 0');
    const x = spec.layer.find((layer) => layer.encoding?.x?.scale)?.encoding.x;
    if (!words || !x) return;
    const place = (row) => x.scale.type === 'log' ? Math.log10(row[x.field]) : row[x.field];
    const places = rows.map(place).filter(Number.isFinite);
    const low = Math.min(...places), high = Math.max(...places);
    const lacks = x.scale.type === 'log' ? Math.max(0, 1 - (high - low)) / 2 : 0;  // of the decade that is shown
    const shares = rows.filter((row) => row.zero).map((row) => (place(row) - low + lacks) / (high - low + 2 * lacks));
    if (shares.some((share) => share < 0.2) && !shares.some((share) => share > 0.75))
      Object.assign(words.mark, {align: 'right', x: 'width', dx: -4});
  }

  /** Powers of ten around two exponents, thinned out to nine or so; over few decades also 2 and 5 times them. */
  function logTicks(low, high) {
    const step = Math.max(1, Math.ceil((high - low + 1) / 9)), ticks = [];
    for (let e = Math.floor(low / step) * step; e <= high + step; e += step)
      for (const m of high - low < 2 ? [1, 2, 5] : [1]) ticks.push(m * 10 ** e);
    return ticks;
  }

  const markers = {
    'circle': 'M18,8a4,4 0 1,0 8,0a4,4 0 1,0 -8,0', 'square': 'M18,4h8v8h-8Z', 'diamond': 'M22,3l5,5l-5,5l-5,-5Z',
    'triangle-up': 'M22,3l5,9h-10Z', 'triangle-down': 'M22,13l5,-9h-10Z', 'triangle-left': 'M17,8l9,5v-10Z',
    'triangle-right': 'M27,8l-9,5v-10Z', 'cross': 'M18,8h8M22,4v8',
  };
  const switchedOff = new WeakMap();  // by figure, names of series

  /** A button for each series that is among the rows: it takes the series out of all panels and puts it back. */
  function drawLegend(figure, series, rows) {
    const names = new Set(rows.map((row) => row.series)), off = switchedOff.get(figure) ?? new Set();
    const marked = new Set(rows.filter((row) => !row.unmarked).map((row) => row.series));
    const place = figure.querySelector('.legend');
    place.replaceChildren();
    for (const s of series.length > 1 ? series.filter((s) => names.has(s.name)) : []) {
      const button = place.appendChild(document.createElement('button'));
      const color = s.color === '$ink' ? css('--ink') : s.color;
      button.type = 'button';
      button.setAttribute('aria-pressed', !off.has(s.name));
      button.innerHTML = `<svg width="44" height="16" aria-hidden="true" fill="none" stroke="${color}" stroke-width="2">` +
          `<path d="M0,8H44" stroke-dasharray="${s.dash.at(-1) ? s.dash : 'none'}"/>${marked.has(s.name) ? `<path d="${markers[s.shape]}"/>` : ''}</svg>`;
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

  function config() {
    const ink = css('--ink'), soft = css('--soft'), line = css('--line');
    return {
      background: 'transparent',
      font: 'system-ui, sans-serif',
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
      data.fields.map((field, i) => [field, meant(data, field, values[i])]).filter(([, value]) => value !== null))));

  /** What is chosen, in a line for paper. */
  function tellChosen(figure) {
    const line = figure.querySelector('.chosen');
    if (!line) return;
    const selects = [...figure.querySelectorAll('.choices select')];
    line.textContent = selects.map((select) => select.parentElement.firstChild.data + select.value).join('; ');
  }

  /** A row with the words beside its point that have room in a narrow panel, instead of the others. */
  const inBrief = (row) => Object.fromEntries(Object.entries(row)
      .filter(([field]) => !field.startsWith('tag') || field.includes('_narrow'))
      .map(([field, entry]) => [field.replace('_narrow', ''), entry]));

  /** A row without words beside its point that have no room in the lower chart on paper. */
  const onPaper = (row) => Object.fromEntries(Object.entries(row).filter(([field]) => !row[field + '_tall']));

  /** Draws a figure: as wide as its place, or as wide as paper is. */
  async function draw(figure, paper) {
    tellChosen(figure);
    const data = dataOf(figure), all = chosenRows(figure, data), off = switchedOff.get(figure);
    const rows = off ? all.filter((row) => !off.has(row.series)) : all;
    const panels = figure.querySelectorAll('.panel');
    const inPanels = [];
    for (const [i, spec] of data.panels.entries()) {
      const panel = panels[i];
      if (panel.closest('details:not([open])')) continue;  // has no width yet; drawn when it is opened
      const only = spec.usermeta.panel;
      const own = (only ? rows.filter((row) => row.panel === only) : rows)
          .map((row) => paper ? onPaper(row) : panel.clientWidth < 400 ? inBrief(row) : row);
      panel.hidden = !all.some((row) => !only || row.panel === only);
      if (panel.hidden) continue;
      inPanels.push(...(only ? all.filter((row) => row.panel === only) : all));
      const full = filled(spec, data.series, own, paper ?? panel.clientWidth);
      if (paper) Object.assign(full, {width: paper, height: Math.min(full.height, 220)});
      await vegaEmbed(panel.querySelector('.vega'), full, {
        mode: 'vega-lite', renderer: 'svg', config: config(), logLevel: vega.Error,
        actions: {export: true, source: false, compiled: false, editor: false},
        tooltip: {theme: dark.matches ? 'dark' : 'light', formatTooltip: tooltipTable},
        downloadFileName: figure.id + '-' + i,
      });
      panel.querySelector('.static').hidden = true;
    }
    drawLegend(figure, data.series, inPanels);
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
    for (const folded of figure.querySelectorAll('details.panels-folded'))
      folded.addEventListener('toggle', () => folded.open && draw(figure).catch(console.error));
  }
  dark.addEventListener('change', () => drawn.forEach((figure) => draw(figure).catch(console.error)));

  // Paper has no folds: charts and tables are whole there; licences, and the data of charts, stay away.
  let unfolded = [];
  addEventListener('beforeprint', () => {
    unfolded = [...document.querySelectorAll(
        'details.fold:not([open]), details:not([open]):not(figure details):has(> .wide, > pre.wrap, > dl)')];
    for (const details of unfolded) details.open = true;
    for (const figure of figures) draw(figure, 680).catch(console.error);
  });
  addEventListener('afterprint', () => {
    for (const figure of figures) draw(figure).catch(console.error);
    unfolded.forEach((details) => (details.open = false));
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
