//! Spectra, frequencies and damping ratios.

use certified::by_frequency;
use num_complex::Complex;

/// Spectrum: all finite eigenvalues of a system, rad/s, in the order of [`sort`](crate::sort).
///
/// Complex ones come in exact conjugate pairs, because the matrices are real.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// The eigenvalues.
    pub eigenvalues: Vec<Complex<f64>>,
    /// Scale of the problem, an estimate of the largest |lambda| before rounding; errors are relative to it.
    pub scale: f64,
}

/// Largest distance of two frequencies, or of two growth rates, that are equal but for rounding, as a fraction of |lambda|; chosen: far
/// above the rounding of a solver, far below the distance of modes that differ.
pub const EQUAL_BUT_FOR_ROUNDING: f64 = 1e-10;

/// Largest |Im lambda| / |lambda| of two real eigenvalues that rounding has made a pair; chosen: where a pair becomes two real
/// eigenvalues Im lambda grows with the root of the distance, so that the place moves by the square of this.
const STILL_REAL: f64 = 1e-7;

/// Number of real eigenvalues that one with Im lambda >= 0 stands for: none where a mode oscillates, one where it is real, two where rounding has
/// made two real ones a pair, as it does to equal parts that are overdamped or diverge, and to a mode where it loses its frequency.
#[must_use]
pub fn real_count(lambda: Complex<f64>) -> usize {
    match lambda.im.abs() {
        0.0 => 1,
        im if im <= STILL_REAL * lambda.norm() => 2,
        _ => 0,
    }
}

/// Indices of the eigenvalues of oscillating modes in the order of their frequency ranks: ascending in frequency; of equal
/// frequencies, as two modes that flutter can have, the damped one first and the one of the largest growth last. Equal is what
/// differs by 1e-10 of |lambda| or less, else the last bits of a solver would decide. Where both parts are equal, as for the double
/// eigenvalues of a symmetric brake, which are alike but for their shapes, the order given stays.
///
/// ```
/// use num_complex::Complex;
/// let [damped, growing] = [Complex::new(-0.1, 1.4), Complex::new(0.1, 1.4 * (1.0 - 1e-15))];
/// assert_eq!(cea::rank_order(&[growing, damped]), [1, 0]);
/// ```
#[must_use]
pub fn rank_order(lambdas: &[Complex<f64>]) -> Vec<usize> {
    let is_equal = |difference: f64, a: usize, b: usize| {
        difference.abs() <= EQUAL_BUT_FOR_ROUNDING * lambdas[a].norm().max(lambdas[b].norm())
    };
    let mut order: Vec<usize> = (0..lambdas.len()).collect();
    order.sort_by(|&a, &b| by_frequency(&lambdas[a], &lambdas[b]));
    let is_one_frequency = |&a: &usize, &b: &usize| is_equal(lambdas[a].im.abs() - lambdas[b].im.abs(), a, b);
    for group in order.chunk_by_mut(is_one_frequency).filter(|group| group.len() > 1) {
        group.sort_by(|&a, &b| lambdas[a].re.total_cmp(&lambdas[b].re));
        group.chunk_by_mut(|&a, &b| is_equal(lambdas[a].re - lambdas[b].re, a, b)).for_each(<[usize]>::sort_unstable);
    }
    order
}

impl Spectrum {
    /// Eigenvalues of the conjugate pairs, of each the one with Im lambda > 0, ascending in frequency.
    pub fn oscillatory(&self) -> impl Iterator<Item = Complex<f64>> + '_ {
        self.eigenvalues.iter().copied().filter(|l| l.im > 0.0)
    }

    /// Real eigenvalues, ascending: overdamped modes, divergence and internal states.
    pub fn real(&self) -> impl Iterator<Item = f64> + '_ {
        self.eigenvalues.iter().filter(|l| l.im == 0.0).map(|l| l.re)
    }
}

/// Frequency `f = Im lambda / 2 pi`, Hz.
#[must_use]
pub fn frequency_hz(lambda: Complex<f64>) -> f64 {
    lambda.im / std::f64::consts::TAU
}

/// Damping ratio `zeta = -Re lambda / |lambda|`, the textbook's: 1 is critical, negative is unstable.
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
    fn ranks_do_not_hang_on_the_last_bit() {
        let [low, damped, growing, high] =
            [(-0.1, 1.0), (-0.1, 2.0), (0.1, 2.0), (0.3, 2.1)].map(|(re, im)| Complex::new(re, im));
        for rounding in [-1e-14, 0.0, 1e-14] {
            let growing = growing + Complex::new(0.0, rounding);
            assert_eq!(rank_order(&[high, growing, low, damped]), [2, 3, 1, 0]);
            // A double eigenvalue stays as it is given.
            let double = growing + Complex::new(rounding, rounding);
            assert_eq!(rank_order(&[growing, double, damped]), [2, 0, 1]);
        }
        // Frequencies that differ are never taken for equal.
        assert_eq!(rank_order(&[growing, damped + Complex::new(0.0, 1e-8)]), [0, 1]);
    }

    #[test]
    fn frequency_and_damping_of_a_known_eigenvalue() {
        let lambda = Complex::new(-3.0, 4.0);
        assert_eq!(damping_ratio(lambda), 0.6);
        assert_eq!(frequency_hz(lambda), 4.0 / std::f64::consts::TAU);
    }
}
