//! Blocks of all kinds of elements.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

use elements::{FaceId, Kind, Mesh};
use nalgebra::Vector3;

/// Nodes and elements while they are made.
#[derive(Default)]
pub struct Making {
    pub nodes: Vec<(i64, [f64; 3])>,
    pub elements: Vec<(i64, Kind, Vec<i64>)>,
}

impl Making {
    fn node(&mut self, from: usize, at: [f64; 3]) -> i64 {
        let same = |known: &(i64, [f64; 3])| (0..3).all(|x| (known.1[x] - at[x]).abs() < 1e-9);
        if let Some(known) = self.nodes[from..].iter().find(|known| same(known)) {
            return known.0;
        }
        let label = 1 + self.nodes.len() as i64;
        self.nodes.push((label, at));
        label
    }

    /// A block of `cells` cells between two corners, each of one hexahedron, two wedges or six tetrahedra, bent by a function.
    pub fn block(
        &mut self,
        kind: Kind,
        cells: [usize; 3],
        corners: [[f64; 3]; 2],
        bend: impl Fn([f64; 3]) -> [f64; 3],
    ) {
        let first = self.nodes.len();
        // Corners of a hexahedron by the bits of their places, and what it is cut into.
        let parts: Vec<Vec<[usize; 3]>> = match kind.corners() {
            8 => vec![vec![[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]],
            6 => [[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]]
                .map(|of| [0, 1].iter().flat_map(|&z| of.map(|[x, y]| [x, y, z])).collect())
                .into(),
            // Along the six ways from a corner to the opposite one.
            _ => [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]]
                .map(|order: [usize; 3]| {
                    let mut at = [0; 3];
                    let mut way = vec![at];
                    for axis in order {
                        at[axis] = 1;
                        way.push(at);
                    }
                    // Odd orders are mirrored.
                    if order[(order.iter().position(|x| *x == 0).unwrap() + 1) % 3] != 1 {
                        way.swap(1, 2);
                    }
                    way
                })
                .into(),
        };
        for cell in
            (0..cells.iter().product()).map(|i| [i % cells[0], i / cells[0] % cells[1], i / cells[0] / cells[1]])
        {
            for part in &parts {
                let at = |corner: [usize; 3]| {
                    [0, 1, 2].map(|x| {
                        let along = (cell[x] + corner[x]) as f64 / cells[x] as f64;
                        corners[0][x] + along * (corners[1][x] - corners[0][x])
                    })
                };
                let mut places: Vec<[f64; 3]> = part.iter().map(|&corner| at(corner)).collect();
                if kind.is_quadratic() {
                    for &[a, b] in kind.edges() {
                        let (a, b) = (places[a], places[b]);
                        places.push([0, 1, 2].map(|x| 0.5 * (a[x] + b[x])));
                    }
                }
                let nodes = places.into_iter().map(|place| self.node(first, bend(place))).collect();
                self.elements.push((1 + self.elements.len() as i64, kind, nodes));
            }
        }
    }

    pub fn mesh(self) -> Mesh {
        let mesh = Mesh::new(self.nodes, self.elements).unwrap();
        mesh.check().unwrap();
        mesh
    }
}

/// The outer faces all of whose nodes have a property.
pub fn faces(mesh: &Mesh, is_there: impl Fn(&Vector3<f64>) -> bool) -> Vec<FaceId> {
    let outer = mesh.outer_faces(&mesh.all()).unwrap();
    outer.into_iter().filter(|id| mesh.face(*id).unwrap().positions.iter().all(&is_there)).collect()
}
