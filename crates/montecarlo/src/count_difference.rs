//! The difference of two counts of the same samples: no more can drop than is there.

use crate::bounded_mean::{BoundedMean, Bounds};
use crate::confidence::{Confidence, Interval};

/// Counts of the same samples in two cases, `more` and `fewer`, and their differences.
///
/// In a sample with the count a in one case and b in the other, neither below 0, the difference d = a - b lies in -b to a. So the mean of d lies between the
/// means of -b and a, and a difference that was never seen is at most as large as the count of one more sample may be.
#[derive(Debug, Clone, Copy)]
pub struct CountDifference<'a> {
    /// Differences of the samples that were solved in both.
    pub differences: &'a BoundedMean,
    /// Number of the samples that were not.
    pub failed: u64,
    /// Counts from which the others are taken.
    pub more: CountedSide<'a>,
    /// Counts that are taken.
    pub fewer: CountedSide<'a>,
}

/// Counts of the samples in one of two cases.
#[derive(Debug, Clone, Copy)]
pub struct CountedSide<'a> {
    /// Counts of the samples that were solved.
    pub counts: &'a BoundedMean,
    /// Number of the samples that were not.
    pub failed: u64,
    /// Largest count that is possible.
    pub greatest: f64,
    /// Largest distance of a count that was not seen beyond those seen ([`Bounds::step`]).
    pub step: f64,
    /// Number of units of the difference that one is, >= 1.
    pub times: f64,
}

impl CountedSide<'_> {
    fn bounds(&self) -> Bounds {
        Bounds::of_count(self.greatest, self.step)
    }

    /// Upper limit of the mean, in units of the difference; what failed may have the largest count.
    fn upper(&self, confidence: Confidence) -> f64 {
        self.times * self.counts.and(self.greatest as i32, self.failed).interval(self.bounds(), confidence).upper
    }

    /// Largest count that one more sample may have, in units of the difference.
    fn one_more(&self) -> f64 {
        self.times * self.counts.one_more(self.bounds())[1]
    }
}

impl CountDifference<'_> {
    /// A confidence interval for the mean difference: [`BoundedMean::interval`], cut to the limits of the two means. Where all differences were zero, a
    /// difference that was not seen is taken to be no larger than the count that one more sample may have. A sample that failed may have any difference.
    #[must_use]
    pub fn interval(&self, confidence: Confidence) -> Interval {
        let Self { differences, failed, more, fewer } = self;
        let (least, greatest) = (-fewer.times * fewer.greatest, more.times * more.greatest);
        let bounds =
            Bounds { least, greatest, step: more.times * more.step, unseen: [-fewer.one_more(), more.one_more()] };
        let [lower, upper] =
            [least, greatest].map(|of_failed| differences.and(of_failed as i32, *failed).interval(bounds, confidence));
        // Samples that failed in one of the two are in the mean of the other alone.
        let mean = differences.mean();
        let (at_least, at_most) = (mean.unwrap_or(f64::INFINITY), mean.unwrap_or(f64::NEG_INFINITY));
        Interval {
            lower: lower.lower.max(-fewer.upper(confidence)).min(at_least),
            upper: upper.upper.min(more.upper(confidence)).max(at_most),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::stream;
    use rand::RngExt;

    fn of(values: impl IntoIterator<Item = i32>) -> BoundedMean {
        let mut mean = BoundedMean::default();
        values.into_iter().for_each(|value| mean.record(value));
        mean
    }

    /// The interval of pairs of counts of at most 60.
    fn interval(pairs: &[[i32; 2]], failed: u64) -> Interval {
        let [more, fewer] = [0, 1].map(|at| of(pairs.iter().map(|pair| pair[at])));
        let side = |counts| CountedSide { counts, failed, greatest: 60.0, step: 1.0, times: 1.0 };
        let differences = of(pairs.iter().map(|[a, b]| a - b));
        CountDifference { differences: &differences, failed, more: side(&more), fewer: side(&fewer) }
            .interval(Confidence::P95)
    }

    #[test]
    fn no_more_can_drop_than_there_is() {
        let pairs: Vec<[i32; 2]> = (0..40).map(|at| [4 + at % 3; 2]).collect();
        let found = interval(&pairs, 0);
        // 1 - 0.025^(1/40) = 8.8 % of the samples may be of those that were not seen, of 7 unstable modes at most.
        assert!((found.upper - 7.0 * 0.088_1).abs() < 1e-3 && found.lower == -found.upper, "{found:?}");
        // Of two samples Student's limits alone are far beyond what is there.
        let found = interval(&[[5, 0], [5, 1]], 0);
        assert!(found.upper <= 6.0 && found.lower >= -60.0, "{found:?}");
        // Nothing was ever unstable: nothing is known of how much may be.
        assert!(interval(&[[0, 0]; 5], 0).upper > 30.0);
        // What failed may be anything, and no difference lies beyond its own limits.
        let found = interval(&pairs[..2], 40);
        assert!(found.lower < -50.0 && found.upper > 50.0, "{found:?}");
        assert_eq!(interval(&[], 3), Interval { lower: -60.0, upper: 60.0 });
    }

    #[test]
    fn ninety_two_percent_of_the_intervals_or_more_cover_the_difference() {
        // Probability that each of six modes is unstable, and that a change takes it away or adds another.
        let cases =
            [(0.8, 0.0, 0.0), (0.8, 0.01, 0.0), (0.8, 0.002, 0.02), (0.1, 0.3, 0.05), (0.5, 0.9, 0.0), (0.9, 0.5, 0.2)];
        let experiments = 400;
        for (unstable, taken, added) in cases {
            for count in [1, 2, 5, 20, 100] {
                let covers = |experiment: u64| {
                    let mut rng = stream(12, experiment);
                    let mut is = |probability: f64| i32::from(rng.random::<f64>() < probability);
                    let mut sample = || {
                        let modes: Vec<[i32; 3]> = (0..6).map(|_| [is(unstable), is(taken), is(added)]).collect();
                        let before = modes.iter().map(|of| of[0]).sum::<i32>();
                        [before, modes.iter().map(|[a, taken, added]| a * (1 - taken) + added).sum()]
                    };
                    let pairs: Vec<[i32; 2]> = (0..count).map(|_| sample()).collect();
                    interval(&pairs, 0).contains(6.0 * (unstable * taken - added))
                };
                let covered = (0..experiments).filter(|&experiment| covers(experiment)).count();
                // 92 % less three deviations of so many experiments.
                assert!(covered >= 352, "{unstable}, {taken}, {added}, {count} samples: {covered} of {experiments}");
            }
        }
    }
}
