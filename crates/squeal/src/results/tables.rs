//! The numbers of a study as CSV, one observation per row.

use std::path::Path;

use montecarlo::{Confidence, QuantileSketch};
use output::write_csv;
use study::{ComparisonKind, Panel, SceneLabels, set_links};

use super::Results;
use super::modes::{write_links, write_modes};
use super::reasons::{SceneReasons, write_sensitivities};
use super::summary_page::write_summary;
use crate::Error;

/// Writes `summary.md`, `modes.csv` with the shapes, `links.csv`, `occurrence.csv`, `panels.csv`, `differences.csv`, `net_work.csv`,
/// `family_work.csv`, `sensitivities.csv` and `failures.csv` into `dir`; `reasons` are those of [`reasons`](super::reasons()).
///
/// # Errors
/// [`Error::Output`]; those of following modes from one set of constraints to another.
pub fn write_tables(results: &Results, reasons: &[SceneReasons], dir: &Path) -> Result<(), Error> {
    let links = set_links(results.plan(), results.origins(), &cea::QrSolver)?;
    write_modes(results, dir)?;
    write_links(results, &links, dir)?;
    write_occurrence(results, dir)?;
    write_panels(results, dir)?;
    write_differences(results, dir)?;
    write_net_work(results, dir)?;
    write_family_work(results, dir)?;
    write_sensitivities(results.plan(), reasons, dir)?;
    write_failures(results, dir)?;
    write_summary(results, &links, reasons, dir)
}

fn write_occurrence(results: &Results, dir: &Path) -> Result<(), Error> {
    let labels = &results.plan().labels;
    let own = ["samples", "unstable", "open", "occurrence", "lower", "upper", "failed"];
    let mut rows = Vec::new();
    for panel in results.panels() {
        for (name, occurrences) in results.every_occurrence(panel) {
            for occurrence in occurrences {
                let estimate = occurrence.estimate();
                let mut row = labels.mode_columns(panel.key, occurrence.arrangement, name);
                row.extend([
                    occurrence.proportion.trials().to_string(),
                    occurrence.proportion.hits().to_string(),
                    occurrence.proportion.ambiguous().to_string(),
                    estimate.value.to_string(),
                    estimate.lower.to_string(),
                    estimate.upper.to_string(),
                    occurrence.failed.to_string(),
                ]);
                rows.push(row);
            }
        }
    }
    let header = [&SceneLabels::MODE_COLUMNS[..], &own].concat();
    Ok(write_csv(&dir.join("occurrence.csv"), &header, rows)?)
}

fn write_panels(results: &Results, dir: &Path) -> Result<(), Error> {
    let labels = &results.plan().labels;
    let header = [
        "constraints",
        "law",
        "speed",
        "in_contact",
        "arrangements",
        "solved",
        "mean_unstable_modes",
        "lower",
        "upper",
        "any_unstable",
        "ambiguous_modes",
        "undecided",
        "divergent",
        "diverging",
        "marginal",
        "perhaps_unstable",
        "failed",
    ];
    let rows = results.panels().iter().map(|panel| {
        let key = panel.key;
        let weighted = |of: &dyn Fn(usize) -> u64| -> u64 {
            panel.scenes.iter().map(|&scene| of(scene) * results.plan().scenes[scene].members.len() as u64).sum()
        };
        let sum = |of: fn(&study::SceneTally) -> u64| weighted(&|scene| of(&results.summary.tally.scenes[scene]));
        let mean = results.mean_unstable(panel);
        let number = |of: fn(&super::Estimate) -> f64| {
            mean.as_ref().map(of).filter(|x| x.is_finite()).map_or(String::new(), |x| x.to_string())
        };
        let mut row = labels.key_columns(key).to_vec();
        row.extend([
            labels.panels[key.panel].in_contact.to_string(),
            panel.arrangements.to_string(),
            sum(|t| t.solved).to_string(),
            number(|e| e.value),
            number(|e| e.lower),
            number(|e| e.upper),
            sum(|t| t.any_unstable).to_string(),
            sum(|t| t.ambiguous_modes).to_string(),
            sum(|t| t.undecided).to_string(),
            sum(|t| t.divergent).to_string(),
            sum(|t| t.diverging).to_string(),
            sum(|t| t.marginal).to_string(),
            sum(|t| t.perhaps_unstable).to_string(),
            weighted(&|scene| results.failed(scene)).to_string(),
        ]);
        row
    });
    Ok(write_csv(&dir.join("panels.csv"), &header, rows)?)
}

