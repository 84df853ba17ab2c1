//! `summary.md`: which modes squeal, how sure that is, and which set of constraints helps by how much.

use montecarlo::Confidence;
use std::collections::BTreeMap;
use std::path::Path;

use super::results::Estimate;
use super::summary::hertz;
use super::{Results, set_letter};
use crate::Error;
use crate::output::write;
use crate::study::{ComparisonKind, ModeLabel, Panel, SetLinks};

/// A mode that is unstable in more than this part of the samples is called likely; chosen.
const LIKELY: f64 = 0.5;

/// The occurrences of a mode over all panels of a set of constraints.
struct ModeRange<'a> {
    /// The smallest median over the arrangements of a panel, and the largest.
    least: (Estimate, &'a Panel),
    most: (Estimate, &'a Panel),
    /// Whether it is unstable, or may be, in any sample.
    is_ever_unstable: bool,
    /// In the arrangement where it is unstable most often.
    largest: Estimate,
}

/// Writes `summary.md`.
pub(super) fn write_summary(results: &Results<'_>, links: &[SetLinks], dir: &Path) -> Result<(), Error> {
    let labels = &results.plan().labels;
    let mut text = format!(
        "# {}\n\n{} samples of each arrangement, law and speed range. The occurrence of a mode is the part of the samples in \
         which it is unstable; of a panel (one law, number in contact and speed range) the median over its arrangements. In \
         parentheses are 95 % intervals; samples in which an unstable mode may be this one or another widen them upwards.\n",
        results.plan().name,
        results.summary.samples
    );
    let ranges = (0..labels.constraints.len())
        .map(|constraints| mode_ranges(results, constraints))
        .collect::<Result<Vec<_>, Error>>()?;
    for (constraints, ranges) in ranges.iter().enumerate() {
        text += &squealing(results, constraints, ranges);
    }
    text += &open_questions(results);
    if labels.constraints.len() > 1 {
        text += "\n## What helps\n\nUnstable modes per analysis, compared with the first set on the same samples:\n\n";
        for constraints in 1..labels.constraints.len() {
            text += &helped(results, constraints);
        }
        for link in links.iter().filter(|link| link.from == 0) {
            text += &followed(results, link, &ranges);
        }
    }
    write(&dir.join("summary.md"), text.as_bytes())
}

fn mode_ranges<'a>(results: &'a Results<'_>, constraints: usize) -> Result<BTreeMap<ModeLabel, ModeRange<'a>>, Error> {
    let mut modes = BTreeMap::new();
    let none = Estimate { value: 0.0, lower: 0.0, upper: 0.0 };
    for panel in results.panels().iter().filter(|panel| panel.key.constraints == constraints) {
        for (name, occurrences) in results.all_occurrences(panel) {
            let median = results.median(&occurrences)?;
            let first =
                || ModeRange { least: (median, panel), most: (median, panel), is_ever_unstable: false, largest: none };
            let range = modes.entry(name).or_insert_with(first);
            let order = |e: &Estimate| [e.value, e.upper];
            if order(&median) < order(&range.least.0) {
                range.least = (median, panel);
            }
            if order(&median) > order(&range.most.0) {
                range.most = (median, panel);
            }
            for occurrence in &occurrences {
                range.is_ever_unstable |= occurrence.proportion.hits() + occurrence.proportion.ambiguous() > 0;
                let estimate = occurrence.estimate();
                if order(&estimate) > order(&range.largest) {
                    range.largest = estimate;
                }
            }
        }
    }
    Ok(modes)
}

/// The modes of a set of constraints that are ever unstable, the most robust first.
fn squealing(results: &Results<'_>, constraints: usize, ranges: &BTreeMap<ModeLabel, ModeRange<'_>>) -> String {
    let (mut unstable, stable): (Vec<_>, Vec<_>) = ranges.iter().partition(|(_, range)| range.is_ever_unstable);
    unstable.sort_by(|(_, a), (_, b)| {
        let key = |range: &ModeRange<'_>| [range.least.0, range.most.0, range.largest].map(|e| (e.value * 1e9) as u64);
        key(b).cmp(&key(a))
    });
    let names = |list: Vec<String>| if list.is_empty() { "none".to_owned() } else { list.join(", ") };
    let everywhere = unstable.iter().filter(|(_, range)| range.least.0.lower > LIKELY);
    let somewhere = unstable.iter().filter(|(_, range)| range.most.0.lower > LIKELY && range.least.0.lower <= LIKELY);
    let label = |name: ModeLabel| results.mode_label(constraints, name);
    let mut text = format!(
        "\n## Set {}\n\nUnstable in more than half of the samples, sure to 95 %: in every panel {}; in some panels {}.\n",
        set_name(results, constraints),
        names(everywhere.map(|(name, _)| label(**name)).collect()),
        names(somewhere.map(|(name, _)| label(**name)).collect())
    );
    if !unstable.is_empty() {
        text += "\n| mode | Hz | least of a panel | largest of a panel | where | largest of an arrangement |\n";
        text += "| --- | --- | --- | --- | --- | --- |\n";
    }
    for (name, range) in &unstable {
        text += &format!(
            "| {} | {} | {} | {} | {} | {} |\n",
            label(**name),
            frequency(results, constraints, **name),
            with_limits(&range.least.0),
            with_limits(&range.most.0),
            if range.most.0.value > 0.0 { place(results, range.most.1) } else { "-".into() },
            with_limits(&range.largest)
        );
    }
    if !stable.is_empty() {
        let upper = stable.iter().map(|(_, range)| range.largest.upper).fold(0.0, f64::max);
        text += &format!(
            "\nModes that are unstable in no sample: {}; of the samples of an arrangement each is unstable in at most {:.2} % \
             (95 %).\n",
            stable.len(),
            100.0 * upper
        );
    }
    text
}

/// What the samples leave open.
fn open_questions(results: &Results<'_>) -> String {
    let sum = |of: fn(&crate::study::SceneTally) -> u64| results.summary.tally.scenes.iter().map(of).sum::<u64>();
    format!(
        "\n## What is left open\n\nOf {} unstable modes found, {} have a name that is open, near a coalescence. {} verdicts are \
         undecided and count as stable. {} draws or evaluations failed.\n",
        sum(|tally| tally.unstable_modes),
        sum(|tally| tally.ambiguous_modes),
        sum(|tally| tally.undecided),
        results.summary.failures.total()
    )
}

/// By how much a set of constraints changes the number of unstable modes.
fn helped(results: &Results<'_>, constraints: usize) -> String {
    let of_set = results
        .differences(ComparisonKind::Constraints, Confidence::P95)
        .filter(|(_, set, _)| set.key.constraints == constraints);
    let differences: Vec<(&Panel, Estimate)> = of_set.filter_map(|(_, set, d)| Some((set, d?))).collect();
    let name = set_name(results, constraints);
    let by_value = |a: &&(&Panel, Estimate), b: &&(&Panel, Estimate)| a.1.value.total_cmp(&b.1.value);
    let (Some(least), Some(most)) = (differences.iter().min_by(by_value), differences.iter().max_by(by_value)) else {
        return format!("- **{name}**: nothing to compare.\n");
    };
    let fewer = differences.iter().filter(|(_, d)| d.lower > 0.0).count();
    let more = differences.iter().filter(|(_, d)| d.upper < 0.0).count();
    let change = |(panel, d): &(&Panel, Estimate)| {
        let word = if d.value < 0.0 { "more" } else { "fewer" };
        let limits = if d.value < 0.0 { [-d.upper, -d.lower] } else { [d.lower, d.upper] };
        format!("{:.3} {word} ({:.3} to {:.3}) with {}", d.value.abs(), limits[0], limits[1], place(results, panel))
    };
    format!(
        "- **{name}**: fewer in {fewer} of {} panels, more in {more}, no difference that is sure in {}; from {} to {}.\n",
        differences.len(),
        differences.len() - fewer - more,
        change(least),
        change(most)
    )
}

/// What becomes of each mode of the first set that is ever unstable.
fn followed(results: &Results<'_>, link: &SetLinks, ranges: &[BTreeMap<ModeLabel, ModeRange<'_>>]) -> String {
    let mut text = format!(
        "\nWhat becomes of the modes of {} under {}, by continuation as the constraints come in; MAC compares the two shapes, \
         occurrences are the least and the largest of a panel:\n\n| mode | Hz | occurrence | becomes | Hz | MAC | occurrence |\n\
         | --- | --- | --- | --- | --- | --- | --- |\n",
        set_name(results, link.from),
        set_name(results, link.to)
    );
    let ends = |constraints: usize, name: ModeLabel| {
        let range = ranges[constraints].get(&name)?;
        Some(format!("{:.3} to {:.3}", range.least.0.value, range.most.0.value))
    };
    let targets = results.modes_of_set(link.to);
    for (i, (name, mode)) in results.modes_of_set(link.from).into_iter().enumerate() {
        if !ranges[link.from].get(&name).is_some_and(|range| range.is_ever_unstable) {
            continue;
        }
        let before = format!(
            "| {} | {} | {} |",
            results.mode_label(link.from, name),
            hertz(cea::frequency_hz(mode.lambda)),
            ends(link.from, name).unwrap_or_default()
        );
        let open = if link.becomes[i].len() > 1 { " or another" } else { "" };
        for to in &link.becomes[i] {
            text += &match to {
                None => format!("{before} held{open} | | | |\n"),
                Some(j) => {
                    let (target, mode) = targets[*j];
                    format!(
                        "{before} {}{open} | {} | {:.2} | {} |\n",
                        results.mode_label(link.to, target),
                        hertz(cea::frequency_hz(mode.lambda)),
                        link.mac[(i, *j)],
                        ends(link.to, target).unwrap_or_default()
                    )
                }
            };
        }
    }
    text
}

fn set_name(results: &Results<'_>, constraints: usize) -> String {
    let sets = &results.plan().labels.constraints;
    match sets.len() {
        1 => format!("\"{}\"", sets[constraints]),
        _ => format!("{}, \"{}\"", set_letter(constraints), sets[constraints]),
    }
}

fn frequency(results: &Results<'_>, constraints: usize, name: ModeLabel) -> String {
    results.frequency(constraints, name).map_or("-".into(), hertz)
}

fn with_limits(e: &Estimate) -> String {
    format!("{:.3} ({:.3} to {:.3})", e.value, e.lower, e.upper)
}

/// Law, number in contact and speed of a panel.
fn place(results: &Results<'_>, panel: &Panel) -> String {
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
