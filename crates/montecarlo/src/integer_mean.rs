//! The mean of integers, without rounding in the sums.

use serde::{Deserialize, Serialize};

use crate::confidence::{Confidence, Interval};
use crate::merge::Merge;

/// Count, sum and sum of squares of integers. They are exact, so that neither the order nor the grouping in which values are entered matters. For a mean
/// over several scenes enter, of each sample, the sum over its scenes, and divide the mean by their number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct IntegerMean {
    count: u64,
    sum: i128,
    sum_of_squares: u128,
}

impl IntegerMean {
    /// Enters one value.
    pub fn record(&mut self, value: i32) {
        self.count += 1;
        self.sum += i128::from(value);
        self.sum_of_squares += u128::from(value.unsigned_abs()).pow(2);
    }

    /// Enters one value `times` times.
    pub(crate) fn record_times(&mut self, value: i32, times: u64) {
        self.count += times;
        self.sum += i128::from(value) * i128::from(times);
        self.sum_of_squares += u128::from(value.unsigned_abs()).pow(2) * u128::from(times);
    }

    /// Number of values.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The exact sum of the values.
    #[must_use]
    pub fn sum(&self) -> i128 {
        self.sum
    }

    /// The mean of the values; `None` without values.
    #[must_use]
    pub fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum as f64 / self.count as f64)
    }

    /// The unbiased sample variance; `None` with fewer than two values.
    ///
    /// Let n be the number of values, q and r the quotient and the remainder of their sum by n (q is about the mean), and `S = sum (x - q)^2`. The squared
    /// deviations from the mean then sum to `S - r^2 / n = (S - r) + r (n - r) / n`. `S - r` and `r (n - r)` are integers and both are >= 0, so that no
    /// digits cancel.
    #[must_use]
    pub fn variance(&self) -> Option<f64> {
        if self.count < 2 {
            return None;
        }
        let n = i128::from(self.count);
        let (q, r) = (self.sum.div_euclid(n), self.sum.rem_euclid(n));
        // S = sum x^2 - 2 q sum x + n q^2, with sum x = n q + r. No overflow: |x| <= 2^31 and n < 2^64 keep each term below 2^127.
        let about_q = self.sum_of_squares as i128 - q * self.sum - q * r;
        let squares = (about_q - r) as f64 + (r * (n - r)) as f64 / n as f64;
        Some(squares / (n - 1) as f64)
    }

    /// A confidence interval for the expectation: `mean -+ t sqrt(variance / n)` with Student's t of `n - 1` degrees of
    /// freedom. `None` with fewer than two values.
    #[must_use]
    pub fn interval(&self, confidence: Confidence) -> Option<Interval> {
        let mean = self.mean()?;
        let error = (self.variance()? / self.count as f64).sqrt();
        let half_width = confidence.t(self.count - 1) * error;
        Some(Interval { lower: mean - half_width, upper: mean + half_width })
    }
}

impl Merge for IntegerMean {
    fn merge(&mut self, later: Self) {
        self.count += later.count;
        self.sum += later.sum;
        self.sum_of_squares += later.sum_of_squares;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    fn of(values: &[i32]) -> IntegerMean {
        let mut mean = IntegerMean::default();
        values.iter().for_each(|&value| mean.record(value));
        mean
    }

    #[test]
    fn interval_is_that_of_the_textbook() {
        // 1..=5: mean 3, variance 5/2, t_{0.975, 4} = 2.776445 (Abramowitz and Stegun, table 26.10: 2.776).
        let interval = of(&[1, 2, 3, 4, 5]).interval(Confidence::P95).unwrap();
        assert_relative_eq!(interval.upper, 3.0 + 2.776_445 * 0.5f64.sqrt(), max_relative = 1e-6);
        assert_relative_eq!(interval.lower + interval.upper, 6.0, max_relative = 1e-15);
    }

    #[test]
    fn too_few_values_have_no_interval() {
        assert_eq!(of(&[]).mean(), None);
        assert_eq!((of(&[7]).mean(), of(&[7]).interval(Confidence::P95)), (Some(7.0), None));
    }

    #[test]
    fn large_offsets_do_not_cancel() {
        let values = [i32::MAX - 2, i32::MAX - 1, i32::MAX];
        assert_relative_eq!(of(&values).variance().unwrap(), 1.0, max_relative = 1e-15);
        assert_eq!(of(&[i32::MIN; 9]).variance(), Some(0.0));
    }

    proptest! {
        #[test]
        fn variance_is_that_of_two_passes_and_halves_merge(values in prop::collection::vec(-1000i32..1000, 2..50), cut in 0usize..50) {
            let n = values.len() as f64;
            let average = values.iter().map(|&v| f64::from(v)).sum::<f64>() / n;
            let two_pass = values.iter().map(|&v| (f64::from(v) - average).powi(2)).sum::<f64>() / (n - 1.0);
            let whole = of(&values);
            prop_assert!((whole.variance().unwrap() - two_pass).abs() <= 1e-12 * (1.0 + two_pass));
            let (early, late) = values.split_at(cut.min(values.len()));
            let mut merged = of(early);
            merged.merge(of(late));
            prop_assert_eq!(merged, whole);
        }
    }
}
