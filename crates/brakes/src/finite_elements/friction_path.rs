//! The path between two samples of a scene that differ in friction alone.

use cea::{CeaError, NewtonStep};
use linsys::{AffineSystem, OperatingPoint, SecondOrder};
use nalgebra::DVector;
use num_complex::Complex;
use reduction::{FrictionPath, OnFrictionPath};
use tracking::{Eigenpair, OwnedPath};

/// A path between two frictions of one structure.
#[derive(Debug)]
pub(super) struct FrictionalPath<'a> {
    pub path: FrictionPath<'a>,
    /// The brake of the scene, and its operating point at the beginning.
    pub brake: &'a AffineSystem,
    pub from: OperatingPoint,
}

impl OwnedPath for FrictionalPath<'_> {
    fn correct(&self, t: f64, lambda: Complex<f64>) -> Option<(NewtonStep, DVector<Complex<f64>>)> {
        let OnFrictionPath { lambda, rate, shape } = self.path.next_to(t, lambda)?;
        Some((NewtonStep { lambda, rate }, shape))
    }

    fn characteristic(&self, at: &[(f64, Complex<f64>)]) -> Vec<Complex<f64>> {
        self.path.characteristic(at)
    }

    fn nearest(&self, t: f64, to: &[Complex<f64>], count: usize) -> Option<Vec<Eigenpair>> {
        self.path.nearest(t, to, count)
    }

    fn system(&self) -> Result<SecondOrder, CeaError> {
        Ok(self.brake.assemble(&self.from)?)
    }
}
