// A body of faces, on a canvas: those that are farther away are painted first.

// Pixels of the canvas for each unit of the view: enough for sharp screens and paper.
const SHARPNESS = 2.5;
// Light from above, the left and the reader, in the view's directions: right, down, away.
const LIGHT = [-0.35, -0.6, -0.72];
const DARKEST = 0.6;
// Above so many faces the lines between them would hide their colours.
const FEW_FACES = 6000;
const BORDER = 'rgb(0,0,0,0.45)';
// Two faces that meet at more than this angle have an edge between them.
const EDGE = Math.cos((35 * Math.PI) / 180);

// White to dark orange, as counts have in the map of stability: colour-blind readers and grey print keep the order, and the light is seen
// on it. By the root of the amplitude: a disc that moves a tenth as far as its pad must still tell where it moves.
const COLOURS = [[255, 255, 255], [245, 190, 110], [150, 55, 0]];
const colourAt = amplitude => {
  const place = Math.sqrt(Math.max(0, Math.min(1, amplitude))) * (COLOURS.length - 1);
  const lower = Math.min(Math.floor(place), COLOURS.length - 2);
  return COLOURS[lower].map((a, i) => a + (place - lower) * (COLOURS[lower + 1][i] - a));
};
const inCss = (colour, light = 1) => `rgb(${colour.map(part => Math.round(part * light)).join(',')})`;

const across = (a, b, c, d) => {
  const [u, v] = [[0, 1, 2].map(i => c[i] - a[i]), [0, 1, 2].map(i => d[i] - b[i])];
  return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
};

// Pairs of nodes where faces meet at an angle, or where one ends.
const edgesOf = ({ at, faces }) => {
  const normals = new Map();
  for (const face of faces) {
    const normal = across(...Array.from(face, i => at[i]));
    const size = Math.hypot(...normal) || 1;
    face.forEach((a, i) => {
      const b = face[(i + 1) % 4];
      if (a === b) return;
      const key = Math.min(a, b) * 65536 + Math.max(a, b);
      normals.set(key, [...(normals.get(key) ?? []), normal.map(x => x / size)]);
    });
  }
  const isEdge = found => found.length !== 2 || Math.abs(dot(...found)) < EDGE;
  return [...normals].filter(([, found]) => isEdge(found)).map(([key]) => [Math.floor(key / 65536), key % 65536]);
};

const surfacePicture = (body, view) => {
  const { at, faces, ofSolids } = body;
  const element = make('canvas', { width: VIEW.width * SHARPNESS, height: VIEW.height * SHARPNESS, role: 'img' });
  const pen = element.getContext('2d');
  const edges = edgesOf(body);
  const visible = new Uint32Array(faces.length);
  const [depths, lights] = [new Float32Array(faces.length), new Float32Array(faces.length)];
  let [colours, farthest, rest] = [[], 0, []];

  // Which faces are seen and how bright they are; how many.
  const look = places => {
    let count = 0;
    faces.forEach((face, i) => {
      const [a, b, c, d] = [places[face[0]], places[face[1]], places[face[2]], places[face[3]]];
      const normal = across(a, b, c, d);
      if (i < ofSolids && normal[2] >= 0) return;
      const size = Math.hypot(...normal) * (normal[2] > 0 ? -1 : 1);
      lights[i] = size === 0 ? 1 : DARKEST + (1 - DARKEST) * Math.max(0, dot(normal, LIGHT) / size);
      depths[i] = a[2] + b[2] + c[2] + d[2];
      visible[count++] = i;
    });
    return visible.subarray(0, count).sort((i, j) => depths[j] - depths[i]);
  };
  const paint = (face, places, fill) => {
    pen.beginPath();
    if (face[0] === face[3]) {
      pen.arc(places[face[0]][0], places[face[0]][1], 2, 0, 2 * Math.PI);
    } else {
      face.forEach(i => pen.lineTo(places[i][0], places[i][1]));
      pen.closePath();
    }
    // A thin element is its lines alone, with a dark border that is seen on light paper.
    const isThin = face[1] === face[3];
    if (isThin) {
      pen.lineWidth = 3;
      pen.strokeStyle = BORDER;
      pen.stroke();
    }
    pen.fillStyle = fill;
    pen.fill();
    // A line of a face's own colour closes the seam to the next one.
    pen.lineWidth = isThin ? 1.8 : 0.5;
    pen.strokeStyle = isThin || faces.length > FEW_FACES ? fill : BORDER;
    pen.stroke();
  };
  return {
    element,
    // The colour at a part of the legend, and amplitudes at equal steps of it.
    legend: { colour: part => inCss(colourAt(part * part)), marks: ['0', '0.06', '0.25', '0.56', '1'] },
    setShape: amplitudes => {
      const most = amplitudes.reduce((a, b) => Math.max(a, b), Number.MIN_VALUE);
      farthest = amplitudes.indexOf(most);
      colours = faces.map(face => colourAt((amplitudes[face[0]] + amplitudes[face[1]] + amplitudes[face[2]] + amplitudes[face[3]]) / (4 * most)));
    },
    setUnmoved: () => { rest = at.map(view.camera()); },
    setMoved: places => {
      pen.setTransform(SHARPNESS, 0, 0, SHARPNESS, 0, 0);
      pen.clearRect(0, 0, VIEW.width, VIEW.height);
      pen.lineJoin = 'round';
      for (const i of look(places)) paint(faces[i], places, inCss(colours[i], lights[i]));
      pen.beginPath();
      for (const [a, b] of edges) {
        pen.moveTo(rest[a][0], rest[a][1]);
        pen.lineTo(rest[b][0], rest[b][1]);
      }
      pen.lineWidth = 0.6;
      pen.strokeStyle = 'rgb(128,128,128,0.9)';
      pen.stroke();
      // Black in white, seen on every colour.
      for (const [width, colour] of [[3, 'white'], [1.4, 'black']]) {
        pen.beginPath();
        pen.arc(places[farthest][0], places[farthest][1], 6, 0, 2 * Math.PI);
        pen.lineWidth = width;
        pen.strokeStyle = colour;
        pen.stroke();
      }
      // For tests: where the nodes are on the picture, and which of them moves farthest.
      element.shown = { places, farthest };
    },
  };
};
