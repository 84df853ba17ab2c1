//! Proportions: how often an event occurs.

use serde::{Deserialize, Serialize};

use crate::confidence::{Confidence, Interval};
use crate::error::MonteCarloError;
use crate::experiment::{Experiment, Runs, Tally};
use crate::merge::Merge;

/// Wilson's score interval for a proportion, from `hits` in `trials`:
///
/// ```text
/// (p + z^2/2n -+ z sqrt(p (1 - p)/n + z^2/4n^2)) / (1 + z^2/n)
/// ```
///
/// E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209. It is `[0, 1]` without trials, begins at exactly 0 without hits and
/// ends at exactly 1 with hits only.
///
/// # Errors
/// More hits than trials.
///
/// ```
/// use montecarlo::{Confidence, wilson};
/// let interval = wilson(920, 1_000, Confidence::P95)?;
/// assert!(interval.lower > 0.90 && interval.upper < 0.94);
/// # Ok::<(), montecarlo::MonteCarloError>(())
/// ```
pub fn wilson(hits: u64, trials: u64, confidence: Confidence) -> Result<Interval, MonteCarloError> {
    if hits > trials {
        return Err(MonteCarloError::Hits { hits, trials });
    }
    Ok(score_interval(hits, trials, confidence))
}

fn score_interval(hits: u64, trials: u64, confidence: Confidence) -> Interval {
    if trials == 0 {
        return Interval { lower: 0.0, upper: 1.0 };
    }
    let n = trials as f64;
    let p = hits as f64 / n;
    let z2_n = confidence.z().powi(2) / n;
    let centre = p + z2_n / 2.0;
    let half_width = (z2_n * (p * (1.0 - p) + z2_n / 4.0)).sqrt();
    // Without hits, and with hits only, the formula gives 0 and 1 up to rounding.
    Interval {
        lower: if hits == 0 { 0.0 } else { (centre - half_width) / (1.0 + z2_n) },
        upper: if hits == trials { 1.0 } else { (centre + half_width) / (1.0 + z2_n) },
    }
}

/// Number of trials that brings both limits of [`clopper_pearson`](crate::clopper_pearson) within h of a proportion near p, nearly.
/// Wilson's limits of p are the solutions P of `(P - p)^2 = z^2 P (1 - P) / n`, so that they take
///
/// ```text
/// n = (z / h)^2 max(q(p - h), q(p + h)),    q(P) = P (1 - P), 0 outside of 0 to 1
/// ```
///
/// and the limits of Clopper and Pearson 1 / h more. Where p is 0 or 1 it is `ln(tail) / ln(1 - h)`, exactly. h has to be above 0 and below 1, which is not
/// checked.
///
/// ```
/// use montecarlo::{Confidence, trials_for_half_width};
/// assert_eq!(trials_for_half_width(0.5, 0.01, Confidence::P95).ceil(), 9_700.0);
/// assert_eq!(trials_for_half_width(0.0, 0.01, Confidence::P95).ceil(), 368.0);
/// ```
#[must_use]
pub fn trials_for_half_width(p: f64, half_width: f64, confidence: Confidence) -> f64 {
    let at_the_edge = confidence.tail().ln() / (-half_width).ln_1p();
    if p <= 0.0 || p >= 1.0 {
        return at_the_edge;
    }
    let spread = [p - half_width, p + half_width].map(|limit| (limit * (1.0 - limit)).max(0.0));
    let inside = (confidence.z() / half_width).powi(2) * spread[0].max(spread[1]) + 1.0 / half_width;
    inside.max(at_the_edge)
}

/// Outcome of one trial: whether the event occurred.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trial {
    /// The event occurred.
    Yes,
    /// The event did not occur.
    No,
    /// The trial does not tell whether the event occurred.
    Ambiguous,
}

/// Counts of the trials in which an event occurs. Ambiguous trials widen estimate and interval: they are no hits for the lower
/// limit and hits for the upper one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Proportion {
    hits: u64,
    ambiguous: u64,
    trials: u64,
}

impl Proportion {
    /// A proportion from counts; no trial is counted both as a certain and as an ambiguous hit, and hits beyond the number of trials are left out.
    #[must_use]
    pub fn of_counts(hits: u64, ambiguous: u64, trials: u64) -> Self {
        let hits = hits.min(trials);
        Self { hits, ambiguous: ambiguous.min(trials - hits), trials }
    }

    /// A copy with more trials of which nothing is known, such as failed trials: they are ambiguous.
    #[must_use]
    pub fn and_unknown(self, trials: u64) -> Self {
        Self { ambiguous: self.ambiguous + trials, trials: self.trials + trials, ..self }
    }

    /// Enters one trial.
    pub fn record(&mut self, trial: Trial) {
        self.trials += 1;
        match trial {
            Trial::Yes => self.hits += 1,
            Trial::No => {}
            Trial::Ambiguous => self.ambiguous += 1,
        }
    }

    /// Number of trials in which the event occurred for certain.
    #[must_use]
    pub fn hits(&self) -> u64 {
        self.hits
    }

    /// Number of ambiguous trials.
    #[must_use]
    pub fn ambiguous(&self) -> u64 {
        self.ambiguous
    }

    /// Number of trials.
    #[must_use]
    pub fn trials(&self) -> u64 {
        self.trials
    }

