//! The point of a face that is nearest to a given one.

use elements::{Face, SurfacePoint};
use nalgebra::{Matrix2, Vector2, Vector3};

/// Most steps of Newton's method; chosen, it takes one on a flat face and three on a curved one.
const STEPS: usize = 50;
/// Largest change of own coordinates by the last step; chosen: some roundings.
const ENOUGH: f64 = 1e-14;
/// Longest step in own coordinates, to which longer ones are cut; chosen.
const LONGEST: f64 = 1.0;
/// Largest own coordinate of a search; chosen: a search that leads farther out is given up, and the point has no projection onto the face.
const FAR_OUT: f64 = 20.0;

/// Projection of a point on a face.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Projection {
    /// Own coordinates.
    pub own: [f64; 2],
    /// Distance of these coordinates outside of the face; 0 inside and on its border.
    pub outside: f64,
    /// The point of the face.
    pub at: SurfacePoint,
    /// The normal there, of length 1.
    pub normal: Vector3<f64>,
    /// Gap `n . (x - x_face)`: negative inside of the body of the face.
    pub gap: f64,
}

/// The point where `x - x_face` is perpendicular to the face, on it or on what its shape functions continue it to; `None` where the search does not end or
/// leads too far out, and where the face has no two tangents there.
pub(crate) fn project(face: &Face, x: &Vector3<f64>) -> Option<Projection> {
    let places = face.kind.places();
    let mut own = places.iter().fold(Vector2::zeros(), |sum, place| sum + Vector2::from(*place)) / places.len() as f64;
    for step in 0..=STEPS {
        let at = face.at(own.into());
        let away = x - at.position;
        let [a, b] = at.tangents;
        let gradient = Vector2::new(a.dot(&away), b.dot(&away));
        // Gauss and Newton: what is left out is the distance times the curvature.
        let metric = Matrix2::new(a.dot(&a), a.dot(&b), a.dot(&b), b.dot(&b));
        let mut change = metric.try_inverse()? * gradient;
        let length = change.amax();
        if length < ENOUGH || (step == STEPS && length < 1e-9) {
            let normal = at.area.try_normalize(0.0)?;
            let outside = face.kind.outside(own.into());
            return Some(Projection { own: own.into(), outside, at, normal, gap: normal.dot(&away) });
        }
        if length > LONGEST {
            change *= LONGEST / length;
        }
        own += change;
        if !own.iter().all(|x| x.abs() < FAR_OUT) {
            return None;
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use elements::{FaceId, Kind, Mesh};
    use proptest::prelude::*;

    /// The top of one bent element.
    fn top(kind: Kind, bend: f64) -> Face {
        let at = |[r, s, t]: [f64; 3]| [2.0 * r + 0.2 * s, 1.5 * s, t - bend * r * r + bend * s * r];
        let nodes: Vec<(i64, [f64; 3])> = (1..).zip(kind.places()).map(|(label, place)| (label, at(place))).collect();
        let labels = nodes.iter().map(|(label, _)| *label).collect();
        Mesh::new(nodes, vec![(1, kind, labels)]).unwrap().face(FaceId { element: 0, number: 2 }).unwrap()
    }

    proptest! {
        #[test]
        fn a_point_above_a_face_comes_back_to_it(r in 0.05..0.45, s in 0.05..0.45, height in -0.05..0.05_f64, bend in 0.0..0.15) {
            for kind in [Kind::Wedge6, Kind::Wedge15, Kind::Hexahedron8, Kind::Hexahedron20] {
                let face = top(kind, bend);
                let at = face.at([r, s]);
                let normal = at.area.normalize();
                let found = project(&face, &(at.position + normal * height)).unwrap();
                prop_assert!((found.own[0] - r).abs() + (found.own[1] - s).abs() < 1e-11, "{:?} {:?}", kind, found.own);
                prop_assert!((found.gap - height).abs() < 1e-12 && found.outside == 0.0);
            }
        }
    }

    #[test]
    fn beside_a_face_it_is_said_how_far() {
        let found = project(&top(Kind::Hexahedron8, 0.0), &Vector3::new(2.5, 0.0, 3.0)).unwrap();
        assert!((found.outside - 0.25).abs() < 1e-12 && (found.gap - 2.0).abs() < 1e-12);
    }
}
