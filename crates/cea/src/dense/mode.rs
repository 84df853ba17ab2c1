//! Oscillating mode: its eigenvalue and its shape.

use linsys::{SecondOrder, real_times_complex};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::vectors::fix_phase;
use crate::{CeaError, Workspace, right_vectors_of_all};

/// Oscillating mode: its eigenvalue (rad/s, Im > 0) and its shape over the free degrees of freedom.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// Eigenvalue lambda, rad/s.
    pub lambda: Complex<f64>,
    /// Shape phi, length n, `phi^H M phi = 1`, largest component real and positive.
    pub shape: DVector<Complex<f64>>,
}

impl Mode {
    /// The modes of `system` at the given eigenvalues.
    ///
    /// # Errors
    /// Those of [`right_vectors_of_all`].
    pub fn at(system: &SecondOrder, lambdas: &[Complex<f64>], work: &mut Workspace) -> Result<Vec<Self>, CeaError> {
        Self::of_all(&[(system, lambdas)], work).remove(0)
    }

    /// [`Mode::at`] of several systems, one result each; cheaper than one call per system.
    pub fn of_all(of: &[(&SecondOrder, &[Complex<f64>])], work: &mut Workspace) -> Vec<Result<Vec<Self>, CeaError>> {
        let shapes = right_vectors_of_all(of, work);
        let modes = |(&(system, lambdas), shapes): (&(&SecondOrder, &[Complex<f64>]), Result<Vec<_>, _>)| {
            Ok(lambdas.iter().zip(shapes?).map(|(&lambda, shape)| Self::normalised(&system.m, lambda, shape)).collect())
        };
        of.iter().zip(shapes).map(modes).collect()
    }

    /// The mode at `lambda` with this shape, of a system with this mass matrix, normalised.
    #[must_use]
    pub fn normalised(mass: &DMatrix<f64>, lambda: Complex<f64>, shape: DVector<Complex<f64>>) -> Self {
        Self::weighted(mass, lambda, shape).0
    }

    /// The mode at `lambda` with this shape, normalised, and `M phi`, length n.
    #[must_use]
    pub fn weighted(
        mass: &DMatrix<f64>,
        lambda: Complex<f64>,
        mut shape: DVector<Complex<f64>>,
    ) -> (Self, DVector<Complex<f64>>) {
        fix_phase(&mut shape);
        let mut weighted = real_times_complex(mass, &shape);
        let size = shape.dotc(&weighted).re.abs().sqrt();
        shape.unscale_mut(size);
        weighted.unscale_mut(size);
        (Self { lambda, shape }, weighted)
    }
}
