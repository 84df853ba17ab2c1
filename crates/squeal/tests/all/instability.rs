//! What counts as unstable and how it is said: divergence, modes without a name, samples that fail, and what lies on the axis.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

use brakes::MatricesBrake;
use brakes::case::MatricesCase;
use cea::{BatchSolver, EigenSolver, QrSolver, Workspace};
use linsys::{AffineSystem, OperatingPoint, SecondOrder, Term};
use montecarlo::rand::RngExt;
use montecarlo::{StreamRng, stream};
use nalgebra::{DMatrix, dmatrix};
use osc_model::{Body, Brake};
use squeal::estimators::scene_occurrences_beside;
use squeal::results::{ArrangementOccurrence, Results};
use squeal::study::{ModeLabel, Outcome, Plan, Scene, SceneTally, Study, StudyTally, ThirdOctave, UncertainBrake};

/// `Q_0 + p Q_1` with p uniform between two numbers.
struct Family {
    plan: Plan,
    ends: [f64; 2],
}

impl Family {
    fn new(constant: SecondOrder, linear: SecondOrder, ends: [f64; 2], samples: u64, seed: u64) -> Self {
        let terms = [("constant", constant), ("linear", linear)];
        let terms = terms.map(|(name, part)| Term::new(name, name, part).unwrap());
        let brake = Brake::new(AffineSystem::new(terms.to_vec(), Vec::new()).unwrap());
        Self { plan: Plan::single("family", brake, at(0.5 * (ends[0] + ends[1])), samples, seed), ends }
    }
}

fn at(p: f64) -> OperatingPoint {
    OperatingPoint { coefficients: vec![1.0, p], channels: Vec::new() }
}

impl UncertainBrake for Family {
    type Sample = f64;

    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<f64, squeal::study::Error> {
        Ok(rng.random_range(self.ends[0]..self.ends[1]))
    }

    fn median(&self) -> f64 {
        0.5 * (self.ends[0] + self.ends[1])
    }

    fn operating_point(&self, _: &Scene, p: &f64) -> Result<OperatingPoint, squeal::study::Error> {
        Ok(at(*p))
    }
}

/// The eigenvalues of each sample, by a solver of its own.
fn spectra(brake: &Family) -> Vec<Vec<num_complex::Complex<f64>>> {
    let (system, mut work) = (&brake.plan.configurations[0].brake.system, Workspace::default());
    let of = |index: u64| {
        let p = brake.draw(&mut stream(brake.plan.seed, index)).unwrap();
        QrSolver.eigenvalues(&system.assemble(&at(p)).unwrap(), &mut work).unwrap().eigenvalues
    };
    (0..brake.plan.samples).map(of).collect()
}

/// The text of a study, its tally, and how often each of three things is unstable: anything, divergence, modes without a name.
fn studied(brake: &Family) -> (String, SceneTally, [ArrangementOccurrence; 3]) {
    let study = Study::new(brake, &BatchSolver).unwrap();
    let results = Results::sampled(&study).unwrap();
    let panel = &results.panels()[0];
    let of = |name| results.occurrences_of(panel, name)[0];
    let counts = [results.any_occurrence(panel)[0], of(ModeLabel::DIVERGENCE), of(ModeLabel::UNNAMED)];
    (results.text().unwrap(), results.summary.tally.scenes[0].clone(), counts)
}

/// A matrix with entries between -1 and 1.
fn random(n: usize, rng: &mut StreamRng) -> DMatrix<f64> {
    DMatrix::from_fn(n, n, |_, _| rng.random_range(-1.0..1.0))
}

/// A symmetric positive definite matrix.
fn definite(n: usize, rng: &mut StreamRng) -> DMatrix<f64> {
    let half = random(n, rng);
    &half * half.transpose() + DMatrix::identity(n, n) * 0.5
}

