//! Differences of two proportions: of the same samples, of others, and of samples that may depend on each other in any way.

use crate::confidence::{Confidence, Interval};
use crate::proportion::{Proportion, Trial};

/// The difference of two proportions, the second less the first, with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Difference of the certain hits; `None` where either proportion has no trials.
    pub value: Option<f64>,
    /// Interval of the difference: from the lowest to the highest that ambiguous trials leave.
    pub interval: Interval,
}

/// Occurrences of an event in pairs of trials, as of one draw in two studies; pairs are independent of each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PairedTrials {
    /// Pairs by the first and the second trial: no, ambiguous, yes.
    counts: [[u64; 3]; 3],
}

impl PairedTrials {
    /// Enters a pair.
    pub fn record(&mut self, first: Trial, second: Trial) {
        let place = |trial| match trial {
            Trial::No => 0,
            Trial::Ambiguous => 1,
            Trial::Yes => 2,
        };
        self.counts[place(first)][place(second)] += 1;
    }

    /// The first and the second trials by themselves.
    #[must_use]
    pub fn proportions(&self) -> [Proportion; 2] {
        let sum = |of: &dyn Fn(usize, usize) -> bool| self.sum(of);
        let trials = sum(&|_, _| true);
        [
            Proportion::of_counts(sum(&|first, _| first == 2), sum(&|first, _| first == 1), trials),
            Proportion::of_counts(sum(&|_, second| second == 2), sum(&|_, second| second == 1), trials),
        ]
    }

    fn sum(&self, of: &dyn Fn(usize, usize) -> bool) -> u64 {
        let all = self
            .counts
            .iter()
            .enumerate()
            .flat_map(|(first, row)| row.iter().enumerate().map(move |(s, n)| (first, s, n)));
        all.filter(|(first, second, _)| of(*first, *second)).map(|(_, _, count)| count).sum()
    }

    /// The difference with the adjusted interval of Bonett and Price. With b pairs in which the second trial alone is a hit, c in which the
    /// first alone is, and n in all:
    ///
    /// ```text
    /// p = (b + 1) / (n + 2),    q = (c + 1) / (n + 2),    p - q -+ z sqrt((p + q - (p - q)^2) / (n + 2)),    within -1 to 1
    /// ```
    ///
    /// D. G. Bonett, R. M. Price, J. Educ. Behav. Stat. 37 (2012) 479. Ambiguous trials count for the lower limit as hits of the first alone,
    /// where they can be, and for the upper one as hits of the second.
    #[must_use]
    pub fn difference(&self, confidence: Confidence) -> Difference {
        let trials = self.sum(&|_, _| true);
        let limits = |least_first: usize, least_second: usize| {
            let second_alone = self.sum(&|first, second| first < least_first && second >= least_second);
            let first_alone = self.sum(&|first, second| first >= least_first && second < least_second);
            let n = trials as f64 + 2.0;
            let (p, q) = ((second_alone as f64 + 1.0) / n, (first_alone as f64 + 1.0) / n);
            let half_width = confidence.z() * ((p + q - (p - q).powi(2)) / n).sqrt();
            Interval { lower: (p - q - half_width).max(-1.0), upper: (p - q + half_width).min(1.0) }
        };
        // A trial is a hit from ambiguous on (1), or when it is certain (2).
        let interval = Interval { lower: limits(1, 2).lower, upper: limits(2, 1).upper };
        Difference { value: value(&self.proportions()), interval }
    }
}

/// The difference of the proportions of independent samples, with Newcombe's interval. With Wilson's limits l and u of each:
///
/// ```text
/// d = p_2 - p_1,    d - sqrt((p_2 - l_2)^2 + (u_1 - p_1)^2)    to    d + sqrt((u_2 - p_2)^2 + (p_1 - l_1)^2)
/// ```
///
/// R. G. Newcombe, Stat. Med. 17 (1998) 873, method 10.
#[must_use]
pub fn independent_difference(first: &Proportion, second: &Proportion, confidence: Confidence) -> Difference {
    let proportions = [*first, *second];
    let [Some(p1), Some(p2)] = proportions.map(|of| of.estimate()) else { return unknown() };
    let [w1, w2] = proportions.map(|of| of.interval(confidence));
    let interval = Interval {
        lower: p2.lower - p1.upper - (p2.lower - w2.lower).hypot(w1.upper - p1.upper),
        upper: p2.upper - p1.lower + (w2.upper - p2.upper).hypot(p1.lower - w1.lower),
    };
    Difference { value: value(&proportions), interval }
}

/// The difference of the proportions of samples that may depend on each other in any way: the limits of each by itself, each missed half
/// as often.
#[must_use]
pub fn dependent_difference(first: &Proportion, second: &Proportion, confidence: Confidence) -> Difference {
    let proportions = [*first, *second];
    let [a, b] = proportions.map(|of| of.interval(confidence.halved()));
    Difference { value: value(&proportions), interval: Interval { lower: b.lower - a.upper, upper: b.upper - a.lower } }
}

