//! Exact confidence limits of a proportion.

use statrs::function::beta::beta_reg;

use crate::confidence::{Confidence, Interval};
use crate::error::MonteCarloError;

/// Largest relative width of the bracket at the end of the bisection for a limit; chosen, far below the digits of a table.
const LARGEST_BRACKET: f64 = 1e-9;

/// The interval of Clopper and Pearson for a proportion, from `hits` in `trials`. For every proportion it covers with at least
/// the probability asked for; it is wider than [`wilson`](crate::wilson)'s interval, which has that probability on average.
///
/// C. J. Clopper, E. S. Pearson, Biometrika 26 (1934) 404.
///
/// # Errors
/// More hits than trials.
///
/// ```
/// use montecarlo::{Confidence, clopper_pearson};
/// // Nothing in 1,000 trials: a probability of at most 0.37 %.
/// let interval = clopper_pearson(0, 1_000, Confidence::P95)?;
/// assert_eq!(interval.lower, 0.0);
/// assert!((interval.upper - 0.00368).abs() < 1e-5);
/// # Ok::<(), montecarlo::MonteCarloError>(())
/// ```
pub fn clopper_pearson(hits: u64, trials: u64, confidence: Confidence) -> Result<Interval, MonteCarloError> {
    if hits > trials {
        return Err(MonteCarloError::Hits { hits, trials });
    }
    let tail = confidence.tail();
    Ok(Interval { lower: exact_lower_limit(hits, trials, tail), upper: exact_upper_limit(hits, trials, tail) })
}

/// The upper limit alone: the proportion at which at most `hits` in `trials` have the probability `tail`. It is 1 where all
/// trials are hits.
#[must_use]
pub fn exact_upper_limit(hits: u64, trials: u64, tail: f64) -> f64 {
    if hits >= trials {
        return 1.0;
    }
    let (mut low, mut high) = (hits as f64 / trials as f64, 1.0);
    while high - low > LARGEST_BRACKET * high {
        let middle = 0.5 * (low + high);
        // P(more than `hits`).
        if beta_reg(hits as f64 + 1.0, (trials - hits) as f64, middle) < 1.0 - tail {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// The lower limit alone: the proportion at which at least `hits` in `trials` have the probability `tail`. It is 0 without hits; more hits than trials
/// count as `trials` hits. It is known to about 1e-9, absolute: a limit that is smaller has no digits.
#[must_use]
pub fn exact_lower_limit(hits: u64, trials: u64, tail: f64) -> f64 {
    if hits == 0 { 0.0 } else { 1.0 - exact_upper_limit(trials.saturating_sub(hits), trials, tail) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn limits_are_those_of_clopper_and_pearson() {
        // R. G. Newcombe, Stat. Med. 17 (1998) 857, table I, method 5.
        for (hits, trials, lower, upper) in
            [(81, 263, 0.2527, 0.3676), (15, 148, 0.0578, 0.1617), (0, 20, 0.0, 0.1684), (1, 29, 0.0009, 0.1776)]
        {
            let interval = clopper_pearson(hits, trials, Confidence::P95).unwrap();
            assert_abs_diff_eq!(interval.lower, lower, epsilon = 5e-5);
            assert_abs_diff_eq!(interval.upper, upper, epsilon = 5e-5);
        }
        let expected = 1.0 - 0.02_f64.powf(1.0 / 5_000.0);
        assert_abs_diff_eq!(exact_upper_limit(0, 5_000, 0.02), expected, epsilon = 1e-10);
        assert_eq!(exact_upper_limit(7, 7, 0.02), 1.0);
        assert_eq!(clopper_pearson(0, 0, Confidence::P95).unwrap(), Interval { lower: 0.0, upper: 1.0 });
        let refused = clopper_pearson(3, 2, Confidence::P95);
        assert!(matches!(refused, Err(MonteCarloError::Hits { hits: 3, trials: 2 })));
    }

    #[test]
    fn the_limits_keep_their_promise_for_any_probability() {
        // P(upper limit < p), summed over all numbers of hits whose limit is below p.
        let n = 50_u64;
        for p in [0.01, 0.1, 0.37, 0.8] {
            let mut term = (1.0_f64 - p).powi(50);
            let (mut above, mut below) = (0.0, 0.0);
            for k in 0..=n {
                above += if exact_upper_limit(k, n, 0.02) < p { term } else { 0.0 };
                below += if exact_lower_limit(k, n, 0.02) > p { term } else { 0.0 };
                term *= (n - k) as f64 / (k + 1) as f64 * p / (1.0 - p);
            }
            assert!(above <= 0.02 && below <= 0.02, "{p}: {above} {below}");
        }
    }
}
