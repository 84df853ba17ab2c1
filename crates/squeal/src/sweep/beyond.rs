//! Branches as a threshold sees them: the margin beyond it in place of the growth rate.
//!
//! Where onsets are found, an eigenvalue is looked at by its real part and its rate alone. With the margin in place of the real
//! part the imaginary axis is the threshold; at a given frequency either follows from the other.

use cea::Threshold;
use num_complex::Complex;
use tracking::{BranchPoint, Branches, RefinedPoint};

/// Branches whose eigenvalues `margin + i omega` are zero in their real part on a threshold; for the axis they are the same.
pub(super) struct Beyond<'a, B> {
    branches: &'a mut B,
    threshold: Threshold,
    /// Those of the parameter that was asked for last.
    seen: Vec<Complex<f64>>,
}

impl<'a, B: Branches> Beyond<'a, B> {
    pub fn new(branches: &'a mut B, threshold: Threshold) -> Self {
        Self { branches, threshold, seen: Vec::new() }
    }
}

fn seen(threshold: &Threshold, lambda: Complex<f64>) -> Complex<f64> {
    Complex::new(threshold.margin(lambda), lambda.im)
}

fn seen_rate(threshold: &Threshold, lambda: Complex<f64>, rate: Complex<f64>) -> Complex<f64> {
    Complex::new(threshold.margin_rate(lambda, rate), rate.im)
}

impl<B: Branches> Branches for Beyond<'_, B> {
    type Error = B::Error;

    fn lambdas(&mut self, at: f64) -> Result<&[Complex<f64>], B::Error> {
        let lambdas = self.branches.lambdas(at)?;
        self.seen.clear();
        self.seen.extend(lambdas.iter().map(|&lambda| seen(&self.threshold, lambda)));
        Ok(&self.seen)
    }

    fn point(&mut self, at: f64, index: usize) -> Result<BranchPoint, B::Error> {
        let BranchPoint { lambda, rate } = self.branches.point(at, index)?;
        Ok(BranchPoint { lambda: seen(&self.threshold, lambda), rate: seen_rate(&self.threshold, lambda, rate) })
    }

    /// The margin is no farther from the true one than the eigenvalue from its own: the bound stays.
    fn refined(&mut self, at: f64, lambda: Complex<f64>) -> Result<RefinedPoint, B::Error> {
        let RefinedPoint { lambda, rate, bound } =
            self.branches.refined(at, self.threshold.at_margin(lambda.re, lambda.im))?;
        let rate = seen_rate(&self.threshold, lambda, rate);
        Ok(RefinedPoint { lambda: seen(&self.threshold, lambda), rate, bound })
    }

    fn growing_outside(&mut self, at: f64) -> Result<usize, B::Error> {
        self.branches.growing_outside(at)
    }

    fn known_between(&self, from: f64, to: f64) -> Vec<f64> {
        self.branches.known_between(from, to)
    }
}
