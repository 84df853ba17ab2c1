//! The numbers of a study as CSV, one observation per row.

use std::path::Path;

use montecarlo::{Confidence, QuantileSketch};
use output::Table;
use study::{ComparisonKind, FullChecks, Panel, SceneKey, SceneLabels, SetLinks};

use super::modes::{links_table, modes};
use super::reasons::{SceneReasons, sensitivities};
use super::strengths::growth;
use super::summary_page::write_summary;
use super::{Results, measured};
use crate::Error;

impl Results {
    /// The numbers of a study as tables: `modes` with a table of shapes for each set of constraints, `links`, `occurrence`, `growth`,
    /// `panels`, `differences`, `net_work`, `family_work`, `sensitivities`, `failures`, `divergence` of a reduced brake whose draws were solved with the
    /// full model, and `measured` of a brake on which squeal was measured; `reasons` and `links` are made by [`reasons_and_links`](super::reasons_and_links).
    ///
    /// # Errors
    /// Counts that make no interval, or no quartile.
    pub fn tables(&self, reasons: &[SceneReasons], links: &[SetLinks]) -> Result<Vec<Table>, Error> {
        let mut tables = Vec::new();
        self.for_each_table(links, reasons, |table| {
            tables.push(table);
            Ok(())
        })?;
        Ok(tables)
    }

    /// Makes one table after the other: of a large brake all together are much of the memory of a run.
    fn for_each_table(
        &self,
        links: &[SetLinks],
        reasons: &[SceneReasons],
        mut each: impl FnMut(Table) -> Result<(), Error>,
    ) -> Result<(), Error> {
        modes(self).into_iter().try_for_each(&mut each)?;
        each(links_table(self, links))?;
        each(occurrence(self))?;
        each(growth(self)?)?;
        each(panels(self))?;
        each(differences(self))?;
        each(net_work(self)?)?;
        each(family_work(self)?)?;
        each(sensitivities(self.plan(), reasons))?;
        each(failures(self))?;
        if let Some(checks) = &self.full_checks {
            each(divergence(self, checks))?;
        }
        if self.plan().measured.is_some() {
            each(measured::table(self, &self.beside_measured(&self.findings()?)))?;
        }
        Ok(())
    }
}

/// Writes `summary.md` and all [`Results::tables`] into `dir`.
///
/// # Errors
/// [`Error::Output`]; as [`Results::tables`].
pub fn write_tables(results: &Results, reasons: &[SceneReasons], links: &[SetLinks], dir: &Path) -> Result<(), Error> {
    results.for_each_table(links, reasons, |table| Ok(table.write(dir)?))?;
    write_summary(results, links, reasons, dir)
}

fn occurrence(results: &Results) -> Table {
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
    Table::new("occurrence", header, rows)
}

fn panels(results: &Results) -> Table {
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
    Table::new("panels", header, rows)
}

/// The table `divergence`: how many draws of the full model diverge, of all, of each law and of each panel; a column is empty where a row is over
/// all that it tells apart.
fn divergence(results: &Results, checks: &FullChecks) -> Table {
    let (labels, scenes) = (&results.plan().labels, &results.plan().scenes);
    let empty = || [const { String::new() }; 4];
    let row = |names: [String; 4], is_of: &dyn Fn(&SceneKey) -> bool| {
        let found = checks.divergence_where(|scene| is_of(&scenes[scene].key));
        let (proportion, number) =
            (found.proportion(), |of: Option<f64>| of.map_or_else(String::new, |of| of.to_string()));
        let limits = proportion.interval(Confidence::P95);
        let counts = [found.draws, found.diverging, found.beyond, found.open].map(|count| count.to_string());
        let share = number(proportion.estimate().map(|part| part.lower));
        let numbers = [
            share,
            limits.lower.to_string(),
            limits.upper.to_string(),
            number((found.fastest > 0.0).then_some(found.fastest)),
        ];
        names.into_iter().chain(counts).chain(numbers).collect::<Vec<_>>()
    };
    let mut rows = vec![row(empty(), &|_| true)];
    for (law, label) in labels.laws.iter().enumerate() {
        let [constraints, _, speed, in_contact] = empty();
        rows.push(row([constraints, label.name.clone(), speed, in_contact], &|key| key.law == law));
    }
    for panel in results.panels() {
        let [constraints, law, speed] = labels.key_columns(panel.key);
        let in_contact = labels.panels[panel.key.panel].in_contact.to_string();
        rows.push(row([constraints, law, speed, in_contact], &|key| *key == panel.key));
    }
    let own = ["draws", "diverging", "beyond", "open", "share", "lower", "upper", "fastest"];
    Table::new("divergence", [&["constraints", "law", "speed", "in_contact"][..], &own].concat(), rows)
}

/// The table `differences`: by how much the mean number of unstable modes differs between two panels on the same draws.
fn differences(results: &Results) -> Table {
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
    Table::new("differences", header, rows)
}

fn net_work(results: &Results) -> Result<Table, Error> {
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
    Ok(Table::new("net_work", header, rows))
}

fn family_work(results: &Results) -> Result<Table, Error> {
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
    Ok(Table::new("family_work", header, rows))
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

fn failures(results: &Results) -> Table {
    let rows = results.summary.failures.listed().iter().map(|failure| {
        let scene = failure.scene.map(|at| results.plan().describe(&results.plan().scenes[at]));
        let scene = scene.unwrap_or_else(|| "every scene: the draw failed".into());
        vec![failure.index.to_string(), scene, failure.message.clone()]
    });
    Table::new("failures", ["sample", "scene", "error"], rows)
}
