//! Time to +-0.1 percentage points of every occurrence, against plain Monte Carlo with LAPACK.
//!
//! The gain of an estimator is given by two factors. *Fewer* evaluations: the samples that plain sampling needs for its
//! occurrence nearest to one half, by [`trials_for_half_width`], over the number of systems that the estimator solves.
//! *Cheaper* evaluations: the time of `dgeev` on one sample of the same scene, eigenvalues alone, over the time of the estimator
//! per evaluation, with vectors, names, and all its overhead. Times are processor times of all threads, measured one after the
//! other. The second factor is measured only with the feature `lapack`.

use brakes::LatticeBrake;
use brakes::case::{LatticeCase, Law};
use cea::{BatchSolver, QrSolver};
use cpu_time::ProcessTime;
use montecarlo::{Confidence, trials_for_half_width};
use serde::Serialize;
use squeal::estimators::{Evaluations, FrictionPoints, OccurrenceBounds, OneParameterFamily, control_variate, exact};
use squeal::study::{SceneKey, Study};

use crate::ValidationError;

/// The tolerance, a tenth of a percentage point.
const HALF_WIDTH: f64 = 1e-3;
/// Number of Sobol points per scrambling; chosen.
const POINTS: u32 = 1 << 15;
/// Number of scramblings; chosen.
const SCRAMBLINGS: u32 = 32;
/// Seed of the samples solved in full.
const SEED: u64 = 1;
/// Number of samples on which `dgeev` is timed; chosen.
#[cfg(feature = "lapack")]
const DGEEV_SAMPLES: u64 = 16;
/// Number of times that `dgeev` solves these samples, of which the shortest time is reported; chosen.
#[cfg(feature = "lapack")]
const DGEEV_REPEATS: usize = 3;

/// The cost of the scenes of a law and speed range.
#[derive(Debug, Clone, Serialize)]
pub struct TimeToTolerance {
    /// Law and speed range.
    pub scenes_of: String,
    /// Number of scenes, one for each class of arrangements.
    pub scenes: usize,
    /// Number of occurrences in these scenes.
    pub occurrences: usize,
    /// Number of scenes in which every half width is at most 0.1 percentage points.
    pub reached: usize,
    /// Largest half width of a 95 % interval, or largest error bound of the exact integral. The part that is due to open names
    /// is left out, because it is no error of the estimator.
    pub largest_half_width: f64,
    /// Largest part of an occurrence that is due to open names.
    pub largest_open: f64,
    /// Time for all scenes, seconds.
    pub seconds: f64,
    /// Number of systems solved for all scenes; for the exact integral its number of spectra.
    pub evaluations: u64,
    /// Largest number of evaluations of a scene.
    pub most_evaluations: u64,
    /// The evaluations of the control variate by their purpose.
    pub kinds: Option<Evaluations>,
    /// Number of samples that plain Monte Carlo needs for all scenes.
    pub plain_samples: f64,
    /// Time of these samples with dgeev, seconds.
    pub plain_seconds: Option<f64>,
    /// Smallest [`TimeToTolerance::fewer`] of a scene.
    pub least_fewer: f64,
    /// Smallest [`TimeToTolerance::cheaper`] of a scene.
    pub least_cheaper: Option<f64>,
    /// Mean time of dgeev, microseconds.
    pub dgeev_us: Option<f64>,
}

impl TimeToTolerance {
    /// Number of samples of plain Monte Carlo over the number of evaluations.
    pub fn fewer(&self) -> f64 {
        self.plain_samples / self.evaluations as f64
    }

    /// The time of a sample with dgeev over the time of an evaluation.
    pub fn cheaper(&self) -> Option<f64> {
        let by_dgeev = self.plain_seconds? / self.plain_samples;
        Some(by_dgeev / (self.seconds / self.evaluations as f64))
    }
}

/// The cost of one scene.
struct OneScene {
    half_width: f64,
    occurrences: Vec<OccurrenceBounds>,
    seconds: f64,
    evaluations: u64,
    kinds: Option<Evaluations>,
    /// Time of dgeev for one sample.
    dgeev_seconds: Option<f64>,
}

