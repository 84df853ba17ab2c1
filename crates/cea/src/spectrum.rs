//! Spectra, frequencies and damping ratios.

use std::cmp::Ordering;

use num_complex::Complex;

/// All finite eigenvalues of a system, rad/s, in the order of [`sort`].
///
/// Complex ones come in exact conjugate pairs, because the matrices are real.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// The eigenvalues.
    pub eigenvalues: Vec<Complex<f64>>,
    /// Scale of the problem, an estimate of the largest |lambda| before rounding; errors are relative to it.
    pub scale: f64,
}

/// Sorts eigenvalues as [`by_frequency`] orders them.
pub fn sort(eigenvalues: &mut [Complex<f64>]) {
    eigenvalues.sort_by(by_frequency);
}

/// Orders eigenvalues by |Im|, then Re, then Im: real ones first, conjugates next to each other.
#[must_use]
pub fn by_frequency(a: &Complex<f64>, b: &Complex<f64>) -> Ordering {
    a.im.abs().total_cmp(&b.im.abs()).then(a.re.total_cmp(&b.re)).then(a.im.total_cmp(&b.im))
}

impl Spectrum {
    /// One eigenvalue of each conjugate pair, the one with Im lambda > 0, ascending in frequency.
    pub fn oscillatory(&self) -> impl Iterator<Item = Complex<f64>> + '_ {
        self.eigenvalues.iter().copied().filter(|l| l.im > 0.0)
    }

    /// Real eigenvalues, ascending: overdamped modes, divergence and internal states.
    pub fn real(&self) -> impl Iterator<Item = f64> + '_ {
        self.eigenvalues.iter().filter(|l| l.im == 0.0).map(|l| l.re)
    }
}

/// `f = Im lambda / 2 pi`, Hz.
#[must_use]
pub fn frequency_hz(lambda: Complex<f64>) -> f64 {
    lambda.im / std::f64::consts::TAU
}

/// `zeta = -Re lambda / |lambda|`, the textbook's damping ratio: 1 is critical, negative is unstable.
///
/// Abaqus prints `-2 Re lambda / |lambda|`, twice this.
#[must_use]
pub fn damping_ratio(lambda: Complex<f64>) -> f64 {
    if lambda.norm() == 0.0 { 0.0 } else { -lambda.re / lambda.norm() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequency_and_damping_of_a_known_eigenvalue() {
        let lambda = Complex::new(-3.0, 4.0);
        assert_eq!(damping_ratio(lambda), 0.6);
        assert_eq!(frequency_hz(lambda), 4.0 / std::f64::consts::TAU);
    }
}
