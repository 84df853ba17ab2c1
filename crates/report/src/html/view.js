// How a body is seen: its displacements at a phase, from where the sliders say.
const VIEW = { width: 480, height: 400, margin: 15 };
const radians = degrees => (degrees * Math.PI) / 180;

const viewOf = (body, value) => {
  const { at, dofs, isSpatial, middle, reach } = body;
  // From a place of the body to one of the picture, in its units: right, down, and how far away.
  const camera = () => {
    const [turn, tilt] = isSpatial ? [radians(value('turn')), radians(value('tilt'))] : [0, 0];
    const zoom = isSpatial ? (value('zoom') * (VIEW.height / 2 - VIEW.margin)) / reach : (VIEW.width / 2 - 4 * VIEW.margin) / reach;
    const [cosTurn, sinTurn, cosTilt, sinTilt] = [Math.cos(turn), Math.sin(turn), Math.cos(tilt), Math.sin(tilt)];
    return ([x, y, z]) => {
      const [a, b, c] = [x - middle[0], y - middle[1], z - middle[2]];
      const depth = a * sinTurn + b * cosTurn;
      const up = c * cosTilt + depth * sinTilt;
      return [VIEW.width / 2 + zoom * (a * cosTurn - b * sinTurn), VIEW.height / 2 - zoom * up, zoom * (depth * cosTilt - c * sinTilt)];
    };
  };
  const places = (shape, phase) => {
    const [size, onScreen, all] = [body.amplitude * value('size') * shape.scale, camera(), displacements(shape, phase)];
    const moved = dof => size * (all[dof] ?? 0);
    return at.map(([x, y, z], i) => {
      const [u, v, w] = dofs[i];
      return onScreen([x + moved(u), y + moved(v), z + moved(w)]);
    });
  };
  return { camera, places };
};
