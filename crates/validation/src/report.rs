//! `accuracy.{json,md,csv,svg,png}`: the report of one run and its figures.

use std::path::Path;

use serde::Serialize;
use squeal::figures::{LogLogFigure, LogLogPanel, LogLogSeries, loglog};
use squeal::output::{make_folder, write};

use crate::estimator_comparison::Estimators;
use crate::problem::RouteOutcome;
use crate::route_comparison::RouteAccuracy;
use crate::time_to_tolerance::TimeToTolerance;

/// All that was measured.
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
    pub fn save(&self, folder: &Path) -> Result<(), squeal::Error> {
        make_folder(folder)?;
        let path = folder.join("accuracy.json");
        let json = serde_json::to_vec_pretty(self)
            .map_err(|error| squeal::Error::Write { path: path.clone(), source: error.into() })?;
        write(&path, &json)?;
        write(&folder.join("accuracy.md"), self.markdown().as_bytes())?;
        loglog(&self.routes_figure())?.save(folder, "accuracy")?;
        Ok(loglog(&self.estimators_figure())?.save(folder, "accuracy-estimators")?)
    }

    fn routes_figure(&self) -> LogLogFigure {
        let panel = |near: bool, title: &str| {
            let mut series: Vec<LogLogSeries> = Vec::new();
            for row in self.routes.iter().filter(|row| row.near_coalescence == near && row.max_error.is_finite()) {
                let point = [row.us, row.max_error];
                match series.iter_mut().find(|s| s.name == row.route) {
                    Some(one) => one.points.push(point),
                    None => series.push(LogLogSeries { name: row.route.into(), points: vec![point], joined: false }),
                }
            }
            LogLogPanel { title: title.into(), series }
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
            let mut series: Vec<LogLogSeries> = Vec::new();
            for row in &self.estimators.rows {
                let point = [row.seconds, if near { row.max_error_near } else { row.max_error_away }];
                match series.iter_mut().find(|s| s.name == row.estimator) {
                    Some(one) => one.points.push(point),
                    None => series.push(LogLogSeries { name: row.estimator.into(), points: vec![point], joined: true }),
                }
            }
            LogLogPanel { title: title.into(), series }
        };
        LogLogFigure {
            title: "Estimators of an occurrence".into(),
            x_label: "Time per scene, s".into(),
            y_label: "Largest error of an occurrence".into(),
            panels: vec![panel(false, "No coalescence before the onset"), panel(true, "Past a coalescence")],
        }
    }
}
