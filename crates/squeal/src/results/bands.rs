//! Unstable modes by third octaves, with a traffic light.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use montecarlo::Estimate;
use output::{Block, Cell, Cells, significant};
use study::{Panel, Strength, ThirdOctave};

use super::Results;
use super::findings::{LIKELY, SetFindings};
use super::study_results::ArrangementOccurrence;

/// Bands below the highest that are listed, at most; chosen: four decades.
const MOST_BANDS: u16 = 40;

/// Heading of the column with `red`, `amber` and `green`.
pub const LIGHT: &str = "Light";

/// Text for a reader of the lights, of a study of one arrangement or of several, in which names of unstable modes are open or not.
pub(super) fn lights(has_one_arrangement: bool, has_open_names: bool) -> String {
    let strength = match has_open_names {
        true => {
            " Growth and damping are of the modes listed: a mode whose name is open, or that has none, may grow faster."
        }
        false => "",
    };
    let [of, largest] = match has_one_arrangement {
        true => ["", ""],
        false => [" of an arrangement", "the largest of an arrangement, "],
    };
    format!(
        "Red: in most of the draws{of}, and surely so, some mode of this third octave is unstable, whichever name it has. Amber: in some of the \
         draws, or it may be. Green: in none, and nothing there is open. The occurrence is {largest}of all modes of the third octave together, \
         each draw once. A mode is listed where the median of its frequency lies, over the draws in which it is unstable; in parentheses where \
         only some of these draws reach the band, and nowhere where its name is open in all of them. A light with * is of a band that was studied in part. The last row is of anything at all, modes of \
         all third octaves and divergence together, each draw once: modes that alternate from draw to draw are more often unstable together than in \
         any band.{strength}"
    )
}

/// An unstable mode in a band.
struct InBand {
    label: String,
    strength: Option<Strength>,
    /// The median of its frequency lies in the band; otherwise its frequency does in a part of the draws alone.
    is_median: bool,
}

/// Third octaves of a set of constraints, from the lowest to the highest: of the plan's band, of which the ends may be studied in part, or, without a band, of
/// all modes; and of all measured frequencies.
fn studied(results: &Results, set: usize) -> Vec<ThirdOctave> {
    let modes = results.modes_of_set(set).into_iter().map(|(_, mode)| cea::frequency_hz(mode.lambda));
    let mut hertz: Vec<f64> = match results.plan().band {
        Some(ends) => ends.map(|omega| omega / TAU).to_vec(),
        None => modes.collect(),
    };
    hertz.extend(results.plan().measured.iter().flat_map(|of| &of.frequencies).map(|frequency| frequency.hz));
    hertz.into_iter().filter(|hz| *hz > 0.0).map(ThirdOctave::of_hertz).collect()
}

/// True if all of a third octave is in the band of the plan.
fn is_whole(results: &Results, octave: ThirdOctave) -> bool {
    let ends = octave.edges().map(|hz| TAU * hz);
    results.plan().band.is_none_or(|[from, to]| from <= ends[0] && ends[1] <= to)
}

/// Occurrence of any unstable mode of a third octave, or of anything unstable, over all arrangements of a set of constraints.
struct Occurring {
    /// Occurrence in the arrangement where it is largest.
    largest: Estimate,
    /// Largest lower limit of an arrangement, 0 to 1.
    lower: f64,
    /// A mode is unstable in any draw, or may be.
    is_ever: bool,
}

impl Occurring {
    fn new(results: &Results, set: usize, of_panel: impl Fn(&Panel) -> Vec<ArrangementOccurrence>) -> Self {
        let none = Estimate { value: 0.0, lower: 0.0, upper: 0.0 };
        let mut found = Self { largest: none, lower: 0.0, is_ever: false };
        for panel in results.panels().iter().filter(|panel| panel.key.constraints == set) {
            for occurrence in of_panel(panel) {
                let estimate = occurrence.estimate();
                found.is_ever |= occurrence.proportion.hits() + occurrence.proportion.ambiguous() > 0;
                found.lower = found.lower.max(estimate.lower);
                if [estimate.value, estimate.upper] > [found.largest.value, found.largest.upper] {
                    found.largest = estimate;
                }
            }
        }
        found
    }

