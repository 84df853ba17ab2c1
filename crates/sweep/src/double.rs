//! Two eigenvalues that meet, over two parameters: a growing pair that becomes two real eigenvalues, or two modes on the axis.

use cea::{EigenSolver, QrSolver, Workspace};
use linsys::SecondOrder;
use nalgebra::Vector2;
use num_complex::Complex;

use crate::Error;

/// Pair of eigenvalues by their mean m and their squared half distance s, which are smooth where they meet. On the real axis s is below
/// zero of a pair and above of two real eigenvalues; on the imaginary axis it is below zero of two modes on it, and above of one that
/// grows and one that decays. Either way there is one more unstable mode where s is positive.
#[derive(Debug, Clone)]
pub(super) struct Double {
    /// Mean m, rad/s.
    pub mean: Complex<f64>,
    /// Squared half distance s, (rad/s)^2: real, by the symmetry of the spectrum about the axis in question.
    pub square: f64,
    /// Rates d m / d x and d m / d y.
    pub mean_rates: Vector2<Complex<f64>>,
}

impl Double {
    /// The two eigenvalues of a system that are nearest to a mean, with rates of zero, which the caller fills in; `None` where the system has fewer than
    /// two.
    ///
    /// # Errors
    /// Those of the solver.
    pub fn near(system: &SecondOrder, mean: Complex<f64>) -> Result<Option<Self>, Error> {
        let mut eigenvalues = QrSolver.eigenvalues(system, &mut Workspace::default())?.eigenvalues;
        let distance = |lambda: &Complex<f64>| (lambda - mean).norm_sqr();
        eigenvalues.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        let &[a, b, ..] = &eigenvalues[..] else { return Ok(None) };
        let half = 0.5 * (a - b);
        Ok(Some(Self { mean: 0.5 * (a + b), square: (half * half).re, mean_rates: Vector2::zeros() }))
    }
}
