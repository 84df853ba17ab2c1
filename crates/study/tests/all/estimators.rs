//! The estimators of an occurrence against each other.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::Path;

use crate::paper_brake::{SOME, brake, exact_of};
use brakes::LatticeBrake;
use brakes::case::{LatticeCase, Law};
use cea::{BatchSolver, EigenSolver as _, QrSolver, Workspace};
use linsys::{AffineSystem, OperatingPoint, SecondOrder, Term};
use montecarlo::{Distribution, Experiment as _, StreamRng};
use nalgebra::dmatrix;
use osc_model::Brake;
use rayon::prelude::*;
use study::estimators::{
    Estimated, Estimator, EstimatorError, Evaluations, Exact, FrictionPoints, OneParameterFamily, control_variate,
    exact, monte_carlo, quasi_monte_carlo, scene_occurrences,
};
use study::{DrawnInputs, Input, Plan, Scene, SingleParameter, Study, UncertainBrake};
use tracking::TrackingError;

/// `x'' + c(w) x' + x = 0` with w uniform from 0.1 to 3: overdamped where c > 2.
struct Oscillator {
    plan: Plan,
    w: Distribution,
    damping: fn(f64) -> f64,
    /// Whether it says that w is its only parameter.
    is_single: bool,
}

impl Oscillator {
    fn new(damping: fn(f64) -> f64, is_single: bool) -> Self {
        let (zero, one) = (dmatrix![0.0], dmatrix![1.0]);
        let term = |name: &str, c, rest| {
            Term::new(name, name, SecondOrder::new(one.clone() * rest, c, one.clone() * rest).unwrap()).unwrap()
        };
        let terms = vec![term("spring", zero.clone(), 1.0), term("dashpot", one.clone(), 0.0)];
        let brake = Brake::new(AffineSystem::new(terms, Vec::new()).unwrap());
        let w = Distribution::Uniform { from: 0.1, to: 3.0 };
        let plan = Plan::single("oscillator", brake, at(damping(w.median())), 1, 1);
        Self { plan, w, damping, is_single }
    }
}

fn at(damping: f64) -> OperatingPoint {
    OperatingPoint { coefficients: vec![1.0, damping], channels: Vec::new() }
}

impl UncertainBrake for Oscillator {
    type Sample = f64;

    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<f64, study::Error> {
        Ok(self.w.draw(rng)?)
    }

    fn median(&self) -> f64 {
        self.w.median()
    }

    fn operating_point(&self, _: &Scene, w: &f64) -> Result<OperatingPoint, study::Error> {
        Ok(at((self.damping)(*w)))
    }

    fn drawn_inputs(&self) -> Option<&dyn DrawnInputs<f64>> {
        Some(self)
    }
}

impl DrawnInputs<f64> for Oscillator {
    fn inputs(&self, _: &Scene) -> Vec<Input> {
        vec![Input {
            name: "w".into(),
            unit: "1/s".into(),
            coordinate: 0,
            is_correlated: false,
            has_atoms: false,
            jumps: false,
        }]
    }

    fn input_values(&self, _: &Scene, w: &f64) -> Vec<f64> {
        vec![*w]
    }

    fn quantile_sample(&self, _: &Scene, uniform: &dyn Fn(u32) -> f64) -> f64 {
        self.w.quantile(uniform(0))
    }

    fn single_parameter(&self, _: &Scene) -> Option<SingleParameter<'_, f64>> {
        self.is_single.then(|| SingleParameter::new(&self.w, |w| w))
    }
}

#[test]
fn every_sample_has_the_modes_that_the_exact_integral_gives_it() {
    let brake = brake(SOME, "amontons-coulomb", &[]);
    let study = Study::new(&brake, &QrSolver).unwrap();
    let mut scratch = Default::default();
    for scene in 0..brake.plan.scenes.len() {
        let exact = exact_of(&study, scene);
        assert!(exact.error < 1e-10 && exact.counters.eigenvalue_solves < 200);
        for i in 0..100 {
            let sample = brake.draw(&mut montecarlo::stream(7, i)).unwrap();
            let mu = sample.contact(0).mu;
            let outcome = study.evaluate(scene, &sample, &mut scratch).unwrap();
            let piece = exact.integral.pieces.iter().find(|p| p.from <= mu && mu < p.to).unwrap();
            let names: Vec<_> = outcome.unstable.into_iter().map(|mode| mode.names).collect();
            assert_eq!(names, piece.unstable, "mu = {mu}");
        }
    }
}

