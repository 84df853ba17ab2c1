//! Unstable modes by third octaves, with a traffic light.

use std::collections::BTreeMap;

use output::{Block, Cell, Cells, significant};
use study::Strength;

use super::Results;
use super::findings::{ModeRange, SetFindings};

/// Nominal middles of the ten third octaves of a decade (IEC 61260-1).
const NOMINAL: [f64; 10] = [1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0];

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

/// An unstable mode in its band.
struct InBand<'a> {
    label: String,
    range: &'a ModeRange<'a>,
    strength: Option<Strength>,
}

/// Unstable modes of a set of constraints by third octaves, with the strength of each; `None` where there is none that has a frequency.
pub(super) fn by_third_octaves(
    results: &Results,
    set: usize,
    found: &SetFindings<'_>,
    caption: String,
) -> Option<Block> {
    let mut bands: BTreeMap<i32, Vec<InBand<'_>>> = BTreeMap::new();
    // Unstable modes without a name may be in any band.
    let mut has_unplaced = false;
    for (name, range) in &found.unstable {
        let strength = results.strength(set, *name);
        let Some(hz) = results.unstable_frequency(set, *name) else {
            has_unplaced = true;
            continue;
        };
        let label = results.mode_label(set, *name);
        bands.entry(third_octave(hz)).or_default().push(InBand { label, range, strength });
    }
    let (first, last) = (*bands.keys().next()?, *bands.keys().next_back()?);
    let row = |number: i32| {
        let modes = bands.get(&number).map_or(&[][..], Vec::as_slice);
        let light = match modes {
            [] if has_unplaced => "amber",
            [] => "green",
            _ if modes.iter().any(|of| of.range.is_likely_everywhere() || of.range.is_likely_somewhere()) => "red",
            _ => "amber",
        };
        let names: Vec<&str> = modes.iter().map(|of| of.label.as_str()).collect();
        let largest = |of: &dyn Fn(&InBand<'_>) -> Option<f64>| modes.iter().filter_map(of).max_by(f64::total_cmp);
        let occurrence = largest(&|of| Some(of.range.largest.value));
        let growth = largest(&|of| Some(of.strength.as_ref()?.growth.range()?.upper));
        let damping = largest(&|of| Some(-of.strength.as_ref()?.damping_ratio.range()?.lower)).map(|least| -least);
        let number_or_none = |value: Option<f64>, text: &dyn Fn(f64) -> String| Cell {
            text: value.map_or_else(|| "-".into(), text),
            value: Some(value.unwrap_or(0.0)),
        };
        vec![
            Cell { text: significant(middle(number), 5), value: Some(middle(number)) },
            light.to_owned().into(),
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