impl OneScene {
    fn samples_to_tolerance(&self) -> f64 {
        samples_to_tolerance(self.occurrences.iter().map(|o| 0.5 * (o.lower + o.upper)))
    }

    fn fewer(&self) -> f64 {
        self.samples_to_tolerance() / self.evaluations as f64
    }

    fn cheaper(&self) -> Option<f64> {
        Some(self.dgeev_seconds? / (self.seconds / self.evaluations as f64))
    }
}

/// The cost for every `every`-th class of unconstrained arrangements, beginning at the last, with each law of `case` and each speed
/// range.
///
/// # Errors
/// Those of the estimators.
pub fn time_to_tolerance(case: &LatticeCase, every: usize) -> Result<Vec<TimeToTolerance>, ValidationError> {
    let mut rows = Vec::new();
    for &law in &case.laws {
        let mut one = case.clone();
        one.laws = vec![law];
        one.constraints.truncate(1);
        let mut brake = LatticeBrake::new(one)?;
        // Net work is not needed for occurrences.
        brake.plan.scenes.iter_mut().for_each(|scene| scene.wants_work = false);
        let (study, plan) = (Study::new(&brake, &BatchSolver)?, &brake.plan);
        let mut keys: Vec<SceneKey> = plan.scenes.iter().map(|scene| SceneKey { panel: 0, ..scene.key }).collect();
        keys.sort();
        keys.dedup();
        for key in keys {
            let of_key = |&at: &usize| plan.scenes[at].key.speed == key.speed;
            let scenes: Vec<usize> = (0..plan.scenes.len()).rev().filter(of_key).step_by(every).collect();
            rows.push(row(&study, key, &scenes)?);
        }
    }
    Ok(rows)
}

fn row(study: &Study<'_, LatticeBrake>, key: SceneKey, scenes: &[usize]) -> Result<TimeToTolerance, ValidationError> {
    let plan = study.plan();
    let start = ProcessTime::now();
    let (brake, omega) = (study.brake(), least_stable_frequency(study, scenes));
    let points = match (brake.law(key), scenes.first()) {
        (Law::AmontonsCoulomb, _) | (_, None) => None,
        (_, Some(&first)) => Some(FrictionPoints::new(brake, &plan.scenes[first], omega, POINTS, SCRAMBLINGS)?),
    };
    let shared = start.elapsed().as_secs_f64() / scenes.len().max(1) as f64;
    let mut found = Vec::with_capacity(scenes.len());
    for &scene in scenes {
        let mut one = match &points {
            None => by_integral(study, scene)?,
            Some(points) => by_control_variate(study, scene, points)?,
        };
        one.seconds += shared;
        one.dgeev_seconds = dgeev_seconds(brake, scene)?;
        found.push(one);
    }
    let range = key.speed.map_or(String::new(), |speed| format!(", {} speed", plan.labels.speeds[speed].name));
    let dgeev: Option<f64> = found.iter().map(|one| one.dgeev_seconds).sum();
    Ok(TimeToTolerance {
        scenes_of: format!("{}{range}", plan.labels.laws[key.law].title),
        scenes: found.len(),
        occurrences: found.iter().map(|one| one.occurrences.len()).sum(),
        reached: found.iter().filter(|one| one.half_width <= HALF_WIDTH).count(),
        largest_half_width: found.iter().map(|one| one.half_width).fold(0.0, f64::max),
        largest_open: found.iter().flat_map(|one| &one.occurrences).map(|o| o.upper - o.lower).fold(0.0, f64::max),
        seconds: found.iter().map(|one| one.seconds).sum(),
        evaluations: found.iter().map(|one| one.evaluations).sum(),
        most_evaluations: found.iter().map(|one| one.evaluations).max().unwrap_or(0),
        kinds: found.iter().filter_map(|one| one.kinds).reduce(|sum, kinds| sum + kinds),
        plain_samples: found.iter().map(OneScene::samples_to_tolerance).sum(),
        plain_seconds: found.iter().map(|one| Some(one.samples_to_tolerance() * one.dgeev_seconds?)).sum(),
        least_fewer: found.iter().map(OneScene::fewer).fold(f64::INFINITY, f64::min),
        least_cheaper: found.iter().filter_map(OneScene::cheaper).reduce(f64::min),
        dgeev_us: dgeev.map(|sum| 1e6 * sum / found.len().max(1) as f64),
    })
}

