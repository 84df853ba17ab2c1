//! Counts of how often labels occur, where the label of a thing may be uncertain.

use std::collections::BTreeMap;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::confidence::{Confidence, Interval};
use crate::experiment::{Experiment, Runs, Tally};
use crate::merge::Merge;
use crate::proportion::{Proportion, Trial};

/// The labels that occur in one trial, from the candidate labels of each thing found in the trial: [`Trial::Yes`] for a label
/// that occurs for certain, [`Trial::Ambiguous`] for one that may not.
///
/// A thing with a single candidate has that label. If k things have the same k candidates, all k labels occur for certain. A
/// thing without candidates adds no label to these; it may have any, which [`LabelTally`] counts. The candidates of one thing
/// must differ; their order does not matter.
///
/// ```
/// use montecarlo::{Trial, occurring_labels};
/// let labels = occurring_labels(&[vec!["a"], vec!["b", "c"], vec!["c", "b"], vec!["d", "e"]]);
/// assert_eq!(labels["a"], Trial::Yes);
/// assert_eq!((labels["b"], labels["c"]), (Trial::Yes, Trial::Yes));
/// assert_eq!((labels["d"], labels["e"]), (Trial::Ambiguous, Trial::Ambiguous));
/// ```
#[must_use]
pub fn occurring_labels<L: Ord + Clone>(candidates: &[impl AsRef<[L]>]) -> BTreeMap<L, Trial> {
    let mut labels = BTreeMap::new();
    for mine in candidates.iter().map(AsRef::as_ref) {
        let sharing = candidates.iter().filter(|other| are_same(other.as_ref(), mine)).count();
        let trial = if sharing >= mine.len() { Trial::Yes } else { Trial::Ambiguous };
        for label in mine {
            let entry = labels.entry(label.clone()).or_insert(trial);
            if trial == Trial::Yes {
                *entry = Trial::Yes;
            }
        }
    }
    labels
}

fn are_same<L: Ord>(a: &[L], b: &[L]) -> bool {
    a.len() == b.len() && a.iter().all(|label| b.contains(label))
}

/// The number of trials in which each label occurs. The tally has one entry for each label that has occurred. A thing without
/// candidates may have any label: its trial is ambiguous for each label that does not occur in it for certain.
///
/// ```
/// use montecarlo::{Confidence, LabelTally};
///
/// // The modes of a brake that squeal in each of four trials; in the last trial it is one of two modes.
/// let mut squeal = LabelTally::default();
/// squeal.record(&[vec!["bell"]]);
/// squeal.record(&[vec!["bell"], vec!["rotor"]]);
/// squeal.record::<Vec<_>>(&[]);
/// squeal.record(&[vec!["bell", "pad"]]);
///
/// let bell = squeal.proportion(&"bell");
/// assert_eq!((bell.hits(), bell.ambiguous(), bell.trials()), (2, 1, 4));
/// assert_eq!(squeal.interval(&"never seen", Confidence::P95).lower, 0.0);
///
/// // A mode of which it is open whether it squeals at all is in its upper limit alone.
/// squeal.record_with_open(&[vec!["bell"]], &[vec!["drum"]]);
/// assert_eq!((squeal.proportion(&"drum").hits(), squeal.proportion(&"drum").ambiguous()), (0, 1));
///
/// // Something of which nothing is known may be any of them, also one that was never seen.
/// squeal.record(&[vec!["bell"], vec![]]);
/// assert_eq!(squeal.proportion(&"bell").ambiguous(), 1);
/// assert_eq!((squeal.unlabelled().hits(), squeal.proportion(&"never seen").ambiguous()), (1, 1));
/// for (label, proportion) in squeal.proportions() {
///     let interval = proportion.interval(Confidence::P95);
///     println!("{label}: {} of {}, {interval:?}", proportion.hits(), proportion.trials());
/// }
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(bound(deserialize = "L: Ord + Deserialize<'de>"))]
pub struct LabelTally<L: Ord> {
    trials: u64,
    labels: BTreeMap<L, Hits>,
    /// Trials with a thing without candidates.
    unlabelled: u64,
    /// Trials in which the only things without candidates are open: it is not known whether they are there.
    perhaps_unlabelled: u64,
}

