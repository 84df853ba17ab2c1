//! Points of integration of an element in the mesh, and what is no element: inverted ones, and those without volume.

use nalgebra::{Matrix3, Vector3};

use crate::shape::Shape;
use crate::{ElementsError, Kind, Mesh};

/// Fraction of the largest determinant that edges of the same lengths can have up to which a determinant counts as zero; chosen, above rounding.
const NO_VOLUME: f64 = 1e-12;

/// Point of integration of an element: shape functions, their gradients, where it is, and what it weighs.
#[derive(Debug, Clone)]
pub(crate) struct Point {
    /// Shape functions and derivatives by own coordinates.
    pub shape: Shape,
    /// Gradients `grad N_a`, one of each node.
    pub gradients: Vec<Vector3<f64>>,
    /// Position of the point.
    pub position: Vector3<f64>,
    /// Weight of the rule times the determinant of the Jacobian: a volume.
    pub weight: f64,
}

impl Mesh {
    /// Points of integration of the element with an index, by the rule of its kind.
    ///
    /// # Errors
    /// No such element; one that is inverted or has no volume there.
    pub(crate) fn points(&self, place: usize) -> Result<Vec<Point>, ElementsError> {
        let element = self.element(place)?;
        let nodes: Vec<Vector3<f64>> = element.nodes.iter().map(|&node| self.positions()[node]).collect();
        let mut points = Vec::new();
        for (own, weight) in element.kind.rule() {
            let shape = element.kind.shape(own);
            let jacobian = jacobian(&nodes, &shape);
            let determinant = jacobian.determinant();
            let size = jacobian.column_iter().map(|column| column.norm()).fold(0.0, f64::max).powi(3);
            let is_some = determinant.abs() > NO_VOLUME * size;
            let inverse = jacobian.try_inverse().filter(|_| is_some && determinant > 0.0);
            let Some(inverse) = inverse else {
                let (element, node) = (element.label, self.labels()[element.nodes[worst(element.kind, &nodes)]]);
                return Err(match is_some {
                    true => ElementsError::Inverted { element, node, determinant },
                    false => ElementsError::NoVolume { element, node, determinant },
                });
            };
            let gradient = |d: &[f64; 3]| inverse.tr_mul(&Vector3::from(*d));
            let gradients = shape.derivatives().iter().map(gradient).collect();
            let position = nodes.iter().zip(shape.values()).map(|(node, &n)| node * n).sum();
            points.push(Point { shape, gradients, position, weight: weight * determinant });
        }
        Ok(points)
    }

    /// Volume of the element with an index, in cubic units of length.
    ///
    /// # Errors
    /// No such element; one that is inverted or has no volume at a point of integration.
    pub fn volume(&self, place: usize) -> Result<f64, ElementsError> {
        Ok(self.points(place)?.iter().map(|point| point.weight).sum())
    }

    /// Checks that no element is inverted or without volume at its points of integration.
    ///
    /// # Errors
    /// The first that is, with the node next to where it is.
    pub fn check(&self) -> Result<(), ElementsError> {
        (0..self.elements().len()).try_for_each(|place| self.points(place).map(drop))
    }
}

/// `J_ij = dx_i / d(own)_j`.
fn jacobian(nodes: &[Vector3<f64>], shape: &Shape) -> Matrix3<f64> {
    let of_nodes = nodes.iter().zip(shape.derivatives());
    of_nodes.map(|(node, d)| node * Vector3::from(*d).transpose()).sum()
}

/// The node of an element at which the determinant is smallest.
fn worst(kind: Kind, nodes: &[Vector3<f64>]) -> usize {
    let determinants = kind.places().into_iter().map(|own| jacobian(nodes, &kind.shape(own)).determinant());
    determinants.enumerate().min_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(node, _)| node)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Mesh of one element at its own coordinates, moved by a function.
    pub(crate) fn one(kind: Kind, at: impl Fn([f64; 3]) -> [f64; 3]) -> Mesh {
        let nodes: Vec<(i64, [f64; 3])> = (1..).zip(kind.places()).map(|(label, place)| (label, at(place))).collect();
        let labels = nodes.iter().map(|(label, _)| *label).collect();
        Mesh::new(nodes, vec![(70, kind, labels)]).unwrap()
    }

    #[test]
    fn volumes_are_those_of_the_shapes() {
        for kind in Kind::ALL {
            let expected = [1.0 / 6.0, 1.0, 8.0][kind.corners() / 2 - 2];
            let mesh = one(kind, |[r, s, t]| [2.0 * r + s, 3.0 * s, 0.5 * t - r]);
            assert!((mesh.volume(0).unwrap() - 3.0 * expected).abs() < 1e-13, "{kind:?}");
        }
        assert_eq!(one(Kind::Hexahedron8, |p| p).volume(1), Err(ElementsError::NoElement { place: 1, total: 1 }));
    }

    #[test]
    fn mirrored_and_flat_elements_are_named() {
        for kind in Kind::ALL {
            let error = one(kind, |[r, s, t]| [r, s, -t]).check().unwrap_err();
            assert!(matches!(error, ElementsError::Inverted { element: 70, .. }), "{kind:?}: {error}");
            let error = one(kind, |[r, s, t]| [r, s, r + 2.0 * s + 0.0 * t]).check().unwrap_err();
            assert!(matches!(error, ElementsError::NoVolume { element: 70, .. }), "{kind:?}: {error}");
        }
    }

    #[test]
    fn a_corner_that_is_pushed_through_is_named() {
        let mesh = one(Kind::Hexahedron20, |p| if p == [1.0, 1.0, 1.0] { [-0.9, -0.9, -0.9] } else { p });
        let error = mesh.check().unwrap_err();
        assert!(matches!(error, ElementsError::Inverted { element: 70, node: 7, .. }), "{error}");
        assert!(error.to_string().contains("element 70") && error.to_string().contains("node 7"));
    }

    proptest! {
        /// Gradients of a linear function are its slopes in a distorted element.
        #[test]
        fn gradients_of_linear_functions(c in prop::array::uniform4(-2.0..2.0), bend in -0.1..0.1) {
            for kind in Kind::ALL {
                let mesh = one(kind, |[r, s, t]| [r + bend * s * t, 1.3 * s + bend * r, t + bend * r * r]);
                let f = |p: &Vector3<f64>| c[0] + c[1] * p.x + c[2] * p.y + c[3] * p.z;
                for point in mesh.points(0).unwrap() {
                    let slope: Vector3<f64> =
                        point.gradients.iter().zip(mesh.positions()).map(|(gradient, p)| gradient * f(p)).sum();
                    prop_assert!((slope - Vector3::new(c[1], c[2], c[3])).norm() < 1e-12, "{:?}", kind);
                }
            }
        }
    }
}
