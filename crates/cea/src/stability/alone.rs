//! Eigenvalues that are apart from all others, so that what is known of one is known of no other.

use num_complex::Complex;

/// Least distance of an eigenvalue that is alone from each other one, as a multiple of the larger of both error bounds. Without damping its mirror image at the
/// imaginary axis is within two bounds of it, another one within one of its own, and two computed ones within four; chosen twice that.
const ALONE: f64 = 8.0;

/// True if the eigenvalue at an index is alone: no other of `eigenvalues`, rad/s with the bounds of their errors, can be where it is or, if it is within its
/// bound of the imaginary axis, where its mirror image at that axis is.
///
/// Without damping, `-conj(lambda)` is an eigenvalue with lambda. So one that is alone and within its bound of the axis is on it.
#[must_use]
pub fn is_alone(eigenvalues: &[(Complex<f64>, f64)], at: usize) -> bool {
    let (lambda, bound) = eigenvalues[at];
    // Beside a bound that is no number nothing is alone.
    let is_apart = |(other, of_other): &(Complex<f64>, f64)| {
        let distance = (other - lambda).norm();
        distance > ALONE * bound && distance > ALONE * of_other
    };
    eigenvalues.iter().enumerate().all(|(index, other)| index == at || is_apart(other))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_apart_by_eight_of_the_larger_bound_is_alone() {
        let of = |re: f64, im: f64, bound: f64| (Complex::new(re, im), bound);
        let mut all = vec![of(0.0, 10.0, 1e-3), of(0.0, 10.01, 1e-4), of(0.0, 10.017, 1e-3), of(0.0, 20.0, 1e-3)];
        assert_eq!([0, 1, 2, 3].map(|at| is_alone(&all, at)), [true, false, false, true]);
        all.push(of(0.0, 30.0, f64::NAN));
        assert!((0..5).all(|at| !is_alone(&all, at)));
    }
}
