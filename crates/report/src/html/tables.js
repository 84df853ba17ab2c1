// Tables: rows that can be sorted, searched and saved as the CSV file that they came from.
const ROWS_SHOWN = 50;
// On paper all rows that are chosen, up to some forty pages, and a longer table says that it is cut.
const ROWS_PRINTED = 2000;
// Of numbers that are not whole so many digits; those of the file stand beside the pointer.
const DIGITS_SHOWN = 7;
const DIGITS_PRINTED = 5;
const shortened = (text, digits) => (/^-?\d+$/.test(text) ? text : String(Number(Number(text).toPrecision(digits))));

// The rows of a table; neighbours that are alike are stored once.
const rowsOf = table => {
  if (!table.rows) {
    table.rows = table.groups.flatMap(({ key, inner, outer, places }) =>
      places.map((place, i) => [...key, inner[i % inner.length], outer[Math.floor(i / inner.length)], ...table.values[place]]));
  }
  return table.rows;
};

// Columns in pieces that are not wider than paper, each with the words that a row begins with. A name may break at its underscores, words anywhere.
const CHARACTERS_PRINTED = 105;
const WORD_PRINTED = 14;
const KEYS_PRINTED = 4;
const inPieces = (header, rows) => {
  const width = (text, column) => rows.reduce((most, row) => Math.max(most, isNumber(row[column]) ? row[column].length : Math.min(row[column].length, WORD_PRINTED)),
    Math.max(...text.split(/(?<=_)/).map(part => part.length)));
  const widths = header.map((text, column) => 1 + width(text, column));
  let keys = 0;
  while (keys < KEYS_PRINTED && rows.length > 0 && !isNumber(rows[0][keys])) keys += 1;
  const first = [...header.keys()].slice(0, keys);
  const own = first.reduce((sum, column) => sum + widths[column], 0);
  let [pieces, used] = [[[...first]], own];
  for (let column = keys; column < header.length; column += 1) {
    if (used + widths[column] > CHARACTERS_PRINTED && pieces.at(-1).length > keys) {
      pieces = [...pieces, [...first]];
      used = own;
    }
    pieces.at(-1).push(column);
    used += widths[column];
  }
  return pieces;
};