/// Counts of one label.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
struct Hits {
    certain: u64,
    ambiguous: u64,
    /// Hits, certain and ambiguous, in whose trial something has no candidates.
    beside_unlabelled: u64,
}

impl<L: Ord> Default for LabelTally<L> {
    fn default() -> Self {
        Self { trials: 0, labels: BTreeMap::new(), unlabelled: 0, perhaps_unlabelled: 0 }
    }
}

impl<L: Ord + Clone> LabelTally<L> {
    /// Enters one trial, from the candidate labels of each thing found in the trial; see [`occurring_labels`].
    pub fn record<C: AsRef<[L]>>(&mut self, candidates: &[C]) {
        self.record_with_open(candidates, &[]);
    }

    /// Enters one trial as [`record`](Self::record) does, with things of which it is `open` whether they are there: no label occurs for certain
    /// by one of these, and each of their candidates may.
    pub fn record_with_open<C: AsRef<[L]>>(&mut self, candidates: &[C], open: &[C]) {
        self.trials += 1;
        let has_unlabelled = |things: &[C]| things.iter().any(|candidates| candidates.as_ref().is_empty());
        let (is_unlabelled, may_be) = (has_unlabelled(candidates), has_unlabelled(open));
        self.unlabelled += u64::from(is_unlabelled);
        self.perhaps_unlabelled += u64::from(may_be && !is_unlabelled);
        let mut occurring = occurring_labels(candidates);
        for label in open.iter().flat_map(AsRef::as_ref) {
            occurring.entry(label.clone()).or_insert(Trial::Ambiguous);
        }
        for (label, trial) in occurring {
            let hits = self.labels.entry(label).or_default();
            hits.beside_unlabelled += u64::from(is_unlabelled || may_be);
            match trial {
                Trial::Yes => hits.certain += 1,
                Trial::Ambiguous => hits.ambiguous += 1,
                Trial::No => {}
            }
        }
    }
}

impl<L: Ord> LabelTally<L> {
    /// Number of trials.
    #[must_use]
    pub fn trials(&self) -> u64 {
        self.trials
    }

    /// The proportion of trials with a thing without candidates.
    #[must_use]
    pub fn unlabelled(&self) -> Proportion {
        Proportion::of_counts(self.unlabelled, self.perhaps_unlabelled, self.trials)
    }

    /// The proportion of trials with a label; a label that never occurred has no certain hits.
    #[must_use]
    pub fn proportion(&self, label: &L) -> Proportion {
        self.of_hits(self.labels.get(label).copied().unwrap_or_default())
    }

    /// Every label that has occurred, ascending, with its proportion.
    pub fn proportions(&self) -> impl Iterator<Item = (&L, Proportion)> {
        self.labels.iter().map(|(label, &hits)| (label, self.of_hits(hits)))
    }

    /// A confidence interval for the probability of a label, as [`Proportion::interval`].
    #[must_use]
    pub fn interval(&self, label: &L, confidence: Confidence) -> Interval {
        self.proportion(label).interval(confidence)
    }

    fn of_hits(&self, hits: Hits) -> Proportion {
        let unlabelled = self.unlabelled + self.perhaps_unlabelled - hits.beside_unlabelled;
        Proportion::of_counts(hits.certain, hits.ambiguous + unlabelled, self.trials)
    }
}

/// Tallies, one per scene, for experiments whose outcome is the candidate labels of each thing found.
impl<L, E> Tally<E> for Vec<LabelTally<L>>
where
    L: Ord + Clone + Serialize + DeserializeOwned + Send,
    E: Experiment<Outcome = Vec<Vec<L>>>,
{
    fn record(&mut self, runs: &Runs<'_, E>) {
        self.resize_with(runs.results.len(), LabelTally::default);
        for (tally, result) in self.iter_mut().zip(runs.results) {
            if let Ok(candidates) = result {
                tally.record(candidates);
            }
        }
    }
}

