//! Faces by where they are, so that those near a point are found without looking at all.

use std::collections::HashMap;

use elements::Face;
use nalgebra::Vector3;

/// Largest bulge of a face beyond the box of its nodes, as a fraction of the longest side of the box; chosen: a parabola through three points does so by an
/// eighth.
const BULGE: f64 = 0.15;
/// Most cells along an axis that one face may be listed in; chosen, against faces that are far larger than the others.
const MOST_CELLS: i64 = 64;

/// Cells of equal size, each with the faces that may come near it.
#[derive(Debug)]
pub(crate) struct Grid {
    size: f64,
    cells: HashMap<[i64; 3], Vec<usize>>,
    /// Faces that are in too many cells: looked at always.
    large: Vec<usize>,
}

impl Grid {
    /// The cells of faces; each face may come near what is within `reach` of it.
    pub fn new(faces: &[Face], reach: f64) -> Self {
        let boxes: Vec<[Vector3<f64>; 2]> = faces.iter().map(|face| bounds(face, reach)).collect();
        let mut sizes: Vec<f64> = boxes.iter().map(|[from, to]| (to - from).amax()).collect();
        sizes.sort_by(f64::total_cmp);
        let size = sizes.get(sizes.len() / 2).copied().filter(|size| *size > 0.0).unwrap_or(1.0);
        let mut grid = Self { size, cells: HashMap::new(), large: Vec::new() };
        for (at, [from, to]) in boxes.iter().enumerate() {
            let (from, to) = (grid.cell(from), grid.cell(to));
            if (0..3).any(|x| to[x] - from[x] > MOST_CELLS) {
                grid.large.push(at);
                continue;
            }
            for x in from[0]..=to[0] {
                for y in from[1]..=to[1] {
                    for z in from[2]..=to[2] {
                        grid.cells.entry([x, y, z]).or_default().push(at);
                    }
                }
            }
        }
        grid
    }

    fn cell(&self, at: &Vector3<f64>) -> [i64; 3] {
        [0, 1, 2].map(|x| (at[x] / self.size).floor() as i64)
    }

    /// Faces that may be within reach of a point, ascending.
    pub fn near(&self, at: &Vector3<f64>) -> Vec<usize> {
        let mut near: Vec<usize> = self.cells.get(&self.cell(at)).into_iter().flatten().copied().collect();
        near.extend(&self.large);
        near.sort_unstable();
        near
    }

    /// Faces that may be within reach of a face, ascending.
    pub fn near_face(&self, face: &Face) -> Vec<usize> {
        let [from, to] = bounds(face, 0.0);
        let (from, to) = (self.cell(&from), self.cell(&to));
        let mut near = self.large.clone();
        let count: f64 = (0..3).map(|x| (to[x] - from[x] + 1) as f64).product();
        if count > self.cells.len() as f64 {
            let within = |cell: &[i64; 3]| (0..3).all(|x| (from[x]..=to[x]).contains(&cell[x]));
            near.extend(self.cells.iter().filter(|(cell, _)| within(cell)).flat_map(|(_, faces)| faces));
        } else {
            for x in from[0]..=to[0] {
                for y in from[1]..=to[1] {
                    near.extend((from[2]..=to[2]).filter_map(|z| self.cells.get(&[x, y, z])).flatten());
                }
            }
        }
        near.sort_unstable();
        near.dedup();
        near
    }
}

/// The box around a face, with what it may bulge and reach.
fn bounds(face: &Face, reach: f64) -> [Vector3<f64>; 2] {
    let first = face.positions[0];
    let (mut from, mut to) = (first, first);
    for position in &face.positions {
        from = from.inf(position);
        to = to.sup(position);
    }
    let margin = Vector3::repeat(BULGE * (to - from).amax() + reach);
    [from - margin, to + margin]
}
