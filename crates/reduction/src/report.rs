//! What a reduction costs and how far its error is down.

use std::time::Instant;

use linsys::OperatingPoint;
use num_complex::Complex;

use super::{Reduced, ReducedModes, Route};
use crate::ReductionError;

/// The history of a reduction.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// One row for each basis, the last for the one returned.
    pub stages: Vec<Stage>,
    /// Full modes that the basis of the time did not hold.
    pub missed: Vec<MissedMode>,
    /// Full problems solved.
    pub full_problems: usize,
    /// Sparse factorisations that they took.
    pub factorisations: u64,
    /// True if all training points were within the tolerance and the last full problems showed no missed mode.
    pub is_reached: bool,
}

impl Report {
    /// Full problems beyond those at the given points.
    #[must_use]
    pub fn enrichments(&self) -> usize {
        self.stages.len().saturating_sub(1)
    }
}

/// Reason for solving the full problem at the last point of a stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Why {
    /// The point was given.
    Given,
    /// A basis had a mode there that grows faster than was searched.
    Growth,
    /// The point had the largest residual, and it was above the tolerance.
    LargestResidual,
    /// The point was the farthest from all known points.
    Farthest,
}

/// A full mode that a basis did not hold: no reduced eigenvalue was near.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MissedMode {
    /// The training point.
    pub training: usize,
    /// The eigenvalue, rad/s.
    pub lambda: Complex<f64>,
}

/// One basis: what it took, what it reaches, what an evaluation costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stage {
    /// Reason for its last point.
    pub why: Why,
    /// Columns of the basis, k.
    pub columns: usize,
    /// Known points.
    pub points: usize,
    /// Full problems so far.
    pub full_problems: usize,
    /// Sparse factorisations so far.
    pub factorisations: u64,
    /// Missed modes so far.
    pub missed: usize,
    /// Training points evaluated.
    pub training: usize,
    /// Training points with a residual above the tolerance.
    pub above: usize,
    /// The largest residual of a mode at a training point.
    pub largest_residual: f64,
    /// Training points whose modes took the whole spectrum.
    pub spectra: usize,
    /// Time of an evaluation with residuals, mean, s. The only number here that differs from run to run.
    pub seconds: f64,
}

impl Stage {
    /// Evaluates a reduced system at all points; with the point of the largest residual.
    ///
    /// # Errors
    /// Those of [`Reduced::modes`].
    pub fn measure(
        reduced: &Reduced,
        points: &[OperatingPoint],
        tolerance: f64,
    ) -> Result<(Self, Option<(usize, f64)>), ReductionError> {
        let start = Instant::now();
        let mut tally = ResidualTally::new(tolerance);
        for (at, modes) in (0..).zip(reduced.modes_of_all(points, &|_, _| true)) {
            tally.record(at, &modes?);
        }
        let mean = |sum: f64| if points.is_empty() { 0.0 } else { sum / points.len() as f64 };
        let stage = Self {
            why: Why::Given,
            columns: reduced.basis().ncols(),
            points: 0,
            full_problems: 0,
            factorisations: 0,
            missed: 0,
            training: points.len(),
            above: usize::try_from(tally.above).unwrap_or(usize::MAX),
            largest_residual: tally.largest.map_or(0.0, |(_, residual)| residual),
            spectra: usize::try_from(tally.spectra).unwrap_or(usize::MAX),
            seconds: mean(start.elapsed().as_secs_f64()),
        };
        Ok((stage, tally.largest.map(|(at, residual)| (usize::try_from(at).unwrap_or(usize::MAX), residual))))
    }
}

/// Residuals of many samples, in memory that does not grow with their number.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualTally {
    tolerance: f64,
    /// Samples recorded.
    pub samples: u64,
    /// Modes in them.
    pub modes: u64,
    /// Samples with a residual above the tolerance.
    pub above: u64,
    /// Numbers and largest residuals of these, the first thousand.
    pub listed: Vec<(u64, f64)>,
    /// The sample of the largest residual of all.
    pub largest: Option<(u64, f64)>,
    /// Samples that took the whole spectrum of the reduced system.
    pub spectra: u64,
}

/// Most samples that are listed; all are counted.
const MOST_LISTED: usize = 1000;

impl ResidualTally {
    /// An empty tally.
    #[must_use]
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, samples: 0, modes: 0, above: 0, listed: Vec::new(), largest: None, spectra: 0 }
    }

    /// Adds the sample of this number. A residual that is not a number counts as above.
    pub fn record(&mut self, sample: u64, modes: &ReducedModes) {
        let residual = modes.largest_residual();
        self.samples += 1;
        self.modes += modes.lambdas.len() as u64;
        self.spectra += u64::from(matches!(modes.route, Route::Spectrum(_)));
        if self.largest.is_none_or(|(_, largest)| residual.total_cmp(&largest).is_gt()) {
            self.largest = Some((sample, residual));
        }
        if residual.is_nan() || residual > self.tolerance {
            self.above += 1;
            if self.listed.len() < MOST_LISTED {
                self.listed.push((sample, residual));
            }
        }
    }
}
