//! Faces of solid elements, by the numbers of Abaqus and CalculiX, and their shape functions.

use crate::kind::Kind;
use crate::rules::{FacePoint, square, triangle3, triangle7};

/// Nodes of the largest face.
const MOST_NODES: usize = 8;

/// Faces of a tetrahedron by its nodes: corners around, seen from outside against the clock, then the middles of the edges between them. A
/// linear element has the corners alone.
const TETRAHEDRON: [&[usize]; 4] = [&[0, 2, 1, 6, 5, 4], &[0, 1, 3, 4, 8, 7], &[1, 2, 3, 5, 9, 8], &[2, 0, 3, 6, 7, 9]];
/// Faces of a wedge by its nodes, in the same order.
const WEDGE: [&[usize]; 5] = [
    &[0, 2, 1, 8, 7, 6],
    &[3, 4, 5, 9, 10, 11],
    &[0, 1, 4, 3, 6, 13, 9, 12],
    &[1, 2, 5, 4, 7, 14, 10, 13],
    &[2, 0, 3, 5, 8, 12, 11, 14],
];
/// Faces of a hexahedron by its nodes, in the same order.
const HEXAHEDRON: [&[usize]; 6] = [
    &[0, 3, 2, 1, 11, 10, 9, 8],
    &[4, 5, 6, 7, 12, 13, 14, 15],
    &[0, 1, 5, 4, 8, 17, 12, 16],
    &[1, 2, 6, 5, 9, 18, 13, 17],
    &[2, 3, 7, 6, 10, 19, 14, 18],
    &[3, 0, 4, 7, 11, 16, 15, 19],
];

/// Kind of a face: its corners, and whether there are nodes in the middles of its edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FaceKind {
    /// Three corners.
    Triangle3,
    /// Three corners and three middles.
    Triangle6,
    /// Four corners.
    Quadrilateral4,
    /// Four corners and four middles.
    Quadrilateral8,
}

impl Kind {
    /// Number of faces.
    #[must_use]
    pub fn faces(self) -> usize {
        match self.corners() {
            4 => TETRAHEDRON.len(),
            6 => WEDGE.len(),
            _ => HEXAHEDRON.len(),
        }
    }

    /// Nodes of a face by its number from 1 (S1, S2, ...), as indices from 0 in the element: corners so that seen from outside they go
    /// around against the clock, then the middles of the edges between them. `None` where there is no such face.
    ///
    /// ```
    /// use elements::Kind;
    /// assert_eq!(Kind::Hexahedron8.face(2), Some(&[4, 5, 6, 7][..]));
    /// assert_eq!(Kind::Tetrahedron10.face(5), None);
    /// ```
    #[must_use]
    pub fn face(self, number: usize) -> Option<&'static [usize]> {
        let at = number.checked_sub(1)?;
        let all = match self.corners() {
            4 => TETRAHEDRON.get(at),
            6 => WEDGE.get(at),
            _ => HEXAHEDRON.get(at),
        };
        all.map(|nodes| if self.is_quadratic() { nodes } else { &nodes[..nodes.len() / 2] })
    }
}

impl FaceKind {
    /// The kind of a face of `nodes` nodes.
    pub(crate) fn of_nodes(nodes: usize) -> Self {
        match nodes {
            3 => Self::Triangle3,
            6 => Self::Triangle6,
            4 => Self::Quadrilateral4,
            _ => Self::Quadrilateral8,
        }
    }

    /// Number of nodes.
    #[must_use]
    pub fn nodes(self) -> usize {
        match self {
            Self::Triangle3 => 3,
            Self::Triangle6 => 6,
            Self::Quadrilateral4 => 4,
            Self::Quadrilateral8 => 8,
        }
    }

    /// Number of corners, which are its first nodes.
    #[must_use]
    pub fn corners(self) -> usize {
        match self {
            Self::Triangle3 | Self::Triangle6 => 3,
            Self::Quadrilateral4 | Self::Quadrilateral8 => 4,
        }
    }

    /// Points and weights on the face: 3 (exact to degree 2) and 7 (degree 5) of a triangle, 2 x 2 and 3 x 3 of a quadrilateral.
    #[must_use]
    pub fn rule(self) -> Vec<FacePoint> {
        match self {
            Self::Triangle3 => triangle3(),
            Self::Triangle6 => triangle7(),
            Self::Quadrilateral4 => square(2),
            Self::Quadrilateral8 => square(3),
        }
    }

