// What moves: the points of a lattice, or the nodes on the surface of a mesh.
const axisNames = 'xyz';

// Numbers that are stored as whole ones of 16 bits, little-endian as the machines are on which there are browsers.
const unpacked = (text, List) => new List(Uint8Array.from(atob(text), letter => letter.charCodeAt(0)).buffer);
const parts = text => Float32Array.from(unpacked(text, Int16Array), part => part / 32767);

// A shape with its waves: real and imaginary part of each number, of which the largest has the modulus 1. A mode is one wave, of order 1: once to and fro
// while the phase goes around. A cycle is its mean, of order 0, and some harmonics.
const unpackedShape = shape => {
  if (!shape.waves) {
    const [all, orders] = [parts(shape.parts), shape.orders ?? [1]];
    const length = all.length / orders.length;
    shape.waves = orders.map((order, wave) => {
      const both = all.subarray(wave * length, (wave + 1) * length);
      return { order, re: both.filter((_, i) => i % 2 === 0), im: both.filter((_, i) => i % 2 === 1) };
    });
  }
  return shape;
};

// The displacement of each degree of freedom at a phase: Re of the sum of all waves, each times e^(i order phase).
const displacements = ({ waves }, phase) => {
  const moved = new Float32Array(waves[0].re.length);
  for (const { order, re, im } of waves) {
    const [c, s] = [Math.cos(order * phase), Math.sin(order * phase)];
    for (let dof = 0; dof < moved.length; dof++) moved[dof] += re[dof] * c - im[dof] * s;
  }
  return moved;
};

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

// The contacts of a cycle that are open at a phase, by their names.
const openAt = ({ open = {} }, phase) => new Set(Object.entries(open)
  .filter(([, steps]) => steps[Math.round((phase / (2 * Math.PI)) * steps.length) % steps.length] === 'o').map(([name]) => name));

// How far each point gets from its place, and each degree of freedom with its phase there, in degrees. A mode goes around on ellipses: half of the long axis;
// a cycle is looked at in steps of the phase.
const PHASES = 72;
const farthestOf = ({ dofs }, shape) => {
  const far = (places, value) => places.map(dof => value[dof] ?? 0);
  const { waves } = shape;
  if (waves.length === 1) {
    const [{ re, im }] = waves;
    const points = dofs.map(places => {
      const [a, b] = [far(places, re), far(places, im)];
      const [aa, bb, ab] = [dot(a, a), dot(b, b), dot(a, b)];
      return Math.sqrt((aa + bb) / 2 + Math.hypot((aa - bb) / 2, ab));
    });
    return { points, sizes: re.map((x, i) => Math.hypot(x, im[i])), phases: re.map((x, i) => (Math.atan2(im[i], x) * 180) / Math.PI) };
  }
  const [points, sizes] = [new Float32Array(dofs.length), new Float32Array(waves[0].re.length)];
  const phases = new Float32Array(sizes.length);
  for (let step = 0; step < PHASES; step++) {
    const moved = displacements(shape, (2 * Math.PI * step) / PHASES);
    moved.forEach((u, dof) => {
      if (Math.abs(u) > sizes[dof]) [sizes[dof], phases[dof]] = [Math.abs(u), (360 * step) / PHASES];
    });
    dofs.forEach((places, i) => { points[i] = Math.max(points[i], Math.hypot(...far(places, moved))); });
  }
  return { points: Array.from(points), sizes, phases };
};

const latticeBody = ({ points, lines, is_spatial: isSpatial }) => ({
  at: points.map(point => point.at),
  dofs: points.map(point => point.dofs),
  names: points.map(point => point.name),
  lines,
  isSpatial,
  motionName: (i, axis) => {
    const { name } = points[i];
    return isSpatial ? `${name === 'plate' ? 'plate' : `oscillator ${name}`}, ${axisNames[axis]}` : name;
  },
  // Two neighbours are one unit apart; of a row of many, motion must be seen all the same.
  amplitudeFor: reach => (isSpatial ? 0.45 : 0.3 * reach),
  words: 'Grey is at rest, thin orange lines are the paths. ' + (isSpatial
    ? 'x is along a row and the sliding, z away from the plate.'
    : 'Every degree of freedom is drawn upwards, beside the others of its body.'),
});

const meshBody = ({ nodes, middle, half, at, faces, of_solids: ofSolids }) => {
  const [places, corners] = [parts(at), unpacked(faces, Uint16Array)];
  return {
    at: nodes.map((_, i) => middle.map((x, axis) => x + half * places[3 * i + axis])),
    dofs: nodes.map((_, i) => [3 * i, 3 * i + 1, 3 * i + 2]),
    names: nodes.map(String),
    faces: Array.from({ length: corners.length / 4 }, (_, i) => corners.subarray(4 * i, 4 * i + 4)),
    ofSolids,
    isSpatial: true,
    motionName: (i, axis) => `node ${nodes[i]}, ${axisNames[axis]}`,
    amplitudeFor: reach => 0.12 * reach,
    words: 'The ring is at the node that moves farthest; thin lines are the edges of the brake at rest.',
  };
};

// The body with its middle and its reach from there: the middle of the brake is the middle of the picture, however it is turned.
const bodyOf = geometry => {
  const body = geometry.nodes ? meshBody(geometry) : latticeBody(geometry);
  const middle = geometry.middle ?? [0, 1, 2].map(axis => body.at.reduce((sum, at) => sum + at[axis], 0) / body.at.length);
  const far = body.at.reduce((most, at) => Math.max(most, Math.hypot(...at.map((x, axis) => x - middle[axis]))), 0);
  const reach = Math.max(geometry.nodes ? Number.MIN_VALUE : 0.5, far);
  return { ...body, middle, reach, amplitude: body.amplitudeFor(reach) };
};
