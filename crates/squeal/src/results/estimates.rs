//! Occurrences of a study to a half width, every one: estimated scene by scene, kept in the folder, and written as a table.

use std::io::ErrorKind;
use std::path::Path;
use std::time::{Duration, Instant};

use montecarlo::{Damage, Progress, Sealed};
use output::{OutputError, Table, write};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use study::estimators::{
    Estimator, EstimatorError, FrictionPoints, Rejected, SceneOccurrences, friction_points, scene_occurrences_beside,
};
use study::identity::of_study;
use study::{SceneKey, SceneLabels, Study, UncertainBrake};

use super::Results;
use crate::Error;

/// Name of the file in which estimates are kept, so that a run that was stopped goes on.
const STATE: &str = "estimates.json";
/// Format of the file; the version changes when estimates of an older program can no longer be continued.
const FORMAT: Sealed = Sealed { kind: "squeal-estimates", version: 2 };
/// Number of scenes estimated together; chosen: some for each thread.
const SCENES_PER_BATCH: usize = 16;
/// Time between two writes of the state; chosen, as [`CHECKPOINT_EVERY`](crate::run): what is lost at most when a run is killed.
const SAVE_EVERY: Duration = Duration::from_secs(5);

/// The estimates of the scenes of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Estimates {
    /// Identity of the study and seed, one line.
    identity: String,
    /// Half width asked for.
    pub half_width: f64,
    /// Occurrences of each scene; `None` for one that is still to be estimated.
    pub scenes: Vec<Option<SceneOccurrences>>,
}

impl Estimates {
    /// Estimates every occurrence of a study to a half width at 95 %, and writes `estimates.csv` in `dir`. The state is kept
    /// in the folder `kept_in`: estimates that it holds already are not computed again, unless the samples of the results
    /// contradict it. An estimate that they contradict is rejected, which the results note, and the next estimator takes over.
    ///
    /// # Errors
    /// A sample that cannot be solved; a folder that cannot be written.
    pub fn run<B: UncertainBrake>(
        study: &Study<'_, B>,
        results: &Results,
        half_width: f64,
        kept_in: &Path,
        dir: &Path,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let own = &results.summary.tally.scenes;
        let mut estimates = Self::kept(study, half_width, kept_in)?;
        for (found, own) in estimates.scenes.iter_mut().zip(own) {
            *found = found.take().filter(|found| found.agrees_with(own));
        }
        let (scenes, mut saved) = (&study.plan().scenes, Instant::now());
        let mut open: Vec<usize> = (0..scenes.len()).filter(|&at| estimates.scenes[at].is_none()).collect();
        // Scenes of one law and speed range share their friction, mostly.
        open.sort_by_key(|&at| SceneKey { constraints: 0, panel: 0, ..scenes[at].key });
        let mut points: Option<FrictionPoints> = None;
        progress.begin(scenes.len() as u64, (scenes.len() - open.len()) as u64);
        while let Some(&first) = open.first() {
            if progress.is_cancelled() {
                estimates.keep(kept_in)?;
                progress.go_on()?;
            }
            let is_served = match &points {
                Some(points) => points.serves(study.brake(), &scenes[first]).map_err(inner)?,
                None => false,
            };
            if !is_served {
                points = friction_points(study, first, half_width).map_err(inner)?;
            }
            let mut count = 1;
            while count < open.len().min(SCENES_PER_BATCH) && shares(study, points.as_ref(), first, open[count])? {
                count += 1;
            }
            let batch: Vec<usize> = open.drain(..count).collect();
            let estimate =
                |&at: &usize| scene_occurrences_beside(study, at, half_width, points.as_ref(), Some(&own[at]));
            let found = batch.par_iter().map(estimate).collect::<Result<Vec<_>, EstimatorError>>().map_err(inner)?;
            for (at, found) in batch.into_iter().zip(found) {
                estimates.scenes[at] = Some(found);
            }
            progress.advance(count as u64);
            if open.is_empty() || saved.elapsed() >= SAVE_EVERY {
                estimates.keep(kept_in)?;
                saved = Instant::now();
            }
        }
        progress.end();
        for (scene, found) in scenes.iter().zip(&estimates.scenes) {
            for Rejected { estimator, because } in found.iter().flat_map(|found| &found.rejected) {
                results.note(format!("{}: the {estimator} is rejected: {because}", study.plan().describe(scene)));
            }
        }
        estimates.table(study).write(dir)?;
        Ok(estimates)
    }

    /// Keeps the state in a folder.
    fn keep(&self, kept_in: &Path) -> Result<(), Error> {
        let path = kept_in.join(STATE);
        let failed = |error: serde_json::Error| OutputError::Write { path: path.clone(), source: error.into() };
        let body = serde_json::to_vec(self).map_err(failed)?;
        // A state that cannot be read back, as with an infinite number, is estimated anew.
        if serde_json::from_slice::<Self>(&body).is_err() {
            return Ok(());
        }
        Ok(write(&path, &[FORMAT.header(&body).as_bytes(), &body].concat())?)
    }

