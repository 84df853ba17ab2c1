//! Distribution functions and quantiles of the uncertain parameters.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::case::Distribution;

/// Probability that may be cut off at either end of a support.
const TAIL: f64 = 1e-12;

/// P(X <= x).
pub fn cumulative(distribution: Distribution, x: f64) -> f64 {
    let normal = Normal::standard();
    match distribution {
        Distribution::Constant { value } => f64::from(x >= value),
        Distribution::Normal { mean, deviation, at_least } => {
            let z = |x: f64| (x - mean) / deviation;
            // Tails by the survival function, which does not cancel above the mean.
            let kept = normal.sf(z(at_least));
            if x <= at_least { 0.0 } else { 1.0 - normal.sf(z(x)) / kept }
        }
        Distribution::LogNormal { median, sigma } => {
            if x <= 0.0 {
                0.0
            } else {
                normal.cdf((x / median).ln() / sigma)
            }
        }
        Distribution::Uniform { from, to } => {
            if to > from {
                ((x - from) / (to - from)).clamp(0.0, 1.0)
            } else {
                f64::from(x >= from)
            }
        }
    }
}

/// The value below which the part `u` of the probability lies, 0 < u < 1.
pub fn quantile(distribution: Distribution, u: f64) -> f64 {
    let normal = Normal::standard();
    match distribution {
        Distribution::Constant { value } => value,
        Distribution::Normal { mean, deviation, at_least } => {
            let below = normal.cdf((at_least - mean) / deviation);
            (mean + deviation * normal.inverse_cdf(below + u * (1.0 - below))).max(at_least)
        }
        Distribution::LogNormal { median, sigma } => median * (sigma * normal.inverse_cdf(u)).exp(),
        Distribution::Uniform { from, to } => from + (to - from) * u,
    }
}

/// The interval outside of which less than 2e-12 of the probability lies.
pub fn support(distribution: Distribution) -> (f64, f64) {
    // Far out the quantile is exact in z, not in u.
    let z = -Normal::standard().inverse_cdf(TAIL);
    match distribution {
        Distribution::Constant { value } => (value, value),
        Distribution::Normal { mean, deviation, at_least } => {
            ((mean - z * deviation).max(at_least), mean + z * deviation)
        }
        Distribution::LogNormal { median, sigma } => (median * (-z * sigma).exp(), median * (z * sigma).exp()),
        Distribution::Uniform { from, to } => (from, to),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn one_of_each() -> [Distribution; 3] {
        [
            Distribution::Normal { mean: 0.5, deviation: 0.1, at_least: 0.45 },
            Distribution::LogNormal { median: 1.5, sigma: 0.25 },
            Distribution::Uniform { from: 2.0, to: 5.0 },
        ]
    }

    proptest! {
        #[test]
        fn the_quantile_inverts_the_distribution_function(u in 1e-6..0.999_999_f64) {
            for distribution in one_of_each() {
                prop_assert!((cumulative(distribution, quantile(distribution, u)) - u).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn the_support_holds_nearly_all_of_it() {
        for distribution in one_of_each() {
            let (from, to) = support(distribution);
            assert!(cumulative(distribution, from) < 2.0 * TAIL && 1.0 - cumulative(distribution, to) < 2.0 * TAIL);
        }
    }
}
