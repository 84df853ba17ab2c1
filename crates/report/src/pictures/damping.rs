//! Damping ratio against frequency of the modes of a study.

use std::path::Path;

use figures::{DampingFigure, Figure, UnstableRange, damping_figure};
use montecarlo::QuantileSketch;
use squeal::results::Results;

use super::set_heading;
use crate::Error;

/// Draws damping ratio against frequency under each set of constraints, `damping-SET`.
///
/// # Errors
/// Those of the figures.
pub fn draw_damping(results: &Results, dir: &Path) -> Result<(), Error> {
    for (set, figure) in damping(results)? {
        figure.save(dir, &format!("damping-{set}"))?;
    }
    Ok(())
}

/// Figure of each set of constraints that has modes, with the name of the set.
pub(crate) fn damping(results: &Results) -> Result<Vec<(String, Figure)>, Error> {
    let plan = results.plan();
    let mut found = Vec::new();
    // Names other than names of tracked modes have no strengths: an unstable mode would be drawn as a stable one.
    if !results.has_strengths() {
        return Ok(found);
    }
    for (constraints, set) in plan.labels.constraints.iter().enumerate() {
        let title = format!("{}: damping ratio of modes, {}", plan.name, set_heading(results, constraints));
        let mut data = DampingFigure { title, ..DampingFigure::default() };
        for (name, mode) in results.modes_of_set(constraints) {
            let label = results.mode_label(constraints, name);
            let strength = results.strength(constraints, name);
            let ranges = strength.and_then(|of| Some((range(&of.frequency_hz)?, range(&of.damping_ratio)?)));
            match ranges {
                Some((hz, damping_ratio)) => data.unstable.push(UnstableRange { mode: label, hz, damping_ratio }),
                None => {
                    let lambda = mode.lambda;
                    data.stable.push((label, [squeal::cea::frequency_hz(lambda), squeal::cea::damping_ratio(lambda)]));
                }
            }
        }
        if !data.unstable.is_empty() || !data.stable.is_empty() {
            found.push((set.clone(), damping_figure(&data)?));
        }
    }
    Ok(found)
}

/// Smallest value, median and largest value.
fn range(sketch: &QuantileSketch) -> Option<[f64; 3]> {
    let ends = sketch.range()?;
    Some([ends.lower, sketch.median().ok()?.clamp(ends.lower, ends.upper), ends.upper])
}