/// Number of spectra on a grid that is much finer than the steps of the search for onsets, and of those with another number of
/// unstable modes than the exact integral has there: onsets that its rule for quiet steps overlooked. Half of the grid is even
/// in mu, half in its probability.
fn against_a_fine_grid(study: &Study<'_, LatticeBrake>, scene: usize, points: u32) -> [u64; 3] {
    let mut family = OneParameterFamily::new(study.brake(), &study.plan().scenes[scene], &QrSolver).unwrap();
    let Exact { integral, onsets, counters, .. } = exact(&study.references()[scene], &mut family).unwrap();
    let (distribution, mut work, mut spectra) = (family.distribution(), Workspace::default(), Vec::new());
    let (from, to) = distribution.support();
    let parts = (0..points).map(|i| (f64::from(i) + 0.5) / f64::from(points));
    let grid = parts.flat_map(|part| [from + part * (to - from), distribution.quantile(part)]);
    // Next to an onset rounding decides.
    let is_clear = |mu: &f64| onsets.onsets.iter().all(|onset| (mu - onset.at).abs() > onset.error + 1e-9);
    let grid: Vec<f64> = grid.filter(is_clear).collect();
    let mut missed = 0;
    for block in grid.chunks(64) {
        let systems: Vec<_> = block.iter().map(|&mu| family.system(mu).clone()).collect();
        BatchSolver.eigenvalues_of_all(&systems, &mut work, &mut spectra);
        for (mu, spectrum) in block.iter().zip(&spectra) {
            let unstable = spectrum.as_ref().unwrap().oscillatory().filter(|lambda| lambda.re > 0.0).count();
            let piece = integral.pieces.iter().find(|piece| piece.from <= *mu && *mu <= piece.to).unwrap();
            missed += u64::from(unstable != piece.unstable.len());
        }
    }
    [counters.eigenvalue_solves, grid.len() as u64, missed]
}

fn sum_of_grids(study: &Study<'_, LatticeBrake>, points: u32) -> [u64; 3] {
    let of_scene = |scene| against_a_fine_grid(study, scene, points);
    let sum = (0..study.plan().scenes.len())
        .into_par_iter()
        .map(of_scene)
        .reduce(|| [0; 3], |a, b| std::array::from_fn(|i| a[i] + b[i]));
    println!(
        "{} scenes: {} spectra of the search, {} on the grid, {} differ",
        study.plan().scenes.len(),
        sum[0],
        sum[1],
        sum[2]
    );
    sum
}

#[test]
fn a_fine_grid_shows_no_onset_that_the_exact_integral_overlooks() {
    let brake = brake(SOME, "amontons-coulomb", &[]);
    let study = Study::new(&brake, &BatchSolver).unwrap();
    let [_, checked, missed] = sum_of_grids(&study, 200);
    assert!(checked > 1_000 && missed == 0, "{missed} of {checked}");
}

/// `cargo test --release -p brake-squeal-study --test all fine_grid -- --ignored --nocapture`
#[test]
#[ignore = "solves 270,000 systems"]
fn a_fine_grid_shows_no_onset_in_any_scene_of_the_case() {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../cases/paper.toml"));
    let mut case = LatticeCase::read(path).unwrap();
    case.laws = vec![Law::AmontonsCoulomb];
    let brake = LatticeBrake::new(case).unwrap();
    let [_, checked, missed] = sum_of_grids(&Study::new(&brake, &BatchSolver).unwrap(), 1_000);
    assert!(checked > 250_000 && missed == 0, "{missed} of {checked}");
}

#[test]
fn two_thousand_samples_agree_with_the_exact_integral_within_their_intervals() {
    let brake = brake("[[1,2,3,4,5,6,7,8,9],[1,3,4,5,6,8]]", "amontons-coulomb", &[]);
    let study = Study::new(&brake, &BatchSolver).unwrap();
    for scene in 0..brake.plan.scenes.len() {
        let exact = exact_of(&study, scene).integral.occurrences;
        let samples = monte_carlo(&study, scene, 11, 2000).unwrap();
        for (name, occurrence) in &exact {
            // Not 95 %: a dozen intervals have to hold at once.
            let Some(found) = samples.modes.get(name) else {
                assert!(occurrence.upper < 0.005);
                continue;
            };
            assert!((found.occurrence.lower - occurrence.lower).abs() < 1.7 * found.half_width(), "{name}");
        }
    }
}

