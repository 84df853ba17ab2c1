//! What squeals beside what was measured: hits, misses, and modes that nobody heard.

use std::fmt::Write as _;

use montecarlo::{Confidence, Proportion};
use output::{Block, Cell, Cells, Table, significant};
use study::{Measured, MeasuredFrequency, ModeLabel, ThirdOctave};

use super::findings::SetFindings;
use super::{Estimate, Results, UnstableHertz};

/// Rule of the comparison, for whoever reads one.
pub(super) const RULE: &str = "A measured frequency is hit where the occurrence of a mode within its tolerance surely is above the \
     share in some arrangement; open where it may be, as with few samples, or where modes some of whose draws reach the tolerance may be above the share \
     together, as where one squeal has other names from draw to draw; missed else. A mode within the tolerance of several counts for the one that is nearest in \
     tolerances; the others are open, as it may be any of them. A mode lies where the median of its frequency \
     does, over the draws in which it is unstable; the median is known to 1 in 2048, and within the tolerance where it may be. One whose name is \
     open in all of these draws has no such frequency, as that at the medians is not where it squeals: a measured frequency is open where it may be it, by \
     what is unstable in the third octaves of the tolerance. Modes that are unstable in some draw, and may be in more than the share of them, next to no \
     measured frequency, stand below as not measured.";

/// Finding on a mode whose frequency where it is unstable is not known.
const NOT_PLACED: &str = "not placed";

/// Finding on a measured frequency.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Found {
    /// A mode within the tolerance surely squeals in more than the share of the draws.
    Hit,
    /// One may, or a mode without a known frequency may be there.
    Open,
    /// None does.
    Missed,
    /// None does, and a frequency within the tolerance is outside of the band that is studied.
    NotStudied,
}

impl Found {
    const fn name(self) -> &'static str {
        match self {
            Self::Hit => "hit",
            Self::Open => "open",
            Self::Missed => "missed",
            Self::NotStudied => "outside of the band",
        }
    }
}

/// Mode with its frequency.
struct Placed {
    name: ModeLabel,
    label: String,
    hz: UnstableHertz,
    /// Its largest value of an arrangement, and the largest lower and upper limits of any.
    occurrence: Estimate,
    is_ever_unstable: bool,
}

/// A set of constraints beside what was measured.
pub(super) struct Beside<'a> {
    set: usize,
    measured: Vec<(&'a MeasuredFrequency, Found)>,
    /// Modes with a frequency that are ever unstable, or may be in more than the share of the draws, ascending.
    modes: Vec<Placed>,
    /// Modes that are unstable, and may be in more than the share of the draws, at frequencies that are not known: in all of these draws their names are
    /// open. That at the medians says nothing of where they are then.
    unplaced: Vec<Placed>,
    share: f64,
}

