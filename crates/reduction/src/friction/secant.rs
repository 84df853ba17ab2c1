//! The secant method.

use num_complex::Complex;

/// A number, and what was missed there: how far it is from where it should be, as far as one can tell.
pub(super) type Missed = (Complex<f64>, Complex<f64>);

/// The next number of the secant method, from the last two. The first step is what was missed.
pub(super) fn secant(before: Option<Missed>, (lambda, miss): Missed) -> Complex<f64> {
    match before {
        Some((there, missed)) if missed != miss => lambda - miss * (lambda - there) / (miss - missed),
        _ => lambda + miss,
    }
}
