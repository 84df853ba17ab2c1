//! Real modes: the classical basis, to compare with.

use linsys::OperatingPoint;
use nalgebra::DMatrix;
use nalgebra_sparse::CscMatrix;
use sparse::{Rectangle, SparseAffineSystem, SparseSecondOrder};

use super::Vectors;
use super::basis::{candidates, directions};
use super::full::solve;
use crate::ReductionError;

/// Half the width of the strip around the imaginary axis in which undamped modes are looked for, as a part of the highest
/// frequency: rounding does not move an eigenvalue so far.
const HALF_WIDTH: f64 = 1e-4;
/// Singular values up to which a part of a vector is rounding: real modes come as complex vectors of any phase.
const REAL: f64 = 1e-6;

/// An orthonormal basis of the modes of M and the symmetric part of K at a point, without damping and friction, whose angular
/// frequencies are in `frequencies`, rad/s; n x k.
///
/// # Errors
/// A point of another system; what [`eigenpairs_in`](sparse::eigenpairs_in) refuses, an empty range for example.
pub fn real_modes(
    system: &SparseAffineSystem,
    point: &OperatingPoint,
    frequencies: [f64; 2],
) -> Result<DMatrix<f64>, ReductionError> {
    let SparseSecondOrder { m, k, .. } = system.assemble(point)?;
    let symmetric = (&k + k.transpose()) * 0.5;
    let order = m.nrows();
    let undamped = SparseSecondOrder::new(m, CscMatrix::zeros(order, order), symmetric)?;
    let half = HALF_WIDTH * frequencies[1].abs();
    let strip = Rectangle { re: [-half, half], im: frequencies };
    let (modes, _) = solve(&undamped, &strip, &sparse::Options::default())?;
    directions(&DMatrix::zeros(order, 0), candidates(&modes, Vectors::Right), REAL)
}
