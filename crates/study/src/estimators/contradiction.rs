//! Contradictions between an estimate of the occurrences of a study and its samples.

use std::collections::BTreeSet;

use montecarlo::{Confidence, Interval, Proportion, exact_lower_limit, exact_upper_limit};
use serde::{Deserialize, Serialize};

use super::{Estimated, Estimator, SceneOccurrences};
use crate::{ModeLabel, SceneTally};

/// The probability at each end with which samples that are all right contradict an estimate that is exact; chosen: in a thousand
/// studies of a thousand scenes about once.
const TAIL: f64 = 0.5e-6;

/// An estimate that was not used, and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rejected {
    /// Estimator of the estimate.
    pub estimator: Estimator,
    /// Contradiction, in words.
    pub because: String,
}

/// Contradiction between the samples of a scene and its estimated occurrences, if any: an occurrence of a mode, or of anything unstable,
/// whose limits in the samples (Clopper and Pearson at 1e-6) have no number in common with the limits of the estimate, widened from 95 % to
/// the same confidence by the ratio of the normal deviations.
pub(super) fn contradiction(found: &SceneOccurrences, own: &SceneTally) -> Option<String> {
    let widened = Confidence::new(1.0 - 2.0 * TAIL).map_or(3.0, |level| level.z() / Confidence::P95.z());
    let estimated = |label: &ModeLabel| match found.modes.get(label) {
        None => Interval { lower: 0.0, upper: widened * found.half_width },
        Some(Estimated { occurrence, limits }) => Interval {
            lower: occurrence.lower - widened * (occurrence.lower - limits.lower),
            upper: occurrence.upper + widened * (limits.upper - occurrence.upper),
        },
    };
    let of_label = |label: &ModeLabel| match *label {
        ModeLabel::DIVERGENCE => own.divergence(),
        ModeLabel::UNNAMED => own.unnamed(),
        label => own.tracked.proportion(&label),
    };
    let seen = own.tracked.proportions().map(|(label, _)| *label);
    let labels: BTreeSet<ModeLabel> =
        seen.chain(found.modes.keys().copied()).chain([ModeLabel::UNNAMED, ModeLabel::DIVERGENCE]).collect();
    for label in &labels {
        let (estimate, proportion) = (estimated(label), of_label(label));
        if are_apart(&estimate, &proportion) {
            let what = if label.is_mode() { format!("mode {label}") } else { label.to_string() };
            return Some(in_words(&what, &estimate, &proportion));
        }
    }
    // Where anything is unstable one of the labels is, listed or not.
    let lower = found.modes.keys().map(|label| estimated(label).lower).fold(0.0, f64::max);
    let listed: f64 = found.modes.keys().map(|label| estimated(label).upper).sum();
    let any = Interval { lower, upper: listed + widened * found.half_width };
    are_apart(&any, &own.any()).then(|| in_words("anything", &any, &own.any()))
}

/// True if the limits of a proportion have no number in common with an interval.
fn are_apart(estimate: &Interval, of: &Proportion) -> bool {
    let (sure, possible, trials) = (of.hits(), of.hits() + of.ambiguous(), of.trials());
    // The lower limit of one hit, 1 - (1 - tail)^(1/n), which a bisection of numbers near 1 does not resolve.
    let of_one = -((-TAIL).ln_1p() / trials.max(1) as f64).exp_m1();
    let lower = exact_lower_limit(sure, trials, TAIL).max(if sure > 0 { of_one } else { 0.0 });
    let upper = exact_upper_limit(possible, trials, TAIL).min(if possible < trials { 1.0 - of_one } else { 1.0 });
    trials > 0 && (estimate.upper < lower || upper < estimate.lower)
}

fn in_words(what: &str, estimate: &Interval, of: &Proportion) -> String {
    let open = if of.ambiguous() > 0 { format!(" to {}", of.hits() + of.ambiguous()) } else { String::new() };
    format!(
        "{what} is unstable in {}{open} of the {} samples of this run, and with {:.3e} to {:.3e} by the estimate",
        of.hits(),
        of.trials(),
        estimate.lower.max(0.0),
        estimate.upper.min(1.0)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimators::OccurrenceBounds;
    use montecarlo::rand::RngExt;
    use montecarlo::{LabelTally, clopper_pearson, stream};

    const MODE: ModeLabel = ModeLabel::new(3);

    fn tally(hits: u64, samples: u64) -> SceneTally {
        let mut tracked = LabelTally::default();
        (0..hits).for_each(|_| tracked.record(&[[MODE]]));
        (hits..samples).for_each(|_| tracked.record::<[ModeLabel; 1]>(&[]));
        SceneTally { solved: samples, any_unstable: hits, tracked, ..SceneTally::default() }
    }

    fn found(mode: Option<[f64; 3]>, half_width: f64) -> SceneOccurrences {
        let estimated = |[lower, value, upper]: [f64; 3]| {
            (
                MODE,
                Estimated {
                    occurrence: OccurrenceBounds { lower: value, upper: value },
                    limits: Interval { lower, upper },
                },
            )
        };
        SceneOccurrences {
            estimator: Estimator::ExactIntegral,
            modes: mode.into_iter().map(estimated).collect(),
            half_width,
            evaluations: 1,
            plain_evaluations: 1,
            rejected: Vec::new(),
        }
    }

    #[test]
    fn an_estimate_of_none_is_contradicted_by_few_samples() {
        let none = found(None, 2e-12);
        assert!(contradiction(&none, &tally(0, 10_000)).is_none());
        let words = contradiction(&none, &tally(1, 10_000)).unwrap();
        assert!(words.contains("mode 3 is unstable in 1 of the 10000 samples"), "{words}");
        let all = found(Some([1.0 - 1e-12, 1.0, 1.0]), 1e-12);
        assert!(contradiction(&all, &tally(9_999, 10_000)).is_some());
        assert!(contradiction(&all, &tally(10_000, 10_000)).is_none());
        // What has no name, and what diverges, is not one of the modes.
        let diverging = SceneTally { diverging: 5, any_unstable: 5, ..tally(0, 100) };
        assert!(contradiction(&none, &diverging).unwrap().starts_with("divergence"));
    }

    #[test]
    fn estimates_that_are_right_are_not_contradicted() {
        for experiment in 0..400 {
            let mut rng = stream(5, experiment);
            let truth = [0.003, 0.3, 0.9][(experiment % 3) as usize];
            let mut draws = |count: u64| (0..count).filter(|_| rng.random_bool(truth)).count() as u64;
            let (by_estimator, own) = (draws(3_000), draws(2_000));
            let limits = clopper_pearson(by_estimator, 3_000, Confidence::P95).unwrap();
            let estimate = found(Some([limits.lower, by_estimator as f64 / 3_000.0, limits.upper]), 0.02);
            assert_eq!(contradiction(&estimate, &tally(own, 2_000)), None);
        }
    }
}
