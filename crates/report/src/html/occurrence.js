// The occurrence of each mode, drawn from the first of the tables.
const PLOT = { width: 320, left: 76, right: 14, top: 8, bottom: 34, line: 12, gap: 6 };
const plotX = part => PLOT.left + Number(part) * (PLOT.width - PLOT.left - PLOT.right);

// A shape for each speed range, so that colour is not needed.
const SHAPES = ['M-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0z', 'M-3.6-3.6h7.2v7.2h-7.2z', 'M0-5l4.7 8.2h-9.4z', 'M0-5l5 5l-5 5l-5-5z'];
const markOf = series => draw('path', { d: SHAPES[series % SHAPES.length], class: 'spot' });

// What stands beside a mark; where there is one number of contacts and one law, neither is named.
const inWords = (row, several) => {
  const place = [several.laws ? row.law : '', several.numbers ? `${row.in_contact} in contact` : '', row.speed === 'all' ? '' : `${row.speed} speed`];
  const all = `${row.arrangements} arrangements: ${rounded(row.least_of_arrangements)} to ${rounded(row.largest_of_arrangements)}`;
  const [unstable, atMedians] = [row.unstable_hz, row.frequency_hz === '' ? '' : `${Number(row.frequency_hz).toPrecision(7)} Hz at the medians`];
  const hertz = unstable === '' ? atMedians || 'not oscillating' : [`${unstable} Hz where unstable`, atMedians].filter(Boolean).join(', ');
  const what = { divergence: 'Divergence, not oscillating', unnamed: 'Modes without a name' }[row.mode] ?? `Mode ${row.mode}, ${hertz}`;
  return [what, place.filter(Boolean).join(', ')].filter(Boolean).join('\n') +
    `\nUnstable in ${percent(row.median_occurrence)} % of the samples\n` +
    `95 %: ${percent(row.lower)} % to ${percent(row.upper)} %` + (row.arrangements === '1' ? '' : `\n${all}`);
};

const plotOf = (title, rows, speeds, several) => {
  const modes = [...new Set(rows.map(row => row.mode))];
  const pitch = speeds.length * PLOT.line + PLOT.gap;
  const bottom = PLOT.top + modes.length * pitch;
  const height = bottom + PLOT.bottom;
  const picture = draw('svg', { viewBox: `0 0 ${PLOT.width} ${height}`, role: 'group', 'aria-label': `Occurrences, ${title}` });
  modes.forEach((mode, i) => {
    const y = PLOT.top + i * pitch;
    if (i % 2 === 0) picture.append(draw('rect', { x: 0, y, width: PLOT.width, height: pitch, class: 'stripe' }));
    picture.append(draw('text', { x: PLOT.left - 6, y: y + pitch / 2 + 4, 'text-anchor': 'end' }, mode));
  });
  for (const part of [0, 0.25, 0.5, 0.75, 1]) {
    const x = plotX(part);
    picture.append(draw('line', { x1: x, x2: x, y1: PLOT.top, y2: bottom, class: 'grid' }),
      draw('text', { x, y: bottom + 14, 'text-anchor': 'middle', class: 'soft' }, 100 * part));
  }
  picture.append(draw('text', { x: plotX(0.5), y: bottom + 29, 'text-anchor': 'middle', class: 'soft' }, 'unstable, % of the samples'));
  rows.forEach((row, i) => {
    const series = speeds.indexOf(row.speed);
    const y = PLOT.top + modes.indexOf(row.mode) * pitch + PLOT.gap / 2 + (series + 0.5) * PLOT.line;
    const bar = (from, to, name) => draw('line', { x1: plotX(from), x2: plotX(to), y1: y, y2: y, class: name });
    const x = plotX(row.median_occurrence);
    const mark = draw('g', { transform: `translate(${x} ${y})` }, draw('circle', { r: 7, class: 'hit' }), markOf(series));
    const point = draw('g', { class: `point m${series % 4}`, role: 'img', tabindex: i === 0 ? 0 : -1 },
      bar(row.least_of_arrangements, row.largest_of_arrangements, 'range'), bar(row.lower, row.upper, 'limits'), mark);
    point.dataset.x = x;
    point.dataset.key = [row.constraints, row.law, row.speed, row.in_contact, row.mode].join('\n');
    withTip(point, inWords(row, several));
    picture.append(point);
  });
  // One stop of the Tab key for each figure; the arrow keys move inside it.
  const points = [...picture.querySelectorAll('.point')];
  picture.addEventListener('keydown', event => {
    const step = { ArrowDown: 1, ArrowRight: 1, ArrowUp: -1, ArrowLeft: -1, Home: -points.length, End: points.length }[event.key];
    const at = points.indexOf(document.activeElement);
    if (step === undefined || at < 0) return;
    event.preventDefault();
    const to = points[Math.max(0, Math.min(points.length - 1, at + step))];
    points[at].setAttribute('tabindex', -1);
    to.setAttribute('tabindex', 0);
    to.focus();
  });
  return make('figure', {}, make('figcaption', {}, title), picture);
};

const startOccurrence = () => {
  const [set, law, all] = [byId('occurrence-set'), byId('occurrence-law'), byId('occurrence-all')];
  const table = data.tables[0];
  const every = table.rows.map(row => Object.fromEntries(table.header.map((name, i) => [name, row[i]])));
  fill(set, data.sets.map(name => [name, name]));
  fill(law, data.laws.map((name, i) => [name, data.law_titles[i] || name]));
  const several = { laws: data.laws.length > 1, numbers: new Set(every.map(row => row.in_contact)).size > 1 };
  set.parentElement.hidden = data.sets.length < 2;
  law.parentElement.hidden = !several.laws;
  const redraw = () => {
    hideTip();
    const rows = every.filter(row => row.constraints === set.value && row.law === law.value);
    const ever = new Set(rows.filter(row => row.ever_unstable === 'yes').map(row => row.mode));
    const shown = rows.filter(row => all.checked || ever.has(row.mode));
    const speeds = [...new Set(rows.map(row => row.speed))];
    const numbers = [...new Set(shown.map(row => row.in_contact))];
    const title = number => (several.numbers ? `${number} in contact` : 'All draws');
    const plots = numbers.map(number => plotOf(title(number), shown.filter(row => row.in_contact === number), speeds, several));
    byId('occurrence-plots').replaceChildren(...(plots.length ? plots : [make('p', {}, 'No mode is ever unstable here.')]));
    const described = name => (data.speeds.find(speed => speed[0] === name) ?? [name, 'any speed'])[1];
    byId('occurrence-key').replaceChildren(...speeds.map((speed, i) =>
      make('li', { class: `m${i % 4}` }, draw('svg', { viewBox: '-8 -8 16 16', 'aria-hidden': true }, markOf(i)), ` ${described(speed)}`)));
  };
  for (const control of [set, law, all]) control.addEventListener('change', redraw);
  redraw();
};