    /// Own coordinates of the nodes: `r, s >= 0, r + s <= 1` on a triangle, both from -1 to 1 on a quadrilateral.
    #[must_use]
    pub fn places(self) -> Vec<[f64; 2]> {
        let corners: &[[f64; 2]] = match self.corners() {
            3 => &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
            _ => &[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]],
        };
        let middle = |at: usize| {
            let (a, b) = (corners[at], corners[(at + 1) % corners.len()]);
            [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
        };
        let middles = (0..self.nodes() - self.corners()).map(middle);
        corners.iter().copied().chain(middles).collect()
    }

    /// Distance of own coordinates outside of the face, in own units: 0 inside and on its border.
    #[must_use]
    pub fn outside(self, [r, s]: [f64; 2]) -> f64 {
        let beyond = match self.corners() {
            3 => (-r).max(-s).max(r + s - 1.0),
            _ => r.abs().max(s.abs()) - 1.0,
        };
        beyond.max(0.0)
    }

    /// Shape functions and their derivatives at own coordinates.
    #[must_use]
    pub fn shape(self, own: [f64; 2]) -> FaceShape {
        let mut shape =
            FaceShape { nodes: self.nodes(), values: [0.0; MOST_NODES], derivatives: [[0.0; 2]; MOST_NODES] };
        let is_quadratic = self.nodes() > self.corners();
        match self.corners() {
            3 => shape.triangle(is_quadratic, own),
            _ => shape.quadrilateral(&self.places(), is_quadratic, own),
        }
        shape
    }
}

/// Values `N_a` and derivatives `dN_a/d(r, s)` of the shape functions of a face at a point, one for each node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceShape {
    nodes: usize,
    values: [f64; MOST_NODES],
    derivatives: [[f64; 2]; MOST_NODES],
}

