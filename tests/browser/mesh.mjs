// Modes on a mesh: are the pixels where the file of shapes beside the page says that the brake is?
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { select } from './controls.mjs';

// The arrays of a VTU file in rows of their components, by name.
const arraysOf = text => new Map([...text.matchAll(/<DataArray [^>]*Name="([^"]*)"[^>]*>([^<]*)</g)]
  .map(([, name, body]) => [name, body.trim().split('\n').map(line => line.split(' ').map(Number))]));

// The pixels of the picture, read from a copy: who reads a canvas often is warned.
const pixels = `const canvas = document.querySelector('#shape-view canvas');
  const { width, height } = canvas;
  const copy = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true });
  copy.drawImage(canvas, 0, 0);
  const pixels = copy.getImageData(0, 0, width, height).data;`;
// The rectangle of pixels that are painted, in units of the view, 480 by 400: least and largest x, least and largest y. Faint ones, of
// which the border of a line is made, do not count.
const painted = `(() => {
  ${pixels}
  const ends = [Infinity, -Infinity, Infinity, -Infinity];
  for (let y = 0; y < height; y++) for (let x = 0; x < width; x++) {
    if (pixels[4 * (y * width + x) + 3] < 128) continue;
    [ends[0], ends[1], ends[2], ends[3]] = [Math.min(ends[0], x), Math.max(ends[1], x + 1), Math.min(ends[2], y), Math.max(ends[3], y + 1)];
  }
  return ends.map(end => end * 480 / width);
})()`;
// Red, green and blue at places of the view.
const coloursAt = places => `(() => {
  ${pixels}
  return ${JSON.stringify(places)}.map(([x, y]) => {
    const at = 4 * (Math.floor(y * width / 480) * width + Math.floor(x * width / 480));
    return [...pixels.slice(at, at + 3)];
  });
})()`;
const endsOf = places => [0, 1].flatMap(axis => [Math.min, Math.max].map(end => end(...places.map(place => place[axis]))));
const picture = "document.querySelector('#shape-view canvas').toDataURL()";
const shown = "document.querySelector('#shape-view canvas').shown";
const near = (a, b, within) => a.every((x, i) => Math.abs(x - b[i]) <= within);
const mean = values => values.reduce((sum, value) => sum + value, 0) / values.length;

// White, pale orange, dark orange at equal steps of the root of the amplitude.
const colourOf = amplitude => {
  const [stops, place] = [[[255, 255, 255], [245, 190, 110], [150, 55, 0]], 2 * Math.sqrt(amplitude)];
  const lower = Math.min(1, Math.floor(place));
  return stops[lower].map((a, i) => a + (place - lower) * (stops[lower + 1][i] - a));
};

