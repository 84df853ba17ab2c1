//! The numbers of a study for the script of its page.

use std::path::Path;

use output::Table;
use serde_json::{Value, json};
use squeal::results::Results;
use squeal::study::SceneLabels;

use super::Geometry;
use super::shapes;
use super::tables::{grouped_on_page, on_page, read, with_rows};
use crate::Error;

/// The tables of a study that the page shows, and what they are about. `occurrence.csv` is apart.
const TABLES: [(&str, &str); 14] = [
    ("divergence.csv", "Draws of the whole brake in which something grows faster than it oscillates"),
    ("modes.csv", "The modes of each set of constraints where they have their names"),
    (
        "growth.csv",
        "How fast unstable modes grow, at which frequency and damping ratio, over the draws in which they do",
    ),
    ("measured.csv", "Measured frequencies with the modes next to them, and modes that were not measured"),
    ("panels.csv", "Unstable modes per analysis"),
    (
        "differences.csv",
        "Differences of two panels on the same samples: positive where the second has fewer unstable modes",
    ),
    ("links.csv", "Which mode of a set of constraints is which of one that holds more"),
    ("net_work.csv", "Net work of friction and damping on each body in unstable modes, per cycle and mass of the mode"),
    ("family_work.csv", "The same work by family of forces"),
    ("sensitivities.csv", "What changes the growth of unstable modes at median parameters, and how far that holds"),
    ("estimates.csv", "Occurrences to the half width that was asked for, by the cheapest estimator"),
    (
        "cycles_by_mode.csv",
        "The motions that unstable modes of draws grow into: how many are cycles, and how loud they are",
    ),
    ("cycles_by_scene.csv", "Whether the mode that grows fastest makes the loudest motion"),
    ("failures.csv", "Draws and evaluations that failed"),
];

/// Data that the page of a study draws and lists. The tables are those in `dir`.
pub(super) fn of_study(results: &Results, geometry: &Geometry<'_>, dir: &Path) -> Result<Value, Error> {
    let labels = &results.plan().labels;
    let mut tables = vec![by_panel(results)?];
    if let Some(table) = read(dir, "occurrence.csv")? {
        let about = match results.has_one_arrangement() {
            true => "How often each mode is unstable",
            false => "How often each mode is unstable in each arrangement",
        };
        let key = SceneLabels::MODE_COLUMNS.len() - 2;
        let grouped = grouped_on_page(&table, "occurrence.csv", about, key);
        tables.push(grouped.unwrap_or_else(|| on_page(&table, "occurrence.csv", about)));
    }
    tables.extend(with_rows(dir, &TABLES)?);
    let titles: Vec<&str> = labels.laws.iter().map(|law| law.title.as_str()).collect();
    let speeds: Vec<[&str; 2]> = labels.speeds.iter().map(|speed| [&*speed.name, &*speed.description]).collect();
    Ok(json!({
        "sets": labels.constraints,
        "laws": labels.laws.iter().map(|law| &law.name).collect::<Vec<_>>(),
        "law_titles": titles,
        "speeds": speeds,
        "tables": tables,
        "moving": shapes::of_study(results, geometry)?,
    }))
}

/// The occurrence of every mode in every panel, as the figure shows it.
fn by_panel(results: &Results) -> Result<Value, Error> {
    let labels = &results.plan().labels;
    let mut rows = Vec::new();
    for panel in results.panels() {
        let set = panel.key.constraints;
        for (name, occurrences) in results.every_occurrence(panel) {
            let median = results.median(&occurrences)?;
            let values = || occurrences.iter().map(|occurrence| occurrence.estimate().value);
            let counted: u64 =
                occurrences.iter().map(|o| o.proportion.hits() + o.proportion.ambiguous() - o.failed).sum();
            let mut row = labels.key_columns(panel.key).to_vec();
            row.push(labels.panels[panel.key.panel].in_contact.to_string());
            row.push(results.mode_label(set, name));
            row.push(results.frequency(set, name).map_or(String::new(), |hertz| hertz.to_string()));
            let unstable = results.unstable_hertz(set, name).filter(|hertz| hertz.range.is_some());
            row.push(unstable.map_or(String::new(), |hertz| hertz.to_string()));
            row.extend([median.value, median.lower, median.upper].map(|x| x.to_string()));
            row.extend([values().fold(1.0, f64::min), values().fold(0.0, f64::max)].map(|x| x.to_string()));
            row.push(panel.arrangements.to_string());
            row.push(if counted > 0 { "yes" } else { "no" }.into());
            rows.push(row);
        }
    }
    let header = [
        "constraints",
        "law",
        "speed",
        "in_contact",
        "mode",
        "frequency_hz",
        "unstable_hz",
        "median_occurrence",
        "lower",
        "upper",
        "least_of_arrangements",
        "largest_of_arrangements",
        "arrangements",
        "ever_unstable",
    ];
    let about = match results.has_one_arrangement() {
        true => "The figure above: each mode",
        false => "The figure above: each mode in each panel, the median over its arrangements",
    };
    let mut table = on_page(&Table::new("occurrence_by_panel", header, rows), "occurrence_by_panel.csv", about);
    // There is no such file.
    table["is_figure"] = json!(true);
    Ok(table)
}
