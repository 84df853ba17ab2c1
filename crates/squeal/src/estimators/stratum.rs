//! How often prediction and reference differ among samples of one kind, with limits that hold for any number of them.

use std::collections::{BTreeMap, BTreeSet};

use montecarlo::{exact_lower_limit, exact_upper_limit};

use crate::study::ModeLabel;

/// Part of an error probability that the upper of four limits spend; chosen. The lower ones help where prediction and
/// reference often differ.
const UPPER_LIMITS_PART: f64 = 0.9;

/// Differences that are counted though none was seen, as many as Wilson's interval at two deviations has.
const UNSEEN_DIFFERENCES: f64 = 4.0;

/// In how many samples prediction and reference of a mode differed.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Differences {
    /// Surely unstable: by the reference and not predicted, predicted and not by the reference.
    sure: [u64; 2],
    /// The same of perhaps unstable.
    perhaps: [u64; 2],
    /// Either.
    any: u64,
}

/// Counts of samples of one kind: those of which the prediction is clear, or uncertain.
#[derive(Debug, Clone, Default)]
pub(super) struct Stratum {
    pub samples: u64,
    /// By name.
    pub differences: BTreeMap<ModeLabel, Differences>,
    /// Those in which the prediction was wrong about any mode.
    pub wrong: u64,
}

impl Stratum {
    /// Enters one sample by its prediction and reference, by name: whether it is sure that the mode is unstable, or open.
    pub fn enter(&mut self, predicted: &BTreeMap<ModeLabel, bool>, reference: &BTreeMap<ModeLabel, bool>) {
        self.enter_alike(1, predicted, reference);
    }

    /// Enters some samples of which all have the same prediction and the same reference.
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

    /// The differences of a mode; none of one that has no name because it was never seen.
    fn of(&self, name: Option<ModeLabel>) -> Differences {
        name.and_then(|name| self.differences.get(&name)).copied().unwrap_or_default()
    }

    /// By how much the probability of a mode among such samples may be below and above that of the prediction.
    pub fn limits(&self, name: Option<ModeLabel>, tail: f64, is_joint: bool) -> [f64; 2] {
        let d = self.of(name);
        if is_joint {
            // One limit of the probability that prediction and reference differ, whichever way.
            return [exact_upper_limit(d.any, self.samples, tail); 2];
        }
        let at_most = |hits: u64| exact_upper_limit(hits, self.samples, 0.5 * UPPER_LIMITS_PART * tail);
        let at_least = |hits: u64| exact_lower_limit(hits, self.samples, 0.5 * (1.0 - UPPER_LIMITS_PART) * tail);
        [at_most(d.sure[1]) - at_least(d.sure[0]), at_most(d.perhaps[0]) - at_least(d.perhaps[1])]
    }

    /// The largest part of the samples in which the prediction of a mode was wrong, and a standard deviation more.
    pub fn most_wrong(&self) -> f64 {
        let any = self.differences.values().map(|d| d.any).max().unwrap_or(0).max(1) as f64;
        (any + any.sqrt()) / self.samples.max(1) as f64
    }

    /// Standard error of such a shift. Some differences are counted that were not seen, so that few do not pass for none: for
    /// none this is the upper limit of Wilson's interval at two deviations.
    pub fn deviation(&self, name: Option<ModeLabel>) -> f64 {
        let any = self.of(name).any;
        let samples = self.samples.max(1) as f64;
        ((any as f64 + UNSEEN_DIFFERENCES) / (samples + UNSEEN_DIFFERENCES) / samples).sqrt()
    }

    /// By how much that of a mode surely, and of a mode perhaps unstable seems to be above the prediction.
    pub fn shift(&self, name: Option<ModeLabel>) -> [f64; 2] {
        let d = self.of(name);
        [d.sure, d.perhaps].map(|[more, less]| (more as f64 - less as f64) / self.samples.max(1) as f64)
    }
}

/// Counts samples in which a mode is unstable by the reference alone, or predicted to be and is not.
fn count(samples: u64, counts: &mut [u64; 2], predicted: bool, reference: bool) {
    counts[0] += samples * u64::from(reference && !predicted);
    counts[1] += samples * u64::from(predicted && !reference);
}
