//! The ranking of changes by prediction, and the greedy building of sets.

use std::collections::HashMap;

use montecarlo::Progress;

use super::candidates::Candidates;
use super::criterion::Criterion;
use super::predict::{Prediction, Probes};

/// Changes of one kind with their prediction.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranked {
    /// Indices of the changes in [`Candidates::singles`], ascending.
    pub singles: Vec<usize>,
    /// Prediction for the brake with these changes.
    pub prediction: Prediction,
}

/// Ranking of one kind of changes.
#[derive(Debug, Clone)]
pub struct KindRanking {
    /// Candidates of the kind.
    pub candidates: Candidates,
    /// Changes at one place, the best first; of changes that symmetries map onto each other only the first is listed.
    pub singles: Vec<Ranked>,
    /// Best set found of each size, from 1; the list ends where no set of a size could be analysed.
    pub best: Vec<Ranked>,
    /// Best set found of each size among the sets that every symmetry of the brake leaves as they are.
    pub symmetric: Vec<Option<Ranked>>,
    /// Sets that could not be analysed, with the reason.
    pub failed: Vec<(String, String)>,
    /// Number of sets of changes analysed: what the ranking cost.
    pub sets: u64,
    /// Number of combinations of changes that made these sets, some of them the same ones: known before the search, so that progress counts them.
    pub combinations: u64,
}

/// Number of combinations of changes that a search makes: each group alone, and joined to the best set and to the best symmetric set of every size that still fits into `up_to`.
pub(super) fn combinations(candidates: &Candidates, up_to: usize) -> u64 {
    let groups = candidates.groups.iter().filter(|group| group.len() <= up_to);
    groups.map(|group| 1 + 2 * (up_to - group.len()) as u64).sum()
}

/// Ranks single changes, by predictions over the arrangements of `probes`, and builds the best set of each size up to `up_to`: each group of changes
/// ([`Candidates::groups`], changes that a symmetry makes of each other are one, however many) is added to the best set that leaves room for it, and to the best symmetric
/// one. Greedy: a set is found only if it is one group, or if removing one group leaves the best set, or the best symmetric set, of that size. It ends at the
/// first size of which no set could be analysed, also where a larger group could be.
///
/// A search that is cancelled ends with what it has, and all that is left as failed; its caller makes an error of that (`when_cancelled`).
pub(super) fn search(
    candidates: Candidates,
    probes: &Probes<'_>,
    up_to: usize,
    criterion: Criterion,
    progress: &dyn Progress,
) -> KindRanking {
    let mut known: HashMap<Vec<usize>, Option<Prediction>> = HashMap::new();
    let mut ranking = KindRanking {
        singles: Vec::new(),
        best: Vec::new(),
        symmetric: Vec::new(),
        failed: Vec::new(),
        sets: 0,
        combinations: combinations(&candidates, up_to),
        candidates,
    };
    let mut done = 0;
    for size in 1..=up_to {
        let sets = ranking.sets_of(size);
        let new: Vec<Vec<usize>> = sets.iter().filter(|set| !known.contains_key(*set)).cloned().collect();
        let images = |set: &Vec<usize>| {
            let images = ranking.candidates.images_of(set);
            images.iter().map(|image| ranking.candidates.changes(image)).collect()
        };
        let images: Vec<Vec<_>> = new.iter().map(images).collect();
        ranking.sets += new.len() as u64;
        let until_now = combinations(&ranking.candidates, size);
        let known_already = (until_now - done).saturating_sub(new.len() as u64);
        done = until_now;
        for (set, found) in new.into_iter().zip(probes.predictions(&images, progress)) {
            let prediction = match found {
                Ok(prediction) => Some(prediction),
                Err(error) => {
                    ranking.failed.push((ranking.candidates.name(&set), error.to_string()));
                    None
                }
            };
            known.insert(set, prediction);
        }
        progress.advance(known_already);
        let analysed = sets.into_iter().filter_map(|singles| {
            let prediction = known.get(&singles).copied().flatten()?;
            Some(Ranked { singles, prediction })
        });
        let mut analysed: Vec<Ranked> = analysed.collect();
        analysed.sort_by(|a, b| criterion.order(&a.prediction, &b.prediction));
        let Some(best) = analysed.first().cloned() else { break };
        ranking.best.push(best);
        let is_symmetric = |ranked: &&Ranked| ranking.candidates.is_symmetric(&ranked.singles);
        ranking.symmetric.push(analysed.iter().find(is_symmetric).cloned());
        if size == 1 {
            ranking.singles = analysed;
        }
    }
    progress.advance(ranking.combinations - done);
    ranking
}

impl KindRanking {
    /// Sets of a size that are analysed: each group filled up to `size` with the best set, and the best symmetric set, of the remaining size.
    fn sets_of(&self, size: usize) -> Vec<Vec<usize>> {
        let mut sets: Vec<Vec<usize>> = Vec::new();
        for group in self.candidates.groups.iter().filter(|group| group.len() <= size) {
            let of_chains = |missing: usize| {
                let any = self.best.get(missing - 1).map(|best| best.singles.as_slice());
                let symmetric = self.symmetric.get(missing - 1).and_then(Option::as_ref);
                any.into_iter().chain(symmetric.map(|best| best.singles.as_slice()))
            };
            let rests: Vec<&[usize]> = match size - group.len() {
                0 => vec![&[]],
                missing => of_chains(missing).collect(),
            };
            for rest in rests.into_iter().filter(|rest| rest.iter().all(|single| !group.contains(single))) {
                let set = self.candidates.representative(&[group, rest].concat());
                if self.candidates.are_compatible(&set) && !sets.contains(&set) {
                    sets.push(set);
                }
            }
        }
        sets
    }
}
