// What moves: the points of a lattice, or the nodes on the surface of a mesh.
const axisNames = 'xyz';

// Numbers that are stored as whole ones of 16 bits, little-endian as the machines are on which there are browsers.
const unpacked = (text, List) => new List(Uint8Array.from(atob(text), letter => letter.charCodeAt(0)).buffer);
const parts = text => Float32Array.from(unpacked(text, Int16Array), part => part / 32767);

// Real and imaginary part of each number of a mode, of which the largest has the modulus 1.
const partsOf = shape => {
  if (!shape.re) {
    const both = parts(shape.parts);
    shape.re = both.filter((_, i) => i % 2 === 0);
    shape.im = both.filter((_, i) => i % 2 === 1);
  }
  return shape;
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
