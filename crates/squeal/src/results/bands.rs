//! Unstable modes by third octaves, with a traffic light.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use output::{Block, Cell, Cells, significant};
use study::{Strength, divergence_doubt};

use super::Results;
use super::findings::{ModeRange, SetFindings};

/// Nominal middles of the ten third octaves of a decade (IEC 61260-1).
const NOMINAL: [f64; 10] = [1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0];

/// Bands below the highest that are listed, at most; chosen: four decades.
const MOST_BANDS: i32 = 40;

/// Heading of the column with `red`, `amber` and `green`.
pub const LIGHT: &str = "Light";

/// Number of the third octave that a frequency lies in, 0 of the one about 1 Hz: middles are 10^(n/10) Hz, edges 10^(n/10 -+ 1/20).
fn third_octave(hz: f64) -> i32 {
    (10.0 * hz.log10()).round() as i32
}

/// Nominal middle of a third octave, Hz.
fn middle(number: i32) -> f64 {
    NOMINAL[number.rem_euclid(10) as usize] * 10_f64.powi(number.div_euclid(10))
}

/// What a reader of the lights has to know.
pub(super) const LIGHTS: &str = "Red: a mode of this third octave is unstable in most of the draws of an arrangement, and surely so. Amber: \
     one is in some, or may be. Green: none was in any draw, and nothing is open. A mode lies where the median of its frequency does, over \
     the draws in which it is unstable; in parentheses where only some of these draws reach the band. A light with * is of a band that was studied in part.";

/// An unstable mode in a band.
struct InBand<'a> {
    label: String,
    range: &'a ModeRange<'a>,
    strength: Option<Strength>,
    /// The median of its frequency lies in the band; otherwise some of its draws reach it.
    is_median: bool,
}

/// Third octaves of a set of constraints, from the lowest to the highest in which modes are: those of the plan's band, of which the ends may be
/// studied in part, or those of all modes, and of all measured frequencies.
fn studied(results: &Results, set: usize) -> Vec<i32> {
    let modes = results.modes_of_set(set).into_iter().map(|(_, mode)| cea::frequency_hz(mode.lambda));
    let mut hertz: Vec<f64> = match results.plan().band {
        Some(ends) => ends.map(|omega| omega / TAU).to_vec(),
        None => modes.collect(),
    };
    hertz.extend(results.plan().measured.iter().flat_map(|of| &of.frequencies).map(|frequency| frequency.hz));
    hertz.into_iter().filter(|hz| *hz > 0.0).map(third_octave).collect()
}

/// True if all of a third octave is in the band of the plan.
fn is_whole(results: &Results, number: i32) -> bool {
    let ends = [-0.5, 0.5].map(|side| TAU * 10_f64.powf((f64::from(number) + side) / 10.0));
    results.plan().band.is_none_or(|[from, to]| from <= ends[0] && ends[1] <= to)
}

/// True if something may be unstable in any band: what has no frequency, a mode whose frequency in its unstable draws is not known, a verdict that is
/// open, divergence that was not looked for.
fn is_anything_open(results: &Results, set: usize, found: &SetFindings<'_>) -> bool {
    let is_open = |scene: usize| results.summary.tally.scenes[scene].undecided > 0 || results.failed(scene) > 0;
    let mut scenes = results.panels().iter().filter(|panel| panel.key.constraints == set).flat_map(|p| &p.scenes);
    let checks = results.full_checks.as_ref();
    found.unstable.iter().any(|(name, _)| results.unstable_hertz(set, *name).and_then(|hz| hz.range).is_none())
        || scenes.any(|&scene| is_open(scene))
        || divergence_doubt(results.plan(), results.has_band_modes, checks).is_some()
}

/// Unstable modes of a set of constraints by third octaves, with the strength of each; `None` of a set without a mode that has a frequency.
pub(super) fn by_third_octaves(
    results: &Results,
    set: usize,
    found: &SetFindings<'_>,
    caption: String,
) -> Option<Block> {
    let mut bands: BTreeMap<i32, Vec<InBand<'_>>> = BTreeMap::new();
    for (name, range) in &found.unstable {
        let Some(hz) = results.unstable_hertz(set, *name) else { continue };
        let median = third_octave(hz.median);
        let [first, last] =
            hz.range.map_or([median; 2], |of| [of.lower.max(f64::MIN_POSITIVE), of.upper].map(third_octave));
        for number in first..=last {
            let (label, strength) = (results.mode_label(set, *name), results.strength(set, *name));
            bands.entry(number).or_default().push(InBand { label, range, strength, is_median: number == median });
        }
    }
    let studied = studied(results, set);
    let numbers = || studied.iter().chain(bands.keys()).copied();
    let last = numbers().max()?;
    // Rigid bodies have modes next to 0 Hz, of which nobody wants all bands.
    let first = numbers().min()?.max(last - MOST_BANDS).min(bands.keys().next().copied().unwrap_or(last));
    let is_open = is_anything_open(results, set, found);
    let row = |number: i32| {
        let modes = bands.get(&number).map_or(&[][..], Vec::as_slice);
        let here = || modes.iter().filter(|of| of.is_median);
        let light = match modes {
            [] if !is_open => "green",
            _ if here().any(|of| of.range.is_likely_in_an_arrangement()) => "red",
            _ => "amber",
        };
        let names: Vec<String> =
            modes.iter().map(|of| if of.is_median { of.label.clone() } else { format!("({})", of.label) }).collect();
        let largest = |of: &dyn Fn(&InBand<'_>) -> Option<f64>| here().filter_map(of).max_by(f64::total_cmp);
        let occurrence = largest(&|of| Some(of.range.largest.value));
        let growth = largest(&|of| Some(of.strength.as_ref()?.growth.range()?.upper));
        let damping = largest(&|of| Some(-of.strength.as_ref()?.damping_ratio.range()?.lower)).map(|least| -least);
        let number_or_none = |value: Option<f64>, text: &dyn Fn(f64) -> String| Cell {
            text: value.map_or_else(|| "-".into(), text),
            value: Some(value.unwrap_or(0.0)),
        };
        vec![
            Cell { text: significant(middle(number), 5), value: Some(middle(number)) },
            format!("{light}{}", if is_whole(results, number) { "" } else { " *" }).into(),
            if names.is_empty() { "-".to_owned() } else { names.join(", ") }.into(),
            number_or_none(occurrence, &|part| format!("{:.1}\u{a0}%", 100.0 * part)),
            number_or_none(growth, &|rate| significant(rate, 3)),
            number_or_none(damping, &|ratio| significant(ratio, 3)),
        ]
    };
    let columns =
        ["Third octave, Hz", LIGHT, "Modes", "Largest occurrence", "Largest growth, 1/s", "Worst damping ratio"];
    let rows = (first..=last).map(row).collect();
    Some(Block::Table(Cells { caption, columns: columns.map(str::to_owned).to_vec(), rows }))
}

#[cfg(test)]
mod tests {
    use super::{middle, third_octave};

    #[test]
    fn frequencies_lie_in_the_third_octaves_of_the_norm() {
        for (hz, nominal) in [
            (1000.0, 1000.0),
            (1122.0, 1000.0),
            (1123.0, 1250.0),
            (2602.7, 2500.0),
            (5534.7, 5000.0),
            (5650.0, 6300.0),
            (12_000.0, 12_500.0),
            (0.2255, 0.25),
            (891.0, 800.0),
            (892.0, 1000.0),
        ] {
            assert!((middle(third_octave(hz)) / nominal - 1.0_f64).abs() < 1e-12, "{hz}: {}", middle(third_octave(hz)));
        }
    }
}
