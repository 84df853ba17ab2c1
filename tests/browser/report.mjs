// Opens pages that `squeal run`, `sweep`, `screen` or `cycle` wrote in headless Chromium: do controls work, is nothing complained of or asked
// from a network, does the picture show the numbers of the tables beside the page, and is it whole on paper?
//
// node tests/browser/report.mjs FOLDER... [--pictures DIR]
import assert from 'node:assert/strict';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { basename, join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { Browser } from './browser.mjs';
import { mesh } from './mesh.mjs';
import { select } from './controls.mjs';

const options = id => `[...document.querySelectorAll('#${id} option')].map(option => option.value)`;
const click = id => `document.getElementById('${id}').click()`;
const column = index => `[...document.querySelectorAll('#table tbody tr')].map(row => row.cells[${index}].textContent)`;
const ascending = values => values.every((value, i) => i === 0 || Number(values[i - 1]) <= Number(value));
const frames = 'new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 60))))';

// Every table is, downloaded, the file beside the page; a click on a header sorts.
const tables = async (page, folder) => {
  await page.value(`window.saved = null; window.made = URL.createObjectURL;
    URL.createObjectURL = blob => { window.saved = blob.text(); return window.made.call(URL, blob); }`);
  const names = await page.value("[...document.querySelectorAll('#table-choice option')].map(option => option.textContent)");
  assert.ok(names.length > 0, 'no table');
  for (const [i, name] of names.entries()) {
    await page.value(select('table-choice', String(i)));
    await page.value(click('table-save'));
    const text = await page.value('window.saved');
    if (name === 'occurrence_by_panel.csv') continue;
    assert.ok(text === readFileSync(join(folder, name), 'utf8'), `${name} differs from its file`);
  }
  await page.value(select('table-choice', '0'));
  const long = "[...document.querySelectorAll('#table td.number')].map(cell => cell.textContent).filter(text => text.length > 16)";
  assert.deepEqual(await page.value(long), [], 'numbers with all their digits');
  // By the column of numbers that differ most.
  const shown = await page.value(`[...document.querySelectorAll('#table tbody tr:first-child td')].map((cell, i) =>
    cell.className === 'number' ? new Set(${column('i')}).size : 0)`);
  const number = shown.indexOf(Math.max(...shown));
  const head = `document.querySelectorAll('#table thead button')[${number}].click()`;
  await page.value(head);
  // A table of a screening leaves empty what is not confirmed.
  const filled = values => values.filter(value => value !== '');
  assert.ok(ascending(filled(await page.value(column(number)))), 'not ascending');
  await page.value(head);
  assert.ok(ascending(filled(await page.value(column(number))).reverse()), 'not descending');
  assert.equal(await page.value(`document.querySelectorAll('#table thead th')[${number}].getAttribute('aria-sort')`), 'descending');
  const before = await page.value("document.getElementById('table-rows').textContent");
  await page.value("{ const filter = document.getElementById('table-filter'); filter.value = 'no such row'; filter.dispatchEvent(new Event('input')); }");
  assert.equal(await page.value("document.getElementById('table-rows').textContent"), 'No row');
  await page.value("{ const filter = document.getElementById('table-filter'); filter.value = ''; filter.dispatchEvent(new Event('input')); }");
  assert.equal(await page.value("document.getElementById('table-rows').textContent"), before);
};

const csv = text => {
  const cells = line => [...line.matchAll(/(?:^|,)(?:"((?:[^"]|"")*)"|([^,]*))/g)].map(found => found[1]?.replaceAll('""', '"') ?? found[2]);
  const [header, ...rows] = text.trimEnd().split('\n').map(cells);
  return rows.map(row => Object.fromEntries(header.map((name, i) => [name, row[i]])));
};
const median = values => {
  const sorted = [...values].sort((a, b) => a - b);
  return 0.5 * (sorted[Math.floor((sorted.length - 1) / 2)] + sorted[Math.ceil((sorted.length - 1) / 2)]);
};

// Marks stand at the medians of occurrence.csv, measured on the screen against the axis, and say them.
const occurrence = async (page, folder) => {
  const medians = new Map();
  const labels = new Map(csv(readFileSync(join(folder, 'modes.csv'), 'utf8')).map(row => [`${row.constraints}\n${row.mode}`, row.label]));
  for (const row of csv(readFileSync(join(folder, 'occurrence.csv'), 'utf8'))) {
    const mode = labels.get(`${row.constraints}\n${row.mode}`) ?? row.mode;
    const key = [row.constraints, row.law, row.speed, row.in_contact, mode].join('\n');
    medians.set(key, [...(medians.get(key) ?? []), Number(row.occurrence)]);
  }
  let [marks, sets, laws] = [0, await page.value(options('occurrence-set')), await page.value(options('occurrence-law'))];
  await page.value("document.getElementById('occurrence-all').click()");
  for (const set of sets) {
    for (const law of laws) {
      await page.value(select('occurrence-set', set));
      await page.value(select('occurrence-law', law));
      const shown = await page.value(`[...document.querySelectorAll('#occurrence-plots svg')].flatMap(plot => {
        const axis = [...plot.querySelectorAll('.grid')].map(line => line.getBoundingClientRect().x);
        return [...plot.querySelectorAll('.point')].map(point => {
          const mark = point.querySelector('.hit').getBoundingClientRect();
          return [point.dataset.key, (mark.x + mark.width / 2 - axis[0]) / (axis[4] - axis[0]), point.getAttribute('aria-label')];
        });
      })`);
      for (const [key, part, label] of shown) {
        const expected = median(medians.get(key));
        // A pixel of some three hundred.
        assert.ok(Math.abs(part - expected) < 0.004, `${key}: drawn at ${part}, is ${expected}`);
        const said = Number(label.match(/Unstable in ([^ ]+) %/)[1]);
        assert.ok(Math.abs(said - 100 * expected) <= 0.005 + 1e-9, `${key}: said ${said}`);
      }
      marks += shown.length;
    }
  }
  assert.equal(marks, medians.size, 'marks');
  // Arrow keys move from mark to mark, and its numbers appear.
  await page.value("document.querySelector('#occurrence-plots .point').focus()");
  await page.key('ArrowDown');
  const [at, tip, label] = await page.value(`[[...document.querySelectorAll('.point')].indexOf(document.activeElement),
    document.getElementById('tip').hidden ? '' : document.getElementById('tip').textContent, document.activeElement.getAttribute('aria-label')]`);
  assert.equal(at, 1);
  assert.equal(tip.replaceAll('\n', '; '), label);
  await page.key('Escape');
  assert.equal(await page.value("document.getElementById('tip').hidden"), true);
  await page.value("document.getElementById('occurrence-all').click()");
};

const hasShapes = page => page.value("document.getElementById('shape-view')?.checkVisibility() === true");

const shapes = async page => {
  const isMesh = await page.value("document.querySelector('#shape-view canvas') !== null");
  const shown = isMesh ? "document.querySelector('#shape-view canvas').toDataURL()"
    : "JSON.stringify([...document.querySelectorAll('#shape-view circle')].map(dot => [dot.getAttribute('cx'), dot.getAttribute('cy')]))";
  await page.value("document.getElementById('shapes').scrollIntoView()");
  const playing = await page.value("document.getElementById('shape-play').textContent");
  assert.equal(playing, 'Pause');
  const moving = await page.value(shown);
  await page.value(frames);
  await page.value(frames);
  assert.notEqual(await page.value(shown), moving, 'the mode does not move');
  await page.value(click('shape-play'));
  await page.value(frames);
  const still = await page.value(shown);
  await page.value(frames);
  assert.equal(await page.value(shown), still, 'the mode moves while it is paused');
  const isSpatial = await page.value("!document.getElementById('shape-turn').closest('label').hidden");
  for (const [control, there] of [['phase', '120'], ['size', '2.5'], ['turn', '75'], ['tilt', '80'], ['zoom', '1.5'], ['mode', '1']]) {
    if (!isSpatial && ['turn', 'tilt', 'zoom'].includes(control)) continue;
    if (control === 'mode' && (await page.value(options('shape-mode'))).length < 2) continue;
    const before = await page.value(shown);
    await page.value(select(`shape-${control}`, there));
    assert.notEqual(await page.value(shown), before, `${control} changes nothing`);
  }
  if (isSpatial) {
    await page.value("document.getElementById('shape-view').focus()");
    for (const key of ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', '+', '-']) {
      const before = await page.value(shown);
      await page.key(key);
      assert.notEqual(await page.value(shown), before, `the key ${key} changes nothing`);
    }
  }
  if (isSpatial) {
    const [before, turn] = [await page.value(shown), await page.value("document.getElementById('shape-turn').value")];
    const [x, y] = await page.value(`(() => { const box = document.querySelector('#shape-view > *').getBoundingClientRect();
      return [box.x + box.width / 2, box.y + box.height / 2]; })()`);
    for (const [type, by] of [['mousePressed', 0], ['mouseMoved', 20], ['mouseReleased', 20], ['mouseMoved', 60]]) {
      await page.send('Input.dispatchMouseEvent', { type, x: x + by, y, button: 'left', clickCount: 1 });
    }
    assert.notEqual(await page.value(shown), before, 'a drag changes nothing');
    assert.equal(Number(await page.value("document.getElementById('shape-turn').value")) - Number(turn), 10, 'a drag by 20 pixels');
  }
  return isMesh;
};

// The modes at onsets, or at the middle of each curve of a boundary, are those of the tables.
const crossing = async (page, folder) => {
  const file = ['onsets.csv', 'boundary.csv'].find(name => existsSync(join(folder, name)));
  const rows = csv(readFileSync(join(folder, file), 'utf8'));
  const wanted = file === 'onsets.csv' ? rows : [...new Map(rows.map(row => [row.curve, row])).values()];
  const said = await page.value("[...document.querySelectorAll('#shape-mode option')].map(option => option.textContent)");
  assert.equal(said.length, wanted.length);
  const lead = await page.value("[...document.querySelectorAll('.lead li')].map(item => item.textContent)");
  const names = [...new Set(rows.map(row => row.mode))].filter(mode => mode !== 'divergence');
  for (const mode of names.slice(0, 10)) {
    const isOf = file === 'onsets.csv' ? item => item.startsWith(`Mode ${mode} (`) : item => ` ${item}`.match(/[^ ,:.]+/g).includes(mode);
    assert.ok(lead.some(isOf), `no sentence on mode ${mode}: ${lead}`);
  }
  const hertz = text => Number(text.match(/, ([0-9.]+) Hz/)[1]);
  for (const [i, { mode, curve, frequency_hz: frequency }] of wanted.entries()) {
    assert.ok(said[i].startsWith(mode === 'divergence' ? 'Divergence,' : `Mode ${mode},`), `${said[i]} is of mode ${mode}`);
    const own = rows.filter(row => row.curve === curve).map(row => Number(row.frequency_hz));
    const [least, most] = curve ? [Math.min(...own), Math.max(...own)] : [frequency, frequency].map(Number);
    assert.ok(hertz(said[i]) > 0.999 * least - 0.001 && hertz(said[i]) < 1.001 * most + 0.001, `${said[i]} is not at ${least} to ${most} Hz`);
  }
};

// Marks of a root locus say the numbers of the tables, where there are such tables.
const marks = async (page, folder) => {
  assert.ok(await page.value("document.querySelector('#locus svg') !== null"));
  const files = ['onsets.csv', 'coalescences.csv'].filter(name => existsSync(join(folder, name)));
  const rows = files.flatMap(name => csv(readFileSync(join(folder, name), 'utf8')));
  const labels = await page.value("[...document.querySelectorAll('#locus .mark[tabindex]')].map(mark => mark.getAttribute('aria-label'))");
  // In each of three panels.
  assert.equal(labels.length, 3 * rows.length);
  for (const row of rows) {
    const said = labels.filter(label => label.includes(`${row.frequency_hz} Hz`) && label.includes(row.mode));
    assert.ok(said.length >= 3, `no mark says ${JSON.stringify(row)}`);
  }
};

// Bars of a screening say the drops of its table.
const bars = async (page, folder) => {
  const rows = csv(readFileSync(join(folder, 'screen.csv'), 'utf8')).filter(row => row.drop !== '').slice(1);
  const labels = await page.value("[...document.querySelectorAll('#drops .mark[tabindex]')].map(mark => mark.getAttribute('aria-label'))");
  assert.equal(labels.length, rows.length);
  for (const row of rows) {
    const said = labels.some(label => label.startsWith(row.places) && label.includes(Number(row.drop).toFixed(4)));
    assert.ok(said, `no bar says ${JSON.stringify(row)}`);
  }
};

// Marks of the figures of cycles say the numbers of the tables.
const cycles = async (page, folder) => {
  const rows = name => csv(readFileSync(join(folder, `${name}.csv`), 'utf8'));
  const labels = selector => page.value(`[...document.querySelectorAll('${selector}')].map(mark => mark.getAttribute('aria-label'))`);
  if (existsSync(join(folder, 'cycle_branches.csv'))) {
    const said = await labels('#cycle_branches .point, #cycle_branches .fold');
    const all = rows('cycle_branches');
    // In both panels, but for what has no loudness.
    assert.equal(said.length, all.length + all.filter(row => row.loudness_m_per_s !== '').length);
    for (const { mode, cycle_hz: cycle, balance_hz: balance, loudness_m_per_s: loudness, stable } of all) {
      const word = { yes: 'stable', no: 'unstable', '': 'in harmonic balance alone' }[stable];
      const wanted = `: ${cycle || balance} Hz, ${word}${loudness && `, ${loudness} m/s`}`;
      assert.ok(said.some(label => label.startsWith(`cycle of mode ${mode} at `) && label.includes(wanted)), `no mark says ${wanted}`);
    }
    return;
  }
  const moving = rows('cycles').filter(row => row.kind === 'cycle').slice(0, 5);
  assert.equal(await page.value("document.querySelector('#cycle_spectrum') !== null"), moving.length > 0);
  const said = await labels('#cycle_spectrum .harmonic');
  const harmonics = rows('cycle_spectrum').map(row => `harmonic ${row.harmonic}: ${row.frequency_hz} Hz, ${row.loudness_m_per_s} m/s`);
  assert.ok(said.length >= moving.length && said.every(label => harmonics.includes(label)), `${said}`);
  const of = (column, unit) => moving.flatMap(({ from_mode: from }) => {
    const all = rows('cycle_contacts').filter(row => row.from_mode === from);
    return [...new Set(all.map(row => row.contact))].map(contact => {
      const values = all.filter(row => row.contact === contact).map(row => Number(row[column]));
      return `contact ${contact}: ${Math.min(...values).toFixed(4)} to ${Math.max(...values).toFixed(4)} ${unit}`;
    });
  });
  const ranges = [...of('normal_force_n', 'N'), ...of('sliding_velocity_m_per_s', 'm/s')];
  // Of the first cycle that moves, on a lattice: hollow where a contact is open at a third of the period.
  const open = new Set(rows('cycle_contacts').filter(row => row.from_mode === moving[0]?.from_mode && row.state === 'open' && row.part_of_period === String(43 / 128))
    .map(row => row.contact));
  await page.value(select('shape-phase', '121'));
  const hollow = await page.value("[...document.querySelectorAll('#shape-view circle')].filter(dot => dot.classList.contains('open')).length");
  if (await page.value("JSON.parse(document.getElementById('data').textContent).moving.geometry.is_spatial === true")) assert.equal(hollow, open.size, 'hollow');
  const lines = await labels('#cycle_contacts .contact');
  assert.ok(lines.every(label => ranges.includes(label)), `${lines}`);
};

const theme = async page => {
  const background = 'getComputedStyle(document.body).backgroundColor';
  const seen = [await page.value(background)];
  for (let i = 0; i < 2; i++) {
    await page.value(click('theme'));
    seen.push(await page.value(background));
  }
  assert.equal(new Set(seen).size, 2, `colours: ${seen}`);
  await page.value(click('theme'));
  assert.equal(await page.value(background), seen[0]);
};

const semantics = async page => {
  const levels = await page.value("[...document.querySelectorAll('h1, h2, h3')].map(heading => Number(heading.tagName[1]))");
  assert.equal(levels[0], 1);
  assert.ok(levels.every((level, i) => i === 0 || level <= levels[i - 1] + 1), `headings: ${levels}`);
  const nameless = await page.value(`[...document.querySelectorAll('main button, main select, main input, [role=img]')]
    .filter(control => !control.closest('label') && !control.textContent.trim() && !control.getAttribute('aria-label')).map(control => control.outerHTML)`);
  assert.deepEqual(nameless, []);
  assert.equal(await page.value('document.documentElement.lang'), 'en');
  assert.deepEqual(await page.value("[...document.querySelectorAll('[hidden]')].filter(part => part.getClientRects().length > 0).map(part => part.outerHTML)"), []);
};

// On paper: no controls, every row and every heading of a table, nothing wider than the paper, black on white.
const paper = async (page, folder, pictures) => {
  const rows = "document.querySelectorAll('#table tbody tr').length";
  const [before, said] = await page.value(`[${rows}, document.getElementById('table-rows').textContent]`);
  const all = Math.min(2000, Number(said.match(/of (\d+)$/)[1]));
  await page.view(718, 1000, 'dark', 'reduce'); // 19 cm
  await page.printed(true);
  const visible = selector => `[...document.querySelectorAll('${selector}')].filter(part => part.checkVisibility()).length`;
  assert.equal(await page.value(visible('nav, input, main button:not(thead button), #theme')), 0, 'controls on paper');
  assert.equal(await page.value(rows), all, 'rows on paper');
  const heads = await page.value("[...document.querySelectorAll('#table thead th')].map(head => head.innerText.trim())");
  const header = await page.value("JSON.parse(document.getElementById('data').textContent).tables[0].header");
  assert.deepEqual(heads, header, 'headings on paper');
  // In pieces, if there are more than fit beside each other: each column is in one, and no number is broken.
  const seen = await page.value(`[...document.querySelectorAll('#table thead th, #table-more thead th')].filter(head => head.checkVisibility())
    .map(head => head.innerText.trim())`);
  assert.deepEqual([...new Set(seen)].sort(), [...new Set(header)].sort(), 'columns on paper');
  const broken = await page.value(`[...document.querySelectorAll('#table td.number, #table-more td.number')].filter(cell => {
    const range = document.createRange();
    range.selectNodeContents(cell);
    return range.getClientRects().length > 1;
  }).map(cell => cell.textContent)`);
  assert.deepEqual(broken, [], 'numbers that are broken on paper');
  const wide = await page.value(`[...document.querySelectorAll('main *')].filter(part => part.checkVisibility() && !part.closest('svg'))
    .filter(part => part.getBoundingClientRect().right > 719 || (part.clientHeight && part.scrollHeight > part.clientHeight + 2
      && getComputedStyle(part).overflowY !== 'visible')).map(part => part.outerHTML.slice(0, 80))`);
  assert.deepEqual(wide, [], 'cut by the paper');
  const tall = await page.value("[...document.querySelectorAll('figure, #shape-view')].map(figure => figure.getBoundingClientRect().height)");
  assert.ok(tall.every(height => height < 1000), `figures of ${tall} pixels`);
  // What stands first because results may be wrong is red there too.
  const colours = await page.value("['p:not(.doubt)', 'td', 'th'].map(name => getComputedStyle(document.querySelector(`main ${name}`)).color)");
  assert.deepEqual([...new Set(colours)], ['rgb(0, 0, 0)']);
  await page.printed(false);
  const pdf = await page.pdf();
  assert.equal(pdf.subarray(0, 5).toString(), '%PDF-');
  if (pictures) writeFileSync(join(pictures, `${basename(resolve(folder))}.pdf`), pdf);
  assert.equal(await page.value(rows), before, 'rows after printing');
  assert.equal(await page.value("document.getElementById('table-rows').textContent"), said);
};

const check = async (browser, folder, pictures) => {
  const url = pathToFileURL(resolve(folder, 'report.html')).href;
  const page = await browser.open(url);
  await page.view(1280, 900, 'light');
  await semantics(page);
  await theme(page);
  await tables(page, folder);
  if (existsSync(join(folder, 'cycles_by_mode.csv'))) {
    const headings = await page.value("[...document.querySelectorAll('#answer h3')].map(heading => heading.textContent)");
    assert.ok(headings.includes('The motions that unstable modes grow into'), `${headings}`);
  }
  const isStudy = await page.value("document.getElementById('occurrence') !== null");
  if (isStudy) {
    await occurrence(page, folder);
    if (await shapes(page)) await mesh(page, folder);
  } else if (await page.value("document.getElementById('drops') !== null")) {
    await bars(page, folder);
  } else if (['cycles.csv', 'cycle_branches.csv'].some(name => existsSync(join(folder, name)))) {
    await cycles(page, folder);
  } else {
    await marks(page, folder);
    if (!(await page.value("JSON.parse(document.getElementById('data').textContent).moving.geometry.why"))) await crossing(page, folder);
  }
  if (!isStudy && (await hasShapes(page))) await shapes(page);
  // As a reader finds it, at rest: the same picture each time.
  const calm = await browser.open('about:blank');
  await calm.view(900, 900, 'light', 'reduce');
  await calm.start(url);
  if (await hasShapes(calm)) assert.equal(await calm.value("document.getElementById('shape-play').textContent"), 'Play');
  for (const width of [400, 900, 1400]) {
    for (const scheme of ['light', 'dark']) {
      await calm.view(width, 900, scheme, 'reduce');
      const wide = await calm.value('document.documentElement.scrollWidth');
      assert.ok(wide <= width, `${width} pixels: the page is ${wide} wide`);
      if (pictures) writeFileSync(join(pictures, `${basename(resolve(folder))}-${width}-${scheme}.png`), await calm.picture());
    }
  }
  const cut = "[...document.querySelectorAll('pre')].filter(part => part.checkVisibility() && part.scrollWidth > part.clientWidth).length";
  assert.equal(await calm.value(cut), 0, 'text that is cut on a wide screen');
  await paper(calm, folder, pictures);
  assert.deepEqual([...page.complaints, ...calm.complaints], []);
  assert.deepEqual([...page.requests, ...calm.requests].filter(request => request !== url && !request.startsWith('blob:')), []);
  console.log(`${folder}: the page shows what its tables say`);
};

const args = process.argv.slice(2);
const at = args.indexOf('--pictures');
const pictures = at >= 0 ? args.splice(at, 2)[1] : null;
if (pictures) mkdirSync(pictures, { recursive: true });
const browser = new Browser(process.env.CHROMIUM ?? 'chromium');
try {
  for (const folder of args) await check(browser, folder, pictures);
} finally {
  await browser.close();
}
