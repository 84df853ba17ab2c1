//! How often prediction and reference differ among samples of one kind, with limits that hold for any number of them.

use std::collections::{BTreeMap, BTreeSet};

use statrs::function::beta::beta_reg;

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
    pub differences: BTreeMap<u16, Differences>,
    /// Those in which the prediction was wrong about any mode.
    pub wrong: u64,
}

impl Stratum {
    /// Prediction and reference of one sample, by name: whether it is sure that the mode is unstable, or open.
    pub fn enter(&mut self, predicted: &BTreeMap<u16, bool>, reference: &BTreeMap<u16, bool>) {
        let names: BTreeSet<u16> = predicted
            .keys()
            .chain(reference.keys())
            .copied()
            .filter(|name| predicted.get(name) != reference.get(name))
            .collect();
        for name in &names {
            let difference = self.differences.entry(*name).or_default();
            let (predicted, reference) = (predicted.get(name), reference.get(name));
            count(&mut difference.sure, predicted == Some(&true), reference == Some(&true));
            count(&mut difference.perhaps, predicted.is_some(), reference.is_some());
            difference.any += 1;
        }
        self.samples += 1;
        self.wrong += u64::from(!names.is_empty());
    }

    /// By how much the probability of a mode among such samples may be below and above that of the prediction.
    pub fn limits(&self, name: u16, tail: f64, is_joint: bool) -> [f64; 2] {
        let d = self.differences.get(&name).copied().unwrap_or_default();
        if is_joint {
            // One limit of the probability that prediction and reference differ, whichever way.
            return [upper_limit(d.any, self.samples, tail); 2];
        }
        let at_most = |hits: u64| upper_limit(hits, self.samples, 0.5 * UPPER_LIMITS_PART * tail);
        let at_least = |hits: u64| lower_limit(hits, self.samples, 0.5 * (1.0 - UPPER_LIMITS_PART) * tail);
        [at_most(d.sure[1]) - at_least(d.sure[0]), at_most(d.perhaps[0]) - at_least(d.perhaps[1])]
    }

    /// The largest part of the samples in which the prediction of a mode was wrong, and a standard deviation more.
    pub fn most_wrong(&self) -> f64 {
        let any = self.differences.values().map(|d| d.any).max().unwrap_or(0).max(1) as f64;
        (any + any.sqrt()) / self.samples.max(1) as f64
    }

    /// Standard error of such a shift. Some differences are counted that were not seen, so that few do not pass for none: for
    /// none this is the upper limit of Wilson's interval at two deviations.
    pub fn deviation(&self, name: u16) -> f64 {
        let any = self.differences.get(&name).map_or(0, |d| d.any);
        let samples = self.samples.max(1) as f64;
        ((any as f64 + UNSEEN_DIFFERENCES) / (samples + UNSEEN_DIFFERENCES) / samples).sqrt()
    }

    /// By how much that of a mode surely, and of a mode perhaps unstable seems to be above the prediction.
    pub fn shift(&self, name: u16) -> [f64; 2] {
        let d = self.differences.get(&name).copied().unwrap_or_default();
        [d.sure, d.perhaps].map(|[more, less]| (more as f64 - less as f64) / self.samples.max(1) as f64)
    }
}

/// Counts a sample in which a mode is unstable by the reference alone, or predicted to be and is not.
fn count(counts: &mut [u64; 2], predicted: bool, reference: bool) {
    counts[0] += u64::from(reference && !predicted);
    counts[1] += u64::from(predicted && !reference);
}

/// The probability at which at most `hits` in `trials` has the probability `tail`.
fn upper_limit(hits: u64, trials: u64, tail: f64) -> f64 {
    if hits >= trials {
        return 1.0;
    }
    let (mut low, mut high) = (hits as f64 / trials as f64, 1.0);
    while high - low > 1e-9 * high {
        let middle = 0.5 * (low + high);
        // P(more than `hits`).
        if beta_reg(hits as f64 + 1.0, (trials - hits) as f64, middle) < 1.0 - tail {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

fn lower_limit(hits: u64, trials: u64, tail: f64) -> f64 {
    if hits == 0 { 0.0 } else { 1.0 - upper_limit(trials - hits, trials, tail) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn limits_are_those_of_clopper_and_pearson() {
        // R. G. Newcombe, Stat. Med. 17 (1998) 857, table I, method 5.
        for (hits, trials, lower, upper) in
            [(81, 263, 0.2527, 0.3676), (15, 148, 0.0578, 0.1617), (0, 20, 0.0, 0.1684), (1, 29, 0.0009, 0.1776)]
        {
            assert_abs_diff_eq!(lower_limit(hits, trials, 0.025), lower, epsilon = 5e-5);
            assert_abs_diff_eq!(upper_limit(hits, trials, 0.025), upper, epsilon = 5e-5);
        }
        assert_abs_diff_eq!(upper_limit(0, 5_000, 0.02), 1.0 - 0.02_f64.powf(1.0 / 5_000.0), epsilon = 1e-10);
        assert_eq!(upper_limit(7, 7, 0.02), 1.0);
    }

    #[test]
    fn the_limits_keep_their_promise_for_any_probability() {
        // P(upper limit < p) summed over all numbers of hits that have too small a limit.
        let n = 50_u64;
        for p in [0.01, 0.1, 0.37, 0.8] {
            let mut term = (1.0_f64 - p).powi(50);
            let (mut above, mut below) = (0.0, 0.0);
            for k in 0..=n {
                above += if upper_limit(k, n, 0.02) < p { term } else { 0.0 };
                below += if lower_limit(k, n, 0.02) > p { term } else { 0.0 };
                term *= (n - k) as f64 / (k + 1) as f64 * p / (1.0 - p);
            }
            assert!(above <= 0.02 && below <= 0.02, "{p}: {above} {below}");
        }
    }
}