const quoted = cell => (/[",\n\r]/.test(cell) ? `"${cell.replaceAll('"', '""')}"` : cell);
const csvOf = table => [table.header, ...rowsOf(table)].map(row => `${row.map(quoted).join(',')}\n`).join('');

const isNumber = cell => cell !== '' && Number.isFinite(Number(cell));
// Numbers by value before all words, words with the numbers in them by value: A2 before A10.
const words = new Intl.Collator('en', { numeric: true });
const order = (a, b) => {
  const [x, y] = [isNumber(a), isNumber(b)];
  return x && y ? Number(a) - Number(b) : x !== y ? (x ? -1 : 1) : words.compare(a, b);
};

const save = (name, text) => {
  const url = URL.createObjectURL(new Blob([text], { type: 'text/csv' }));
  make('a', { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
};

// The direction in which a click sorts next, kept in the header cell; the others forget theirs.
const nextDirection = head => {
  const direction = head.getAttribute('aria-sort') === 'ascending' ? 'descending' : 'ascending';
  for (const other of head.parentElement.children) {
    other.removeAttribute('aria-sort');
  }
  head.setAttribute('aria-sort', direction);
  return direction === 'ascending' ? 1 : -1;
};
const sortButton = (head, text, sort) => {
  // Names of columns may break at their underscores.
  const parts = text.split(/(?<=_)/).flatMap((part, place) => (place === 0 ? [part] : [make('wbr'), part]));
  const button = make('button', { type: 'button' }, ...parts);
  button.addEventListener('click', () => sort(nextDirection(head)));
  head.replaceChildren(button);
};

// A table that stands in the document.
const makeSortable = table => {
  const body = table.tBodies[0];
  [...table.tHead.rows[0].cells].forEach((head, column) => {
    const value = row => row.cells[column].dataset.value ?? row.cells[column].textContent;
    sortButton(head, head.textContent, sign =>
      body.append(...[...body.rows].sort((a, b) => sign * order(value(a), value(b)))));
  });
};

const startTables = () => {
  const [choice, filter, shown] = [byId('table-choice'), byId('table-filter'), byId('table')];
  let [table, rows, first, most] = [data.tables[0], [], 0, ROWS_SHOWN];
  fill(choice, data.tables.map((one, i) => [i, one.name]));

  const show = () => {
    const page = rows.slice(first, first + most);
    const isPaper = most === ROWS_PRINTED;
    const short = text => (isNumber(text) ? shortened(text, isPaper ? DIGITS_PRINTED : DIGITS_SHOWN) : text);
    const number = text => make('td', short(text) === text ? { class: 'number' } : { class: 'number', title: text }, short(text));
    const cell = text => (isNumber(text) ? number(text) : make('td', {}, text));
    const bodyOf = columns => page.map(row => make('tr', {}, ...columns.map(column => cell(row[column]))));
    const [columns, ...others] = isPaper ? inPieces(table.header, page.map(row => row.map(short))) : [[...table.header.keys()]];
    shown.tBodies[0].replaceChildren(...bodyOf(columns));
    const heads = [...shown.tHead.rows[0].cells];
    heads.forEach((head, column) => { head.hidden = !columns.includes(column); });
    const headOf = of => of.map(column => {
      const head = heads[column].cloneNode(true);
      head.hidden = false;
      return head;
    });
    byId('table-more').replaceChildren(...others.map(of =>
      make('table', {}, make('thead', {}, make('tr', {}, ...headOf(of))), make('tbody', {}, ...bodyOf(of)))));
    const last = first + page.length;
    const where = rows.length ? `Rows ${first + 1} to ${last} of ${rows.length}` : table.header.length ? 'No row' : '';
    byId('table-rows').textContent = isPaper && where && !table.is_figure ? `${where}; ${table.name} has all digits` : where;
    byId('table-back').disabled = first === 0;
    byId('table-on').disabled = last >= rows.length;
  };
  const select = () => {
    const wanted = filter.value.trim().toLowerCase();
    rows = rowsOf(table).filter(row => row.some(cell => cell.toLowerCase().includes(wanted)));
    first = 0;
  };
  const begin = () => {
    table = data.tables[choice.value];
    byId('table-about').textContent = `${table.about}.`;
    // A table that is too long for a page has no columns here.
    byId('table-save').disabled = filter.disabled = !table.header.length;
    select();
    const heads = table.header.map((text, column) => {
      const head = make('th', { scope: 'col' });
      // By the first cell that is filled.
      if (isNumber(rows.find(row => row[column] !== '')?.[column] ?? '')) head.className = 'number';
      sortButton(head, text, sign => {
        rows = [...rows].sort((a, b) => sign * order(a[column], b[column]));
        first = 0;
        show();
      });
      return head;
    });
    shown.tHead.replaceChildren(make('tr', {}, ...heads));
    show();
  };
  choice.addEventListener('change', begin);
  filter.addEventListener('input', () => {
    for (const head of shown.tHead.rows[0].cells) head.removeAttribute('aria-sort');
    select();
    show();
  });
  byId('table-save').addEventListener('click', () => save(table.name, csvOf(table)));
  byId('table-back').addEventListener('click', () => { first -= ROWS_SHOWN; show(); });
  byId('table-on').addEventListener('click', () => { first += ROWS_SHOWN; show(); });
  let kept = 0;
  window.addEventListener('beforeprint', () => {
    [kept, first, most] = [first, 0, ROWS_PRINTED];
    show();
  });
  window.addEventListener('afterprint', () => {
    [first, most] = [kept, ROWS_SHOWN];
    show();
  });
  begin();
};
