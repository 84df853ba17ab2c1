//! `accuracy.{json,md,csv,svg,png}`: the report of one run and its figures.

use std::path::Path;

use figures::{LogLogFigure, LogLogPanel, LogLogSeries, loglog};
use serde::Serialize;
use squeal::output::{make_folder, write};

use crate::ValidationError;
use crate::estimator_comparison::{EstimatorAccuracy, Estimators};
use crate::problem::RouteOutcome;
use crate::route_comparison::RouteAccuracy;
use crate::time_to_tolerance::TimeToTolerance;

/// The results of all measurements.
#[derive(Debug, Clone, Serialize)]
pub struct AccuracyReport {
    /// Time per system against largest relative error.
    pub routes: Vec<RouteAccuracy>,
    /// Time per scene against error of the occurrences.
    pub estimators: Estimators,
    /// Time to a tenth of a percentage point, by law and speed range.
    pub time_to_tolerance: Vec<TimeToTolerance>,
    /// Stress cases of the lattice.
    pub lattice: Vec<RouteOutcome>,
    /// Problems of NLEVP and others, from files.
    pub nlevp: Vec<RouteOutcome>,
}

impl AccuracyReport {
    /// Writes the report and its figures into `folder`.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn save(&self, folder: &Path) -> Result<(), ValidationError> {
        make_folder(folder)?;
        let path = folder.join("accuracy.json");
        let json = serde_json::to_vec_pretty(self)
            .map_err(|error| squeal::output::OutputError::Write { path: path.clone(), source: error.into() })?;
        write(&path, &json)?;
        write(&folder.join("accuracy.md"), self.markdown().as_bytes())?;
        loglog(&self.routes_figure())?.save(folder, "accuracy")?;
        Ok(loglog(&self.estimators_figure())?.save(folder, "accuracy-estimators")?)
    }

    fn routes_figure(&self) -> LogLogFigure {
        let panel = |near: bool, title: &str| {
            let rows = self.routes.iter().filter(|row| row.near_coalescence == near && row.max_error.is_finite());
            panel_by_name(title, false, rows.map(|row| (row.route, [row.us, row.max_error])))
        };
        LogLogFigure {
            title: "Solver routes".into(),
            x_label: "Time per system, \u{b5}s".into(),
            y_label: "Largest relative error of an eigenvalue".into(),
            panels: vec![panel(false, "Away from coalescence"), panel(true, "Near coalescence")],
        }
    }

    fn estimators_figure(&self) -> LogLogFigure {
        let panel = |near: bool, title: &str| {
            let error = |row: &EstimatorAccuracy| if near { row.max_error_near } else { row.max_error_away };
            let rows = self.estimators.rows.iter();
            panel_by_name(title, true, rows.map(|row| (row.estimator, [row.seconds, error(row)])))
        };
        LogLogFigure {
            title: "Estimators of an occurrence".into(),
            x_label: "Time per scene, s".into(),
            y_label: "Largest error of an occurrence".into(),
            panels: vec![panel(false, "No coalescence before the onset"), panel(true, "Past a coalescence")],
        }
    }
}

/// A panel with one series for each name.
fn panel_by_name(title: &str, joined: bool, points: impl Iterator<Item = (&'static str, [f64; 2])>) -> LogLogPanel {
    let mut series: Vec<LogLogSeries> = Vec::new();
    for (name, point) in points {
        match series.iter_mut().find(|series| series.name == name) {
            Some(series) => series.points.push(point),
            None => series.push(LogLogSeries { name: name.into(), points: vec![point], joined }),
        }
    }
    LogLogPanel { title: title.into(), series }
}
