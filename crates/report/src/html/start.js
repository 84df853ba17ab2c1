// The parts of this page, each where it is.
const startTheme = () => {
  const button = byId('theme');
  const themes = ['', 'dark', 'light'];
  button.hidden = false;
  button.addEventListener('click', () => {
    const root = document.documentElement;
    const next = themes[(themes.indexOf(root.dataset.theme ?? '') + 1) % themes.length];
    if (next) root.dataset.theme = next;
    else delete root.dataset.theme;
    button.textContent = `Colours: ${next || 'as the system'}`;
  });
};

// Marks of a figure that is in the document, which have their numbers in their titles.
const startFigure = figure => {
  for (const group of figure.querySelectorAll('g:has(> title)')) {
    const title = group.querySelector('title');
    const text = title.textContent;
    title.remove();
    group.setAttribute('role', 'img');
    if (group.classList.contains('mark')) group.setAttribute('tabindex', 0);
    withTip(group, text);
  }
};

startTheme();
for (const table of document.querySelectorAll('table.sortable')) makeSortable(table);
if (byId('occurrence')) startOccurrence();
if (byId('shapes')) startShapes();
for (const id of ['locus', 'drops', 'cycle_branches', 'cycle_contacts', 'cycle_spectrum']) if (byId(id)) startFigure(byId(id));
if (data.tables.length) startTables();
else byId('tables').hidden = true;
document.querySelector('nav').append(...[...document.querySelectorAll('section:not([hidden])')].map(section =>
  make('a', { href: `#${section.id}` }, section.querySelector('h2').textContent)));