#[test]
fn scrambled_sobol_points_converge_to_the_exact_integral() {
    let brake = brake("[[1,3,4,5,6,8]]", "amontons-coulomb", &[]);
    let study = Study::new(&brake, &QrSolver).unwrap();
    let exact = exact_of(&study, 0).integral.occurrences;
    for (points, tolerance) in [(16, 0.04), (256, 0.0025)] {
        let found = quasi_monte_carlo(&study, 0, 5, points, 4).unwrap();
        for (name, occurrence) in &exact {
            let found = found.modes.get(name).map_or(0.0, |mode| mode.occurrence.lower);
            assert!((found - occurrence.lower).abs() < tolerance, "{name}: {found} {occurrence:?}");
        }
    }
    assert!(matches!(quasi_monte_carlo(&study, 0, 5, 0, 4), Err(EstimatorError::Points { .. })));
    assert!(matches!(quasi_monte_carlo(&study, 0, 5, 8, 1), Err(EstimatorError::Points { .. })));
}

#[test]
fn sobol_points_sample_every_law() {
    for law in ["velocity-dependent", "lugre"] {
        let brake = brake("[[1,2,3,4,5,6,7,8,9]]", law, &[]);
        let study = Study::new(&brake, &BatchSolver).unwrap();
        let plain = monte_carlo(&study, 0, 3, 400).unwrap();
        let quasi = quasi_monte_carlo(&study, 0, 3, 64, 4).unwrap();
        for (name, mode) in plain.modes {
            let other = quasi.modes.get(&name).map_or(0.0, |mode| mode.occurrence.lower);
            assert!((mode.occurrence.lower - other).abs() < 1.5 * mode.half_width() + 0.02, "{law} {name}");
        }
    }
}

#[test]
fn what_is_no_family_is_refused() {
    for (law, edits) in [
        ("velocity-dependent", &[][..]),
        ("amontons-coulomb", &[("draws = \"shared\"", "draws = \"each\"")]),
        ("amontons-coulomb", &[("lateral = \"none\"", "lateral = \"vector\"")]),
    ] {
        let brake = brake("[[1,3,4,5,6,8]]", law, edits);
        let refused = OneParameterFamily::new(&brake, &brake.plan.scenes[0], &QrSolver).map(|_| ());
        assert!(matches!(refused, Err(EstimatorError::NotOneParameter { .. })));
    }
    assert_eq!(brake(SOME, "lugre", &[]).case.laws, [Law::LuGre]);
    // No system at w = 0, which no sample has; and affine at all whole numbers, but nowhere between them.
    for damping in [|w: f64| 1.0 / w, |w: f64| 1.0 + (std::f64::consts::TAU * w).sin()] {
        let brake = Oscillator::new(damping, true);
        let refused = OneParameterFamily::new(&brake, &brake.plan.scenes[0], &QrSolver).map(|_| ());
        assert!(matches!(refused, Err(EstimatorError::NotOneParameter { .. })), "{refused:?}");
        let study = Study::new(&brake, &QrSolver).unwrap();
        assert_eq!(scene_occurrences(&study, 0, 0.05, None).unwrap().estimator, Estimator::PlainSampling);
    }
}

#[test]
fn what_a_failed_attempt_solved_counts() {
    let found = |is_single: bool| {
        let brake = Oscillator::new(|w| w, is_single);
        let study = Study::new(&brake, &QrSolver).unwrap();
        scene_occurrences(&study, 0, 0.05, None).unwrap()
    };
    let brake = Oscillator::new(|w| w, true);
    let study = Study::new(&brake, &QrSolver).unwrap();
    let mut family = OneParameterFamily::new(&brake, &brake.plan.scenes[0], &QrSolver).unwrap();
    let attempt = exact(&study.references()[0], &mut family);
    let is_overdamped = matches!(
        attempt,
        Err(EstimatorError::Tracking(TrackingError::ModeCount { at, found: 0, expected: 1 })) if at > 2.0
    );
    assert!(is_overdamped, "{attempt:?}");
    let solved = family.counters().eigenvalue_solves;
    assert!(solved > 1);
    let (tried, sampled) = (found(true), found(false));
    assert_eq!([&tried, &sampled].map(|found| found.estimator), [Estimator::PlainSampling; 2]);
    assert_eq!(tried.evaluations, sampled.evaluations + solved);
}

