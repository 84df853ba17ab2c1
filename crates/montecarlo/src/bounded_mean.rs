//! The mean of integers that have bounds, with limits that are honest where there are few of them.

use serde::{Deserialize, Serialize};

use crate::clopper_pearson::{exact_lower_limit, exact_upper_limit};
use crate::confidence::{Confidence, Interval};
use crate::integer_mean::IntegerMean;
use crate::merge::Merge;

/// Bounds of an integer, for [`BoundedMean::interval`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Least value that is possible.
    pub least: f64,
    /// Greatest value that is possible.
    pub greatest: f64,
    /// Largest distance of a value that was not seen beyond the values that were seen, where at least one of these was not zero.
    pub step: f64,
    /// Least and greatest value that was not seen, where all that were seen are zero.
    pub unseen: [f64; 2],
}

impl Bounds {
    /// Bounds of a count, 0 to `greatest`, of which nothing else is known.
    #[must_use]
    pub fn of_count(greatest: f64, step: f64) -> Self {
        Self { least: 0.0, greatest, step, unseen: [0.0, greatest] }
    }
}

/// Count, sum and sum of squares of integers, the number of integers that are not zero, and the extremes. All are kept exactly, as by
/// [`IntegerMean`].
///
/// Student's interval knows of no value that was not among those entered: of five zeros it is (0 to 0), of one value everything.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct BoundedMean {
    values: IntegerMean,
    nonzero: u64,
    /// Least value; 0 where none is below.
    least: i32,
    /// Greatest value; 0 where none is above.
    greatest: i32,
}

impl BoundedMean {
    /// Enters one value.
    pub fn record(&mut self, value: i32) {
        self.values.record(value);
        self.nonzero += u64::from(value != 0);
        self.least = self.least.min(value);
        self.greatest = self.greatest.max(value);
    }

    /// A copy with one more value, entered `times` times.
    #[must_use]
    pub fn and(mut self, value: i32, times: u64) -> Self {
        if times > 0 {
            self.record(value);
            self.values.record_times(value, times - 1);
            self.nonzero += (times - 1) * u64::from(value != 0);
        }
        self
    }

    /// Count, sum and sum of squares alone.
    #[must_use]
    pub fn values(&self) -> &IntegerMean {
        &self.values
    }

    /// Number of values.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.values.count()
    }

    /// Number of values that are not zero.
    #[must_use]
    pub fn nonzero(&self) -> u64 {
        self.nonzero
    }

    /// The mean of the values; `None` without values.
    #[must_use]
    pub fn mean(&self) -> Option<f64> {
        self.values.mean()
    }

    /// Least and greatest value that one more may have.
    pub(crate) fn one_more(&self, Bounds { least, greatest, step, unseen }: Bounds) -> [f64; 2] {
        match self.nonzero {
            0 => unseen,
            _ => {
                let [low, high] = [self.least.min(0), self.greatest.max(0)].map(f64::from);
                [(low - step).max(least), (high + step).min(greatest)]
            }
        }
    }

    /// A confidence interval for the expectation, within the bounds; without values the bounds. The widest of three intervals at each end:
    ///
    /// - Student's, [`IntegerMean::interval`];
    /// - for what is rare: the limit of Clopper and Pearson of the fraction p of values that are not zero, times the mean of these values
    ///   and of one value more, which lies `step` beyond the extreme seen, at `unseen` where all values are zero;
    /// - where all values are equal: `mean + q (x - mean)`, in which x is that value more and q the limit of the part that was not
    ///   seen, `1 - tail^(1/n)`.
    ///
    /// It covers the expectation in 92 % of the samples or more for every count of unstable modes that was tried (one in 500 to 99 in
    /// 100 samples unstable, one to three modes each, 1 to 1,000 samples) and falls below that for values that are rare and far
    /// beyond all others. `docs/uncertainty.md` has the numbers.
    #[must_use]
    pub fn interval(&self, bounds: Bounds, confidence: Confidence) -> Interval {
        let Bounds { least, greatest, .. } = bounds;
        let (count, tail) = (self.count(), confidence.tail());
        let Some(mean) = self.mean() else { return Interval { lower: least, upper: greatest } };
        let student = self.values.interval(confidence);
        let student = student.unwrap_or(Interval { lower: f64::NEG_INFINITY, upper: f64::INFINITY });
        let [low, high] = self.one_more(bounds);
        let (nonzero, sum) = (self.nonzero, self.values.sum() as f64);
        let of_nonzero = [low, high].map(|one_more| (sum + one_more) / (nonzero + 1) as f64);
        let (rarely, often) = (exact_lower_limit(nonzero, count, tail), exact_upper_limit(nonzero, count, tail));
        let times = |mean: f64, is_upper: bool| mean * if (mean > 0.0) == is_upper { often } else { rarely };
        let never_varied = self.values.variance().is_none_or(|variance| variance == 0.0);
        let unseen = if never_varied { exact_upper_limit(0, count, tail) } else { 0.0 };
        let lower = student.lower.min(times(of_nonzero[0], false)).min(mean - unseen * (mean - low));
        let upper = student.upper.max(times(of_nonzero[1], true)).max(mean + unseen * (high - mean));
        Interval { lower: lower.clamp(least, greatest), upper: upper.clamp(least, greatest) }
    }
}

