//! Quantiles, and the numbers that a box plot shows.

use serde::{Deserialize, Serialize};

use crate::error::MonteCarloError;

/// The quantile at probability `p` of values sorted in ascending order: linear interpolation between the order statistics
/// around rank `(n - 1) p` from 0 (type 7 of Hyndman and Fan, Am. Stat. 50 (1996) 361; the default of R and NumPy).
///
/// # Errors
/// No values, or `p` outside [0, 1].
pub fn quantile(sorted: &[f64], p: f64) -> Result<f64, MonteCarloError> {
    let last = sorted.len().checked_sub(1).ok_or(MonteCarloError::Empty { statistic: "a quantile" })?;
    let (rank, fraction) = rank(last as u64, p)?;
    let below = sorted[rank as usize];
    let above = sorted[(rank as usize + 1).min(last)];
    Ok(interpolate(below, above, fraction))
}

/// The number that the fraction `p` of the values, sorted in ascending order, does not exceed: the smallest of them of which that holds (type 1 of Hyndman and
/// Fan, `inverted_cdf` of NumPy). It is a value that occurred, also where many values are equal; between values [`quantile`] interpolates.
///
/// # Errors
/// No values, or `p` outside [0, 1].
pub fn not_exceeded(sorted: &[f64], p: f64) -> Result<f64, MonteCarloError> {
    let rank = rank_not_exceeded(sorted.len() as u64, p)?;
    Ok(sorted[rank as usize])
}

/// The rank, from 0, of the value that the fraction `p` of `count` values does not exceed.
pub(crate) fn rank_not_exceeded(count: u64, p: f64) -> Result<u64, MonteCarloError> {
    if count == 0 {
        return Err(MonteCarloError::Empty { statistic: "a quantile" });
    }
    check_probability(p)?;
    // 0.1 times 30 is 3.0000000000000004: what is above an integer by rounding is that integer.
    let number = (count as f64 * p * (1.0 - 4.0 * f64::EPSILON)).ceil() as u64;
    Ok(number.clamp(1, count) - 1)
}

fn check_probability(p: f64) -> Result<(), MonteCarloError> {
    let refused = MonteCarloError::Probability { name: "the quantile's probability", value: p, range: "in [0, 1]" };
    if (0.0..=1.0).contains(&p) { Ok(()) } else { Err(refused) }
}

/// The rank, from 0, at or below the quantile `p`, and the fraction of the way to the next rank.
pub(crate) fn rank(last: u64, p: f64) -> Result<(u64, f64), MonteCarloError> {
    check_probability(p)?;
    let position = last as f64 * p;
    let rank = (position.floor() as u64).min(last);
    Ok((rank, position - rank as f64))
}

pub(crate) fn interpolate(below: f64, above: f64, fraction: f64) -> f64 {
    // The form below + fraction (above - below) would overflow for huge values of opposite sign.
    if fraction == 0.0 || below == above { below } else { (1.0 - fraction) * below + fraction * above }
}

/// Five numbers and the outliers: Tukey's box plot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BoxStatistics {
    /// Number of values.
    pub count: usize,
    /// The smallest value not more than 1.5 interquartile ranges below the lower quartile, or the lower quartile where every
    /// such value lies above it.
    pub lower_whisker: f64,
    /// The quantile at 1/4.
    pub lower_quartile: f64,
    /// The quantile at 1/2.
    pub median: f64,
    /// The quantile at 3/4.
    pub upper_quartile: f64,
    /// The largest value not more than 1.5 interquartile ranges above the upper quartile, or the upper quartile where every
    /// such value lies below it.
    pub upper_whisker: f64,
    /// The values beyond the whiskers, ascending.
    pub outliers: Vec<f64>,
}

