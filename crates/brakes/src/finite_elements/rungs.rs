//! Cost against error: what fewer columns of a basis hold.

use linsys::OperatingPoint;
use num_complex::Complex;
use reduction::{ReducedModes, largest_residual};

use super::points::{all_patches, naming_point, of_brake};
use super::reduced_set::{Part, ReducedSet};
use super::training::training;
use crate::Error;
use crate::case::FiniteElementCase;

/// Number of rungs: equal steps in the number of columns, up to the whole basis; chosen.
const RUNGS: usize = 6;
/// Number of draws at which the error of each is measured, beside the medians; chosen.
const MEASURED_POINTS: u64 = 6;

/// Error of the first columns of the basis of a part, taken as a basis.
#[derive(Debug, Clone, PartialEq)]
pub struct Rung {
    /// Number of columns.
    pub columns: usize,
    /// The largest residual in the whole brake of a mode in the rectangle, at the medians and at draws.
    pub residual: f64,
    /// The modes in the rectangle at the medians, rad/s.
    pub first: Vec<Complex<f64>>,
}

/// Cost against error of a set of constraints with all patches closed: what fewer columns of its basis hold.
pub(super) fn rungs_of(case: &FiniteElementCase, set: &ReducedSet, origin: &Part) -> Result<Vec<Rung>, Error> {
    let all = all_patches(case);
    let at_median = of_brake(case, &all, &naming_point(case, &all)?);
    let training = training(case, &[all], MEASURED_POINTS, &[])?;
    let points: Vec<OperatingPoint> = std::iter::once(at_median).chain(training).collect();
    let all = origin.within.basis.ncols();
    let mut columns: Vec<usize> = (1..=RUNGS).map(|rung| (all * rung).div_ceil(RUNGS)).collect();
    columns.dedup();
    let rung = |columns: usize| {
        let first = origin.within.basis.columns(0, columns).into_owned();
        let reduced = set.reduced_within(&first, case)?.with_distance_of_losses(origin.distance_of_losses);
        let found = points.iter().map(|at| reduced.modes(at)).collect::<Result<Vec<_>, _>>()?;
        let residual = largest_residual(found.iter().map(ReducedModes::largest_residual));
        let first = found.into_iter().next().map_or(Vec::new(), |found| found.lambdas);
        Ok(Rung { columns, residual, first })
    };
    columns.into_iter().map(rung).collect()
}
