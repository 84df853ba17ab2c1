//! Direction and speed in which the master slides under the slave.

use elements::{Axis, Face, Mesh};
use nalgebra::{Matrix2, Vector2, Vector3};

use crate::{ContactError, Side};

/// Least speed along the face as a fraction of the velocity; chosen: nearer to the normal, rounding would say where it slides.
const LEAST_ALONG: f64 = 1e-6;
/// Most steps of Newton's method for the point at which an axis goes through a face; chosen: where more are needed the axis is taken to pass the face by.
const STEPS: usize = 25;
/// Largest last step of it, and largest distance of its point from the face, in own coordinates; chosen.
const NEAR: f64 = 1e-10;

/// Velocity of the master under the slave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sliding {
    /// A velocity that is the same everywhere, m/s.
    Along([f64; 3]),
    /// Turning about an axis with a speed in rad/s: `speed axis x (x - through)`.
    About {
        /// The axis, positive by the right hand.
        axis: Axis,
        /// Speed, rad/s, of any sign but not 0.
        speed: f64,
    },
}

impl Sliding {
    /// The velocity of the master at a point.
    #[must_use]
    pub fn velocity(&self, at: &Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Along(velocity) => Vector3::from(*velocity),
            Self::About { axis, speed } => axis.velocity(at) * *speed,
        }
    }

    /// The direction t along a face with the normal n, of length 1, and the speed along it; `node` is for messages.
    pub(crate) fn on(
        &self,
        at: &Vector3<f64>,
        normal: &Vector3<f64>,
        node: i64,
    ) -> Result<(Vector3<f64>, f64), ContactError> {
        let velocity = self.velocity(at);
        let along = velocity - normal * normal.dot(&velocity);
        let (speed, whole) = (along.norm(), velocity.norm());
        if !(whole.is_finite() && speed > LEAST_ALONG * whole) {
            return Err(ContactError::NoSliding { node, velocity: velocity.into() });
        }
        Ok((along / speed, speed))
    }

    /// Checks that the velocity or the speed of rotation is finite and not 0, and that an axis goes through none of the slave's faces.
    pub(crate) fn check(&self, mesh: &Mesh, faces: &[Face]) -> Result<(), ContactError> {
        match self {
            Self::Along(velocity) => {
                let size = Vector3::from(*velocity).norm();
                let allowed = "a finite velocity, not 0";
                if size.is_finite() && size > 0.0 { Ok(()) } else { Err(value("the sliding velocity", size, allowed)) }
            }
            Self::About { axis, speed } => {
                if !speed.is_finite() || *speed == 0.0 {
                    return Err(value("the speed of rotation", *speed, "a finite number in rad/s, not 0"));
                }
                faces.iter().try_for_each(|face| match pierced(axis, face) {
                    None => Ok(()),
                    Some(node) => {
                        let element = mesh.element(face.id.element)?.label;
                        Err(ContactError::AxisThroughSlave { element, node: mesh.labels()[face.nodes[node]] })
                    }
                })
            }
        }
    }
}

/// Node of a face next to where an axis goes through it, by its index in the face; `None` where the axis does not.
fn pierced(axis: &Axis, face: &Face) -> Option<usize> {
    // The distance from the axis as two numbers.
    let first = axis.direction().cross(&Vector3::ith(axis.direction().iamin(), 1.0)).normalize();
    let second = axis.direction().cross(&first);
    let across = |v: &Vector3<f64>| Vector2::new(first.dot(v), second.dot(v));
    let mut own = face.kind.places().iter().fold(Vector2::zeros(), |sum, place| sum + Vector2::from(*place));
    own /= face.kind.nodes() as f64;
    for _ in 0..STEPS {
        let at = face.at(own.into());
        // The velocity at 1 rad/s is the distance, turned by a quarter.
        let distance = across(&axis.velocity(&at.position).cross(&axis.direction()));
        let jacobian = Matrix2::from_columns(&at.tangents.map(|tangent| across(&tangent)));
        let step = jacobian.try_inverse()? * distance;
        own -= step;
        if !own.iter().all(|x| x.abs() < 10.0) {
            return None;
        }
        if step.amax() < NEAR {
            let is_inside = face.kind.outside(own.into()) <= NEAR;
            let distance = |place: &[f64; 2]| (Vector2::from(*place) - own).norm();
            let places = face.kind.places().into_iter().enumerate();
            let nearest = places.min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)));
            return nearest.filter(|_| is_inside).map(|(node, _)| node);
        }
    }
    None
}

/// A setting that is refused.
pub(crate) fn value(what: &'static str, value: f64, allowed: &'static str) -> ContactError {
    ContactError::Value { what, value, allowed }
}

/// The faces of a side, each with an area, of elements that are not inverted: their faces look outwards.
pub(crate) fn faces(mesh: &Mesh, ids: &[elements::FaceId], side: Side) -> Result<Vec<Face>, ContactError> {
    if ids.is_empty() {
        return Err(ContactError::NoFaces { side });
    }
    let face = |id: &elements::FaceId| {
        let face = mesh.face(*id)?;
        let size = face.positions.iter().map(|p| (p - face.positions[0]).norm_squared()).fold(0.0, f64::max);
        if face.area().norm() <= NO_AREA * size {
            let element = mesh.element(id.element)?.label;
            return Err(ContactError::NoArea { side, element, face: id.number });
        }
        mesh.volume(id.element)?;
        Ok(face)
    };
    ids.iter().map(face).collect()
}

/// Fraction of the square of the size up to which an area counts as zero; chosen, above rounding.
const NO_AREA: f64 = 1e-10;
