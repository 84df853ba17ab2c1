//! Measurements of accuracy and cost, all in one run.

use std::path::Path;

use brakes::LatticeBrake;
use brakes::case::{LatticeCase, Law};
use cea::{BatchSolver, QrSolver};
use squeal::estimators::{OneParameterFamily, exact};
use squeal::study::{Scene, Study, UncertainBrake};

use crate::ValidationError;
use crate::estimator_comparison::compare_estimators;
use crate::exceptional_point::exceptional_point;
use crate::nlevp::judge_folder;
use crate::problem::ReferenceProblem;
use crate::report::AccuracyReport;
use crate::route_comparison::{SystemGroup, compare_routes};
use crate::stress_cases::{around_exceptional_point, around_onset, extremes};
use crate::time_to_tolerance::time_to_tolerance;

/// The extent of the measurements.
#[derive(Debug, Clone)]
pub struct Effort {
    /// Number of classes of arrangements of which one is a scene of the estimators.
    pub every: usize,
    /// Numbers of samples of plain Monte Carlo.
    pub plain: Vec<u64>,
    /// Numbers of points per scrambling of quasi-Monte Carlo.
    pub quasi: Vec<u32>,
    /// Number of scramblings.
    pub scramblings: u32,
    /// Number of systems per route away from coalescence.
    pub systems: u64,
    /// Number of classes of arrangements of which one is estimated to a tenth of a percentage point with every law.
    pub every_to_tolerance: usize,
}

impl Effort {
    /// Measurements of about a minute.
    pub fn quick() -> Self {
        Self {
            every: 15,
            plain: vec![100, 1_000],
            quasi: vec![16, 64],
            scramblings: 8,
            systems: 32,
            every_to_tolerance: 45,
        }
    }

    /// Measurements of several minutes.
    pub fn full() -> Self {
        Self {
            every: 3,
            plain: vec![100, 1_000, 10_000],
            quasi: vec![16, 64, 256],
            scramblings: 8,
            systems: 256,
            every_to_tolerance: 1,
        }
    }
}

/// Distances in mu from an exceptional point, below and above.
const DISTANCES: [f64; 10] = [-1e-4, -1e-6, -1e-8, -1e-10, 1e-10, 1e-9, 1e-8, 1e-6, 1e-4, 1e-3];

/// Measures all routes and estimators on the lattice of `case`, and routes on the problems in the folder `nlevp`.
///
/// # Errors
/// A case without Coulomb friction shared by all contacts; errors of the solvers and files.
pub fn accuracy(case: &LatticeCase, nlevp: &Path, effort: &Effort) -> Result<AccuracyReport, ValidationError> {
    let with_laws = |laws: Vec<Law>| {
        let mut case = case.clone();
        case.laws = laws;
        LatticeBrake::new(case).map_err(ValidationError::from)
    };
    let brake = with_laws(vec![Law::AmontonsCoulomb])?;
    let plan = &brake.plan;
    let both = with_laws(vec![Law::AmontonsCoulomb, Law::LuGre])?;
    let scene_of = |law: Law| {
        both.plan.scenes.iter().find(|scene| both.law(scene.key) == law).ok_or(ValidationError::NoScene { law })
    };
    let (coulomb, lugre) = (scene_of(Law::AmontonsCoulomb)?, scene_of(Law::LuGre)?);

    let (from, to) = case.friction.mu.support();
    let undamped = OneParameterFamily::new(&brake, &plan.scenes[0], &QrSolver)?;
    let mut system = |mu: f64| {
        let mut system = undamped.system(mu);
        system.c.fill(0.0);
        Ok(system)
    };
    let point = exceptional_point(&mut system, from, to)?;
    let near = around_exceptional_point(&mut system, &point, &DISTANCES)?;

    let study = Study::new(&brake, &BatchSolver)?;
    let mut family = OneParameterFamily::new(&brake, &plan.scenes[0], &QrSolver)?;
    let first = exact(&study.references()[0], &mut family)?;
    let mut stress_cases = Vec::new();
    for onset in &first.onsets.onsets {
        stress_cases.extend(around_onset(&brake, &plan.scenes[0], onset)?);
    }
    stress_cases.extend(around_exceptional_point(&mut system, &point, &DISTANCES)?);
    stress_cases.extend(extremes(&both, coulomb, lugre)?);

    let group =
        |systems: &str, near_coalescence, problems| SystemGroup { systems: systems.into(), near_coalescence, problems };
    let groups = [
        group("Amontons-Coulomb, draws", false, drawn(&both, coulomb, effort.systems)?),
        group("LuGre, draws", false, drawn(&both, lugre, effort.systems)?),
        group("no damping, 1e-3 to 1e-10 from an exceptional point", true, near),
    ];
    let scenes: Vec<usize> = (0..plan.scenes.len()).step_by(effort.every).collect();
    let mut lattice = Vec::new();
    for case in &stress_cases {
        lattice.extend(case.judge());
    }
    Ok(AccuracyReport {
        routes: compare_routes(&groups),
        estimators: compare_estimators(&study, &scenes, &effort.plain, &effort.quasi, effort.scramblings)?,
        time_to_tolerance: time_to_tolerance(case, effort.every_to_tolerance)?,
        lattice,
        nlevp: judge_folder(nlevp)?,
    })
}

fn drawn(brake: &LatticeBrake, scene: &Scene, count: u64) -> Result<Vec<ReferenceProblem>, ValidationError> {
    let system = |i: u64| {
        let sample = brake.draw(&mut montecarlo::stream(brake.plan.seed, i))?;
        ReferenceProblem::new(format!("draw {i}"), brake.system(scene, &sample)?)
    };
    (0..count).map(system).collect()
}
