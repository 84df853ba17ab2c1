//! Eigenvalue of which a neighbour is known.

use nalgebra::DVector;
use num_complex::Complex;

use super::disc::{Candidate, Problem};
use super::types::{Counters, Eigenpair};
use crate::SparseError;

impl Problem {
    /// The eigenvalue next to `lambda`, rad/s, whose right vector is like `shape`, over the n degrees of freedom: by inverse iteration and
    /// Rayleigh quotients, with a factorisation for each of a few steps, one where `lambda` is very near. The pair has a backward error of at most
    /// `tolerance`.
    ///
    /// Which one is found follows from `shape` as much as from `lambda`: the modes of a reduced brake are good ones to begin with.
    ///
    /// # Errors
    /// A shape of another length, a factorisation that does not fit into memory, [`SparseError::NotConverged`], also where Q next to `lambda` is singular
    /// or cannot be solved with accurately.
    pub fn eigenpair_near(
        &self,
        lambda: Complex<f64>,
        shape: &DVector<Complex<f64>>,
        tolerance: f64,
    ) -> Result<Eigenpair, SparseError> {
        if shape.len() != self.pencil.order() {
            let (value, allowed) = (shape.len() as f64, "as many as degrees of freedom");
            return Err(SparseError::Option { option: "the number of entries of the shape", value, allowed });
        }
        let candidate = Candidate { lambda, right: shape.iter().copied().collect(), left: None };
        self.polish(candidate, [tolerance; 2], &mut Counters::default())
    }
}
