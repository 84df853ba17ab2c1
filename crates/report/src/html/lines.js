// A body of points and lines, as an SVG.
const TRAIL_POINTS = 36;
const TRAIL_POINTS_OF_WAVE = 12;

const linesPicture = (body, view) => {
  const { at, names: all, lines, isSpatial } = body;
  const path = places => `M${places.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join('L')}`;
  const element = draw('svg', { viewBox: `0 0 ${VIEW.width} ${VIEW.height}`, role: 'img' });
  const rest = draw('path', { class: 'rest' });
  const trails = draw('path', { class: 'trail' });
  const links = draw('path', { class: 'link' });
  const dots = all.map(name => draw('circle', { r: isSpatial ? (name === 'plate' ? 3 : 8) : 4, class: 'mass' }));
  const few = all.length <= 24;
  const names = all.map((name, i) => draw('text', { class: 'soft' }, few && (i === 0 || all[i - 1] !== name) ? name : ''));
  element.append(rest, trails, links, ...dots, ...names);
  return {
    element,
    setShape: () => {},
    // What does not move while the phase does.
    setUnmoved: shape => {
      const onScreen = view.camera();
      rest.setAttribute('d', lines.map(ends => path(ends.map(i => onScreen(at[i])))).join(''));
      const points = Math.max(TRAIL_POINTS, TRAIL_POINTS_OF_WAVE * shape.waves.at(-1).order);
      const round = [...Array(points).keys()].map(k => view.places(shape, (2 * Math.PI * k) / points));
      trails.setAttribute('d', at.map((_, i) => `${path(round.map(places => places[i]))}Z`).join(''));
    },
    setMoved: (places, open) => {
      links.setAttribute('d', lines.map(ends => path(ends.map(i => places[i]))).join(''));
      places.forEach(([x, y], i) => {
        dots[i].setAttribute('cx', x.toFixed(1));
        dots[i].setAttribute('cy', y.toFixed(1));
        dots[i].classList.toggle('open', open.has(all[i]));
        names[i].setAttribute('x', (x + 10).toFixed(1));
        names[i].setAttribute('y', (y - 8).toFixed(1));
      });
    },
  };
};