    /// The proportion of hits: the lower limit without the ambiguous trials, the upper one with them as hits. `None` without
    /// trials.
    #[must_use]
    pub fn estimate(&self) -> Option<Interval> {
        let of_trials = |hits: u64| hits as f64 / self.trials as f64;
        (self.trials > 0)
            .then(|| Interval { lower: of_trials(self.hits), upper: of_trials(self.hits + self.ambiguous) })
    }

    /// A confidence interval for the probability: the lower limit of [`wilson`] from the certain hits, the upper one with
    /// the ambiguous trials counted as hits.
    #[must_use]
    pub fn interval(&self, confidence: Confidence) -> Interval {
        Interval {
            lower: score_interval(self.hits, self.trials, confidence).lower,
            upper: score_interval(self.hits + self.ambiguous, self.trials, confidence).upper,
        }
    }
}

impl Merge for Proportion {
    fn merge(&mut self, later: Self) {
        self.hits += later.hits;
        self.ambiguous += later.ambiguous;
        self.trials += later.trials;
    }
}

/// Proportions, one per scene, over the samples that were evaluated in it.
impl<S: Experiment<Outcome = Trial>> Tally<S> for Vec<Proportion> {
    fn record(&mut self, runs: &Runs<'_, S>) {
        self.resize(runs.results.len(), Proportion::default());
        for (proportion, result) in self.iter_mut().zip(runs.results) {
            if let Ok(trial) = result {
                proportion.record(*trial);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::stream;
    use approx::assert_abs_diff_eq;
    use proptest::prelude::*;
    use rand::RngExt;

    #[test]
    fn wilson_gives_the_published_limits() {
        // R. G. Newcombe, Stat. Med. 17 (1998) 857, table I, method 3 (score, no continuity correction).
        for (hits, trials, lower, upper) in
            [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)]
        {
            let interval = wilson(hits, trials, Confidence::P95).unwrap();
            assert_abs_diff_eq!(interval.lower, lower, epsilon = 5e-5);
            assert_abs_diff_eq!(interval.upper, upper, epsilon = 5e-5);
        }
        assert_eq!(wilson(29, 29, Confidence::P95).unwrap().upper, 1.0);
        assert_eq!(wilson(0, 0, Confidence::P95).unwrap(), Interval { lower: 0.0, upper: 1.0 });
        assert!(matches!(wilson(3, 2, Confidence::P95), Err(MonteCarloError::Hits { hits: 3, trials: 2 })));
    }

    #[test]
    fn ninety_five_percent_of_the_intervals_cover_the_true_proportion() {
        let (experiments, trials, p) = (4_000, 100, 0.3);
        let mut covered = 0;
        for experiment in 0..experiments {
            let mut rng = stream(7, experiment);
            let mut counts = Proportion::default();
            for _ in 0..trials {
                counts.record(if rng.random_bool(p) { Trial::Yes } else { Trial::No });
            }
            covered += u64::from(counts.interval(Confidence::P95).contains(p));
        }
        // The exact coverage at n = 100, p = 0.3 is 0.9372 (sum of the binomial probabilities of k = 22..=38).
        assert_abs_diff_eq!(covered as f64 / experiments as f64, 0.9372, epsilon = 0.012);
    }

    #[test]
    fn ambiguous_trials_widen_the_interval_and_the_estimate() {
        let counts = |hits, ambiguous, misses| Proportion { hits, ambiguous, trials: hits + ambiguous + misses };
        let sure = counts(40, 0, 60);
        let unsure = counts(40, 10, 50);
        assert_eq!(sure.estimate(), Some(Interval { lower: 0.4, upper: 0.4 }));
        assert_eq!(unsure.estimate(), Some(Interval { lower: 0.4, upper: 0.5 }));
        let interval = unsure.interval(Confidence::P95);
        assert_eq!(interval.lower, wilson(40, 100, Confidence::P95).unwrap().lower);
        assert_eq!(interval.upper, wilson(50, 100, Confidence::P95).unwrap().upper);
        assert_eq!(Proportion::default().estimate(), None);
    }

    #[test]
    fn lists_merge_element_by_element_and_keep_the_rest_of_the_longer() {
        let of =
            |hits: &[u64]| hits.iter().map(|&hits| Proportion { hits, ambiguous: 0, trials: 9 }).collect::<Vec<_>>();
        let merged = |a: &[u64], b: &[u64]| {
            let mut merged = of(a);
            merged.merge(of(b));
            merged.iter().map(|p| (p.hits, p.trials)).collect::<Vec<_>>()
        };
        assert_eq!(merged(&[1, 2], &[3, 4]), [(4, 18), (6, 18)]);
        assert_eq!(merged(&[], &[3, 4]), [(3, 9), (4, 9)]);
        assert_eq!(merged(&[1, 2], &[3]), [(4, 18), (2, 9)]);
    }

    proptest! {
        #[test]
        fn wilson_lies_in_the_unit_interval_around_the_estimate(trials in 1u64..100_000, share in 0.0f64..=1.0) {
            let hits = (share * trials as f64) as u64;
            let interval = wilson(hits, trials, Confidence::P95).unwrap();
            prop_assert!(0.0 <= interval.lower && interval.upper <= 1.0);
            prop_assert!(interval.contains(hits as f64 / trials as f64));
            let mirrored = wilson(trials - hits, trials, Confidence::P95).unwrap();
            prop_assert!((interval.lower + mirrored.upper - 1.0).abs() < 1e-12);
        }
    }
}