export const mesh = async (page, folder) => {
  const { geometry, shapes, groups } = await page.value("JSON.parse(document.getElementById('data').textContent).moving");
  const set = (name, value) => page.value(select(`shape-${name}`, String(value)));
  await set('zoom', 1);
  // Of sets that differ only in what is held the first one has all that the others have.
  const { group, name: title } = shapes[0];
  const name = title.replace('Mode', 'mode');
  const arrays = arraysOf(readFileSync(join(folder, `shapes-${groups[group]}.vtu`), 'utf8'));
  const row = new Map(arrays.get('node').map(([node], i) => [node, i]));
  const rows = geometry.nodes.map(node => row.get(node));
  const [rest, re, im] = ['Points', `${name} real`, `${name} imaginary`].map(name => rows.map(i => arrays.get(name)[i]));

  // From the side the height of the picture is z, from above it is y; x is to the right.
  const largest = Math.max(...re.flatMap((u, i) => u.map((x, axis) => Math.hypot(x, im[i][axis]))));
  const middle = [0, 1, 2].map(axis => {
    const along = rest.map(at => at[axis]);
    return (Math.min(...along) + Math.max(...along)) / 2;
  });
  const reach = Math.max(...rest.map(at => Math.hypot(...at.map((x, axis) => x - middle[axis]))));
  const size = 3;
  const expected = (upwards, degrees, scale) => rest.map((at, i) => {
    const phase = (degrees * Math.PI) / 180;
    const moved = at.map((x, axis) => x - middle[axis]
      + ((0.12 * reach * scale) / largest) * (re[i][axis] * Math.cos(phase) - im[i][axis] * Math.sin(phase)));
    const zoom = 185 / reach;
    return [240 + zoom * moved[0], 200 - zoom * moved[upwards]];
  });
  await set('mode', 0);
  await set('turn', 0);
  for (const [tilt, upwards] of [[0, 2], [90, 1]]) {
    await set('tilt', tilt);
    for (const [degrees, scale] of [[0, 0], [0, size], [90, size], [230, 1]]) {
      await set('size', scale);
      await set('phase', degrees);
      const places = expected(upwards, degrees, scale);
      const { places: drawn, farthest } = await page.value(shown);
      for (const [i, place] of places.entries()) {
        assert.ok(near(place, drawn[i], 0.05), `node ${geometry.nodes[i]} from ${tilt} degrees at phase ${degrees}: drawn at ${drawn[i]}, is at ${place}`);
      }
      // The edges at rest and the ring around the node that moves farthest are painted too: the pixels may reach as far as these.
      const ring = [-7.5, 7.5].map(by => places[farthest].map(x => x + by));
      const [seen, least, most] = [await page.value(painted), endsOf(places), endsOf([...places, ...expected(upwards, 0, 0), ...ring])];
      for (const [i, sign] of [-1, 1, -1, 1].entries()) {
        const [from, to] = [sign * least[i] - 0.8, sign * most[i] + 0.8];
        assert.ok(sign * seen[i] >= from && sign * seen[i] <= to, `painted to ${seen}, nodes reach ${least}, edges and ring ${most}`);
      }
    }
  }

  // The node in the ring is the one that moves farthest in a cycle, and the table names the largest of all motions.
  const amplitudes = re.map((a, i) => Math.max(...[...Array(720).keys()].map(k => {
    const phase = (k * Math.PI) / 720;
    return Math.hypot(...a.map((x, axis) => x * Math.cos(phase) - im[i][axis] * Math.sin(phase)));
  })));
  const { farthest } = await page.value(shown);
  assert.ok(amplitudes[farthest] > (1 - 1e-4) * Math.max(...amplitudes), `ring at node ${geometry.nodes[farthest]}`);
  const said = await page.value("[...document.querySelectorAll('#shape-largest tr')].map(row => [...row.cells].map(cell => cell.textContent))");
  for (const [name, part, phase] of said) {
    const [, node, axis] = name.match(/^node (\d+), ([xyz])$/);
    const at = geometry.nodes.indexOf(Number(node));
    const [x, y] = [re[at]['xyz'.indexOf(axis)], im[at]['xyz'.indexOf(axis)]];
    assert.ok(Math.abs(Math.hypot(x, y) / largest - Number(part)) < 6e-4, `${name}: ${part}`);
    // 180 degrees are -180.
    const apart = Math.abs(Math.atan2(y, x) * 180 / Math.PI - Number(phase));
    assert.ok(Math.min(apart, 360 - apart) < 0.6, `${name}: ${phase} degrees`);
  }

  // From above and at rest the faces on top have all the same light: their colours are those of the amplitudes at their corners.
  await set('tilt', 90);
  await set('size', 0);
  const bytes = Uint8Array.from(atob(geometry.faces), letter => letter.charCodeAt(0));
  const corners = [...new Uint16Array(bytes.buffer)];
  const faces = Array.from({ length: corners.length / 4 }, (_, i) => corners.slice(4 * i, 4 * i + 4));
  const [top, flat, most] = [Math.max(...rest.map(at => at[2])), expected(1, 0, 0), Math.max(...amplitudes)];
  const centre = face => [0, 1].map(axis => mean(face.map(node => flat[node][axis])));
  const onTop = faces.filter(face => face.every(node => rest[node][2] > top - 1e-9 * reach)
    && Math.hypot(...centre(face).map((x, axis) => x - flat[farthest][axis])) > 9);
  assert.ok(onTop.length > 3, `${onTop.length} faces on top`);
  const seen = await page.value(coloursAt(onTop.map(centre)));
  const wanted = onTop.map(face => colourOf(mean(face.map(node => amplitudes[node])) / most));
  const light = seen[0][0] / wanted[0][0];
  assert.ok(light > 0.6 && light <= 1, `light ${light}`);
  for (const [i, colour] of wanted.entries()) {
    assert.ok(near(seen[i], colour.map(x => light * x), 3), `a face is ${seen[i]}, is ${colour} under the light ${light}`);
  }

  // Without size nothing moves, whatever the phase and the mode.
  await set('tilt', 30);
  await set('phase', 0);
  const still = await page.value(picture);
  await set('phase', 140);
  assert.equal(await page.value(picture), still, 'a mode of no size moves');
};
