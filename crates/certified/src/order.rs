//! The order of eigenvalues in a spectrum.

use std::cmp::Ordering;

use num_complex::Complex;

/// Sorts eigenvalues as [`by_frequency`] orders them.
pub fn sort(eigenvalues: &mut [Complex<f64>]) {
    eigenvalues.sort_by(by_frequency);
}

/// Orders eigenvalues by |Im|, then Re, then Im: real ones first, conjugates next to each other.
#[must_use]
#[inline]
pub fn by_frequency(a: &Complex<f64>, b: &Complex<f64>) -> Ordering {
    a.im.abs().total_cmp(&b.im.abs()).then(a.re.total_cmp(&b.re)).then(a.im.total_cmp(&b.im))
}
