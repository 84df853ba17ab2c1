//! The capability of a brake whose outer faces are known: for the sound of a motion.

use montecarlo::Progress;
use nalgebra::DMatrix;

use crate::{Error, Scene};

/// Faces to the air.
pub trait OuterFaces: Sync {
    /// The outer faces as motions of a scene move them; `None` of a brake without faces. What makes it looks often whether `progress` is cancelled.
    ///
    /// # Errors
    /// Work that is cancelled.
    fn faces_in_motion(&self, scene: &Scene, progress: &dyn Progress) -> Result<Option<FacesInMotion>, Error>;
}

/// Outer faces as the free degrees of freedom u of a scene move them.
#[derive(Debug, Clone, PartialEq)]
pub struct FacesInMotion {
    /// G, symmetric, of the order of u: `u^H G u` is the integral `int |u_n|^2 dA` over all outer faces, `u_n` along their normals, in the square of the
    /// unit of u times the unit of the brake's length.
    pub form: DMatrix<f64>,
    /// Fraction of the outer area, 0 to 1, that G has at rest though nothing is known to hold it: its nodes have no rows in the matrices. Each node has its
    /// share of its faces, by its shape functions, and of that each direction the square of its component of the normal.
    pub without_rows: f64,
}
