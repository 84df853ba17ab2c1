//! Parts of a run put together: the summaries of ranges of samples that were taken elsewhere, in any order.

use std::ops::Range;

use crate::error::MonteCarloError;
use crate::merge::Merge;
use crate::summary::Summary;

/// The range of samples of part `part` of `parts`, from 1, of the samples `from..to`: all parts together have each sample once, and their
/// sizes differ by one at most. `None` of a part that is not there or has no sample.
#[must_use]
pub fn part_of(Range { start: from, end: to }: Range<u64>, part: u64, parts: u64) -> Option<Range<u64>> {
    let samples = u128::from(to.checked_sub(from)?);
    let edge = |number: u64| from + (u128::from(number) * samples / u128::from(parts)) as u64;
    let range = (1..=parts).contains(&part).then(|| edge(part - 1)..edge(part))?;
    (!range.is_empty()).then_some(range)
}

/// The summary of parts that have the samples `0..samples` once, with a name for each part. A part that is there twice with equal
/// contents counts once, as after a task that ran twice.
///
/// # Errors
/// [`MonteCarloError::PartsMissing`], [`MonteCarloError::PartsOverlap`]; those of [`Summary::merge`].
pub fn tiled<T: Merge + PartialEq>(
    mut parts: Vec<(String, Summary<T>)>,
    samples: u64,
) -> Result<Summary<T>, MonteCarloError> {
    parts.sort_by_key(|(_, part)| (part.first, part.samples));
    let mut merged: Option<(String, Summary<T>)> = None;
    let mut kept: Vec<(String, Summary<T>)> = Vec::with_capacity(parts.len());
    for (name, part) in parts {
        match kept.last() {
            Some((_, same)) if *same == part => {}
            Some((other, earlier)) if part.first < earlier.next() => {
                let (from, to) = (part.first, earlier.next().min(part.next()));
                return Err(MonteCarloError::PartsOverlap { part: name, other: other.clone(), from, to });
            }
            _ => kept.push((name, part)),
        }
    }
    for (name, part) in kept {
        let next = merged.as_ref().map_or(0, |(_, so_far)| so_far.next());
        if part.first > next {
            return Err(MonteCarloError::PartsMissing { from: next, to: part.first, samples });
        }
        merged = Some(match merged {
            None => (name, part),
            Some((first, so_far)) => (first, so_far.merge(part)?),
        });
    }
    match merged {
        Some((_, whole)) if whole.next() == samples => Ok(whole),
        Some((name, whole)) if whole.next() > samples => {
            let (from, to) = (samples, whole.next());
            Err(MonteCarloError::PartsOverlap { part: name, other: "the samples asked for".into(), from, to })
        }
        other => {
            let from = other.map_or(0, |(_, whole)| whole.next());
            Err(MonteCarloError::PartsMissing { from, to: samples, samples })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::failures::Failures;
    use proptest::prelude::*;

    #[derive(Debug, Clone, PartialEq)]
    struct Indices(Vec<u64>);

    impl Merge for Indices {
        fn merge(&mut self, later: Self) {
            self.0.extend(later.0);
        }
    }

    fn part(range: Range<u64>) -> (String, Summary<Indices>) {
        let samples = range.end - range.start;
        let summary = Summary {
            seed: 7,
            first: range.start,
            samples,
            failures: Failures::new(1),
            tally: Indices(range.clone().collect()),
        };
        (format!("{range:?}"), summary)
    }

    proptest! {
        #[test]
        fn any_parts_in_any_order_are_the_whole(samples in 1_u64..60, parts in 1_u64..12, turned in 0_usize..12, twice in 0_usize..12) {
            let mut all: Vec<_> = (1..=parts).filter_map(|at| part_of(0..samples, at, parts)).map(part).collect();
            let sizes: Vec<u64> = all.iter().map(|(_, part)| part.samples).collect();
            prop_assert!(sizes.iter().max().unwrap() - sizes.iter().min().unwrap() <= 1);
            let (turned, twice) = (turned % all.len(), twice % all.len());
            all.push(all[twice].clone());
            all.rotate_left(turned);
            let whole = tiled(all.clone(), samples).unwrap();
            prop_assert_eq!(whole, part(0..samples).1);
            // Without one of them, which may be there twice, something is missing.
            let gone = all[0].1.first;
            all.retain(|(_, part)| part.first != gone);
            let is_missing = matches!(tiled(all, samples), Err(MonteCarloError::PartsMissing { from, .. }) if from == gone);
            prop_assert!(is_missing);
        }
    }

    #[test]
    fn what_does_not_fit_is_said() {
        let said = |parts: Vec<Range<u64>>, samples| {
            tiled(parts.into_iter().map(part).collect(), samples).map(drop).map_err(|error| error.to_string())
        };
        assert_eq!(said(vec![0..4, 4..10], 10), Ok(()));
        assert_eq!(
            said(vec![], 10),
            Err("no part has the samples 0..10; allowed: parts that have all samples 0..10 once".into())
        );
        let gap = "no part has the samples 4..6; allowed: parts that have all samples 0..10 once";
        assert_eq!(said(vec![6..10, 0..4], 10), Err(gap.into()));
        let overlap = "5..10 and 0..6: both have the samples 5..6; allowed: parts that have each sample once";
        assert_eq!(said(vec![5..10, 0..6], 10), Err(overlap.into()));
        let mut other = part(0..10);
        other.1.tally.0[3] = 0;
        let differ = tiled(vec![part(0..10), other], 10).unwrap_err().to_string();
        assert!(differ.contains("both have the samples 0..10"), "{differ}");
        assert!(said(vec![0..2, 2..12], 10).unwrap_err().contains("the samples asked for"));
        assert_eq!(
            (part_of(0..3, 1, 4), part_of(0..3, 2, 4), part_of(0..3, 5, 4), part_of(Range { start: 5, end: 3 }, 1, 1)),
            (None, Some(0..1), None, None)
        );
        assert_eq!(part_of(100..u64::MAX, 3, 3).map(|range| range.end), Some(u64::MAX));
    }
}