    /// The traffic light, of a study whose reduction is doubtful or not.
    fn light(&self, is_doubtful: bool) -> &'static str {
        match self {
            of if of.lower > LIKELY => "red",
            of if of.is_ever || is_doubtful => "amber",
            _ => "green",
        }
    }

    /// The occurrence in percent, as a cell; a dash where nothing ever is unstable.
    fn cell(&self) -> Cell {
        number_or_none(self.is_ever.then_some(self.largest.value), |part| format!("{:.1}\u{a0}%", 100.0 * part))
    }
}

/// Number as a cell; a dash for none.
fn number_or_none(value: Option<f64>, text: impl Fn(f64) -> String) -> Cell {
    Cell { text: value.map_or_else(|| "-".into(), text), value: Some(value.unwrap_or(0.0)) }
}

/// Unstable modes of a set of constraints by third octaves, with the strength of each; `None` of a set without a mode that has a frequency.
pub(super) fn by_third_octaves(
    results: &Results,
    set: usize,
    found: &SetFindings<'_>,
    caption: String,
) -> Option<Block> {
    let mut bands: BTreeMap<ThirdOctave, Vec<InBand>> = BTreeMap::new();
    for (name, _) in &found.unstable {
        // A mode that never was surely the one that was unstable lies in no band that is known.
        let Some((hz, range)) = results.unstable_hertz(set, *name).and_then(|hz| Some((hz, hz.range?))) else {
            continue;
        };
        let median = ThirdOctave::of_hertz(hz.median);
        let [first, last] = [range.lower.max(f64::MIN_POSITIVE), range.upper].map(ThirdOctave::of_hertz);
        for octave in first.up_to(last) {
            let (label, strength) = (results.mode_label(set, *name), results.strength(set, *name));
            bands.entry(octave).or_default().push(InBand { label, strength, is_median: octave == median });
        }
    }
    let studied = studied(results, set);
    let seen: BTreeSet<ThirdOctave> = results
        .panels()
        .iter()
        .filter(|panel| panel.key.constraints == set)
        .flat_map(|panel| &panel.scenes)
        .flat_map(|&scene| results.summary.tally.scenes[scene].third_octaves.keys().copied())
        .collect();
    let octaves = || studied.iter().chain(bands.keys()).chain(&seen).copied();
    let last = octaves().max()?;
    // Rigid bodies have modes next to 0 Hz, of which nobody wants all bands.
    let first =
        octaves().min()?.max(last.below(MOST_BANDS)).min(bands.keys().chain(&seen).copied().min().unwrap_or(last));
    // Whole draws that the reduction did not have right may hold a mode anywhere.
    let is_doubtful = results.full_checks.as_ref().is_some_and(|checks| checks.missing + checks.other_verdicts > 0);
    let row = |octave: ThirdOctave| {
        let middle = octave.middle();
        let modes = bands.get(&octave).map_or(&[][..], Vec::as_slice);
        let here = || modes.iter().filter(|of| of.is_median);
        let occurring = Occurring::new(results, set, |panel| results.third_octave_occurrence(panel, octave));
        let light = occurring.light(is_doubtful);
        let names: Vec<String> =
            modes.iter().map(|of| if of.is_median { of.label.clone() } else { format!("({})", of.label) }).collect();
        let largest = |of: &dyn Fn(&InBand) -> Option<f64>| here().filter_map(of).max_by(f64::total_cmp);
        let growth = largest(&|of| Some(of.strength.as_ref()?.growth.range()?.upper));
        let damping = largest(&|of| Some(-of.strength.as_ref()?.damping_ratio.range()?.lower)).map(|least| -least);
        vec![
            Cell { text: significant(middle, 5), value: Some(middle) },
            format!("{light}{}", if is_whole(results, octave) { "" } else { " *" }).into(),
            if names.is_empty() { "-".to_owned() } else { names.join(", ") }.into(),
            occurring.cell(),
            number_or_none(growth, |rate| significant(rate, 3)),
            number_or_none(damping, |ratio| significant(ratio, 3)),
        ]
    };
    let columns =
        ["Third octave, Hz", LIGHT, "Modes", "Largest occurrence", "Largest growth, 1/s", "Worst damping ratio"];
    let anything = Occurring::new(results, set, |panel| results.any_occurrence(panel));
    let dash = || Cell::from("-".to_owned());
    let of_all = vec![
        "anything".to_owned().into(),
        anything.light(is_doubtful).to_owned().into(),
        dash(),
        anything.cell(),
        dash(),
        dash(),
    ];
    let rows = first.up_to(last).map(row).chain([of_all]).collect();
    Some(Block::Table(Cells { caption, columns: columns.map(str::to_owned).to_vec(), rows }))
}
