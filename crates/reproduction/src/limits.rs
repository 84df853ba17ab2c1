//! Limits that hold together: every interval of the scorecard.
//!
//! A claim compares many estimates, and all of them come from the same draws. Each of its K estimates gets limits that fail
//! with a probability of at most 0.05 / K, so with 95 % all K hold at once, however the estimates depend on each other
//! (Bonferroni's inequality). A statistic that does not fall when one of them rises, such as a median over arrangements, a
//! smallest or a largest value, then lies between its value at the lower limits and its value at the upper ones. That is true
//! as well of a largest value that was selected because it is the largest.
//!
//! Limits of occurrences are exact (Clopper and Pearson), limits of medians of net work are order statistics, limits of mean
//! differences are Student's t. All count draws: a draw that is evaluated in many scenes is one trial in each.

use std::cell::RefCell;
use std::collections::HashMap;

use montecarlo::{Confidence, Proportion, QuantileSketch, exact_lower_limit, exact_upper_limit, quantile};
use squeal::results::{ArrangementOccurrence, Estimate};

use crate::Error;
use crate::claims::Holds;

/// The probability that any limit of a claim fails.
const RISK: f64 = 0.05;

/// Way in which claims are judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Judgement {
    /// Simultaneous 95 % limits: a claim holds or fails beyond the sampling error, or it is not determined.
    ByLimits,
    /// Estimated values, as if they were exact. Judgement by them tells which studies are worth more samples, and proves nothing.
    ByValues,
}

/// The limits of one claim.
pub(super) struct Limits {
    /// Confidence of each estimate; `None` where values are taken for exact.
    confidence: Option<Confidence>,
    /// Limits of occurrences computed before, by certain hits, possible hits and trials.
    known: RefCell<HashMap<[u64; 3], [f64; 2]>>,
}

impl Judgement {
    /// The limits of a claim on this number of estimates.
    pub(super) fn of(self, estimates: usize) -> Limits {
        let confidence = match self {
            Self::ByLimits => Confidence::new(1.0 - RISK / estimates.max(1) as f64).ok(),
            Self::ByValues => None,
        };
        Limits { confidence, known: RefCell::default() }
    }
}

impl Limits {
    /// Part of the trials in which something occurs: from those where it surely does to those where it may.
    pub(super) fn occurrence(&self, sure: u64, possible: u64, trials: u64) -> Estimate {
        let value = if trials == 0 { 0.0 } else { sure as f64 / trials as f64 };
        let Some(confidence) = self.confidence else { return Estimate { value, lower: value, upper: value } };
        let tail = confidence.tail();
        let mut known = self.known.borrow_mut();
        let limits = known.entry([sure, possible, trials]);
        let &mut [lower, upper] = limits
            .or_insert_with(|| [exact_lower_limit(sure, trials, tail), exact_upper_limit(possible, trials, tail)]);
        Estimate { value, lower, upper }
    }

    fn of_proportion(&self, proportion: &Proportion) -> Estimate {
        let sure = proportion.hits();
        self.occurrence(sure, sure + proportion.ambiguous(), proportion.trials())
    }

    /// The largest occurrence of any arrangement.
    pub(super) fn largest(&self, occurrences: &[ArrangementOccurrence]) -> Estimate {
        largest(occurrences.iter().map(|occurrence| self.of_proportion(&occurrence.proportion)))
    }

    /// The median over the arrangements of a panel.
    ///
    /// # Errors
    /// A panel without arrangements.
    pub(super) fn median(&self, occurrences: &[ArrangementOccurrence]) -> Result<Estimate, Error> {
        let estimates: Vec<Estimate> =
            occurrences.iter().map(|occurrence| self.of_proportion(&occurrence.proportion)).collect();
        let median = |of: fn(&Estimate) -> f64| {
            let mut values: Vec<f64> = estimates.iter().map(of).collect();
            values.sort_by(f64::total_cmp);
            quantile(&values, 0.5)
        };
        Ok(Estimate { value: median(|e| e.value)?, lower: median(|e| e.lower)?, upper: median(|e| e.upper)? })
    }

    /// The median of the values in a sketch; without limits where there are too few.
    ///
    /// # Errors
    /// A sketch without values.
    pub(super) fn sketched_median(&self, sketch: &QuantileSketch) -> Result<Estimate, Error> {
        let value = sketch.median()?;
        let Some(confidence) = self.confidence else { return Ok(Estimate { value, lower: value, upper: value }) };
        Ok(match sketch.quantile_interval(0.5, confidence)? {
            Some(limits) => Estimate { value, lower: limits.lower, upper: limits.upper },
            None => Estimate { value, lower: f64::NEG_INFINITY, upper: f64::INFINITY },
        })
    }

    /// The confidence of each interval where values are not taken for exact.
    pub(super) fn confidence(&self) -> Option<Confidence> {
        self.confidence
    }
}

/// The smallest of `estimates`, value by value and limit by limit.
pub(super) fn least(estimates: impl IntoIterator<Item = Estimate>) -> Estimate {
    folded(estimates, f64::INFINITY, f64::min)
}

