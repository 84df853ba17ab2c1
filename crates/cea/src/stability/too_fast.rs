//! Growth that is faster than the oscillation.

use num_complex::Complex;

/// True of an eigenvalue that grows faster than it oscillates, Im >= 0: no mode of a band but divergence, of single pairs of nodes for example, which no basis of
/// the modes of a band holds. Whoever solves a brake on such a basis leaves it out, and who solves the whole brake has to say whether there are any.
#[must_use]
pub fn grows_too_fast(lambda: Complex<f64>) -> bool {
    lambda.re > lambda.im
}
