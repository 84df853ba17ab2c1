//! A sum of few positive terms, such as the pairs of neighbours in which a rare output is not zero, and the interval of its mean.

use statrs::distribution::{ContinuousCDF, Gamma};

use crate::confidence::{Confidence, Interval};

/// Least effective number of terms, `(sum t)^2 / sum t^2`, of a sum that is normal enough for its standard error; chosen: 100 counts
/// know their mean to 10 %, and the skewness of a Poisson count of 100 is 0.1.
const MANY: f64 = 100.0;

/// Data for the interval of a sum of few positive terms. The number of terms is a matter of chance, and a term that did not come up may
/// be as large as the terms that did, so that a sum without terms says little.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct FewTerms {
    sum: f64,
    squares: f64,
    /// Size that a term may have that did not come up.
    typical: f64,
    /// Number that is subtracted from the sum.
    offset: f64,
}

impl FewTerms {
    /// A sum by its terms, of which most are zero, the size of one that did not come up, and what is subtracted from the sum. `None` where
    /// the terms are many.
    #[must_use]
    pub fn of(terms: impl Iterator<Item = f64>, typical: f64, offset: f64) -> Option<Self> {
        let (sum, squares) = terms.fold((0.0, 0.0), |(sum, squares), t| (sum + t, squares + t * t));
        (sum * sum < MANY * squares || sum == 0.0).then_some(Self { sum, squares, typical, offset })
    }

    /// The interval of the expected sum, less the offset: with weighted Poisson counts, by the gamma distribution (Fay and Feuer, Stat. Med.
    /// 16, 1997), which for equal terms has Garwood's limits. It covers more often than it says; where the terms are few, by far.
    #[must_use]
    pub fn interval(&self, confidence: Confidence) -> Interval {
        let Self { sum, squares, typical, offset } = *self;
        let tail = confidence.tail();
        // A gamma variable of this mean and variance.
        let quantile = |mean: f64, variance: f64, u: f64| match mean > 0.0 && variance > 0.0 {
            true => variance / mean * gamma_quantile(mean * mean / variance, u),
            false => 0.0,
        };
        Interval {
            lower: quantile(sum, squares, tail) - offset,
            upper: quantile(sum + typical, squares + typical * typical, 1.0 - tail) - offset,
        }
    }
}

/// The quantile of the gamma distribution with a shape and rate 1, by bisection of its distribution function: the inversion of statrs is
/// good to five digits only.
fn gamma_quantile(shape: f64, u: f64) -> f64 {
    let Ok(gamma) = Gamma::new(shape, 1.0) else { return 0.0 };
    let (mut below, mut above) = (0.0, shape + 10.0 * shape.sqrt() + 40.0);
    for _ in 0..100 {
        let middle = 0.5 * (below + above);
        if gamma.cdf(middle) < u { below = middle } else { above = middle }
    }
    above
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_terms_have_the_limits_of_a_poisson_count() {
        // Garwood, Biometrika 28, 1936: limits of the mean at 0, 1, 5 and 20 counts, 95 %.
        for (count, lower, upper) in
            [(0, 0.0, 3.688_879), (1, 0.025_318, 5.571_643), (5, 1.623_486, 11.668_332), (20, 12.216_516, 30.888_378)]
        {
            let few = FewTerms::of((0..count).map(|_| 2.0), 2.0, 1.0).unwrap();
            let found = few.interval(Confidence::P95);
            assert!((found.lower - (2.0 * lower - 1.0)).abs() < 1e-5, "{count}: {found:?}");
            assert!((found.upper - (2.0 * upper - 1.0)).abs() < 1e-5, "{count}: {found:?}");
        }
        assert_eq!(FewTerms::of((0..101).map(|_| 2.0), 2.0, 0.0), None);
    }
}
