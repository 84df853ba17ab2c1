//! A basis of modes at a few points: its columns follow the modes that are wanted, whatever the number of contacts is.
//!
//! A basis of [responses](super::response_basis) has columns for each contact. What friction and opened contacts do to the modes of a band is smooth over a
//! face, and lies in far fewer directions: those of the modes at a few arrangements and frictions. Left vectors are among them, so that the error of an
//! eigenvalue is the product of what is missing on both sides.

use linsys::OperatingPoint;
use nalgebra::DMatrix;
use sparse::{Eigenpair, Rectangle, SparseAffineSystem};

use super::Vectors;
use super::basis::{ROUNDING, candidates, directions, fewest, projected_residual};
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
    let all: Vec<Eigenpair> = known.iter().flat_map(|(.., modes)| modes).cloned().collect();
    let empty = DMatrix::zeros(system.order(), 0);
    let found = directions(&empty, candidates(&all, Vectors::RightAndLeft), ROUNDING)?;
    if found.ncols() == 0 {
        let option = "the number of modes in the rectangle";
        return Err(ReductionError::Option { option, value: 0.0, allowed: "1 or more" });
    }
    let error = |basis: &DMatrix<f64>| {
        let of_point = |(full, norms, modes): &(_, super::norms::NormsAt, Vec<Eigenpair>)| {
            projected_residual(full, |lambda| norms.size(lambda), basis, modes)
        };
        known.iter().map(of_point).fold(0.0, f64::max)
    };
    Ok(fewest(&empty, &found, most_columns, tolerance, error))
}