#[test]
fn divergence_counts_wherever_a_real_eigenvalue_grows() {
    let (mut diverging, mut stable, mut both) = (0, 0, 0);
    for seed in 0..40 {
        let rng = &mut stream(91, seed);
        let n = 1 + (seed % 5) as usize;
        let damping = definite(n, rng) * if seed % 3 == 0 { -0.05 } else { 0.05 };
        let constant = SecondOrder::new(DMatrix::identity(n, n), damping, definite(n, rng) * 3.0).unwrap();
        let pushed = random(n, rng);
        let pushed = &pushed + pushed.transpose() - DMatrix::identity(n, n);
        let zero = DMatrix::zeros(n, n);
        let linear = SecondOrder::new(zero.clone(), zero, pushed).unwrap();
        let brake = Family::new(constant, linear, [0.0, 8.0], 60, seed);
        let (text, tally, [any, divergence, _]) = studied(&brake);
        let spectra = spectra(&brake);
        let count = |of: &dyn Fn(&num_complex::Complex<f64>) -> bool| {
            spectra.iter().filter(|lambdas| lambdas.iter().any(of)).count() as u64
        };
        let expected = count(&|l| l.re > 0.0 && l.im == 0.0);
        assert_eq!((divergence.proportion.hits(), tally.undecided), (expected, 0), "{seed}");
        assert_eq!(any.proportion.hits(), count(&|l| l.re > 0.0), "{seed}");
        assert_eq!(text.contains("divergence"), expected > 0, "{text}");
        assert_eq!(text.contains("no mode is ever unstable"), any.proportion.hits() == 0, "{text}");
        diverging += u64::from(expected > 0);
        stable += u64::from(any.proportion.hits() == 0);
        both += u64::from(expected > 0 && expected < any.proportion.hits());
    }
    assert!(diverging >= 10 && stable >= 3 && both >= 3, "{diverging} {stable} {both}");
}

#[test]
fn flutter_that_no_mode_is_named_for_is_said_and_all_draws_are_unstable() {
    let one = |c: f64, k: f64| SecondOrder::new(dmatrix![1.0], dmatrix![c], dmatrix![k]).unwrap();
    let linear = SecondOrder::new(dmatrix![0.0], dmatrix![0.0], dmatrix![-1.0]).unwrap();
    // At the median k = 0: no mode oscillates. Flutter for k > c^2 / 4.
    let brake = Family::new(one(-0.2, 1.0), linear, [0.0, 2.0], 400, 1);
    let (text, _, [any, divergence, unnamed]) = studied(&brake);
    let draws: Vec<f64> = (0..400).map(|i| brake.draw(&mut stream(1, i)).unwrap()).collect();
    let flutter = draws.iter().filter(|&&p| p < 0.99).count() as u64;
    assert_eq!([any, divergence, unnamed].map(|of| of.proportion.hits()), [400, 400 - flutter, flutter], "{text}");
    assert!(
        text.contains("anything: unstable in 1.0000 of the samples") && text.contains("modes without a name"),
        "{text}"
    );
    assert!(!text.contains("no mode is ever unstable"), "{text}");
}

/// Mixes the degrees of freedom of a system by an orthogonal congruence, a product of reflections.
fn mixed(system: &SecondOrder, rng: &mut StreamRng) -> SecondOrder {
    let n = system.order();
    let mut q = DMatrix::identity(n, n);
    for _ in 0..n {
        let v = nalgebra::DVector::from_fn(n, |_, _| rng.random_range(-1.0..1.0_f64)).normalize();
        q -= 2.0 * &v * (v.transpose() * &q);
    }
    let of = |a: &DMatrix<f64>| q.transpose() * a * &q;
    SecondOrder::new(of(&system.m), of(&system.c), of(&system.k)).unwrap()
}