    /// Estimates that a folder holds, if they are of the same study and half width; else estimates without any. Damaged ones are an error.
    fn kept<B: UncertainBrake>(study: &Study<'_, B>, half_width: f64, kept_in: &Path) -> Result<Self, Error> {
        let count = study.plan().scenes.len();
        let identity = of_study(study.brake()).into_line();
        let path = kept_in.join(STATE);
        let damaged = |damage| Error::EstimatesDamaged { path: path.clone(), damage };
        let kept = match std::fs::read(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(source) => return Err(Error::Read { path, source }),
            Ok(bytes) => {
                let body = FORMAT.open(&bytes).map_err(damaged)?;
                Some(serde_json::from_slice::<Self>(body).map_err(|error| damaged(Damage::Content(error)))?)
            }
        };
        let is_same =
            |kept: &Self| kept.identity == identity && kept.half_width == half_width && kept.scenes.len() == count;
        let empty = || Self { identity: identity.clone(), half_width, scenes: vec![None; count] };
        Ok(kept.filter(is_same).unwrap_or_else(empty))
    }

    /// The table `estimates`: the occurrence of every mode in every arrangement, between two limits.
    pub fn table<B: UncertainBrake>(&self, study: &Study<'_, B>) -> Table {
        let own = ["estimator", "lower", "upper", "half_width", "evaluations", "plain_evaluations"];
        let (labels, mut rows) = (&study.plan().labels, Vec::new());
        for (scene, found) in study.plan().scenes.iter().zip(&self.scenes) {
            let Some(found) = found else { continue };
            for (&member, (&name, mode)) in
                scene.members.iter().flat_map(|member| found.modes.iter().map(move |mode| (member, mode)))
            {
                let mut row = labels.mode_columns(scene.key, member, name);
                row.extend([
                    found.estimator.to_string(),
                    mode.occurrence.lower.to_string(),
                    mode.occurrence.upper.to_string(),
                    mode.half_width().to_string(),
                    found.evaluations.to_string(),
                    found.plain_evaluations.to_string(),
                ]);
                rows.push(row);
            }
        }
        let header = [&SceneLabels::MODE_COLUMNS[..], &own].concat();
        Table::new("estimates", header, rows)
    }

    /// Cost of the estimates, in a few lines: how many scenes by which estimator, the half width reached, and all
    /// evaluations against those of plain sampling.
    #[must_use]
    pub fn text(&self) -> String {
        let found: Vec<&SceneOccurrences> = self.scenes.iter().flatten().collect();
        let mut text = format!("Occurrences to {} at 95 %, without what open names leave open:\n", self.half_width);
        for estimator in Estimator::ALL {
            let of: Vec<_> = found.iter().filter(|scene| scene.estimator == estimator).collect();
            if of.is_empty() {
                continue;
            }
            let reached = of.iter().filter(|scene| scene.half_width <= self.half_width).count();
            let widest = of.iter().map(|scene| scene.half_width).fold(0.0, f64::max);
            let [spent, plain] = [
                of.iter().map(|scene| scene.evaluations).sum::<u64>(),
                of.iter().map(|scene| scene.plain_evaluations).sum::<u64>(),
            ];
            text += &format!(
                "  {estimator}: {} scenes, {reached} reached, widest {widest:.1e}; {spent} systems solved, plain sampling {plain} \
                 ({:.1} times as many)\n",
                of.len(),
                plain as f64 / spent.max(1) as f64
            );
        }
        for estimator in Estimator::ALL {
            let rejected =
                || found.iter().flat_map(|scene| &scene.rejected).filter(|rejected| rejected.estimator == estimator);
            if let Some(first) = rejected().next() {
                text += &format!(
                    "  the {estimator} is REJECTED in {} scenes, where the samples of this run contradict it: {}\n",
                    rejected().count(),
                    first.because
                );
            }
        }
        text
    }
}

/// True if a scene can go with another one, whose points are `points`.
fn shares<B: UncertainBrake>(
    study: &Study<'_, B>,
    points: Option<&FrictionPoints>,
    first: usize,
    other: usize,
) -> Result<bool, Error> {
    let scenes = &study.plan().scenes;
    match points {
        Some(points) => points.serves(study.brake(), &scenes[other]).map_err(inner),
        // Without points nothing is shared but the law and the speed range.
        None => {
            Ok(scenes[first].key.law == scenes[other].key.law && scenes[first].key.speed == scenes[other].key.speed)
        }
    }
}

/// The error of a study that an estimator met, or the estimator's own.
fn inner(error: EstimatorError) -> Error {
    match error {
        EstimatorError::Study(error) if error.is_cancelled() => error.into(),
        EstimatorError::Study(source) => Error::Unsolved { source: Box::new(source) },
        other => Error::Estimator(Box::new(other)),
    }
}
