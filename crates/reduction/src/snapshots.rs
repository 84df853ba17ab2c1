//! A basis of modes at a few points: its columns follow the modes that are wanted, whatever the number of contacts is.
//!
//! A basis of [responses](super::response_basis) has columns for each contact. What friction and opened contacts do to the modes of a band is smooth over a
//! face, and lies in far fewer directions: those of the modes at a few arrangements and frictions. Left vectors are among them, so that the error of an
//! eigenvalue is the product of what is missing on both sides.

use linsys::OperatingPoint;
use nalgebra::DMatrix;
use sparse::{Rectangle, SparseAffineSystem};

use super::Vectors;
use super::basis::{ModesAt, of_modes};
use super::full;
use super::norms::Norms;
use crate::ReductionError;

/// A basis of the modes in and to the right of a rectangle at some points, of which there is at least one: the fewest principal directions of their right
/// and left vectors, n x k with k at most `most_columns`, that leave no right vector a larger residual than `tolerance`.
///
/// # Errors
/// A point of another system, no mode in the rectangle at any point, what [`eigenpairs_in`](sparse::eigenpairs_in) refuses.
pub fn snapshot_basis(
    system: &SparseAffineSystem,
    rectangle: &Rectangle,
    points: &[OperatingPoint],
    tolerance: f64,
    most_columns: usize,
) -> Result<DMatrix<f64>, ReductionError> {
    let norms = Norms::new(system);
    let mut known = Vec::with_capacity(points.len());
    for point in points {
        let full = system.assemble(point)?;
        let (modes, _) = full::solve(&full, rectangle, &sparse::Options::default())?;
        known.push((full, norms.at(point), modes));
    }
    let known: Vec<_> = known.iter().map(|(system, norms, modes)| ModesAt { system, norms, modes }).collect();
    of_modes(system.order(), &known, Vectors::RightAndLeft, (most_columns, tolerance))
}