/// Number of samples of plain Monte Carlo for the tolerance, at 95 %, of the occurrence that takes most; without occurrences, the number for an occurrence
/// of 0.
pub(crate) fn samples_to_tolerance(occurrences: impl Iterator<Item = f64>) -> f64 {
    let needed = |p: f64| trials_for_half_width(p, HALF_WIDTH, Confidence::P95);
    occurrences.map(needed).fold(needed(0.0), f64::max)
}

fn by_integral(study: &Study<'_, LatticeBrake>, scene: usize) -> Result<OneScene, ValidationError> {
    let start = ProcessTime::now();
    let mut family = OneParameterFamily::new(study.brake(), &study.plan().scenes[scene], &QrSolver)?;
    let found = exact(&study.references()[scene], &mut family)?;
    Ok(OneScene {
        half_width: found.error,
        occurrences: found.integral.occurrences.values().copied().collect(),
        seconds: start.elapsed().as_secs_f64(),
        evaluations: found.counters.eigenvalue_solves,
        kinds: None,
        dgeev_seconds: None,
    })
}

fn by_control_variate(
    study: &Study<'_, LatticeBrake>,
    scene: usize,
    points: &FrictionPoints,
) -> Result<OneScene, ValidationError> {
    let start = ProcessTime::now();
    let found = control_variate(study, scene, points, SEED, HALF_WIDTH)?;
    Ok(OneScene {
        half_width: found.half_width(),
        occurrences: found.modes.values().map(|mode| mode.occurrence).collect(),
        seconds: start.elapsed().as_secs_f64(),
        evaluations: found.evaluations.total(),
        kinds: Some(found.evaluations),
        dgeev_seconds: None,
    })
}

/// Im lambda, rad/s, of the mode with the largest Re lambda at median parameters, over all of the scenes.
fn least_stable_frequency(study: &Study<'_, LatticeBrake>, scenes: &[usize]) -> f64 {
    let modes = scenes.iter().flat_map(|&scene| &study.references()[scene].modes).map(|mode| mode.lambda);
    modes.max_by(|a, b| a.re.total_cmp(&b.re)).map_or(0.0, |lambda| lambda.im)
}

/// Time of one `dgeev` on samples of a scene, seconds.
#[cfg(feature = "lapack")]
fn dgeev_seconds(brake: &LatticeBrake, scene: usize) -> Result<Option<f64>, ValidationError> {
    use cea::{EigenSolver, LapackSolver, Workspace};
    use squeal::study::UncertainBrake;

    let system = |i: u64| {
        let sample = brake.draw(&mut montecarlo::stream(SEED, i))?;
        Ok(brake.system(&brake.plan.scenes[scene], &sample)?)
    };
    let systems = (0..DGEEV_SAMPLES).map(system).collect::<Result<Vec<_>, ValidationError>>()?;
    let mut shortest = f64::INFINITY;
    for _ in 0..DGEEV_REPEATS {
        let start = ProcessTime::now();
        for system in &systems {
            LapackSolver.eigenvalues(system, &mut Workspace::default())?;
        }
        shortest = shortest.min(start.elapsed().as_secs_f64() / DGEEV_SAMPLES as f64);
    }
    Ok(Some(shortest))
}

#[cfg(not(feature = "lapack"))]
fn dgeev_seconds(_: &LatticeBrake, _: usize) -> Result<Option<f64>, ValidationError> {
    Ok(None)
}