/// A system without damping: masses on springs, with gyroscopic forces or without, and so many bodies that are free to move.
fn conservative(n: usize, free: usize, gyroscopic: bool, rng: &mut StreamRng) -> SecondOrder {
    let mut k = DMatrix::zeros(n, n);
    // As many chains as bodies, each free as a whole; without any, one chain on a wall.
    let chains = free.max(1);
    for i in 0..n {
        if i + chains < n {
            let spring = rng.random_range(0.5..2.0);
            let j = i + chains;
            k[(i, i)] += spring;
            k[(j, j)] += spring;
            k[(i, j)] -= spring;
            k[(j, i)] -= spring;
        }
        if free == 0 {
            k[(i, i)] += rng.random_range(0.1..1.0);
        }
    }
    let g = random(n, rng);
    let g = if gyroscopic { (&g - g.transpose()) * 0.5 } else { DMatrix::zeros(n, n) };
    SecondOrder::new(
        DMatrix::from_diagonal(&DMatrix::identity(n, n).diagonal().map(|_: f64| rng.random_range(0.5..2.0))),
        g,
        k,
    )
    .unwrap()
}

#[test]
fn what_lies_on_the_axis_is_neither_unstable_nor_a_failure() {
    for seed in 0..60 {
        let rng = &mut stream(17, seed);
        let n = 2 + (seed % 6) as usize;
        let free = [0, 0, 1, 2][(seed % 4) as usize].min(n - 1);
        // A body that is free drifts off where a gyroscopic force does not hold it: its motion grows, and not exponentially.
        let system = conservative(n, free, seed % 4 == 1, rng);
        let mut damped = system.clone();
        if seed % 8 >= 4 {
            // Dashpots between the masses, which do not damp rigid motions.
            damped.c += &system.k * 0.05;
        }
        let system = if seed % 2 == 0 { mixed(&damped, rng) } else { damped };
        let mut scaled = system.clone();
        scaled.m *= 0.0;
        let brake = Family::new(system.clone(), scaled, [0.0, 1.0], 12, seed);
        let study = Study::new(&brake, &BatchSolver).unwrap_or_else(|error| panic!("{seed}: {error}"));
        let results = Results::sampled(&study).unwrap();
        let tally = &results.summary.tally.scenes[0];
        let text = results.text().unwrap();
        assert_eq!((results.summary.failures.total(), tally.any_unstable), (0, 0), "{seed}: {text}");
        // Without a free body dashpots between the masses damp all motions.
        let is_damped = seed % 8 >= 4 && free == 0;
        assert_eq!(tally.marginal + tally.undecided == 0, is_damped, "{seed}: {tally:?}");

        // A negative dashpot at one mass, and they all are.
        let mut growing = system;
        growing.c[(0, 0)] -= 0.01 + if seed % 8 >= 4 { 2.0 * growing.c.norm() } else { 0.0 };
        let mut none = growing.clone();
        [&mut none.m, &mut none.c, &mut none.k].into_iter().for_each(|a| *a *= 0.0);
        let brake = Family::new(growing, none, [0.0, 1.0], 12, seed);
        let study = Study::new(&brake, &BatchSolver).unwrap_or_else(|error| panic!("{seed}: {error}"));
        let results = Results::sampled(&study).unwrap();
        assert_eq!((results.summary.failures.total(), results.summary.tally.scenes[0].any_unstable), (0, 12), "{seed}");
    }
}

/// Equal parts that are pushed off are pairs by rounding, of either sign of Im lambda: each diverges, and none is a mode that flutters.
#[test]
fn equal_parts_that_diverge_are_no_flutter() {
    for seed in 0..40 {
        let rng = &mut stream(53, seed);
        let (equal, n) = (2 + (seed % 4) as usize, 3 + (seed % 4) as usize + (seed % 3) as usize);
        let k = DMatrix::from_fn(n, n, |i, j| if i == j { if i < equal { -9.0 } else { 4.0 + i as f64 } } else { 0.0 });
        let c = DMatrix::identity(n, n) * rng.random_range(0.01..0.5);
        let system = mixed(&SecondOrder::new(DMatrix::identity(n, n), c, k).unwrap(), rng);
        let mut none = system.clone();
        [&mut none.m, &mut none.c, &mut none.k].into_iter().for_each(|a| *a *= 0.0);
        let (text, tally, [any, divergence, unnamed]) = studied(&Family::new(system, none, [0.0, 1.0], 6, seed));
        let hits = [any, divergence, unnamed].map(|of| of.proportion.hits());
        assert_eq!((hits, tally.divergent), ([6, 6, 0], 6 * equal as u64), "{seed}: {text}");
    }
}

