//! Growth that is faster than the oscillation.

use num_complex::Complex;

/// True of an eigenvalue with Im >= 0 (not checked) that grows faster than it oscillates, `Re lambda > Im lambda`. It is divergence, of single pairs of
/// nodes for example, and no mode of a band: no basis of the modes of a band has it. Who solves a brake on such a basis leaves it out; who solves the whole
/// brake has to say whether there are any.
#[must_use]
pub fn grows_too_fast(lambda: Complex<f64>) -> bool {
    lambda.re > lambda.im
}
