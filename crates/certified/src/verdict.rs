//! Verdict on one eigenvalue: whether its motion grows.

use std::fmt;

use num_complex::Complex;

/// Verdict on a motion: whether it grows, as far as the error bound of its eigenvalue tells.
#[derive(Debug, Clone, Copy, PartialEq)]
#[must_use]
pub enum Verdict {
    /// Re lambda is below zero by more than its error bound.
    Stable,
    /// Re lambda is above zero by more than its error bound.
    Unstable,
    /// |Re lambda| is at most the change that rounding the matrices to doubles may make.
    Marginal {
        /// Bound of that change, in rad/s.
        tolerance: f64,
    },
    /// |Re lambda| is within the error bound, in rad/s.
    Undecided {
        /// The bound.
        bound: f64,
    },
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Stable => "stable",
            Self::Unstable => "unstable",
            Self::Marginal { .. } => "marginal",
            Self::Undecided { .. } => "undecided",
        })
    }
}

impl Verdict {
    /// The verdict on `lambda` known to within `bound`, rad/s. Studies, sweeps and maps, which have thresholds, decide by `cea`'s `stability::judge`.
    #[inline]
    pub fn of(lambda: Complex<f64>, bound: f64) -> Self {
        if lambda.re > bound {
            Self::Unstable
        } else if lambda.re < -bound {
            Self::Stable
        } else {
            Self::Undecided { bound }
        }
    }
}

/// Eigenvalue with its error bound and the verdict on its motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JudgedEigenvalue {
    /// The eigenvalue, rad/s; of a conjugate pair the one with Im lambda > 0.
    pub lambda: Complex<f64>,
    /// Error bound, rad/s, that |lambda - exact| does not exceed, certified up to rounding; infinite where nothing encloses it.
    pub bound: f64,
    /// Verdict: whether the motion grows.
    pub verdict: Verdict,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sign_counts_where_it_is_beyond_the_bound() {
        let lambda = Complex::new(-3.0, 4.0);
        assert_eq!(Verdict::of(lambda, 1.0), Verdict::Stable);
        assert_eq!(Verdict::of(-lambda, 1.0), Verdict::Unstable);
        assert_eq!(Verdict::of(lambda, 4.0), Verdict::Undecided { bound: 4.0 });
    }
}
