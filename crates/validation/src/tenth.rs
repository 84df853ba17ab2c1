//! Time to +-0.1 percentage points of every occurrence, against plain Monte Carlo with LAPACK.
//!
//! The peer needs `p (1 - p) (1.96 / 0.001)^2` samples for its occurrence nearest to one half. Its time is extrapolated from
//! `dgeev` measured on samples of the same scene, next to the estimator's own run: eigenvalues alone, neither vectors nor
//! names, which the estimator's time includes. Times are processor times of one thread. Without the feature `lapack` the
//! peer is not measured.

use std::fmt::Write as _;

use cea::{BatchSolver, QrSolver};
use cpu_time::ThreadTime;
use serde::Serialize;
use squeal::case::{Case, Law};
use squeal::estimators::{FrictionPoints, OccurrenceBounds, OneParameterFamily, control_variate, exact};
use squeal::study::{Plan, SceneKey, Study};

use crate::ValidationError;

/// A tenth of a percentage point.
const HALF_WIDTH: f64 = 1e-3;
/// Sobol points of each scrambling, and scramblings.
const POINTS: [u32; 2] = [1 << 15, 32];
/// Seed of the samples solved in full.
const SEED: u64 = 1;
/// Samples and repetitions for the time of `dgeev`; the shortest counts.
#[cfg(feature = "lapack")]
const PEER: [u64; 2] = [16, 3];

/// What it took for the scenes of a law and speed range.
#[derive(Debug, Clone, Serialize)]
pub struct TenthRow {
    /// Law and speed range.
    pub scenes_of: String,
    /// Scenes, one for each class of arrangements.
    pub scenes: usize,
    /// Occurrences in them.
    pub occurrences: usize,
    /// Scenes in which every half width is at most 0.1 percentage points.
    pub reached: usize,
    /// Largest half width of a 95 % interval; of the exact integral its error bound. What open names leave open is not
    /// in it, since it is no error of the estimator.
    pub largest_half_width: f64,
    /// Largest part of an occurrence that open names leave open.
    pub largest_open: f64,
    /// Seconds for all scenes.
    pub seconds: f64,
    /// Spectra of full solutions: mean and largest number per scene.
    pub solutions: [f64; 2],
    /// Samples that plain Monte Carlo needs for all scenes.
    pub plain_samples: f64,
    /// Mean of dgeev's time, microseconds.
    pub dgeev_us: Option<f64>,
    /// Seconds of plain Monte Carlo with dgeev over seconds here, and the smallest such ratio of a scene.
    pub ratio: Option<[f64; 2]>,
}

/// What it took for one scene.
struct OneScene {
    half_width: f64,
    occurrences: Vec<OccurrenceBounds>,
    seconds: f64,
    solutions: u64,
}