#[test]
fn the_control_variate_agrees_with_plain_samples() {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../cases/two-by-two.toml"));
    let mut case = LatticeCase::read(path).unwrap();
    case.constraints.truncate(1);
    case.laws = vec![Law::VelocityDependent, Law::LuGre];
    let brake = LatticeBrake::new(case).unwrap();
    let study = Study::new(&brake, &BatchSolver).unwrap();
    for (scene, of) in brake.plan.scenes.iter().enumerate() {
        let points = FrictionPoints::new(&brake, of, 1e4, 1 << 12, 8).unwrap();
        let found = control_variate(&study, scene, &points, 1, 5e-3).unwrap();
        let Evaluations { sample_points, pilots, clear, uncertain } = found.evaluations;
        assert!(found.half_width() <= 5e-3 && clear + uncertain < 5_000, "{scene}: {found:?}");
        // Every system solved counts, also those of which the estimate does not speak.
        assert!(sample_points > 0 && [0, 400].contains(&pilots));
        assert_eq!(found.evaluations.total(), sample_points + pilots + clear + uncertain);
        let plain = monte_carlo(&study, scene, 2, 4_000).unwrap();
        assert!(!plain.modes.is_empty());
        for (name, mode) in &plain.modes {
            let Some(other) = found.modes.get(name) else {
                assert!(mode.limits.lower < found.unseen, "{scene} {name}");
                continue;
            };
            // Not 95 %: many intervals have to hold at once.
            let tolerance = 1.7 * mode.half_width() + other.half_width();
            assert!((mode.occurrence.lower - other.occurrence.lower).abs() < tolerance, "{scene} {name}");
        }
    }
}

#[test]
fn the_prediction_is_right_for_nearly_every_sample() {
    let brake = brake("[[1,3,4,5,6,8]]", "velocity-dependent", &[]);
    let study = Study::new(&brake, &BatchSolver).unwrap();
    let points = FrictionPoints::new(&brake, &brake.plan.scenes[0], 1.14e4, 1 << 12, 8).unwrap();
    let found = control_variate(&study, 0, &points, 1, 5e-3).unwrap();
    assert!(
        found.wrong[0] <= 1 && found.uncertain < 0.01,
        "{:?} of {:?}, {}",
        found.wrong,
        found.evaluations,
        found.uncertain
    );
}

/// A scene of each law and speed range to 0.1 percentage points, against 200,000 plain samples.
///
/// `cargo test --release -p brake-squeal-study --test all estimators:: -- --ignored --nocapture`: some minutes.
#[test]
#[ignore = "solves 800,000 samples"]
fn occurrences_to_a_tolerance_agree_with_many_plain_samples() {
    for law in ["velocity-dependent", "lugre"] {
        let brake = brake("[[1,3,4,5,6,8]]", law, &[]);
        let study = Study::new(&brake, &BatchSolver).unwrap();
        for (scene, of) in brake.plan.scenes.iter().enumerate() {
            let points = FrictionPoints::new(&brake, of, 1.14e4, 1 << 15, 32).unwrap();
            let found = control_variate(&study, scene, &points, 1, 1e-3).unwrap();
            let plain = monte_carlo(&study, scene, 2, 200_000).unwrap();
            println!(
                "{law}, range {scene}: half width {:.2e}, {} evaluations",
                found.half_width(),
                found.evaluations.total()
            );
            for (name, mode) in &plain.modes {
                let other = found.modes.get(name).map(|mode| mode.occurrence).unwrap_or_default();
                let half_width = found.modes.get(name).map_or(found.unseen, Estimated::half_width);
                println!(
                    "  {name}: {other:?} +- {half_width:.1e}, plain {:?} +- {:.1e}",
                    mode.occurrence,
                    mode.half_width()
                );
                // Not 95 %: many intervals have to hold at once.
                let tolerance = 1.5 * (mode.half_width() + half_width);
                assert!((mode.occurrence.lower - other.lower).abs() < tolerance, "{law} {scene} {name}");
                assert!((mode.occurrence.upper - other.upper).abs() < tolerance, "{law} {scene} {name}");
            }
        }
    }
}
