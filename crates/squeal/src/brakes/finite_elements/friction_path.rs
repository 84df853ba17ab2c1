//! The path between two samples of a scene that differ in friction alone.

use cea::NewtonStep;
use nalgebra::DVector;
use num_complex::Complex;
use sparse::reduction::{FrictionPath, OnFrictionPath};
use tracking::OwnedPath;

/// A path between two frictions of one structure.
#[derive(Debug)]
pub(super) struct FrictionalPath<'a>(pub FrictionPath<'a>);

impl OwnedPath for FrictionalPath<'_> {
    fn correct(&self, t: f64, lambda: Complex<f64>) -> Option<(NewtonStep, DVector<Complex<f64>>)> {
        let OnFrictionPath { lambda, rate, shape } = self.0.next_to(t, lambda)?;
        Some((NewtonStep { lambda, rate }, shape))
    }

    fn characteristic(&self, at: &[(f64, Complex<f64>)]) -> Vec<Complex<f64>> {
        self.0.characteristic(at)
    }
}