impl Merge for BoundedMean {
    fn merge(&mut self, later: Self) {
        self.values.merge(later.values);
        self.nonzero += later.nonzero;
        self.least = self.least.min(later.least);
        self.greatest = self.greatest.max(later.greatest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::stream;
    use approx::assert_relative_eq;
    use rand::RngExt;

    /// Bounds of a number of unstable modes: 0 to `greatest`.
    fn counts(greatest: f64) -> Bounds {
        Bounds::of_count(greatest, 1.0)
    }

    fn of(values: &[i32]) -> BoundedMean {
        let mut mean = BoundedMean::default();
        values.iter().for_each(|&value| mean.record(value));
        mean
    }

    #[test]
    fn few_values_leave_much_open() {
        let limits = |values: &[i32], greatest| of(values).interval(counts(greatest), Confidence::P95);
        assert_eq!(limits(&[], 20.0), Interval { lower: 0.0, upper: 20.0 });
        assert_eq!(limits(&[0], 20.0), Interval { lower: 0.0, upper: 20.0 });
        assert_eq!(limits(&[3], 20.0), Interval { lower: 0.0, upper: 20.0 });
        // 0 of 5: at most 52.2 % (Clopper and Pearson), of a yes or no and of twenty modes.
        assert_relative_eq!(limits(&[0; 5], 1.0).upper, 0.521_824, epsilon = 1e-6);
        assert_relative_eq!(limits(&[0; 5], 20.0).upper, 20.0 * 0.521_824, epsilon = 1e-5);
        let difference = Bounds { least: -2.0, greatest: 2.0, step: 1.0, unseen: [-2.0, 2.0] };
        let none = of(&[0; 5]).interval(difference, Confidence::P95);
        assert_relative_eq!(none.upper, 2.0 * 0.521_824, epsilon = 1e-5);
        assert_eq!(none.lower, -none.upper);
    }

    #[test]
    fn many_values_have_students_interval() {
        let values: Vec<i32> = (0..2_000).map(|i| i % 4).collect();
        let (found, student) = (
            of(&values).interval(counts(30.0), Confidence::P95),
            of(&values).values().interval(Confidence::P95).unwrap(),
        );
        assert_eq!(found, student);
    }

    #[test]
    fn values_entered_at_once_are_those_entered_one_by_one_and_halves_merge() {
        let mut merged = of(&[0, -2]);
        merged.merge(of(&[5, 0, 5, 5]));
        assert_eq!(merged, of(&[0, -2, 5, 0, 5, 5]));
        assert_eq!(of(&[0, -2, 0]).and(5, 3), of(&[0, -2, 0, 5, 5, 5]));
        assert_eq!(of(&[1]).and(5, 0), of(&[1]));
    }

    #[test]
    fn ninety_two_percent_of_the_intervals_or_more_cover_the_expectation_of_rare_and_of_common_counts() {
        // Probabilities of one, two and three unstable modes where there is any, and of any.
        let shapes: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.6, 0.3, 0.1]];
        let experiments = 400;
        for (shape, any) in shapes.into_iter().flat_map(|s| [0.002, 0.05, 0.1761, 0.5867, 0.99].map(|any| (s, any))) {
            let expectation = any * (shape[0] + 2.0 * shape[1] + 3.0 * shape[2]);
            for count in [1, 2, 5, 20, 100] {
                let covers = |experiment: u64| {
                    let (mut rng, mut mean) = (stream(11, experiment), BoundedMean::default());
                    for _ in 0..count {
                        let (is_any, which): (f64, f64) = (rng.random(), rng.random());
                        let modes = 1 + i32::from(which > shape[0]) + i32::from(which > shape[0] + shape[1]);
                        mean.record(if is_any < any { modes } else { 0 });
                    }
                    let limits = mean.interval(counts(20.0), Confidence::P95);
                    assert!(0.0 <= limits.lower && limits.upper <= 20.0 && limits.lower <= limits.upper);
                    limits.contains(expectation)
                };
                let covered = (0..experiments).filter(|&experiment| covers(experiment)).count();
                // 92 % less three deviations of so many experiments.
                assert!(covered >= 352, "{shape:?} in {any}, {count} samples: {covered} of {experiments}");
            }
        }
    }
}
