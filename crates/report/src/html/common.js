// Making elements, and what all parts share.
const data = JSON.parse(document.getElementById('data').textContent);
const byId = id => document.getElementById(id);

const withParts = (element, attributes, parts) => {
  for (const [name, value] of Object.entries(attributes)) {
    element.setAttribute(name, value);
  }
  element.append(...parts);
  return element;
};
const make = (name, attributes = {}, ...parts) => withParts(document.createElement(name), attributes, parts);
const draw = (name, attributes = {}, ...parts) =>
  withParts(document.createElementNS('http://www.w3.org/2000/svg', name), attributes, parts);

// A part as it stands in a table, in percent with four digits; the table has all.
const percent = text => String(Number((100 * Number(text)).toPrecision(4)));
const rounded = text => `${(100 * Number(text)).toFixed(1)} %`;

// Words beside an element, while it is pointed at or has the focus.
const tip = byId('tip');
const showTip = (element, text) => {
  tip.textContent = text;
  tip.hidden = false;
  const at = element.getBoundingClientRect();
  const left = Math.min(at.right + 8, document.documentElement.clientWidth - tip.offsetWidth - 8);
  const below = at.bottom + 8 + tip.offsetHeight < window.innerHeight;
  tip.style.left = `${Math.max(8, left)}px`;
  tip.style.top = `${below ? at.bottom + 8 : Math.max(8, at.top - tip.offsetHeight - 8)}px`;
};
const hideTip = () => { tip.hidden = true; };
const withTip = (element, text) => {
  element.setAttribute('aria-label', text.replaceAll('\n', '; '));
  for (const event of ['pointerenter', 'focus']) {
    element.addEventListener(event, () => showTip(element, text));
  }
  for (const event of ['pointerleave', 'blur']) {
    element.addEventListener(event, hideTip);
  }
};
document.addEventListener('keydown', event => { if (event.key === 'Escape') hideTip(); });

// The options of a select: values with texts.
const fill = (select, options) => select.replaceChildren(...options.map(([value, text]) => make('option', { value }, text)));
