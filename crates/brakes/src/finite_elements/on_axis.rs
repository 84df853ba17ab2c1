//! Modes of a brake without damping that are on the imaginary axis, of which no sign of growth is read.
//!
//! Without damping `(lambda^2 M + K) u = 0` with real matrices, so that with lambda also `-conj(lambda)` is an eigenvalue. Where one eigenvalue of the whole
//! brake is within the error of a reduced one, and no other is anywhere near, it is its own mirror image: it lies on the axis, as all do before two of them
//! meet.

use cea::is_alone;
use linsys::OperatingPoint;
use num_complex::Complex;
use sparse::SparseAffineSystem;

/// True if nothing damps a brake at an operating point or relaxes in it, and friction has no slope.
pub(super) fn is_undamped(system: &SparseAffineSystem, at: &OperatingPoint) -> bool {
    let mut terms = system.terms().iter().zip(&at.coefficients).filter(|(_, coefficient)| **coefficient != 0.0);
    terms.all(|(term, _)| term.loss == 0.0 && term.matrices.c.values().iter().all(|value| *value == 0.0))
        && at.channels.iter().all(|gain| gain.slope == 0.0 && gain.lag.is_none_or(|lag| lag.force == 0.0))
}

/// Flags of the eigenvalues of a brake without damping, rad/s, that are on the axis; `error` is their relative error, and `band` the frequencies beyond
/// which others are not known, rad/s.
pub(super) fn on_axis(lambdas: &[Complex<f64>], error: f64, band: [f64; 2]) -> Vec<bool> {
    // At the ends there may be others beyond.
    let ends = band.map(|omega| Complex::new(0.0, omega));
    let all: Vec<_> = lambdas.iter().chain(&ends).map(|&lambda| (lambda, error * lambda.norm())).collect();
    let is_on = |at: usize| lambdas[at].re.abs() <= all[at].1 && is_alone(&all, at);
    (0..lambdas.len()).map(is_on).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_alone_is_on_the_axis() {
        let lambdas =
            [(1e-4, 10.0), (0.0, 20.0), (0.0, 20.001), (0.5, 30.0), (0.0, 40.0)].map(|(re, im)| Complex::new(re, im));
        let found = |error: f64, high: f64| on_axis(&lambdas, error, [1.0, high]);
        assert_eq!(found(1e-4, 50.0), [true, false, false, false, true]);
        // Next to an end of the band another may be beyond it; a smaller error tells the two apart, and not what is off the axis by more.
        assert_eq!(found(1e-4, 40.02), [true, false, false, false, false]);
        assert_eq!(found(1e-6, 50.0), [false, true, true, false, true]);
    }
}