impl BoxStatistics {
    /// The statistics of values in any order. Quartiles are type 7, see [`quantile`].
    ///
    /// # Errors
    /// No values, or one that is not finite.
    ///
    /// ```
    /// let boxed = montecarlo::BoxStatistics::of(&[1.0, 2.0, 3.0, 4.0, 100.0])?;
    /// assert_eq!((boxed.lower_quartile, boxed.median, boxed.upper_quartile), (2.0, 3.0, 4.0));
    /// assert_eq!((boxed.upper_whisker, boxed.outliers), (4.0, vec![100.0]));
    /// # Ok::<(), montecarlo::MonteCarloError>(())
    /// ```
    pub fn of(values: &[f64]) -> Result<Self, MonteCarloError> {
        if values.is_empty() {
            return Err(MonteCarloError::Empty { statistic: "a box plot" });
        }
        if let Some((index, &value)) = values.iter().enumerate().find(|(_, value)| !value.is_finite()) {
            return Err(MonteCarloError::NotFinite { index, value });
        }
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let lower_quartile = quantile(&sorted, 0.25)?;
        let upper_quartile = quantile(&sorted, 0.75)?;
        let reach = 1.5 * (upper_quartile - lower_quartile);
        let inside = |&value: &f64| lower_quartile - reach <= value && value <= upper_quartile + reach;
        let (kept, outliers): (Vec<f64>, Vec<f64>) = sorted.iter().copied().partition(inside);
        Ok(Self {
            count: sorted.len(),
            lower_whisker: kept.first().map_or(lower_quartile, |first| first.min(lower_quartile)),
            lower_quartile,
            median: quantile(&sorted, 0.5)?,
            upper_quartile,
            upper_whisker: kept.last().map_or(upper_quartile, |last| last.max(upper_quartile)),
            outliers,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn quantiles_are_type_seven() {
        // numpy.quantile([1, 4, 9, 16], [0, 0.25, 0.4, 0.5, 0.9, 1]), whose default method is "linear" (type 7).
        let sorted = [1.0, 4.0, 9.0, 16.0];
        for (p, expected) in [(0.0, 1.0), (0.25, 3.25), (0.4, 5.0), (0.5, 6.5), (0.9, 13.9), (1.0, 16.0)] {
            assert!((quantile(&sorted, p).unwrap() - expected).abs() < 1e-14, "{p}");
        }
        assert_eq!(quantile(&[3.0], 0.7).unwrap(), 3.0);
    }

    #[test]
    fn what_is_not_exceeded_is_a_value_that_occurred() {
        // numpy.quantile(values, p, method="inverted_cdf") of NumPy 2; of 0.1 of 30 it says 3, as it does not see the rounding.
        let sorted = [1.0, 4.0, 9.0, 16.0];
        for (p, expected) in [(0.0, 1.0), (0.25, 1.0), (0.26, 4.0), (0.5, 4.0), (0.9, 16.0), (1.0, 16.0)] {
            assert_eq!(not_exceeded(&sorted, p).unwrap(), expected, "{p}");
        }
        let thirty: Vec<f64> = (1..=30).map(f64::from).collect();
        assert_eq!(not_exceeded(&thirty, 0.1).unwrap(), 3.0);
        assert!(matches!(not_exceeded(&[], 0.5), Err(MonteCarloError::Empty { .. })));
        assert!(matches!(not_exceeded(&[1.0], -0.5), Err(MonteCarloError::Probability { .. })));
    }

    #[test]
    fn what_has_no_quantile_is_refused() {
        assert!(matches!(quantile(&[], 0.5), Err(MonteCarloError::Empty { .. })));
        assert!(matches!(quantile(&[1.0], 1.5), Err(MonteCarloError::Probability { .. })));
        assert!(matches!(quantile(&[1.0], f64::NAN), Err(MonteCarloError::Probability { .. })));
        assert!(matches!(BoxStatistics::of(&[]), Err(MonteCarloError::Empty { .. })));
        let refused = BoxStatistics::of(&[1.0, f64::INFINITY]);
        assert!(matches!(refused, Err(MonteCarloError::NotFinite { index: 1, .. })));
    }

    proptest! {
        #[test]
        fn what_is_not_exceeded_is_the_least_of_which_that_holds(mut values in prop::collection::vec(0u8..9, 1..300), percent in 1u32..=100) {
            values.sort_unstable();
            let sorted: Vec<f64> = values.iter().map(|&value| f64::from(value)).collect();
            let found = not_exceeded(&sorted, f64::from(percent) / 100.0).unwrap();
            let up_to = |at: f64| 100 * sorted.iter().filter(|&&value| value <= at).count() >= percent as usize * sorted.len();
            prop_assert!(up_to(found));
            prop_assert!(sorted.iter().filter(|&&value| value < found).all(|&value| !up_to(value)));
        }

        #[test]
        fn the_five_numbers_are_ordered_and_no_value_is_lost(values in prop::collection::vec(-1e3f64..1e3, 1..60)) {
            let boxed = BoxStatistics::of(&values).unwrap();
            let five = [
                boxed.lower_whisker, boxed.lower_quartile, boxed.median, boxed.upper_quartile, boxed.upper_whisker,
            ];
            prop_assert!(five.is_sorted(), "{:?}", five);
            let within = values.iter().filter(|&&v| five[0] <= v && v <= five[4]).count();
            prop_assert_eq!(within + boxed.outliers.len(), values.len());
        }
    }
}
