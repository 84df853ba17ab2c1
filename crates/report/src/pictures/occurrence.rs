//! The figures of any study.

use std::collections::BTreeSet;
use std::path::Path;

use figures::{
    Occurrence, OccurrenceArrangement, OccurrenceBox, OccurrenceFigure, OccurrenceLaw, OccurrenceMark, OccurrenceMode,
    OccurrencePanel, OccurrenceSeries, occurrence_boxes,
};
use squeal::results::{ArrangementOccurrence, Results, set_letter};
use squeal::study::{ModeLabel, ModeNaming, Panel, PanelLabel, Plan};

use crate::Error;

/// Draws one figure per constraint set and law, `occurrence-SET-LAW`, or `occurrence-SET` where there is one law.
///
/// # Errors
/// Those of the figures.
pub fn draw_occurrence(results: &Results, dir: &Path) -> Result<(), Error> {
    let Plan { name, labels, .. } = results.plan();
    for constraints in 0..labels.constraints.len() {
        for law in 0..labels.laws.len() {
            let (set_and_law, heading) = set_and_law(results, constraints, law);
            let data = occurrence(results, constraints, &[law], format!("{name}: {heading}"), Vec::new());
            occurrence_boxes(&data)?.save(dir, &format!("occurrence-{set_and_law}"))?;
        }
    }
    Ok(())
}

/// Name of a set of constraints and a law, in files and in headings; of the set alone where there is one law.
pub(super) fn set_and_law(results: &Results, constraints: usize, law: usize) -> (String, String) {
    let labels = &results.plan().labels;
    let (set, heading) = (&labels.constraints[constraints], set_heading(results, constraints));
    match &labels.laws[..] {
        [_] => (set.clone(), heading),
        laws => (format!("{set}-{}", laws[law].name), format!("{heading}, {} friction", laws[law].title)),
    }
}

/// Name of a set of constraints in headings.
pub fn set_heading(results: &Results, constraints: usize) -> String {
    let sets = &results.plan().labels.constraints;
    match sets.len() {
        1 => format!("constraints \"{}\"", sets[constraints]),
        _ => format!("set {}, \"{}\"", set_letter(constraints), sets[constraints]),
    }
}

/// The figure of the occurrences with `laws` under one set of constraints, by the indices of both in the plan.
pub fn occurrence(
    results: &Results,
    constraints: usize,
    laws: &[usize],
    title: String,
    marks: Vec<OccurrenceMark>,
) -> OccurrenceFigure {
    let labels = &results.plan().labels;
    let has_speed = laws.iter().flat_map(|&law| results.panels_of(constraints, law)).any(|p| p.key.speed.is_some());
    let shown = laws.iter().flat_map(|&law| results.panels_of(constraints, law));
    let names: BTreeSet<ModeLabel> = shown.flat_map(|panel| results.every_occurrence(panel).into_keys()).collect();
    let names: Vec<ModeLabel> = names.into_iter().collect();
    let mut of_laws = Vec::new();
    for &law in laws {
        let label = &labels.laws[law];
        let mut row = OccurrenceLaw { name: label.name.clone(), ..OccurrenceLaw::default() };
        if laws.len() > 1 {
            row.title.clone_from(&label.title);
        }
        for (number, PanelLabel { in_contact, .. }) in labels.panels.iter().enumerate() {
            let of_number = |panel: &&Panel| panel.key.panel == number;
            let panels: Vec<&Panel> = results.panels_of(constraints, law).filter(of_number).collect();
            let mut boxes = Vec::new();
            for panel in &panels {
                let series = if has_speed { panel.key.speed.unwrap_or(labels.speeds.len()) } else { 0 };
                for (name, occurrences) in results.every_occurrence(panel) {
                    let mode = names.iter().position(|other| *other == name).unwrap_or_default();
                    boxes.push(OccurrenceBox { mode, series, values: occurrences.iter().map(percent).collect() });
                }
            }
            row.panels.push(OccurrencePanel {
                title: match results.has_one_arrangement() {
                    true => "all draws".to_owned(),
                    false => format!("({}) {}", letter(number), in_words(*in_contact)),
                },
                in_contact: *in_contact,
                arrangements: panels.first().map_or(Vec::new(), |panel| arrangements(results, panel)),
                boxes,
            });
        }
        of_laws.push(row);
    }
    OccurrenceFigure {
        title,
        constraints: labels.constraints[constraints].clone(),
        mode_note: mode_note(results, constraints),
        modes: names
            .iter()
            .map(|&name| OccurrenceMode {
                label: results.mode_label(constraints, name),
                // A rank that is overdamped where modes have their names does not oscillate there.
                frequency_hz: results.frequency(constraints, name).unwrap_or(0.0),
            })
            .collect(),
        series: series(results, has_speed, laws.len()),
        marks,
        laws: of_laws,
    }
}