/// Every comparison of two panels on the same draws: by how much the mean number of unstable modes differs.
fn write_differences(results: &Results, dir: &Path) -> Result<(), Error> {
    let panel_columns = |panel: &Panel| {
        let labels = &results.plan().labels;
        let [constraints, law, speed] = labels.key_columns(panel.key);
        [constraints, law, speed, labels.panels[panel.key.panel].in_contact.to_string()]
    };
    let mut rows = Vec::new();
    for kind in ComparisonKind::ALL {
        for (more, fewer, difference) in results.differences(kind, Confidence::P95) {
            let Some(difference) = difference else { continue };
            let numbers = [difference.value, difference.lower, difference.upper].map(|x| x.to_string());
            let panels = panel_columns(more).into_iter().chain(panel_columns(fewer));
            rows.push([kind.name().to_owned()].into_iter().chain(panels).chain(numbers).collect());
        }
    }
    let header = [
        "comparison",
        "constraints",
        "law",
        "speed",
        "in_contact",
        "other_constraints",
        "other_law",
        "other_speed",
        "other_in_contact",
        "difference",
        "lower",
        "upper",
    ];
    Ok(write_csv(&dir.join("differences.csv"), &header, rows)?)
}

fn write_net_work(results: &Results, dir: &Path) -> Result<(), Error> {
    let header =
        ["constraints", "law", "speed", "mode", "body", "samples", "lower_quartile", "median", "upper_quartile"];
    let mut rows = Vec::new();
    for (scene, tally) in results.plan().scenes.iter().zip(&results.summary.tally.scenes) {
        for (name, sketches) in &tally.net_work {
            for (body, sketch) in results.plan().brake(scene).bodies.iter().zip(sketches) {
                let mut row = results.plan().labels.key_columns(scene.key).to_vec();
                row.extend([name.to_string(), body.name.clone()]);
                row.extend(quartile_columns(sketch)?);
                rows.push(row);
            }
        }
    }
    Ok(write_csv(&dir.join("net_work.csv"), &header, rows)?)
}

fn write_family_work(results: &Results, dir: &Path) -> Result<(), Error> {
    let header = [
        "constraints",
        "law",
        "speed",
        "mode",
        "family",
        "body",
        "samples",
        "lower_quartile",
        "median",
        "upper_quartile",
    ];
    let mut rows = Vec::new();
    for (scene, tally) in results.plan().scenes.iter().zip(&results.summary.tally.scenes) {
        let brake = results.plan().brake(scene);
        for (name, families) in &tally.family_work {
            for (family, sketches) in brake.system.families().iter().zip(families) {
                for (body, sketch) in brake.bodies.iter().zip(sketches) {
                    let mut row = results.plan().labels.key_columns(scene.key).to_vec();
                    row.extend([name.to_string(), family.clone(), body.name.clone()]);
                    row.extend(quartile_columns(sketch)?);
                    rows.push(row);
                }
            }
        }
    }
    Ok(write_csv(&dir.join("family_work.csv"), &header, rows)?)
}

/// Count, lower quartile, median and upper quartile.
fn quartile_columns(sketch: &QuantileSketch) -> Result<[String; 4], Error> {
    Ok([
        sketch.count().to_string(),
        sketch.quantile(0.25)?.to_string(),
        sketch.median()?.to_string(),
        sketch.quantile(0.75)?.to_string(),
    ])
}

fn write_failures(results: &Results, dir: &Path) -> Result<(), Error> {
    let rows = results.summary.failures.listed().iter().map(|failure| {
        let scene = failure.scene.map(|at| results.plan().describe(&results.plan().scenes[at]));
        let scene = scene.unwrap_or_else(|| "every scene: the draw failed".into());
        vec![failure.index.to_string(), scene, failure.message.clone()]
    });
    Ok(write_csv(&dir.join("failures.csv"), &["sample", "scene", "error"], rows)?)
}