#[test]
fn undamped_flutter_begins_where_two_modes_meet() {
    let (eye, none) = (DMatrix::identity(2, 2), DMatrix::zeros(2, 2));
    let constant = SecondOrder::new(eye, none.clone(), dmatrix![2.0, 1.0; 1.0, 2.0]).unwrap();
    let linear = SecondOrder::new(none.clone(), none, dmatrix![0.0, -4.0 / 3.0; 0.0, 0.0]).unwrap();
    let brake = Family::new(constant, linear, [0.5, 1.1], 2_000, 1);
    let (text, tally, [any, ..]) = studied(&brake);
    let expected = (0..2_000).filter(|&i| brake.draw(&mut stream(1, i)).unwrap() > 0.75).count() as u64;
    assert_eq!((any.proportion.hits(), tally.undecided), (expected, 0), "{text}");
    // Both modes of each draw below.
    assert_eq!(tally.marginal, 2 * (2_000 - expected));
}

/// Two modes of one third octave, each unstable in other draws than the other: most draws squeal there, though no mode is unstable in most of them.
#[test]
fn a_third_octave_is_that_of_all_its_modes_together() {
    let none = DMatrix::zeros(2, 2);
    let k = DMatrix::from_diagonal(&nalgebra::dvector![1e6, 1.02e6]);
    let constant = SecondOrder::new(DMatrix::identity(2, 2), dmatrix![-0.45, 0.0; 0.0, 0.55], k).unwrap();
    let linear = SecondOrder::new(none.clone(), dmatrix![1.0, 0.0; 0.0, -1.0], none).unwrap();
    let brake = Family::new(constant, linear, [0.0, 1.0], 1_000, 3);
    let study = Study::new(&brake, &BatchSolver).unwrap();
    let results = Results::sampled(&study).unwrap();
    let drawn: Vec<f64> = (0..1_000).map(|i| brake.draw(&mut stream(3, i)).unwrap()).collect();
    let hits = drawn.iter().filter(|p| **p < 0.45 || **p > 0.55).count() as u64;
    let panel = &results.panels()[0];
    let octave = ThirdOctave::of_omega(1e3);
    assert_eq!(results.third_octave_occurrence(panel, octave)[0].proportion.hits(), hits);
    assert!(results.occurrences(panel).values().all(|of| of[0].proportion.hits() < 500));
    let answer = format!("{:?}", results.answer().unwrap());
    assert!(answer.contains("\"red\"") && !answer.contains("\"amber\""), "{answer}");
}

