// Modes that move: which one, how fast and large, and from where it is seen.
const UNITS = { phase: '°', speed: ' per s', size: ' ×', turn: '°', tilt: '°', zoom: ' ×' };
// What a key does to a slider.
const KEYS = {
  ArrowLeft: ['turn', -5], ArrowRight: ['turn', 5], ArrowUp: ['tilt', -5], ArrowDown: ['tilt', 5], '+': ['zoom', 0.2], '=': ['zoom', 0.2], '-': ['zoom', -0.2],
};
const LEGEND = { width: 240, height: 30, bar: 12, steps: 48, left: 12 };

// What the colours of a picture mean.
const legendOf = ({ colour, marks }) => {
  const { width, height, bar, steps, left } = LEGEND;
  const x = part => left + part * (width - 2 * left);
  const picture = draw('svg', { viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': `Colours from ${marks[0]}, pale, to ${marks.at(-1)}, dark` });
  for (let i = 0; i < steps; i++) {
    picture.append(draw('rect', { x: x(i / steps), width: x(1 / steps) - x(0) + 0.5, height: bar, fill: colour((i + 0.5) / steps) }));
  }
  marks.forEach((mark, i) => {
    const at = x(i / (marks.length - 1));
    picture.append(draw('line', { x1: at, x2: at, y1: bar, y2: bar + 4, class: 'grid' }),
      draw('text', { x: at, y: height - 2, 'text-anchor': 'middle', class: 'soft' }, mark));
  });
  return ['How far it moves, of the farthest: ', picture];
};

const startShapes = () => {
  const slider = name => byId(`shape-${name}`);
  const value = name => Number(slider(name).value);
  const [section, choice, play, frame] = [byId('shapes'), byId('shape-mode'), byId('shape-play'), byId('shape-view')];
  const { geometry, groups, shapes, left_out: leftOut } = data.moving;
  if (geometry.why) {
    section.replaceChildren(section.querySelector('h2'), make('p', {}, geometry.why));
    return;
  }
  if (!shapes.length) {
    if (leftOut) section.replaceChildren(section.querySelector('h2'), make('p', {}, leftOut));
    else section.hidden = true;
    return;
  }
  byId('shape-left-out').textContent = leftOut ?? '';
  byId('shape-left-out').hidden = !leftOut;
  const body = bodyOf(geometry);
  const view = viewOf(body, value);
  const picture = (body.faces ? surfacePicture : linesPicture)(body, view);
  frame.replaceChildren(picture.element);
  for (const label of document.querySelectorAll('label.spatial')) label.hidden = !body.isSpatial;
  if (picture.legend) byId('shape-key').append(...legendOf(picture.legend));
  byId('shape-key').hidden = !picture.legend;
  choice.replaceChildren(...groups.map((label, group) => {
    const options = shapes.map((shape, i) => [shape, i]).filter(([shape]) => shape.group === group);
    return make('optgroup', { label }, ...options.map(([{ name, hertz, note }, i]) =>
      make('option', { value: i }, [name, `${hertz} Hz`, note].filter(Boolean).join(', '))));
  }));

  // The largest number of a mode is drawn as far as the size says, and so is the farthest point of a cycle.
  const shape = () => {
    const chosen = unpackedShape(shapes[choice.value]);
    chosen.farthest ??= farthestOf(body, chosen);
    chosen.scale ??= chosen.orders ? 1 / chosen.farthest.points.reduce((a, b) => Math.max(a, b), Number.MIN_VALUE) : 1;
    return chosen;
  };
  const setValues = () => {
    for (const [name, unit] of Object.entries(UNITS)) byId(`shape-${name}-value`).textContent = `${value(name)}${unit}`;
  };
  const setMoved = () => {
    const phase = radians(value('phase'));
    picture.setMoved(view.places(shape(), phase), openAt(shape(), phase));
  };
  const redraw = () => { setValues(); picture.setUnmoved(shape()); setMoved(); };

  const describe = () => {
    const { name: called, hertz, farthest: { points, sizes, phases } } = shape();
    picture.setShape(points);
    // A body of several points has the same degrees of freedom at each.
    const motions = new Map();
    body.dofs.forEach((dofs, i) => dofs.forEach((dof, axis) => {
      if (dof !== null && dof < sizes.length && !motions.has(dof)) motions.set(dof, [i, axis]);
    }));
    const sized = [...motions].map(([dof, at]) => ({ dof, at, size: sizes[dof] }));
    const largest = sized.sort((a, b) => b.size - a.size).slice(0, 8).map(motion => ({ ...motion, name: body.motionName(...motion.at) }));
    const most = shape().orders ? largest[0].size : 1;
    byId('shape-largest').replaceChildren(...largest.map(({ name, dof, size }) => make('tr', {}, make('th', { scope: 'row' }, name),
      make('td', { class: 'number' }, (size / most).toFixed(3)),
      make('td', { class: 'number' }, Math.round(phases[dof])))));
    const what = `${called} at ${hertz} Hz: most motion at ${largest[0].name}`;
    const hollow = Object.keys(shape().open ?? {}).length ? ' A hollow one has its contact open.' : '';
    byId('shape-words').replaceChildren(`${what}. ${body.words}${hollow}`,
      make('span', { class: 'on-screen' }, body.isSpatial ? ' Drag the picture to turn it, or use the arrow keys, + and -.' : ''));
    picture.element.setAttribute('aria-label', `${what}, animated`);
    redraw();
  };
  choice.addEventListener('change', describe);
  for (const name of Object.keys(UNITS)) slider(name).addEventListener('input', redraw);

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
  new IntersectionObserver(entries => { seen = entries.at(-1).isIntersecting; go(); }).observe(picture.element);
  // On paper nothing moves and no slider is seen: what they say is in words.
  window.addEventListener('beforeprint', () => {
    const seenFrom = body.isSpatial ? `, turned by ${value('turn')}°, tilted by ${value('tilt')}°` : '';
    byId('shape-still').textContent = `The picture is at the phase ${value('phase')}°, with the size ${value('size')}${seenFrom}.`;
  });
  if (body.isSpatial) startTurning(frame, picture.element, slider, redraw);
  setPlay();
  describe();
};

// Turning by pointer and keys, which move the sliders.
const startTurning = (frame, element, slider, redraw) => {
  const change = (name, by) => {
    const control = slider(name);
    const there = Number(control.value) + by;
    // Around the brake without an end.
    control.value = name === 'turn' ? ((((there + 180) % 360) + 360) % 360) - 180 : there;
  };
  frame.classList.add('spatial');
  withParts(frame, { tabindex: 0, role: 'group', 'aria-label': 'Picture: arrow keys turn it, + and - bring it nearer or farther' }, []);
  frame.addEventListener('keydown', event => {
    if (!KEYS[event.key] || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    change(...KEYS[event.key]);
    redraw();
  });
  let from = null;
  element.addEventListener('pointerdown', event => {
    from = [event.clientX, event.clientY];
    element.setPointerCapture(event.pointerId);
  });
  for (const name of ['pointerup', 'pointercancel']) element.addEventListener(name, () => { from = null; });
  element.addEventListener('pointermove', event => {
    if (!from) return;
    change('turn', 0.5 * (event.clientX - from[0]));
    change('tilt', 0.5 * (event.clientY - from[1]));
    from = [event.clientX, event.clientY];
    redraw();
  });
};
