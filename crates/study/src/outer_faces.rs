//! The capability of a brake whose outer faces are known: for the sound of a motion.

use num_complex::Complex;

use crate::{Error, Scene};

/// Faces to the air.
pub trait OuterFaces: Sync {
    /// The integral `int |u_n|^2 dA` over all outer faces, `u_n` along their normals, of each of some motions u over the free degrees of freedom of a
    /// scene: in the square of the unit of u times that of the brake's length. `None` of a brake without faces.
    ///
    /// # Errors
    /// A motion that does not fit the faces.
    fn squares_along_normals(&self, scene: &Scene, motions: &[Vec<Complex<f64>>]) -> Result<Option<Vec<f64>>, Error>;
}
