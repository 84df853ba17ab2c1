//! Counts of the samples of one kind in which prediction and reference differ, with limits that hold for any number of samples.

use std::collections::{BTreeMap, BTreeSet};

use montecarlo::{exact_lower_limit, exact_upper_limit};

use crate::ModeLabel;

/// Fraction of an error probability that belongs to the upper two of four limits; chosen. The lower limits matter only where
/// prediction and reference differ often.
const UPPER_LIMITS_PART: f64 = 0.9;
/// Number of differences added to those counted; chosen as in Wilson's interval at two deviations (z^2).
const UNSEEN_DIFFERENCES: f64 = 4.0;

/// Numbers of samples in which prediction and reference of a mode differ.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Differences {
    /// Numbers of samples that are certainly unstable by the reference only, and by the prediction only.
    sure: [u64; 2],
    /// Numbers of samples that are certainly or possibly unstable by the reference only, and by the prediction only.
    perhaps: [u64; 2],
    /// Number of samples with any difference.
    any: u64,
}

/// Counts of the samples of one kind: with clear, or with uncertain predictions.
#[derive(Debug, Clone, Default)]
pub(super) struct Stratum {
    pub samples: u64,
    /// Differences by name.
    pub differences: BTreeMap<ModeLabel, Differences>,
    /// Number of samples in which the prediction was wrong about any mode.
    pub wrong: u64,
}

impl Stratum {
    /// Enters one sample. Both maps have the unstable modes by name, with `true` where the name is certain.
    pub fn enter(&mut self, predicted: &BTreeMap<ModeLabel, bool>, reference: &BTreeMap<ModeLabel, bool>) {
        self.enter_alike(1, predicted, reference);
    }

    /// Enters `samples` samples of which all have the same prediction and the same reference.
    pub fn enter_alike(
        &mut self,
        samples: u64,
        predicted: &BTreeMap<ModeLabel, bool>,
        reference: &BTreeMap<ModeLabel, bool>,
    ) {
        let names: BTreeSet<ModeLabel> = predicted
            .keys()
            .chain(reference.keys())
            .copied()
            .filter(|name| predicted.get(name) != reference.get(name))
            .collect();
        for name in &names {
            let difference = self.differences.entry(*name).or_default();
            let (predicted, reference) = (predicted.get(name), reference.get(name));
            count(samples, &mut difference.sure, predicted == Some(&true), reference == Some(&true));
            count(samples, &mut difference.perhaps, predicted.is_some(), reference.is_some());
            difference.any += samples;
        }
        self.samples += samples;
        self.wrong += if names.is_empty() { 0 } else { samples };
    }

    /// The differences of a mode; none without a name, which a mode that was never seen has not.
    fn of(&self, name: Option<ModeLabel>) -> Differences {
        name.and_then(|name| self.differences.get(&name)).copied().unwrap_or_default()
    }

    /// Limits of the amounts by which the probability of a mode in this stratum is below and above the probability by the prediction. `tail` is the error
    /// probability of all of them together; if `is_joint` one limit serves both ways.
    pub fn limits(&self, name: Option<ModeLabel>, tail: f64, is_joint: bool) -> [f64; 2] {
        let d = self.of(name);
        if is_joint {
            // One limit of the probability that prediction and reference differ in either direction.
            return [exact_upper_limit(d.any, self.samples, tail); 2];
        }
        let at_most = |hits: u64| exact_upper_limit(hits, self.samples, 0.5 * UPPER_LIMITS_PART * tail);
        let at_least = |hits: u64| exact_lower_limit(hits, self.samples, 0.5 * (1.0 - UPPER_LIMITS_PART) * tail);
        [at_most(d.sure[1]) - at_least(d.sure[0]), at_most(d.perhaps[0]) - at_least(d.perhaps[1])]
    }

    /// The largest share, over the modes, of samples in which the prediction was wrong, plus one standard deviation.
    pub fn most_wrong(&self) -> f64 {
        let any = self.differences.values().map(|d| d.any).max().unwrap_or(0).max(1) as f64;
        (any + any.sqrt()) / self.samples.max(1) as f64
    }

    /// Standard error of [`Stratum::shift`]. [`UNSEEN_DIFFERENCES`] are added to those counted, so that the error is not 0 where
    /// no difference was seen.
    pub fn deviation(&self, name: Option<ModeLabel>) -> f64 {
        let any = self.of(name).any;
        let samples = self.samples.max(1) as f64;
        ((any as f64 + UNSEEN_DIFFERENCES) / (samples + UNSEEN_DIFFERENCES) / samples).sqrt()
    }

    /// Estimates of the amounts by which the probabilities of a certainly, and a possibly, unstable mode exceed the prediction.
    pub fn shift(&self, name: Option<ModeLabel>) -> [f64; 2] {
        let d = self.of(name);
        [d.sure, d.perhaps].map(|[more, less]| (more as f64 - less as f64) / self.samples.max(1) as f64)
    }
}

/// Counts samples in which a mode is unstable by the reference only (first count) or by the prediction only (second count).
fn count(samples: u64, counts: &mut [u64; 2], predicted: bool, reference: bool) {
    counts[0] += samples * u64::from(reference && !predicted);
    counts[1] += samples * u64::from(predicted && !reference);
}
