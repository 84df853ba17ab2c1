//! The figures of any study.

use std::collections::BTreeSet;
use std::path::Path;

use super::Results;
use crate::Error;
use crate::figures::{OccurrenceBox, OccurrenceFigure, OccurrencePanel, OccurrenceRow, occurrence_boxes};
use crate::study::{ModeLabel, ModeNaming, PanelLabel, Plan};

/// Draws one figure per constraint set, `occurrence-NAME`, with a row of panels for each law.
///
/// # Errors
/// Those of the figures.
pub fn draw_occurrence(results: &Results<'_>, dir: &Path) -> Result<(), Error> {
    let Plan { name, labels, .. } = results.plan();
    let laws: Vec<usize> = (0..labels.laws.len()).collect();
    for (constraints, set) in labels.constraints.iter().enumerate() {
        let data = occurrence(results, constraints, &laws, format!("{name}: constraints \"{set}\""))?;
        occurrence_boxes(&data)?.save(dir, &format!("occurrence-{set}"))?;
    }
    Ok(())
}

/// The figure of some laws' occurrences under one constraint set, by the places of both in the plan.
pub(super) fn occurrence(
    results: &Results<'_>,
    constraints: usize,
    laws: &[usize],
    title: String,
) -> Result<OccurrenceFigure, Error> {
    let labels = &results.plan().labels;
    let mut series: Vec<String> = labels.speeds.iter().map(|speed| speed.description.clone()).collect();
    series.push("all speeds".into());
    let panels: Vec<_> = laws.iter().flat_map(|&law| results.panels_of(constraints, law)).collect();
    let names: BTreeSet<ModeLabel> = panels.iter().flat_map(|panel| results.occurrences(panel).into_keys()).collect();
    let names: Vec<ModeLabel> = names.into_iter().collect();

    let mut rows = Vec::new();
    for &law in laws {
        let mut row = OccurrenceRow { law: labels.laws[law].title.clone(), panels: Vec::new() };
        if laws.len() == 1 {
            row.law.clear();
        }
        for (place, PanelLabel { in_contact, arrangements }) in labels.panels.iter().enumerate() {
            let mut boxes = Vec::new();
            for panel in results.panels_of(constraints, law).filter(|panel| panel.key.panel == place) {
                for (name, occurrences) in results.occurrences(panel) {
                    let percent = occurrences.iter().map(|occurrence| 100.0 * occurrence.estimate().value).collect();
                    boxes.push(OccurrenceBox {
                        mode: names.iter().position(|&n| n == name).unwrap_or_default(),
                        series: panel.key.speed.unwrap_or(labels.speeds.len()),
                        percent,
                    });
                }
            }
            row.panels.push(OccurrencePanel {
                title: format!("({}) {}", letter(place), in_words(*in_contact)),
                arrangements: arrangements.clone(),
                boxes,
            });
        }
        rows.push(row);
    }
    let mode_axis = match results.labels {
        ModeNaming::Tracked => format!("tracked mode (frequency rank {})", labels.named_at),
        ModeNaming::Rank => "mode (frequency rank in its own sample)".into(),
        ModeNaming::Pair => "mode (place among all 2n eigenvalues of its own sample)".into(),
    };
    let modes = names.iter().map(ToString::to_string).collect();
    Ok(OccurrenceFigure { title, mode_axis, modes, series, rows })
}

fn letter(place: usize) -> char {
    char::from(b'a' + (place % 26) as u8)
}

/// How many contacts are closed; of a brake that has none there is nothing to count.
fn in_words(in_contact: usize) -> String {
    let words = ["one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"];
    match in_contact.checked_sub(1) {
        None => "one configuration".into(),
        Some(at) => format!("{} in contact", words.get(at).map_or(in_contact.to_string(), ToString::to_string)),
    }
}