impl FaceShape {
    /// Shape functions `N_a`, one of each node.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values[..self.nodes]
    }

    /// Derivatives `dN_a/dr` and `dN_a/ds` of each node.
    #[must_use]
    pub fn derivatives(&self) -> &[[f64; 2]] {
        &self.derivatives[..self.nodes]
    }

    fn triangle(&mut self, is_quadratic: bool, [r, s]: [f64; 2]) {
        let of = [1.0 - r - s, r, s];
        let slope = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
        for corner in 0..3 {
            let (l, d) = (of[corner], slope[corner]);
            let (value, by) = if is_quadratic { (l * (2.0 * l - 1.0), 4.0 * l - 1.0) } else { (l, 1.0) };
            self.values[corner] = value;
            self.derivatives[corner] = d.map(|d| by * d);
            if is_quadratic {
                let next = (corner + 1) % 3;
                self.values[3 + corner] = 4.0 * l * of[next];
                self.derivatives[3 + corner] = [0, 1].map(|x| 4.0 * (l * slope[next][x] + of[next] * d[x]));
            }
        }
    }

    fn quadrilateral(&mut self, places: &[[f64; 2]], is_quadratic: bool, own: [f64; 2]) {
        for (node, place) in places.iter().enumerate() {
            let factor = [0, 1].map(|x| if place[x] == 0.0 { 1.0 - own[x] * own[x] } else { 1.0 + place[x] * own[x] });
            let slope = [0, 1].map(|x| if place[x] == 0.0 { -2.0 * own[x] } else { place[x] });
            let (product, by) = (factor[0] * factor[1], [slope[0] * factor[1], factor[0] * slope[1]]);
            let (value, derivative) = match (is_quadratic, node < 4) {
                (false, _) => (product / 4.0, by.map(|by| by / 4.0)),
                (true, false) => (product / 2.0, by.map(|by| by / 2.0)),
                (true, true) => {
                    let corner = place[0] * own[0] + place[1] * own[1] - 1.0;
                    let derivative = [0, 1].map(|x| (by[x] * corner + product * place[x]) / 4.0);
                    (product * corner / 4.0, derivative)
                }
            };
            self.values[node] = value;
            self.derivatives[node] = derivative;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    #[test]
    fn faces_look_outwards_and_their_middles_lie_between_their_corners() {
        for kind in Kind::ALL {
            let places: Vec<Vector3<f64>> = kind.places().into_iter().map(Vector3::from).collect();
            let middle = places.iter().sum::<Vector3<f64>>() / places.len() as f64;
            let mut area = Vector3::zeros();
            for number in 1..=kind.faces() {
                let nodes = kind.face(number).unwrap();
                let of = FaceKind::of_nodes(nodes.len());
                let corners: Vec<_> = nodes[..of.corners()].iter().map(|&node| places[node]).collect();
                let mut normal = Vector3::zeros();
                for at in 1..corners.len() - 1 {
                    normal += 0.5 * (corners[at] - corners[0]).cross(&(corners[at + 1] - corners[0]));
                }
                assert!(normal.dot(&(corners[0] - middle)) > 0.0, "{kind:?} S{number}");
                area += normal;
                for (at, &node) in nodes[of.corners()..].iter().enumerate() {
                    let between = (corners[at] + corners[(at + 1) % corners.len()]) / 2.0;
                    assert!((places[node] - between).norm() < 1e-15, "{kind:?} S{number}");
                }
            }
            // A closed surface.
            assert!(area.norm() < 1e-14, "{kind:?}");
            assert_eq!((kind.face(0), kind.face(kind.faces() + 1)), (None, None));
        }
    }

    /// The numbers of the corners in the manuals of Abaqus and CalculiX.
    #[test]
    fn faces_have_the_numbers_of_the_manuals() {
        let manual = [
            (Kind::Tetrahedron4, vec![vec![1, 2, 3], vec![1, 4, 2], vec![2, 4, 3], vec![3, 4, 1]]),
            (Kind::Wedge6, vec![vec![1, 2, 3], vec![4, 6, 5], vec![1, 4, 5, 2], vec![2, 5, 6, 3], vec![3, 6, 4, 1]]),
            (
                Kind::Hexahedron8,
                vec![
                    vec![1, 2, 3, 4],
                    vec![5, 8, 7, 6],
                    vec![1, 5, 6, 2],
                    vec![2, 6, 7, 3],
                    vec![3, 7, 8, 4],
                    vec![4, 8, 5, 1],
                ],
            ),
        ];
        for (kind, faces) in manual {
            for (number, mut expected) in (1..).zip(faces) {
                let mut found: Vec<usize> = kind.face(number).unwrap().iter().map(|node| node + 1).collect();
                found.sort_unstable();
                expected.sort_unstable();
                assert_eq!(found, expected, "{kind:?} S{number}");
            }
        }
    }

    #[test]
    fn shapes_of_a_face_are_those_of_the_solid_on_it() {
        for kind in Kind::ALL {
            let places = kind.places();
            for number in 1..=kind.faces() {
                let nodes = kind.face(number).unwrap();
                let face = FaceKind::of_nodes(nodes.len());
                for (own, _) in face.rule() {
                    let shape = face.shape(own);
                    // Where the point lies in the solid: own coordinates of an undistorted element are linear on its faces.
                    let corner = match face.corners() {
                        3 => FaceKind::Triangle3.shape(own),
                        _ => FaceKind::Quadrilateral4.shape(own),
                    };
                    let at = |x: usize| nodes.iter().zip(corner.values()).map(|(&node, n)| n * places[node][x]).sum();
                    let solid = kind.shape([at(0), at(1), at(2)]);
                    for (node, &value) in solid.values().iter().enumerate() {
                        let of_face = nodes.iter().position(|&other| other == node);
                        let expected = of_face.map_or(0.0, |of_face| shape.values()[of_face]);
                        assert!((value - expected).abs() < 1e-14, "{kind:?} S{number} {node}");
                    }
                }
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_values() {
        const STEP: f64 = 1e-5;
        for face in [FaceKind::Triangle3, FaceKind::Triangle6, FaceKind::Quadrilateral4, FaceKind::Quadrilateral8] {
            let own = [0.31, 0.17];
            for axis in 0..2 {
                let moved = |by: f64| {
                    let mut own = own;
                    own[axis] += by;
                    face.shape(own)
                };
                let (before, after) = (moved(-STEP), moved(STEP));
                for node in 0..face.nodes() {
                    let difference = (after.values()[node] - before.values()[node]) / (2.0 * STEP);
                    assert!((difference - face.shape(own).derivatives()[node][axis]).abs() < 1e-9, "{face:?} {node}");
                }
            }
            assert_eq!(face.outside([0.25, 0.25]), 0.0);
            assert!(face.outside([1.5, 0.0]) > 0.49);
        }
    }
}
