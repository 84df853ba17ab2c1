//! Findings of a study on each mode and each set of constraints: the numbers behind `summary.md` and `report.html`.

use std::collections::{BTreeMap, BTreeSet};

use montecarlo::{Confidence, Estimate};
use study::{ComparisonKind, ModeLabel, Panel, SceneTally};

use super::Results;
use super::study_results::ArrangementOccurrence;
use crate::Error;

/// Fraction of the samples: a mode that is unstable in more of them is called likely; chosen.
pub(super) const LIKELY: f64 = 0.5;

/// The occurrences of a mode over all panels of a set of constraints. The occurrence in a panel is the median over its arrangements.
pub struct ModeRange<'a> {
    /// Occurrence in the panel where it is smallest, and the panel.
    pub least: (Estimate, &'a Panel),
    /// Occurrence in the panel where it is largest, and the panel.
    pub most: (Estimate, &'a Panel),
    /// True if the mode is unstable, or may be, in any sample that was evaluated.
    pub is_ever_unstable: bool,
    /// Occurrence in the arrangement where it is smallest, of all panels.
    pub smallest: Estimate,
    /// Occurrence in the arrangement where it is largest, of all panels.
    pub largest: Estimate,
    /// Largest lower and upper limits of its occurrence in any arrangement, 0 to 1.
    pub greatest_limits: [f64; 2],
}

impl ModeRange<'_> {
    /// True if the mode surely is likely in every panel: the lower limit of its least occurrence is above one half.
    pub fn is_likely_everywhere(&self) -> bool {
        self.least.0.lower > LIKELY
    }

    /// Words for whether the mode is unstable in every sample, whatever the arrangement, or in some.
    pub fn in_words(&self) -> &'static str {
        match (self.smallest.value >= 1.0, self.largest.value > 0.0) {
            (true, _) => "unstable in every sample",
            (false, true) => "unstable in some samples",
            (false, false) => "perhaps unstable in some samples",
        }
    }

    /// True if the mode surely is likely in some panels and not, or not surely, in others.
    pub fn is_likely_somewhere(&self) -> bool {
        self.most.0.lower > LIKELY && !self.is_likely_everywhere()
    }
}

/// Findings on the modes of a set of constraints.
pub struct SetFindings<'a> {
    /// Modes that are unstable, or may be, in a sample that was evaluated. They are in descending order of [`ModeRange::least`], then of
    /// [`ModeRange::most`], then of [`ModeRange::largest`].
    pub unstable: Vec<(ModeLabel, ModeRange<'a>)>,
    /// The other modes: stable in every sample that was evaluated.
    pub stable: Vec<(ModeLabel, ModeRange<'a>)>,
    /// Largest upper limit (Wilson, 95 % for each mode alone) of the occurrence, 0 to 1, of a mode of `stable` in one arrangement.
    pub stable_upper: f64,
    /// Occurrence of any instability, 0 to 1, a mode or divergence: the smallest and the largest of the panels, each the median over its arrangements.
    pub anything: [Estimate; 2],
}

impl<'a> SetFindings<'a> {
    /// The findings on the modes of a set of constraints, by its index.
    pub fn new(results: &'a Results, constraints: usize) -> Result<Self, Error> {
        let ranges = mode_ranges(results, constraints)?;
        let (mut unstable, stable): (Vec<_>, Vec<_>) =
            ranges.into_iter().partition(|(_, range)| range.is_ever_unstable);
        unstable.sort_by(|(_, a), (_, b)| {
            // Occurrences as integers, in units of 1e-9, which have an order; modes that are equal in all three stay in the order of their names.
            let key =
                |range: &ModeRange<'_>| [range.least.0, range.most.0, range.largest].map(|e| (e.value * 1e9) as u64);
            key(b).cmp(&key(a))
        });
        let stable_upper = stable.iter().map(|(_, range)| range.greatest_limits[1]).fold(0.0, f64::max);
        let of_set = results.panels().iter().filter(|panel| panel.key.constraints == constraints);
        let mut anything =
            of_set.map(|panel| results.median(&results.any_occurrence(panel))).collect::<Result<Vec<_>, Error>>()?;
        anything.sort_by(|a, b| a.value.total_cmp(&b.value));
        let none = Estimate { value: 0.0, lower: 0.0, upper: 0.0 };
        let anything = [anything.first(), anything.last()].map(|end| end.copied().unwrap_or(none));
        Ok(Self { unstable, stable, stable_upper, anything })
    }

    /// True if the occurrences of single modes do not tell the occurrence of anything: something is unstable without a mode's name, or modes alternate from
    /// draw to draw, so that more draws are surely unstable than by any one of them.
    pub fn has_more_than_modes(&self) -> bool {
        let likeliest = |of: fn(&ModeRange<'a>) -> Estimate| {
            self.unstable.iter().map(|(_, range)| of(range).value).fold(0.0, f64::max)
        };
        let alternate = [likeliest(|range| range.least.0), likeliest(|range| range.most.0)];
        self.unstable.iter().any(|(name, _)| !name.is_mode())
            || self.anything.iter().zip(alternate).any(|(anything, mode)| anything.lower > mode)
    }

    /// Sentence on the fraction of the samples in which anything is unstable, with each estimate worded by `with_limits`; `None` where the occurrences of
    /// single modes tell it.
    pub fn anything_in_words(&self, with_limits: impl Fn(&Estimate) -> String) -> Option<String> {
        let [least, most] = self.anything.each_ref().map(with_limits);
        let range = if least == most { least } else { format!("{least} in one panel to {most} in another") };
        self.has_more_than_modes().then(|| {
            format!(
                "Anything at all, modes with names or without and divergence, is unstable in {range} of the samples"
            )
        })
    }

    /// The occurrences of a mode, by its name; `None` if the set has no such mode.
    pub fn range(&self, name: ModeLabel) -> Option<&ModeRange<'a>> {
        self.unstable.iter().chain(&self.stable).find(|(other, _)| *other == name).map(|(_, range)| range)
    }
}