/// Every `every`-th class of unconstrained arrangements, from the last on, under each law of `case` and each speed range.
///
/// # Errors
/// Those of the estimators.
pub fn time_to_a_tenth(case: &Case, every: usize) -> Result<Vec<TenthRow>, ValidationError> {
    let mut rows = Vec::new();
    for &law in &case.laws {
        let mut one = case.clone();
        one.laws = vec![law];
        one.constraints.truncate(1);
        let mut plan = Plan::new(one)?;
        // Net work is no part of an occurrence.
        plan.scenes.iter_mut().for_each(|scene| scene.wants_work = false);
        let study = Study::new(&plan, &BatchSolver)?;
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

fn row(study: &Study<'_>, key: SceneKey, scenes: &[usize]) -> Result<TenthRow, ValidationError> {
    let plan = study.plan();
    let start = ThreadTime::now();
    let points = match key.law {
        Law::AmontonsCoulomb => None,
        _ => Some(FrictionPoints::new(plan, key, least_stable_frequency(study, scenes), POINTS[0], POINTS[1])?),
    };
    let shared = start.elapsed().as_secs_f64() / scenes.len().max(1) as f64;
    let mut found = Vec::with_capacity(scenes.len());
    let mut peers = Vec::with_capacity(scenes.len());
    for &scene in scenes {
        let mut one = match &points {
            None => by_integral(study, scene)?,
            Some(points) => by_control(study, scene, points)?,
        };
        one.seconds += shared;
        found.push(one);
        peers.push(dgeev_seconds(plan, scene)?);
    }
    let needed = |one: &OneScene| {
        let middle = one.occurrences.iter().map(|o| 0.5 * (o.lower + o.upper));
        middle.map(|p| p * (1.0 - p)).fold(0.0, f64::max) * (1.96 / HALF_WIDTH).powi(2)
    };
    let seconds = found.iter().map(|one| one.seconds).sum::<f64>();
    let peers: Option<Vec<f64>> = peers.into_iter().collect();
    let ratio = peers.as_ref().map(|peers| {
        let plain: Vec<f64> = found.iter().zip(peers).map(|(one, each)| needed(one) * each).collect();
        let ratios =
            plain.iter().zip(&found).filter(|(plain, _)| **plain > 0.0).map(|(plain, one)| plain / one.seconds);
        [plain.iter().sum::<f64>() / seconds, ratios.fold(f64::INFINITY, f64::min)]
    });
    let range = key.speed.map_or(String::new(), |speed| format!(", {} speed", plan.case.speeds[speed].name));
    let solutions = found.iter().map(|one| one.solutions as f64);
    Ok(TenthRow {
        scenes_of: format!("{}{range}", key.law.title()),
        scenes: found.len(),
        occurrences: found.iter().map(|one| one.occurrences.len()).sum(),
        reached: found.iter().filter(|one| one.half_width <= HALF_WIDTH).count(),
        largest_half_width: found.iter().map(|one| one.half_width).fold(0.0, f64::max),
        largest_open: found.iter().flat_map(|one| &one.occurrences).map(|o| o.upper - o.lower).fold(0.0, f64::max),
        seconds,
        solutions: [solutions.clone().sum::<f64>() / found.len().max(1) as f64, solutions.fold(0.0, f64::max)],
        plain_samples: found.iter().map(needed).sum(),
        dgeev_us: peers.map(|peers| 1e6 * peers.iter().sum::<f64>() / peers.len().max(1) as f64),
        ratio,
    })
}

/// What it took, as a table.
pub(crate) fn markdown(rows: &[TenthRow]) -> String {
    let mut text = String::from(
        "\n## Every occurrence to 0.1 percentage points\n\nUnconstrained scenes; 95 % for each occurrence. Amontons-Coulomb by \
         the exact integral, the others by a table of eigenvalues with control variate. Plain Monte Carlo is extrapolated: its \
         samples for the worst occurrence of each scene, times dgeev's time measured next to it, eigenvalues alone",
    );
    let plain: Option<f64> = rows.iter().map(|row| Some(row.ratio?[0] * row.seconds)).sum();
    if plain.is_none() {
        text += " (not measured: feature `lapack`)";
    }
    text += ".\n\n| scenes | number | occurrences | reached | largest half width | largest open | s per scene | solutions, mean | \
             largest | plain samples per scene | dgeev \u{b5}s | ratio | smallest of a scene |\n\
             | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
    for row in rows {
        let TenthRow { scenes_of, scenes, occurrences, reached, largest_half_width, largest_open, solutions, .. } = row;
        let (seconds, plain) = (row.seconds / *scenes as f64, row.plain_samples / *scenes as f64);
        let number = |value: Option<f64>| value.map_or("-".into(), |value| format!("{value:.0}"));
        let _ = writeln!(
            text,
            "| {scenes_of} | {scenes} | {occurrences} | {reached} | {largest_half_width:.1e} | {largest_open:.1e} | {seconds:.2} | \
             {:.0} | {:.0} | {plain:.0} | {} | {} | {} |",
            solutions[0],
            solutions[1],
            number(row.dgeev_us),
            number(row.ratio.map(|ratio| ratio[0])),
            number(row.ratio.map(|ratio| ratio[1])),
        );
    }
    let occurrences: usize = rows.iter().map(|row| row.occurrences).sum();
    let seconds: f64 = rows.iter().map(|row| row.seconds).sum();
    let _ = write!(text, "\nTogether {occurrences} occurrences in {seconds:.0} s");
    if let Some(plain) = plain {
        let _ = write!(text, ", {:.0} times as fast", plain / seconds);
    }
    text + ".\n"
}

fn by_integral(study: &Study<'_>, scene: usize) -> Result<OneScene, ValidationError> {
    let start = ThreadTime::now();
    let mut family = OneParameterFamily::new(study.plan(), &study.plan().scenes[scene], &QrSolver)?;
    let found = exact(study.plan(), &study.references()[scene], &mut family)?;
    Ok(OneScene {
        half_width: found.error,
        occurrences: found.integral.occurrences.values().copied().collect(),
        seconds: start.elapsed().as_secs_f64(),
        solutions: found.counters.eigenvalue_solves,
    })
}

fn by_control(study: &Study<'_>, scene: usize, points: &FrictionPoints) -> Result<OneScene, ValidationError> {
    let start = ThreadTime::now();
    let found = control_variate(study, scene, points, SEED, HALF_WIDTH)?;
    Ok(OneScene {
        half_width: found.half_width(),
        occurrences: found.modes.values().map(|mode| mode.occurrence).collect(),
        seconds: start.elapsed().as_secs_f64(),
        solutions: found.solved,
    })
}

/// Im lambda of the mode nearest to growing at median parameters in any of the scenes, rad/s.
fn least_stable_frequency(study: &Study<'_>, scenes: &[usize]) -> f64 {
    let modes = scenes.iter().flat_map(|&scene| &study.references()[scene].modes).map(|mode| mode.lambda);
    modes.max_by(|a, b| a.re.total_cmp(&b.re)).map_or(0.0, |lambda| lambda.im)
}

/// Seconds of one `dgeev` on samples of a scene.
#[cfg(feature = "lapack")]
fn dgeev_seconds(plan: &Plan, scene: usize) -> Result<Option<f64>, ValidationError> {
    use cea::{EigenSolver, LapackSolver, Workspace};
    use linsys::SecondOrder;

    use squeal::study::Sample;

    let [samples, repetitions] = PEER;
    let system = |i: u64| {
        let sample = Sample::draw(&plan.case, &mut montecarlo::stream(SEED, i)).map_err(squeal::Error::from)?;
        let mut system = SecondOrder::zeros(1, 0);
        plan.linearise(&plan.scenes[scene], &sample, &mut system)?;
        Ok(system)
    };
    let systems = (0..samples).map(system).collect::<Result<Vec<_>, ValidationError>>()?;
    let mut shortest = f64::INFINITY;
    for _ in 0..repetitions {
        let start = ThreadTime::now();
        for system in &systems {
            LapackSolver.eigenvalues(system, &mut Workspace::default())?;
        }
        shortest = shortest.min(start.elapsed().as_secs_f64() / samples as f64);
    }
    Ok(Some(shortest))
}

#[cfg(not(feature = "lapack"))]
fn dgeev_seconds(_: &Plan, _: usize) -> Result<Option<f64>, ValidationError> {
    Ok(None)
}
