//! The figures of the paper, from a study of its case.

use std::path::Path;

use num_complex::Complex;
use osc_model::Lean;
use rayon::prelude::*;

use super::Results;
use super::paper::{CORNERS_HELD, SIX_HELD, UNCONSTRAINED, most_robust, paper_mode, shape, title};
use super::pictures::occurrence;
use crate::Error;
use crate::brakes::LatticeBrake;
use crate::figures::{
    BodyInMode, LawMode, ModeWorkFigure, ModelDiagram, NetWork, mode_and_work, model_diagram, occurrence_boxes,
};
use crate::study::{ModeLabel, Scene};

/// Draws the paper's Figures 2 and 4 to 9 from a study of its case: `fig02`, `fig04` to `fig09`; Figure 7 for
/// the most robust mode, and as `fig07-paper-number` for the one that bears the paper's number, if it ever is unstable.
///
/// # Errors
/// Those of the figures.
pub fn draw_paper(results: &Results<'_>, brake: &LatticeBrake, dir: &Path) -> Result<(), Error> {
    let case = &brake.case;
    let grid = case.lattice.grid;
    let diagram = ModelDiagram {
        title: case.name.clone(),
        rows: grid.rows(),
        columns: grid.columns(),
        in_contact: vec![true; grid.oscillators()],
        theta_degrees: case.lattice.theta.to_degrees(),
        phi_degrees: case.lattice.phi.to_degrees(),
        leans_with_sliding: case.lattice.lean == Lean::Along,
    };
    let mut figures = vec![(model_diagram(&diagram)?, "fig02")];
    let laws: Vec<usize> = (0..case.laws.len()).collect();
    for (&law, stem) in laws.iter().zip(["fig04", "fig05", "fig06"]) {
        let heading = format!("{} friction", case.laws[law].title());
        figures.push((occurrence_boxes(&occurrence(results, UNCONSTRAINED, &[law], heading)?)?, stem));
    }
    for (constraints, stem) in [(CORNERS_HELD, "fig08"), (SIX_HELD, "fig09")] {
        if let Some(set) = case.constraints.get(constraints) {
            let held: Vec<String> = set.fixed.iter().map(ToString::to_string).collect();
            let heading = format!("Held: {}", held.join(", "));
            figures.push((occurrence_boxes(&occurrence(results, constraints, &laws, heading)?)?, stem));
        }
    }
    let robust = most_robust(results, UNCONSTRAINED)?.first().map(|&(name, _)| name);
    let theirs = case.paper.as_ref().map(|paper| paper_mode(results, paper));
    for (name, stem) in [(robust, "fig07"), (theirs, "fig07-paper-number")] {
        if let Some(figure) = name.and_then(|name| mode_work(results, brake, UNCONSTRAINED, name).transpose()) {
            figures.push((mode_and_work(&figure?)?, stem));
        }
    }
    figures.into_par_iter().try_for_each(|(figure, stem)| Ok(figure.save(dir, stem)?))
}

/// A mode with every oscillator in contact, under each law at its first speed range.
fn mode_work(
    results: &Results<'_>,
    brake: &LatticeBrake,
    constraints: usize,
    name: ModeLabel,
) -> Result<Option<ModeWorkFigure>, Error> {
    let grid = brake.case.lattice.grid;
    let mut columns = Vec::new();
    for (law, of_law) in brake.case.laws.iter().enumerate() {
        let is_it = |scene: &Scene| {
            let key = scene.key;
            key.constraints == constraints && key.law == law && key.speed.unwrap_or(0) == 0 && scene.wants_work
        };
        let Some(at) = results.plan().scenes.iter().position(is_it) else { continue };
        let (scene, reference) = (&results.plan().scenes[at], &results.references()[at]);
        let Some(shape) = shape(results, scene, reference, name) else { continue };
        let lambda = reference.modes.iter().zip(&reference.names).find(|(_, names)| **names == [name]);
        let caption = lambda.map_or(String::new(), |(mode, _)| {
            format!("{:.1} Hz, growth {:+.0} 1/s", cea::frequency_hz(mode.lambda), mode.lambda.re)
        });
        let bodies = bodies(results, at, name, &shape)?;
        columns.push(LawMode { law: of_law.title().into(), caption, bodies });
    }
    // A mode that is never unstable has no work to show.
    let has_work = |column: &LawMode| column.bodies.iter().any(|body| body.work.quartiles.is_some());
    if !columns.iter().any(has_work) {
        return Ok(None);
    }
    let heading = title(results, name);
    Ok(Some(ModeWorkFigure { title: heading, rows: grid.rows(), columns: grid.columns(), laws: columns }))
}

fn bodies(results: &Results<'_>, at: usize, name: ModeLabel, shape: &[Complex<f64>]) -> Result<Vec<BodyInMode>, Error> {
    let map = &results.plan().brake(&results.plan().scenes[at]).dofs;
    let tracked = results.tracked_name(at, name);
    let sketches = tracked.and_then(|name| results.summary.tally.scenes[at].net_work.get(&name));
    let mut work = vec![NetWork::default(); shape.len() / 3];
    if let Some(sketches) = sketches {
        let medians = sketches.iter().map(|s| s.median()).collect::<Result<Vec<f64>, _>>()?;
        let largest = medians.iter().fold(f64::MIN_POSITIVE, |m, &w| m.max(w.abs()));
        for ((entry, sketch), median) in work.iter_mut().zip(sketches).zip(medians) {
            let quartiles = [sketch.quantile(0.25)? / largest, sketch.quantile(0.75)? / largest];
            *entry = NetWork { median: median / largest, quartiles: Some(quartiles) };
        }
    }
    let body = |(i, work): (usize, NetWork)| BodyInMode {
        displacement: [shape[3 * i], shape[3 * i + 1], shape[3 * i + 2]],
        constrained: [0, 1, 2].map(|axis| map.position(3 * i + axis).is_none()),
        work,
    };
    Ok(work.into_iter().enumerate().map(body).collect())
}