fn mode_ranges<'a>(results: &'a Results, constraints: usize) -> Result<BTreeMap<ModeLabel, ModeRange<'a>>, Error> {
    let mut modes = BTreeMap::new();
    let none = Estimate { value: 0.0, lower: 0.0, upper: 0.0 };
    for panel in results.panels().iter().filter(|panel| panel.key.constraints == constraints) {
        for (name, occurrences) in results.every_occurrence(panel) {
            let median = results.median(&occurrences)?;
            let first = || ModeRange {
                least: (median, panel),
                most: (median, panel),
                is_ever_unstable: false,
                smallest: Estimate { value: 1.0, lower: 1.0, upper: 1.0 },
                largest: none,
                greatest_limits: [0.0; 2],
            };
            let range = modes.entry(name).or_insert_with(first);
            let order = |e: &Estimate| [e.value, e.upper];
            if order(&median) < order(&range.least.0) {
                range.least = (median, panel);
            }
            if order(&median) > order(&range.most.0) {
                range.most = (median, panel);
            }
            for occurrence in &occurrences {
                let ArrangementOccurrence { proportion, failed, .. } = occurrence;
                range.is_ever_unstable |= proportion.hits() + proportion.ambiguous() > *failed;
                let estimate = occurrence.estimate();
                let [lower, upper] = range.greatest_limits;
                range.greatest_limits = [lower.max(estimate.lower), upper.max(estimate.upper)];
                if order(&estimate) < order(&range.smallest) {
                    range.smallest = estimate;
                }
                if order(&estimate) > order(&range.largest) {
                    range.largest = estimate;
                }
            }
        }
    }
    Ok(modes)
}

