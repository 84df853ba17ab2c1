//! The residual of a reduced mode in the full system, at a cost that does not know the full system's size.
//!
//! ```text
//! Q(lambda) V y = sum_k theta_k (lambda^2 M_k V + lambda C_k V + K_k V) y
//!               + sum_i b_i (mu_i r_i^T V y + lambda s_i(lambda) b_i^T V y)
//! ```
//!
//! All matrices here are known when the basis V is: the columns of every `A_k V` and the b_i. The part of the residual in V is the residual in the reduced
//! system; the norm of the part orthogonal to V is bounded by random combinations of its rows.

use linsys::{AffineSystem, OperatingPoint, SecondOrder, Term};
use nalgebra::DMatrix;
use num_complex::Complex;

use super::combinations::{Combinations, FACTOR, OuterRows};
use super::norms::{Norms, NormsAt};
use super::shared::Friction;
use super::{dense, split};

/// The parts of the terms that are orthogonal to the basis.
#[derive(Debug, Clone)]
pub(super) struct ResidualForm {
    rows: OuterRows,
    /// With `V^T b_i` and `V^T r_i` of each channel.
    friction: Friction,
    pub norms: Norms,
}

/// The residual form at one operating point.
#[derive(Debug, Clone)]
pub(super) struct ResidualAt<'a> {
    form: &'a ResidualForm,
    point: &'a OperatingPoint,
    norms: NormsAt,
}

impl ResidualForm {
    /// The form over `V W`, on which a system is `reduced`, by random combinations for V.
    pub fn new(combined: &Combinations, columns: &DMatrix<f64>, reduced: &AffineSystem) -> Self {
        // S less its part in V W: what it makes of a matrix A is S^T A V W - (S^T V W) (W^T V^T A V W).
        let inside = dense::product(&combined.basis, columns);
        let outside = |of: &DMatrix<f64>, own: &DMatrix<f64>| {
            let mut rows = dense::product(of, columns);
            dense::add_product(&mut rows, -1.0, &inside, own);
            rows
        };
        let of_term = |(of, term): (&[DMatrix<f64>; 3], &Term)| {
            let SecondOrder { m, c, k, .. } = term.matrices();
            let own = [m, c, k];
            std::array::from_fn(|power| match of[power].nrows() {
                0 => DMatrix::zeros(0, columns.ncols()),
                _ => outside(&of[power], own[power]),
            })
        };
        let terms = combined.terms.iter().zip(reduced.terms()).map(of_term).collect();
        let (own, reading) = (reduced.force_matrix(), reduced.reading_matrix());
        let mut force = combined.force.clone();
        dense::add_product(&mut force, -1.0, &inside, &own);
        let (rows, friction) = (OuterRows { terms, force }, Friction::of(own, &reading));
        Self { rows, friction, norms: combined.norms.clone() }
    }

    /// The form at a point that belongs to the system.
    pub fn at<'a>(&'a self, point: &'a OperatingPoint) -> ResidualAt<'a> {
        ResidualAt { form: self, point, norms: self.norms.at(point) }
    }
}

/// Pairs (lambda_j, V y_j) at a point.
pub(super) struct Pairs<'a> {
    pub at: &'a ResidualAt<'a>,
    pub lambdas: &'a [Complex<f64>],
    /// The split columns y_j.
    pub y: &'a DMatrix<f64>,
    /// Coefficients of the terms times their loss factors, where there are some.
    pub losses: Option<&'a [f64]>,
    /// The norms of the residuals of the reduced system.
    pub inner: &'a [f64],
}

impl Pairs<'_> {
    /// Bound of the residual of each pair: the estimate by random combinations times [`FACTOR`].
    pub fn residuals(&self) -> Vec<f64> {
        let Self { at: ResidualAt { form, point, norms }, lambdas, y, losses, inner } = self;
        let outer = form.rows.of((&form.friction, &point.channels), (&point.coefficients, *losses), lambdas, y);
        let residual = |(at, (&lambda, inner)): (usize, (&Complex<f64>, &f64))| {
            let outside = FACTOR * split::norm_squared(&outer, at).sqrt();
            inner.hypot(outside) / (norms.size(lambda) * split::norm_squared(y, at).sqrt())
        };
        lambdas.iter().zip(*inner).enumerate().map(residual).collect()
    }
}

/// `Q(lambda_j) y_j` of the reduced system, internal states eliminated.
pub(super) fn reduced_residual(system: &SecondOrder, lambdas: &[Complex<f64>], y: &DMatrix<f64>) -> DMatrix<f64> {
    let mut out = split::quadratic([&system.m, &system.c, &system.k], lambdas, y);
    if system.states() > 0 {
        let drive = &system.internal.drive * y;
        let mut gains = split::zeros(system.states(), lambdas.len());
        for (at, &lambda) in lambdas.iter().enumerate() {
            let values = split::vector(&drive, at);
            let gain = |(value, decay): (&Complex<f64>, &f64)| value * lambda / (lambda + decay);
            split::set(&mut gains, at, values.iter().zip(&system.internal.decay).map(gain));
        }
        out.gemm(-1.0, &system.internal.force, &gains, 1.0);
    }
    out
}

/// Largest of `residuals`: 0 for an empty list, NaN if one of them is NaN.
pub fn largest_residual(residuals: impl IntoIterator<Item = f64>) -> f64 {
    let larger = |largest: f64, own: f64| if largest.is_nan() || own <= largest { largest } else { own };
    residuals.into_iter().fold(0.0, larger)
}
