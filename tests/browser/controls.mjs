// What moves the controls of a page: expressions for it.

export const select = (id, value) =>
  `{ const control = document.getElementById('${id}'); control.value = ${JSON.stringify(value)};
     control.dispatchEvent(new Event('change')); control.dispatchEvent(new Event('input')); }`;