/// Drops of the mean number of unstable modes per analysis from the first set of constraints to another one, panel by panel and on the same samples. A
/// drop is positive if the other set has fewer unstable modes, and negative if it has more.
pub struct Change<'a> {
    /// Number of panels compared.
    pub panels: usize,
    /// Number of panels with surely fewer unstable modes: the 95 % interval of the drop is above 0.
    pub fewer: usize,
    /// Number of panels with surely more: the interval is below 0.
    pub more: usize,
    /// Panel with the smallest drop, which may be negative, and the drop.
    pub least: (&'a Panel, Estimate),
    /// Panel with the largest drop, and the drop.
    pub most: (&'a Panel, Estimate),
}

impl<'a> Change<'a> {
    /// The change by a set of constraints, by its index; `None` where there is nothing to compare.
    pub fn new(results: &'a Results, constraints: usize) -> Option<Self> {
        let of_set = results
            .differences(ComparisonKind::Constraints, Confidence::P95)
            .filter(|(_, set, _)| set.key.constraints == constraints);
        let differences: Vec<(&Panel, Estimate)> = of_set.filter_map(|(_, set, d)| Some((set, d?))).collect();
        let by_value = |a: &&(&Panel, Estimate), b: &&(&Panel, Estimate)| a.1.value.total_cmp(&b.1.value);
        Some(Self {
            panels: differences.len(),
            fewer: differences.iter().filter(|(_, d)| d.lower > 0.0).count(),
            more: differences.iter().filter(|(_, d)| d.upper < 0.0).count(),
            least: *differences.iter().min_by(by_value)?,
            most: *differences.iter().max_by(by_value)?,
        })
    }
}

/// A drop of the mean number of unstable modes in words, with its limits: how many fewer or, of a negative drop, more.
pub fn drop_in_words(d: &Estimate) -> String {
    let word = if d.value < 0.0 { "more" } else { "fewer" };
    let limits = if d.value < 0.0 { [-d.upper, -d.lower] } else { [d.lower, d.upper] };
    format!("{:.3} {word} ({:.3} to {:.3})", d.value.abs(), limits[0], limits[1])
}

/// Counts of what all analyses of a study found unstable, and of what they left open; a conjugate pair counts once.
pub struct OpenCounts {
    /// Number of unstable modes found.
    pub unstable_modes: u64,
    /// Number of the unstable modes that could not be identified: they have no name, or several that are possible.
    pub ambiguous_modes: u64,
    /// Number of real eigenvalues that diverge.
    pub divergent: u64,
    /// Number of undecided verdicts, which count as stable.
    pub undecided: u64,
    /// Number of eigenvalues on the imaginary axis, to within rounding of the matrices.
    pub marginal: u64,
    /// Number of draws or evaluations that failed.
    pub failures: u64,
}

impl OpenCounts {
    /// The counts of all samples of a study.
    #[must_use]
    pub fn new(results: &Results) -> Self {
        let sum = |of: fn(&SceneTally) -> u64| results.summary.tally.scenes.iter().map(of).sum::<u64>();
        Self {
            unstable_modes: sum(|tally| tally.unstable_modes),
            ambiguous_modes: sum(|tally| tally.ambiguous_modes),
            divergent: sum(|tally| tally.divergent),
            undecided: sum(|tally| tally.undecided),
            marginal: sum(|tally| tally.marginal),
            failures: results.summary.failures.total(),
        }
    }
}

/// Warnings that every number of a study has to be read with, a sentence each: failures first, then undecided verdicts; empty if there are none of either.
pub fn warnings(results: &Results) -> Vec<String> {
    let (summary, mut found) = (&results.summary, Vec::new());
    let scenes = results.plan().scenes.len() as u64;
    let failed: u64 = (0..results.plan().scenes.len()).map(|scene| results.failed(scene)).sum();
    if failed > 0 {
        let first = summary.failures.listed().first();
        let first =
            first.map_or(String::new(), |first| format!("; the first, of sample {}: {}", first.index, first.message));
        found.push(format!(
            "{failed} of {} evaluations FAILED, and what failed may be unstable: upper limits are with all of them unstable{first}",
            summary.samples * scenes
        ));
    }
    let reasons: BTreeSet<Option<&str>> = results.unknown_errors.iter().copied().collect();
    for unknown in reasons {
        let all = || summary.tally.scenes.iter().zip(&results.errors_of_reduction).zip(&results.unknown_errors);
        let scenes = || all().filter(|(_, own)| **own == unknown).map(|(scene, _)| scene);
        let sum = |of: fn(&SceneTally) -> u64| scenes().map(|(tally, _)| of(tally)).sum::<u64>();
        let (undecided, samples) = (sum(|tally| tally.undecided), sum(|tally| tally.perhaps_unstable));
        if undecided > 0 {
            let open = scenes().filter(|(tally, _)| tally.undecided > 0);
            let error = open.map(|(_, error)| *error).fold(0.0, f64::max);
            let reason = match unknown {
                None if error > 0.0 => format!(
                    "the reduced brake has eigenvalues to within {} % of themselves, which is more than their distance from the limit of stability \
                     (a larger reduction.training lowers it)",
                    output::significant(100.0 * error, 2)
                ),
                None => "error bounds are larger than the distance from the limit of stability".to_owned(),
                Some(reason) => format!("{reason}, so that nothing is known of its errors"),
            };
            let (verdicts, count) = if undecided == 1 { ("verdict is", "counts") } else { ("verdicts are", "count") };
            let left_open = match samples {
                0 => "something else is unstable wherever that is so".to_owned(),
                1 => "in one evaluation it is open whether anything is unstable".to_owned(),
                _ => format!("in {samples} evaluations it is open whether anything is unstable"),
            };
            found.push(format!(
                "{undecided} {verdicts} UNDECIDED, because {reason}, and {count} as stable; {left_open}"
            ));
        }
    }
    found
}

/// Description of a panel in words: its law, the number of its contacts and its range of speed, as far as it has them.
pub fn place(results: &Results, panel: &Panel) -> String {
    let labels = &results.plan().labels;
    let mut place = labels.laws[panel.key.law].name.clone();
    match labels.panels[panel.key.panel].in_contact {
        0 => {}
        number => place += &format!(", {number} in contact"),
    }
    match panel.key.speed {
        _ if labels.speeds.is_empty() => {}
        None => place += ", any speed",
        Some(range) => place += &format!(", {} speed", labels.speeds[range].name),
    }
    place
}

#[cfg(test)]
mod tests {
    use study::SceneKey;

    use super::*;

    #[test]
    fn a_median_of_all_samples_is_not_every_sample() {
        let panel = Panel {
            key: SceneKey { constraints: 0, law: 0, panel: 0, speed: None },
            arrangements: 3,
            scenes: vec![0, 1, 2],
        };
        let occurrence = |value: f64| Estimate { value, lower: value, upper: value };
        let words = |smallest: f64, median: f64, largest: f64| {
            let (least, most) = ((occurrence(median), &panel), (occurrence(median), &panel));
            let [smallest, largest] = [smallest, largest].map(occurrence);
            ModeRange { least, most, is_ever_unstable: true, smallest, largest, greatest_limits: [0.0, 1.0] }.in_words()
        };
        assert_eq!(words(1.0, 1.0, 1.0), "unstable in every sample");
        assert_eq!(words(0.2, 1.0, 1.0), "unstable in some samples");
        assert_eq!(words(0.0, 0.0, 0.0), "perhaps unstable in some samples");
    }
}