/// The ranges of speed, and all together where a law has no speed in it.
fn series(results: &Results, has_speed: bool, laws: usize) -> Vec<OccurrenceSeries> {
    let speeds = &results.plan().labels.speeds;
    let all = match (speeds.is_empty(), has_speed && laws > 1) {
        (true, _) => "all samples".to_owned(),
        (false, true) => "any speed: the law has none in it".to_owned(),
        (false, false) => {
            let ranges: Vec<&str> = speeds.iter().map(|speed| speed.description.as_str()).collect();
            format!("the same at {}: the law has no speed in it", ranges.join(", and at "))
        }
    };
    let each = speeds.iter().filter(|_| has_speed);
    let each = each.map(|speed| OccurrenceSeries { name: speed.name.clone(), description: speed.description.clone() });
    let all = OccurrenceSeries { name: "all".into(), description: all };
    each.chain((!has_speed || laws > 1).then_some(all)).collect()
}

/// Note on what the names of the modes mean.
fn mode_note(results: &Results, constraints: usize) -> String {
    let labels = &results.plan().labels;
    let counted = match results.labels {
        ModeNaming::Tracked => None,
        ModeNaming::Rank => Some("the number of its frequency rank in its own sample"),
        ModeNaming::Pair => Some("its place among all 2n eigenvalues of its own sample"),
        ModeNaming::RankDown => {
            Some("the number of its frequency rank in its own sample, counted from the highest down")
        }
        ModeNaming::PairDown => {
            Some("its place among all 2n eigenvalues of its own sample, counted from the highest down")
        }
    };
    let rank = match counted {
        None => format!(
            "a mode has the number of its frequency rank {}, where it has the frequency beside it, and is followed by its shape",
            labels.named_at
        ),
        Some(counted) => format!("a mode has {counted}; beside it the frequency {}", labels.named_at),
    };
    match labels.constraints.len() {
        1 => format!("Names: {rank}."),
        _ => format!(
            "Names: {} is the set \"{}\"; in each set {rank}. links.csv says which mode of one set is which of another.",
            set_letter(constraints),
            labels.constraints[constraints]
        ),
    }
}

/// The arrangements of a panel, each with the number of the scene that was solved for it.
fn arrangements(results: &Results, panel: &Panel) -> Vec<OccurrenceArrangement> {
    let names = &results.plan().labels.panels[panel.key.panel].arrangements;
    let system = |arrangement: usize| {
        let of_scene = |&scene: &usize| results.plan().scenes[scene].members.contains(&arrangement);
        panel.scenes.iter().position(of_scene).map_or(0, |at| at + 1)
    };
    names.iter().enumerate().map(|(i, name)| OccurrenceArrangement { name: name.clone(), system: system(i) }).collect()
}

/// An occurrence in percent.
fn percent(occurrence: &ArrangementOccurrence) -> Occurrence {
    let proportion = &occurrence.proportion;
    let estimate = occurrence.estimate();
    // From the counts and not from their quotient: 1.7 and not 1.7000000000000002.
    let part = |count: u64| 100.0 * count as f64 / proportion.trials().max(1) as f64;
    Occurrence {
        // A cross where nothing is known.
        samples: if occurrence.failed == proportion.trials() { 0 } else { proportion.trials() },
        percent: part(proportion.hits()),
        open: part(proportion.ambiguous()),
        lower: 100.0 * estimate.lower,
        upper: 100.0 * estimate.upper,
    }
}

fn letter(place: usize) -> char {
    char::from(b'a' + (place % 26) as u8)
}

/// Number of closed contacts in words; of a brake that has none there is nothing to count.
fn in_words(in_contact: usize) -> String {
    let words = ["one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"];
    match in_contact.checked_sub(1) {
        None => "one configuration".into(),
        Some(at) => format!("{} in contact", words.get(at).map_or(in_contact.to_string(), ToString::to_string)),
    }
}