impl<'a> Beside<'a> {
    fn new(results: &'a Results, set: usize, found: &SetFindings<'_>, measured: &'a Measured) -> Self {
        let (mut modes, mut unplaced, mut has_unplaced) = (Vec::new(), Vec::new(), false);
        let all = found.unstable.iter().map(|mode| (mode, true)).chain(found.stable.iter().map(|mode| (mode, false)));
        for ((name, range), is_ever_unstable) in all.filter(|((name, _), _)| *name != ModeLabel::DIVERGENCE) {
            let [lower, upper] = range.greatest_limits;
            if !is_ever_unstable && upper <= measured.share {
                continue;
            }
            let occurrence = Estimate { value: range.largest.value, lower, upper };
            match results.unstable_hertz(set, *name) {
                Some(hz) => {
                    let label = results.mode_label(set, *name);
                    let mode = Placed { name: *name, label, hz, occurrence, is_ever_unstable };
                    if !is_placed(&mode) {
                        has_unplaced |= upper > measured.share;
                        unplaced.extend((upper > measured.share).then_some(mode));
                    } else {
                        modes.push(mode);
                    }
                }
                None => has_unplaced |= is_ever_unstable && upper > measured.share,
            }
        }
        modes.sort_by(|a, b| a.hz.median.total_cmp(&b.hz.median));
        let is_outside = |frequency: &MeasuredFrequency| {
            let ends = [-1.0, 1.0].map(|side| std::f64::consts::TAU * (frequency.hz + side * frequency.tolerance_hz));
            results.plan().band.is_some_and(|[from, to]| ends.iter().any(|end| !(from..=to).contains(end)))
        };
        let verdict = |frequency: &'a MeasuredFrequency| {
            let near = || modes.iter().filter(|mode| is_near(frequency, mode));
            let mut own = near().filter(|mode| is_nearest(frequency, mode, &measured.frequencies));
            let found = if own.any(|mode| mode.occurrence.lower > measured.share) {
                Found::Hit
            } else if near().any(|mode| mode.occurrence.upper > measured.share)
                || modes.iter().filter(|mode| reaches(frequency, mode)).map(|mode| mode.occurrence.upper).sum::<f64>()
                    > measured.share
            {
                Found::Open
            } else if is_outside(frequency) {
                Found::NotStudied
            } else if has_unplaced && upper_near(results, set, frequency) > measured.share {
                Found::Open
            } else {
                Found::Missed
            };
            (frequency, found)
        };
        let measured_frequencies = measured.frequencies.iter().map(verdict).collect();
        Self { set, measured: measured_frequencies, modes, unplaced, share: measured.share }
    }

    /// Modes that count for a measured frequency.
    fn near(&self, frequency: &MeasuredFrequency) -> Vec<&Placed> {
        let counts = |mode: &&Placed| {
            is_near(frequency, mode) && is_nearest(frequency, mode, self.measured.iter().map(|(other, _)| *other))
        };
        self.modes.iter().filter(counts).collect()
    }

    /// Modes that may be squeal and are next to nothing that was measured.
    fn not_measured(&self) -> Vec<&Placed> {
        let is_measured = |mode: &Placed| self.measured.iter().any(|(frequency, _)| is_near(frequency, mode));
        let may_squeal = |mode: &&Placed| mode.is_ever_unstable && mode.occurrence.upper > self.share;
        self.modes.iter().filter(may_squeal).filter(|mode| !is_measured(mode)).collect()
    }

    /// Number of measured frequencies with a finding.
    fn count(&self, found: Found) -> usize {
        self.measured.iter().filter(|(_, other)| *other == found).count()
    }
}

/// True of a mode with a frequency: where it is unstable or, of one that never is, at the medians.
fn is_placed(mode: &Placed) -> bool {
    mode.hz.range.is_some() || !mode.is_ever_unstable
}

/// True if a mode may be within the tolerance of a measured frequency: its own is known to an error.
fn is_near(frequency: &MeasuredFrequency, mode: &Placed) -> bool {
    (mode.hz.median - frequency.hz).abs() <= frequency.tolerance_hz + mode.hz.error
}

/// True if a mode is as near to a measured frequency as to any, in tolerances: within several of them it is one squeal and not several. Of two that are as near it is
/// the lower one.
fn is_nearest<'a>(
    frequency: &MeasuredFrequency,
    mode: &Placed,
    all: impl IntoIterator<Item = &'a MeasuredFrequency>,
) -> bool {
    let order = |of: &MeasuredFrequency| ((mode.hz.median - of.hz).abs() / of.tolerance_hz, of.hz);
    all.into_iter().all(|other| order(frequency) <= order(other))
}

/// True if a mode may be within the tolerance of a measured frequency in any of the draws in which it is unstable.
fn reaches(frequency: &MeasuredFrequency, mode: &Placed) -> bool {
    let [from, to] = [-1.0, 1.0].map(|side| frequency.hz + side * (frequency.tolerance_hz + mode.hz.error));
    mode.is_ever_unstable && mode.hz.range.is_some_and(|range| range.lower <= to && range.upper >= from)
}