fn unknown() -> Difference {
    Difference { value: None, interval: Interval { lower: -1.0, upper: 1.0 } }
}

fn value(proportions: &[Proportion; 2]) -> Option<f64> {
    let [first, second] = proportions.map(|of| of.estimate());
    Some(second?.lower - first?.lower)
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::*;

    fn pairs(counts: [u64; 4]) -> PairedTrials {
        let mut pairs = PairedTrials::default();
        let [both, first, second, none] = counts;
        for (count, a, b) in [
            (both, Trial::Yes, Trial::Yes),
            (first, Trial::Yes, Trial::No),
            (second, Trial::No, Trial::Yes),
            (none, Trial::No, Trial::No),
        ] {
            (0..count).for_each(|_| pairs.record(a, b));
        }
        pairs
    }

    #[test]
    fn independent_differences_have_the_published_limits() {
        // R. G. Newcombe, Stat. Med. 17 (1998) 873, table II, method 10: p_1 - p_2, which is the second less the first here.
        for (second, first, lower, upper) in [
            ((56, 70), (48, 80), 0.0524, 0.3339),
            ((9, 10), (3, 10), 0.1705, 0.8090),
            ((10, 10), (0, 20), 0.6791, 1.0),
            ((0, 10), (0, 20), -0.1611, 0.2775),
        ] {
            let [a, b] = [first, second].map(|(hits, trials)| Proportion::of_counts(hits, 0, trials));
            let Difference { value, interval } = independent_difference(&a, &b, Confidence::P95);
            assert_abs_diff_eq!(interval.lower, lower, epsilon = 5e-5);
            assert_abs_diff_eq!(interval.upper, upper, epsilon = 5e-5);
            let expected = second.0 as f64 / second.1 as f64 - first.0 as f64 / first.1 as f64;
            assert_abs_diff_eq!(value.unwrap(), expected, epsilon = 1e-15);
        }
    }

    /// Probability that the intervals of n independent pairs cover the difference, summed over all outcomes.
    fn coverage(n: u64, p: f64, q: f64) -> f64 {
        let log_factorial: Vec<f64> = (0..=n)
            .scan(0.0, |sum, k| {
                *sum += (k.max(1) as f64).ln();
                Some(*sum)
            })
            .collect();
        let mut covered = 0.0;
        for first in 0..=n {
            for second in 0..=n - first {
                let rest = n - first - second;
                let Interval { lower, upper } = pairs([0, first, second, rest]).difference(Confidence::P95).interval;
                if (lower..=upper).contains(&(q - p)) {
                    let ways = log_factorial[n as usize]
                        - log_factorial[first as usize]
                        - log_factorial[second as usize]
                        - log_factorial[rest as usize];
                    let power = |base: f64, count: u64| if count == 0 { 0.0 } else { count as f64 * base.ln() };
                    covered += (ways + power(p, first) + power(q, second) + power(1.0 - p - q, rest)).exp();
                }
            }
        }
        covered
    }

    #[test]
    fn paired_intervals_cover_as_often_as_they_say() {
        let mut sum = 0.0;
        let cases = [(0.02, 0.02), (0.05, 0.2), (0.3, 0.3), (0.1, 0.6), (0.45, 0.5), (0.01, 0.4), (0.0, 0.1)];
        for (p, q) in cases {
            let found = coverage(40, p, q);
            assert!(found > 0.93, "{p} {q}: {found}");
            sum += found;
        }
        assert!((0.945..0.98).contains(&(sum / cases.len() as f64)), "{sum}");
    }

    #[test]
    fn what_is_open_widens_a_difference_both_ways() {
        let sure = pairs([20, 10, 5, 65]);
        let at = sure.difference(Confidence::P95);
        assert_abs_diff_eq!(at.value.unwrap(), -0.05, epsilon = 1e-15);
        let mut open = sure;
        (0..10).for_each(|_| open.record(Trial::Ambiguous, Trial::Yes));
        let widened = open.difference(Confidence::P95);
        // At best these are hits of the second alone, at worst of both.
        assert_eq!(widened.interval.upper, pairs([20, 10, 15, 65]).difference(Confidence::P95).interval.upper);
        assert_eq!(widened.interval.lower, pairs([30, 10, 5, 65]).difference(Confidence::P95).interval.lower);
        // Pairs that agree tell more than two samples of which nothing is known but their sizes.
        let alike = pairs([50, 1, 2, 47]);
        let [first, second] = alike.proportions();
        let width = |of: Difference| of.interval.upper - of.interval.lower;
        let independent = width(independent_difference(&first, &second, Confidence::P95));
        assert!(width(alike.difference(Confidence::P95)) < independent / 2.0);
        assert!(independent < width(dependent_difference(&first, &second, Confidence::P95)));
        let none = Proportion::default();
        for found in [
            independent_difference(&none, &first, Confidence::P95),
            dependent_difference(&none, &none, Confidence::P95),
        ] {
            assert_eq!(found.value, None);
        }
        assert_eq!(
            independent_difference(&none, &first, Confidence::P95).interval,
            Interval { lower: -1.0, upper: 1.0 }
        );
    }
}
