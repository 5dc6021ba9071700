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
    for (const layer of copy.layer)
      for (const [name, room] of [['x', width - 110], ['y', copy.height]]) {
        const channel = layer.encoding?.[name];
        if (channel?.scale) fitAxis(channel, rows.map((row) => row[channel.field]));
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

  /** Powers of ten around two exponents, thinned out to nine or so; over few decades also 2 and 5 times them. */
  function logTicks(low, high) {
    const step = Math.max(1, Math.ceil((high - low + 1) / 9)), ticks = [];
    for (let e = Math.floor(low / step) * step; e <= high + step; e += step)
      for (const m of high - low < 2 ? [1, 2, 5] : [1]) ticks.push(m * 10 ** e);
    return ticks;
  }

  /** Columns of a legend so that the longest of `names` has room. */
  function legendColumns(names, width) {
    const longest = names.reduce((most, name) => Math.max(most, name.length), 0);
    return Math.max(1, Math.floor(width / (7 * longest + 50)));
  }

  function config(names, width) {
    const ink = css('--ink'), soft = css('--soft'), line = css('--line');
    return {
      background: 'transparent',
      font: 'system-ui, sans-serif',
      axis: {labelColor: ink, titleColor: ink, gridColor: line, domainColor: soft, tickColor: soft, labelFontSize: 12,
             titleFontSize: 12, titleFontWeight: 'normal', titleLimit: Math.min(420, innerWidth - 110)},
      legend: {columns: legendColumns(names, width), labelLimit: width - 110, labelColor: ink, titleColor: ink, labelFontSize: 12, symbolStrokeWidth: 2},
      view: {stroke: line},
    };
  }

  const dataOf = (figure) => JSON.parse(document.getElementById(figure.id + '-data').textContent);

  /** The rows of a figure that are chosen, as objects. */
  const chosenRows = (figure, data) => rowsShown(figure, data.rows.map((values) =>
      Object.fromEntries(data.fields.map((field, i) => [field, values[i]]).filter(([, value]) => value !== null))));

  async function draw(figure) {
    const data = dataOf(figure), rows = chosenRows(figure, data);
    const panels = figure.querySelectorAll('.panel');
    for (const [i, spec] of data.panels.entries()) {
      const panel = panels[i];
      if (panel.closest('details:not([open])')) continue;  // has no width yet; drawn when it is opened
      const only = spec.usermeta.panel;
      const own = only ? rows.filter((row) => row.panel === only) : rows;
      const names = [...new Set(own.map((row) => row.series ?? ''))];
      await vegaEmbed(panel.querySelector('.vega'), filled(spec, data.series, own, panel.clientWidth), {
        mode: 'vega-lite', renderer: 'svg', config: config(names, panel.clientWidth), logLevel: vega.Error,
        actions: {export: true, source: false, compiled: false, editor: false},
        tooltip: {theme: dark.matches ? 'dark' : 'light'},
        downloadFileName: figure.id + '-' + i,
      });
      panel.querySelector('.static').hidden = true;
    }
  }

  /** The rows that are chosen as a table, below the chart. */
  function tabulate(figure) {
    const place = figure.querySelector('details.data');
    place.querySelector('.wide')?.remove();
    if (!place.open) return;
    const data = dataOf(figure), rows = chosenRows(figure, data), table = document.createElement('table');
    const fields = data.columns.filter((field) => rows.some((row) => row[field] ?? false));
    table.createCaption().textContent = `${rows.length} rows, six digits; all rows and digits: figures/${figure.id}.csv`;
    const line = (parent, kind, texts) => {
      const row = parent.appendChild(document.createElement('tr'));
      for (const text of texts) {
        const cell = row.appendChild(document.createElement(kind));
        cell.textContent = text ?? '';
        if (typeof text === 'number') cell.className = 'n';
      }
    };
    line(table.createTHead(), 'th', fields);
    const body = table.createTBody();
    for (const row of rows.slice(0, 2000)) line(body, 'td', fields.map((field) => row[field]));
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
    table.caption.append(' ', link);
  }
})();