/// Largest upper limit, 0 to 1, in any arrangement of a set of constraints of the occurrence of any mode, whatever its name, in the third octaves that
/// the tolerance of a measured frequency meets.
fn upper_near(results: &Results, set: usize, frequency: &MeasuredFrequency) -> f64 {
    let end = |side: f64| (frequency.hz + side * frequency.tolerance_hz).max(f64::MIN_POSITIVE);
    let [first, last] = [-1.0, 1.0].map(|side| ThirdOctave::of_hertz(end(side)));
    let upper = |&scene: &usize| {
        let tally = &results.summary.tally.scenes[scene];
        let counts = tally.third_octaves.range(first..=last).map(|(_, found)| [found.unstable, found.perhaps]);
        // A draw may be in several of them.
        let [unstable, perhaps] = counts.fold([0, 0], |[a, b], [unstable, perhaps]| [a + unstable, b + perhaps]);
        let proportion = Proportion::of_counts(unstable, perhaps, tally.solved).and_unknown(results.failed(scene));
        proportion.interval(Confidence::P95).upper
    };
    let panels = results.panels().iter().filter(|panel| panel.key.constraints == set);
    panels.flat_map(|panel| &panel.scenes).map(upper).fold(0.0, f64::max)
}

impl Results {
    /// Each set of constraints beside what was measured; none where the plan has nothing measured.
    pub(super) fn beside_measured<'a>(&'a self, findings: &[SetFindings<'_>]) -> Vec<Beside<'a>> {
        let Some(measured) = &self.plan().measured else { return Vec::new() };
        findings.iter().enumerate().map(|(set, found)| Beside::new(self, set, found, measured)).collect()
    }

    /// Text of what squeals beside what was measured, for people; empty where nothing was.
    ///
    /// # Errors
    /// None for the results of a study.
    pub fn measured_text(&self) -> Result<String, crate::Error> {
        let mut text = String::new();
        for beside in self.beside_measured(&self.findings()?) {
            let (hits, all) = (beside.count(Found::Hit), beside.measured.len());
            let set = &self.plan().labels.constraints[beside.set];
            let _ = writeln!(text, "measured, {set}: {hits} of {all} frequencies hit, {}", shares(beside.share));
            for (frequency, found) in &beside.measured {
                let near: Vec<String> = beside.near(frequency).into_iter().map(in_words).collect();
                let near = if near.is_empty() { String::new() } else { format!(": {}", near.join(", ")) };
                let (hz, tolerance) = (significant(frequency.hz, 6), significant(frequency.tolerance_hz, 3));
                let _ = writeln!(text, "  {hz} Hz +- {tolerance}: {}{near}", found.name());
            }
            let others: Vec<String> = beside.not_measured().into_iter().map(in_words).collect();
            if !others.is_empty() {
                let _ = writeln!(text, "  unstable and not measured: {}", others.join(", "));
            }
            let unplaced: Vec<String> = beside.unplaced.iter().map(without_place).collect();
            if !unplaced.is_empty() {
                let _ = writeln!(
                    text,
                    "  unstable at frequencies that are not known, as names are open: {}",
                    unplaced.join(", ")
                );
            }
        }
        Ok(text)
    }
}

/// Words on the share of the draws: a mode that is unstable in more counts.
fn shares(share: f64) -> String {
    format!("by modes unstable in more than {} % of the draws", significant(100.0 * share, 3))
}

fn in_words(mode: &Placed) -> String {
    format!("mode {} ({} Hz) {}", mode.label, mode.hz, with_limits(mode))
}

/// Words for a mode whose frequency where it is unstable is not known.
fn without_place(mode: &Placed) -> String {
    format!("mode {} ({} Hz at the medians) {}", mode.label, mode.hz, with_limits(mode))
}

/// Occurrence of a mode in percent, with its limits.
fn with_limits(mode: &Placed) -> String {
    let Estimate { value, lower, upper } = mode.occurrence;
    let [value, lower, upper] = [value, lower, upper].map(|part| 100.0 * part);
    format!("{value:.1} % ({lower:.1} to {upper:.1})")
}

/// Table of a set of constraints for people.
pub(super) fn in_cells(beside: &Beside<'_>, caption: String) -> Block {
    let number = |value: f64, text: String| Cell { text, value: Some(value) };
    let dash = || Cell::from("-".to_owned());
    let of_mode = |mode: Option<&Placed>| match mode {
        None => vec![dash(), dash(), dash()],
        Some(mode) => {
            let Estimate { value, lower, upper } = mode.occurrence;
            let [percent, lower, upper] = [value, lower, upper].map(|part| 100.0 * part);
            let limits = format!("{percent:.1}\u{a0}% ({lower:.1} to {upper:.1})");
            let hz = if is_placed(mode) { number(mode.hz.median, mode.hz.to_string()) } else { dash() };
            vec![mode.label.clone().into(), hz, number(value, limits)]
        }
    };
    let mut rows = Vec::new();
    for (frequency, found) in &beside.measured {
        let near = beside.near(frequency);
        let modes: Vec<Option<&Placed>> =
            if near.is_empty() { vec![None] } else { near.into_iter().map(Some).collect() };
        for mode in modes {
            let mut row = vec![
                number(frequency.hz, significant(frequency.hz, 6)),
                number(frequency.tolerance_hz, significant(frequency.tolerance_hz, 3)),
                found.name().to_owned().into(),
            ];
            row.extend(of_mode(mode));
            rows.push(row);
        }
    }
    for mode in beside.not_measured() {
        let first = [dash(), dash(), "not measured".to_owned().into()];
        rows.push(first.into_iter().chain(of_mode(Some(mode))).collect());
    }
    for mode in &beside.unplaced {
        let first = [dash(), dash(), NOT_PLACED.to_owned().into()];
        rows.push(first.into_iter().chain(of_mode(Some(mode))).collect());
    }
    let columns = ["Measured, Hz", "Tolerance, Hz", "Found", "Mode", "Hz", "Largest occurrence"];
    let (hits, all) = (beside.count(Found::Hit), beside.measured.len());
    let caption = format!("{caption}: {hits} of {all} frequencies hit, {}", shares(beside.share));
    Block::Table(Cells { caption, columns: columns.map(str::to_owned).to_vec(), rows })
}

/// The table `measured`: a row for each mode next to a measured frequency, or for that without one; then modes that were not measured.
pub(super) fn table(results: &Results, all: &[Beside<'_>]) -> Table {
    let mut rows = Vec::new();
    for beside in all {
        let set = &results.plan().labels.constraints[beside.set];
        let of_mode = |mode: Option<&Placed>| {
            let Some(Placed { name, label, hz, occurrence: Estimate { value, lower, upper }, .. }) = mode else {
                return vec![String::new(); 6];
            };
            let hz = mode.filter(|mode| is_placed(mode)).map_or(String::new(), |_| hz.median.to_string());
            let numbers = [value, lower, upper].map(ToString::to_string);
            [name.to_string(), label.clone(), hz].into_iter().chain(numbers).collect()
        };
        for (frequency, found) in &beside.measured {
            let (near, MeasuredFrequency { hz, tolerance_hz }) = (beside.near(frequency), frequency);
            let first = [set.clone(), hz.to_string(), tolerance_hz.to_string(), found.name().to_owned()];
            let modes: Vec<Option<&Placed>> =
                if near.is_empty() { vec![None] } else { near.into_iter().map(Some).collect() };
            rows.extend(modes.into_iter().map(|mode| first.iter().cloned().chain(of_mode(mode)).collect::<Vec<_>>()));
        }
        let first = [set.clone(), String::new(), String::new(), "not measured".to_owned()];
        let others = beside.not_measured().into_iter();
        rows.extend(others.map(|mode| first.iter().cloned().chain(of_mode(Some(mode))).collect::<Vec<_>>()));
        let first = [set.clone(), String::new(), String::new(), NOT_PLACED.to_owned()];
        let unplaced = beside.unplaced.iter();
        rows.extend(unplaced.map(|mode| first.iter().cloned().chain(of_mode(Some(mode))).collect::<Vec<_>>()));
    }
    let header = [
        "constraints",
        "measured_hz",
        "tolerance_hz",
        "found",
        "mode",
        "label",
        "frequency_hz",
        "occurrence",
        "lower",
        "upper",
    ];
    Table::new("measured", header, rows)
}
