// Modes that move: u(t) = Re(shape e^(i phase)).
const VIEW = { width: 480, height: 400, margin: 15 };
const TRAIL_POINTS = 36;
const radians = degrees => (degrees * Math.PI) / 180;

const startShapes = () => {
  const { points, lines, is_spatial: isSpatial } = data.geometry;
  const slider = name => byId(`shape-${name}`);
  const value = name => Number(slider(name).value);
  const [choice, play, view] = [byId('shape-mode'), byId('shape-play'), byId('shape-view')];
  if (!points.length || !data.shapes.length) {
    byId('shapes').hidden = true;
    return;
  }
  view.classList.toggle('spatial', isSpatial);
  for (const label of document.querySelectorAll('label.spatial')) label.hidden = !isSpatial;
  choice.replaceChildren(...data.sets.map((name, set) => {
    const options = data.shapes.map((shape, i) => [shape, i]).filter(([shape]) => shape.set === set);
    return make('optgroup', { label: name }, ...options.map(([shape, i]) =>
      make('option', { value: i }, `${shape.label}, ${shape.hertz} Hz${shape.is_unstable ? ', unstable in some samples' : ''}`)));
  }));

  // The middle of the brake is the middle of the picture, however it is turned.
  const middle = [0, 1, 2].map(axis => points.reduce((sum, point) => sum + point.at[axis], 0) / points.length);
  const reach = Math.max(0.5, ...points.map(({ at }) => Math.hypot(...at.map((x, axis) => x - middle[axis]))));
  // Two neighbours are one unit apart; of a row of many, motion must be seen all the same.
  const amplitude = isSpatial ? 0.45 : 0.3 * reach;
  const zoom = isSpatial ? (VIEW.height / 2 - VIEW.margin) / reach : (VIEW.width / 2 - 4 * VIEW.margin) / reach;
  const onScreen = ([x, y, z]) => {
    const [turn, tilt] = isSpatial ? [radians(value('turn')), radians(value('tilt'))] : [0, 0];
    const [a, b, c] = [x - middle[0], y - middle[1], z - middle[2]];
    const depth = a * Math.sin(turn) + b * Math.cos(turn);
    const up = c * Math.cos(tilt) + depth * Math.sin(tilt);
    return [VIEW.width / 2 + zoom * (a * Math.cos(turn) - b * Math.sin(turn)), VIEW.height / 2 - zoom * up];
  };
  const placeAt = (point, shape, phase) => {
    const [c, s] = [Math.cos(phase), Math.sin(phase)];
    const size = amplitude * value('size');
    const moved = axis => {
      const dof = point.dofs[axis];
      return dof === null || dof >= shape.re.length ? 0 : size * (shape.re[dof] * c - shape.im[dof] * s);
    };
    return onScreen(point.at.map((x, axis) => x + moved(axis)));
  };
  const atRest = point => onScreen(point.at);
  const path = places => `M${places.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join('L')}`;

  const picture = draw('svg', { viewBox: `0 0 ${VIEW.width} ${VIEW.height}`, role: 'img' });
  const rest = draw('path', { class: 'rest' });
  const trails = draw('path', { class: 'trail' });
  const links = draw('path', { class: 'link' });
  const dots = points.map(({ name }) => draw('circle', { r: isSpatial ? (name === 'plate' ? 3 : 8) : 4, class: 'mass' }));
  const few = points.length <= 24;
  const names = points.map((point, i) =>
    draw('text', { class: 'soft' }, few && (i === 0 || points[i - 1].name !== point.name) ? point.name : ''));
  picture.append(rest, trails, links, ...dots, ...names);
  view.replaceChildren(picture);

  const shape = () => data.shapes[choice.value];
  const setUnmoved = () => {
    rest.setAttribute('d', lines.map(ends => path(ends.map(i => atRest(points[i])))).join(''));
    const round = [...Array(TRAIL_POINTS).keys()].map(k => (2 * Math.PI * k) / TRAIL_POINTS);
    trails.setAttribute('d', points.map(point => `${path(round.map(phase => placeAt(point, shape(), phase)))}Z`).join(''));
  };
  const setMoved = () => {
    const phase = radians(value('phase'));
    const places = points.map(point => placeAt(point, shape(), phase));
    links.setAttribute('d', lines.map(ends => path(ends.map(i => places[i]))).join(''));
    places.forEach(([x, y], i) => {
      dots[i].setAttribute('cx', x.toFixed(1));
      dots[i].setAttribute('cy', y.toFixed(1));
      names[i].setAttribute('x', (x + 10).toFixed(1));
      names[i].setAttribute('y', (y - 8).toFixed(1));
    });
  };
  const units = { phase: '°', speed: ' per s', size: ' ×', turn: '°', tilt: '°' };
  const setValues = () => {
    for (const [name, unit] of Object.entries(units)) byId(`shape-${name}-value`).textContent = `${value(name)}${unit}`;
  };
  const redraw = () => { setValues(); setUnmoved(); setMoved(); };

  const describe = () => {
    const { label, hertz, re, im } = shape();
    const motions = points.flatMap(({ name, dofs }) => dofs.map((dof, axis) => ({
      dof, name: isSpatial ? `${name === 'plate' ? 'plate' : `oscillator ${name}`}, ${'xyz'[axis]}` : name,
    }))).filter(({ dof }, i, all) => dof !== null && dof < re.length && all.findIndex(other => other.dof === dof) === i);
    const sized = motions.map(motion => ({ ...motion, size: Math.hypot(re[motion.dof], im[motion.dof]) }));
    const largest = sized.sort((a, b) => b.size - a.size).slice(0, 8);
    byId('shape-largest').replaceChildren(...largest.map(({ name, dof, size }) => make('tr', {}, make('th', { scope: 'row' }, name),
      make('td', { class: 'number' }, size.toFixed(3)),
      make('td', { class: 'number' }, Math.round((Math.atan2(im[dof], re[dof]) * 180) / Math.PI)))));
    const what = `Mode ${label} at ${hertz} Hz: most motion at ${largest[0].name}`;
    byId('shape-words').textContent = `${what}. Grey is at rest, thin orange lines are the paths. ` +
      (isSpatial ? 'x is along a row and the sliding, z away from the plate. Drag the picture to turn it.' : 'Every degree of freedom is drawn upwards, beside the others of its body.');
    picture.setAttribute('aria-label', `${what}, animated`);
    redraw();
  };
  choice.addEventListener('change', describe);
  for (const name of Object.keys(units)) slider(name).addEventListener('input', redraw);

  // Whoever asked for less motion starts it themselves.
  let [playing, seen, before] = [!matchMedia('(prefers-reduced-motion: reduce)').matches, false, 0];
  const setPlay = () => { play.textContent = playing ? 'Pause' : 'Play'; };
  const step = now => {
    if (!playing || !seen) {
      before = 0;
      return;
    }
    if (before) {
      exact = (exact + (360 * value('speed') * (now - before)) / 1000) % 360;
      slider('phase').value = exact;
      setMoved();
      byId('shape-phase-value').textContent = `${value('phase')}°`;
    }
    before = now;
    requestAnimationFrame(step);
  };
  let exact = 0;
  const go = () => { if (playing && seen && !before) requestAnimationFrame(step); };
  slider('phase').addEventListener('input', () => { exact = value('phase'); });
  play.addEventListener('click', () => { playing = !playing; setPlay(); go(); });
  new IntersectionObserver(entries => { seen = entries.at(-1).isIntersecting; go(); }).observe(picture);

  let from = null;
  picture.addEventListener('pointerdown', event => { from = isSpatial ? [event.clientX, event.clientY] : null; picture.setPointerCapture(event.pointerId); });
  picture.addEventListener('pointerup', () => { from = null; });
  picture.addEventListener('pointermove', event => {
    if (!from) return;
    slider('turn').value = value('turn') + 0.5 * (event.clientX - from[0]);
    slider('tilt').value = value('tilt') + 0.5 * (event.clientY - from[1]);
    from = [event.clientX, event.clientY];
    redraw();
  });
  setPlay();
  describe();
};