/// A mass that is pushed, of which an evaluation fails where anything grows: work is asked of a degree of freedom that is not there.
#[test]
fn what_fails_may_be_unstable_and_is_said_first() {
    let one =
        SecondOrder::new(DMatrix::identity(2, 2), dmatrix![0.1, 0.0; 0.0, 0.3], dmatrix![1.0, 0.0; 0.0, 7.0]).unwrap();
    let none = DMatrix::zeros(2, 2);
    let linear = SecondOrder::new(none.clone(), dmatrix![-1.0, 0.0; 0.0, 0.0], none).unwrap();
    let mut brake = Family::new(one, linear, [0.0, 0.25], 300, 5);
    std::sync::Arc::make_mut(&mut brake.plan.configurations[0].brake).bodies =
        vec![Body { name: "mass".into(), dofs: vec![0, 99] }];
    let growing = (0..300).filter(|&i| brake.draw(&mut stream(5, i)).unwrap() > 0.1).count() as u64;
    let Ok(study) = Study::new(&brake, &BatchSolver) else {
        // A body that cannot be is refused before anything is sampled.
        return;
    };
    let results = Results::sampled(&study).unwrap();
    let text = results.text().unwrap();
    assert_eq!(results.summary.failures.total(), growing);
    assert!(text.starts_with(&format!("{growing} of 300 evaluations FAILED")), "{text}");
    assert!(!text.contains("ever unstable"), "{text}");
    let truth = growing as f64 / 300.0;
    let panel = &results.panels()[0];
    let any = results.any_occurrence(panel)[0].estimate();
    assert!(any.lower <= truth && truth <= any.upper, "{any:?} {truth}");
    for (name, of) in results.all_occurrences(panel) {
        assert!(of[0].estimate().upper > truth && of[0].proportion.trials() == 300, "{name} {of:?}");
    }
    let mean = results.mean_unstable(panel).unwrap();
    assert!(mean.lower <= truth && truth <= mean.upper && mean.upper <= 2.0, "{mean:?}");
}

#[test]
fn outcomes_count_what_grows() {
    assert!(!Outcome::default().is_unstable());
    assert!(Outcome { divergent: 1, ..Outcome::default() }.is_unstable());
}

/// Hoffmann's oscillator with a bump of the coefficient of friction, unstable in a part `share` of the draws about `centre`.
fn island(centre: f64, share: f64) -> MatricesBrake {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/hoffmann.toml");
    // mu > 0.75375 where |p - centre| < width sqrt(ln(0.06 / 0.05375)).
    let width = 0.5 * share / (0.06_f64 / 0.05375).ln().sqrt();
    let text = std::fs::read_to_string(&path).unwrap();
    let text = text.replacen("from = 0.5", "from = 0.0", 1).replacen("to = 1.1", "to = 1.0", 1);
    let bump = format!("mu = \"0.7 + 0.06*exp(-((mu - {centre})/{width})^2)\"");
    MatricesBrake::new(MatricesCase::parse(&path, text.replacen("mu = \"mu\"", &bump, 1)).unwrap()).unwrap()
}

/// Estimates of islands beside so many samples of their own: each must hold the truth.
fn islands_are_estimated(count: u64, samples: u64) {
    for at in 0..count {
        let share = [0.01, 0.005, 0.002][(at % 3) as usize];
        let centre = stream(23, at).random_range(0.1..0.9);
        let brake = island(centre, share);
        let study = Study::new(&brake, &BatchSolver).unwrap();
        let sampling = montecarlo::Sampling::new(1, samples);
        let own = montecarlo::run(&study, &sampling, || StudyTally::empty(study.plan())).unwrap().tally;
        let found = scene_occurrences_beside(&study, 0, 0.001, None, Some(&own.scenes[0])).unwrap();
        assert!(found.agrees_with(&own.scenes[0]), "{centre} {share}: {found:?}");
        // Both names are open near the coalescence: surely 0, perhaps all of it.
        // One in twenty 95 % intervals misses: twice as wide.
        let upper = found.modes.values().map(|mode| 2.0 * mode.limits.upper - mode.occurrence.upper);
        let upper = upper.fold(found.half_width, f64::max);
        let lower = found.modes.values().map(|mode| mode.limits.lower).fold(0.0, f64::max);
        // Plain samples are planned by pilots, which may have seen none.
        assert!(lower <= share && share <= upper && found.half_width <= 0.003, "{centre} {share}: {found:?}");
    }
}

#[test]
fn narrow_islands_are_estimated() {
    islands_are_estimated(3, 2_000);
}

/// `cargo test -p brake-squeal --test all -- --ignored 75_islands`, some minutes.
#[test]
#[ignore = "minutes"]
fn all_75_islands_are_estimated() {
    islands_are_estimated(75, 10_000);
}