impl<L: Ord> Merge for LabelTally<L> {
    fn merge(&mut self, later: Self) {
        self.trials += later.trials;
        self.unlabelled += later.unlabelled;
        self.perhaps_unlabelled += later.perhaps_unlabelled;
        for (label, more) in later.labels {
            let hits = self.labels.entry(label).or_default();
            hits.certain += more.certain;
            hits.ambiguous += more.ambiguous;
            hits.beside_unlabelled += more.beside_unlabelled;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn occurring(candidates: &[&[u16]]) -> Vec<(u16, bool)> {
        occurring_labels(candidates).into_iter().map(|(label, trial)| (label, trial == Trial::Yes)).collect()
    }

    #[test]
    fn an_ambiguous_pair_is_certain_where_both_are_there() {
        assert_eq!(occurring(&[&[15], &[17]]), [(15, true), (17, true)]);
        assert_eq!(occurring(&[&[15, 16]]), [(15, false), (16, false)]);
        assert_eq!(occurring(&[&[15, 16], &[16, 15]]), [(15, true), (16, true)]);
        assert_eq!(occurring(&[&[15, 16], &[16]]), [(15, false), (16, true)]);
        assert_eq!(occurring(&[&[16], &[15, 16]]), [(15, false), (16, true)]);
        assert_eq!(occurring(&[&[1, 2, 3], &[1, 2, 3]]), [(1, false), (2, false), (3, false)]);
        assert!(occurring(&[&[]]).is_empty());
    }

    #[test]
    fn labels_are_the_keys_of_the_stored_form() {
        let mut tally = LabelTally::default();
        tally.record(&[vec![15_u16], vec![16, 17]]);
        let text = serde_json::to_string(&tally).unwrap();
        assert!(
            text.starts_with(r#"{"trials":1,"labels":{"15":{"certain":1,"ambiguous":0,"beside_unlabelled":0},"16":"#),
            "{text}"
        );
        assert_eq!(serde_json::from_str::<LabelTally<u16>>(&text).unwrap(), tally);
    }

    #[test]
    fn what_has_no_candidates_widens_every_upper_limit_and_no_lower_one() {
        let mut tally = LabelTally::default();
        (0..50).for_each(|_| tally.record(&[vec![15_u16], vec![16, 17]]));
        let before = [15, 16, 99].map(|label| tally.interval(&label, Confidence::P95));
        (0..50).for_each(|_| tally.record(&[vec![15_u16], vec![]]));
        let counts = |label: u16| {
            let proportion = tally.proportion(&label);
            (proportion.hits(), proportion.ambiguous(), proportion.trials())
        };
        assert_eq!([15, 16, 99].map(counts), [(100, 0, 100), (0, 100, 100), (0, 50, 100)]);
        let after = [15, 16, 99].map(|label| tally.interval(&label, Confidence::P95));
        assert!(after[1].upper == 1.0 && after[2].upper > 0.59 && before[2].upper < 0.08, "{before:?} {after:?}");
        assert_eq!([after[1].lower, after[2].lower], [0.0, 0.0]);
        let text = serde_json::to_string(&tally).unwrap();
        assert_eq!(serde_json::from_str::<LabelTally<u16>>(&text).unwrap(), tally);
    }

    /// Trials with up to three things, each with up to three candidates of five labels.
    fn trials() -> impl Strategy<Value = Vec<Vec<Vec<u8>>>> {
        let thing = prop::collection::btree_set(0_u8..5, 0..4).prop_map(|set| set.into_iter().collect());
        prop::collection::vec(prop::collection::vec(thing, 0..4), 0..30)
    }

    proptest! {
        #[test]
        fn two_parts_merge_to_the_whole_and_no_label_is_lost(trials in trials(), cut in 0_usize..30) {
            let of = |trials: &[Vec<Vec<u8>>]| {
                let mut tally = LabelTally::default();
                trials.iter().for_each(|things| tally.record(things));
                tally
            };
            let (early, late) = trials.split_at(cut.min(trials.len()));
            let mut merged = of(early);
            merged.merge(of(late));
            let whole = of(&trials);
            prop_assert_eq!(&merged, &whole);
            prop_assert_eq!(whole.trials(), trials.len() as u64);
            for label in 0..5 {
                let may_be = |thing: &Vec<u8>| thing.is_empty() || thing.contains(&label);
                let perhaps = trials.iter().filter(|things| things.iter().any(may_be)).count() as u64;
                let proportion = whole.proportion(&label);
                prop_assert_eq!(proportion.hits() + proportion.ambiguous(), perhaps);
            }
        }
    }
}
