//! Modes of a large brake at many points, from those that it has at one point.
//!
//! A search finds all modes at a point, for the price of some two hundred solutions with one factorisation. Where modes have only to shape a basis, the modes at
//! one point, taken as a basis, have those at others roughly, and corrections of each with factors of its own point leave little of what they miss: what
//! contacts and friction change locally is the response of modes far above the band, which they bring nearly whole. Nothing is counted, and a mode of
//! which the basis has nothing is missing: searches at other points have to tell.

use cea::{BatchSolver, EigenSolver as _, Workspace, grows_too_fast};
use linsys::{AffineSystem, OperatingPoint, real_times_complex};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use sparse::{Guess, Problem, Rectangle, SparseAffineSystem};

use super::directions::{ROUNDING, directions};
use super::snapshots::{SnapshotMode, columns, with_margin};
use super::spectra::vectors;
use crate::ReductionError;

/// Largest distance from the rectangle, as a fraction of the largest |lambda| in it, of guesses that are corrected; chosen: a mode in the rectangle has a guess above it,
/// as a basis makes a structure stiffer.
const MARGIN: f64 = 0.15;

/// Modes of a brake at one point, as a basis for those at others.
#[derive(Debug)]
pub struct NearModes<'a> {
    system: &'a SparseAffineSystem,
    /// Where guesses are corrected.
    around: Rectangle,
    threads: usize,
    /// Orthonormal directions of the vectors at the one point, n x k.
    basis: DMatrix<f64>,
    reduced: AffineSystem,
}

impl<'a> NearModes<'a> {
    /// A basis of the modes at one point, in and around a rectangle ([`Snapshots::modes_around`](crate::Snapshots::modes_around)). Factors and solutions are made by so many threads.
    ///
    /// # Errors
    /// No mode, vectors that are no numbers or of another system.
    pub fn new(
        system: &'a SparseAffineSystem,
        rectangle: &Rectangle,
        modes: &[SnapshotMode],
        threads: usize,
    ) -> Result<Self, ReductionError> {
        if modes.is_empty() {
            return Err(ReductionError::NoModes);
        }
        let basis = directions(&DMatrix::zeros(system.order(), 0), columns(modes), ROUNDING)?;
        let reduced = system.project(&basis)?;
        Ok(Self { system, around: with_margin(rectangle, MARGIN), threads, basis, reduced })
    }

    /// Modes at a point, nearly: those that the basis has there in and next to the rectangle, corrected ([`Problem::eigenpairs_next_to`]). Not all of them need be
    /// there.
    ///
    /// # Errors
    /// A point of another system, those of the correction.
    pub fn at(&self, point: &OperatingPoint) -> Result<Vec<SnapshotMode>, ReductionError> {
        let small = self.reduced.assemble(point)?;
        let mut lambdas = BatchSolver.eigenvalues(&small, &mut Workspace::default())?.eigenvalues;
        lambdas.retain(|&lambda| {
            lambda.im > 0.0 && self.around.contains_to_the_right(lambda, 0.0) && !grows_too_fast(lambda)
        });
        let lifted = |shape: &DVector<Complex<f64>>| real_times_complex(&self.basis, shape);
        let mut guesses = Vec::with_capacity(lambdas.len());
        for [right, left] in vectors(&[small], std::slice::from_ref(&lambdas))? {
            guesses.extend((0..lambdas.len()).map(|at| Guess {
                lambda: lambdas[at],
                right: lifted(&right[at]),
                left: lifted(&left[at]).conjugate(),
            }));
        }
        let problem = Problem::new(&self.system.assemble(point)?)?.with_threads(self.threads);
        let mut found: Vec<SnapshotMode> =
            problem.eigenpairs_next_to(guesses)?.into_iter().map(SnapshotMode::from).collect();
        found.retain(|mode| !grows_too_fast(mode.lambda));
        Ok(found)
    }
}
