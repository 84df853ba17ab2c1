//! Cost against error of the reduction of a finite element brake.

use std::path::Path;

use brakes::FiniteElementBrake;
use figures::{LogLogFigure, LogLogPanel, LogLogSeries, loglog};
use output::Table;
use reduction::{Compared, compared};
use squeal::study::UncertainBrake;

use crate::Error;

const HEADER: [&str; 6] = ["constraints", "columns", "largest_residual", "modes", "missing", "largest_distance"];

/// Writes `reduction.csv`, `reduction.svg` and `reduction.png`: for each set of constraints with all patches closed, what fewer columns of its basis
/// would hold. Residuals are the largest at the medians and some draws; missing modes and distances of eigenvalues are those from the whole
/// brake at the medians.
pub(super) fn write_reduction(brake: &FiniteElementBrake, dir: &Path) -> Result<(), Error> {
    let (mut rows, mut panels) = (Vec::new(), Vec::new());
    for (constraints, set) in brake.plan().labels.constraints.iter().enumerate() {
        let whole = &brake.sets[constraints].modes;
        let (mut residuals, mut distances) = (Vec::new(), Vec::new());
        for rung in brake.rungs(constraints)? {
            let Compared { distance, missed, .. } = compared(whole, &rung.first);
            let columns = rung.columns as f64;
            residuals.push([columns, rung.residual]);
            distances.push([columns, distance]);
            let counts = [rung.columns.to_string(), rung.residual.to_string(), whole.len().to_string()];
            rows.push(
                [vec![set.clone()], counts.to_vec(), vec![missed.len().to_string(), distance.to_string()]].concat(),
            );
        }
        let series = |name: &str, points| LogLogSeries { name: name.into(), points, joined: true };
        panels.push(LogLogPanel {
            title: format!("constraints \"{set}\""),
            series: vec![
                series("largest residual", residuals),
                series("eigenvalues from those of the whole brake", distances),
            ],
        });
    }
    Table::new("reduction", HEADER, rows).write(dir)?;
    let figure = LogLogFigure {
        title: format!("Reduction: {}", brake.plan().name),
        x_label: "columns of the basis; an evaluation costs about their square".into(),
        y_label: "relative error".into(),
        panels,
    };
    Ok(loglog(&figure)?.save_pictures(dir, "reduction")?)
}
