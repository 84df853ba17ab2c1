//! Modes of a brake without damping that are on the imaginary axis, of which no sign of growth is read.
//!
//! Without damping `(lambda^2 M + K) u = 0` with real matrices, so that with lambda also `-conj(lambda)` is an eigenvalue. Where one eigenvalue of the whole
//! brake is within the error of a reduced one, and no other is anywhere near, it is its own mirror image: it lies on the axis, as all do before two of them
//! meet.

use linsys::OperatingPoint;
use num_complex::Complex;
use sparse::SparseAffineSystem;

/// Distance from all others, as a multiple of the error, from which on an eigenvalue is alone: its mirror image is within three errors of it, and another one
/// within one of its own; chosen twice that.
const ALONE: f64 = 8.0;

/// True if nothing damps a brake at an operating point, and friction has no slope.
pub(super) fn is_undamped(system: &SparseAffineSystem, at: &OperatingPoint) -> bool {
    let mut terms = system.terms().iter().zip(&at.coefficients).filter(|(_, coefficient)| **coefficient != 0.0);
    terms.all(|(term, _)| term.matrices.c.values().iter().all(|value| *value == 0.0))
        && at.channels.iter().all(|gain| gain.slope == 0.0 && gain.lag.is_none())
}

/// Flags of the eigenvalues of a brake without damping, rad/s, that are on the axis; `error` is their relative error, and `band` the frequencies beyond
/// which others are not known, rad/s.
pub(super) fn on_axis(lambdas: &[Complex<f64>], error: f64, [low, high]: [f64; 2]) -> Vec<bool> {
    let is_on = |(at, lambda): (usize, &Complex<f64>)| {
        let near = error * lambda.norm();
        let apart = |other: &Complex<f64>| (other - lambda).norm() > ALONE * error * lambda.norm().max(other.norm());
        lambda.re.abs() <= near
            && lambda.im - low > ALONE * near
            && high - lambda.im > ALONE * near
            && lambdas.iter().enumerate().all(|(other, value)| other == at || apart(value))
    };
    lambdas.iter().enumerate().map(is_on).collect()
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