/// The largest of `estimates` of occurrences, value by value and limit by limit; 0 without estimates.
pub(super) fn largest(estimates: impl IntoIterator<Item = Estimate>) -> Estimate {
    folded(estimates, 0.0, f64::max)
}

fn folded(estimates: impl IntoIterator<Item = Estimate>, start: f64, pick: fn(f64, f64) -> f64) -> Estimate {
    let start = Estimate { value: start, lower: start, upper: start };
    estimates.into_iter().fold(start, |a, b| Estimate {
        value: pick(a.value, b.value),
        lower: pick(a.lower, b.lower),
        upper: pick(a.upper, b.upper),
    })
}

/// The mean of `estimates`, value by value and limit by limit.
pub(super) fn mean(estimates: &[Estimate]) -> Estimate {
    let of = |of: fn(&Estimate) -> f64| estimates.iter().map(of).sum::<f64>() / estimates.len() as f64;
    Estimate { value: of(|e| e.value), lower: of(|e| e.lower), upper: of(|e| e.upper) }
}

/// Verdict on whether an estimate exceeds a bound.
pub(super) fn above(estimate: Estimate, bound: f64) -> Holds {
    if estimate.lower > bound {
        Holds::Yes
    } else if estimate.upper < bound || (estimate.lower == estimate.upper && estimate.value <= bound) {
        Holds::No
    } else {
        Holds::NotDetermined
    }
}

/// Verdict on whether an estimate stays below a bound.
pub(super) fn below(estimate: Estimate, bound: f64) -> Holds {
    match above(estimate, bound) {
        Holds::No if estimate.upper < bound => Holds::Yes,
        Holds::Yes => Holds::No,
        _ => Holds::NotDetermined,
    }
}

/// Verdict on whether all of `conditions` hold.
pub(super) fn all(conditions: impl IntoIterator<Item = Holds>) -> Holds {
    let mut holds = Holds::Yes;
    for condition in conditions {
        match condition {
            Holds::No => return Holds::No,
            Holds::NotDetermined => holds = Holds::NotDetermined,
            Holds::Yes => {}
        }
    }
    holds
}

/// Verdict on something that may be any of several candidates, from that on each: what is true of all.
pub(super) fn agreed(verdicts: &[Holds]) -> Holds {
    match verdicts {
        [first, others @ ..] if others.iter().all(|other| other == first) => *first,
        _ => Holds::NotDetermined,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use montecarlo::stream;
    use rand::RngExt;

    /// Ten scenes with probabilities near 0, in the middle and near 1, all from the same uniform number of each draw.
    const SCENES: [f64; 10] = [0.0005, 0.001, 0.002, 0.3, 0.45, 0.5, 0.52, 0.9, 0.997, 0.9995];

    #[test]
    fn all_limits_of_a_claim_hold_together_however_the_scenes_depend() {
        let (experiments, draws) = (600, 200_u64);
        let mut covered = 0;
        for experiment in 0..experiments {
            let mut rng = stream(11, experiment);
            let mut hits = [0_u64; SCENES.len()];
            for _ in 0..draws {
                let u: f64 = rng.random();
                hits.iter_mut().zip(SCENES).for_each(|(hits, p)| *hits += u64::from(u < p));
            }
            let limits = Judgement::ByLimits.of(SCENES.len());
            let found: Vec<Estimate> = hits.iter().map(|&hits| limits.occurrence(hits, hits, draws)).collect();
            let of_all = largest(found.iter().copied());
            covered += u64::from(
                found.iter().zip(SCENES).all(|(e, p)| e.lower <= p && p <= e.upper)
                    && of_all.lower <= 0.9995
                    && 0.9995 <= of_all.upper,
            );
        }
        assert!(covered as f64 >= 0.95 * experiments as f64, "{covered} of {experiments}");
    }

    #[test]
    fn values_are_judged_as_if_exact_and_limits_leave_doubt() {
        let by = |judgement: Judgement| above(judgement.of(1).occurrence(6, 6, 10), 0.5);
        assert_eq!((by(Judgement::ByValues), by(Judgement::ByLimits)), (Holds::Yes, Holds::NotDetermined));
        let none = Judgement::ByLimits.of(135).occurrence(0, 0, 1000);
        assert!(none.lower == 0.0 && (none.upper - (1.0 - (0.025_f64 / 135.0).powf(1e-3))).abs() < 1e-8);
        assert_eq!((below(none, 0.01), below(none, 0.005)), (Holds::Yes, Holds::NotDetermined));
    }

    #[test]
    fn candidates_that_disagree_determine_nothing() {
        use Holds::{No, NotDetermined, Yes};
        assert_eq!([agreed(&[Yes, Yes]), agreed(&[Yes, No]), agreed(&[])], [Yes, NotDetermined, NotDetermined]);
        assert_eq!([all([Yes, No, NotDetermined]), all([Yes, NotDetermined]), all([])], [No, NotDetermined, Yes]);
    }
}
