//! The verdicts of a study, with its certificates and sectors, against the full solver: every one must be the same.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

use crate::common::case;
use brakes::case::LatticeCase;
use brakes::{LatticeBrake, LatticeSample};
use cea::{AxisMargins, BatchSolver, Counters, EigenSolver, Modes, Spectrum, Verdict, Workspace, verdict};
use linsys::SecondOrder;
use montecarlo::{Experiment as _, stream};
use rayon::prelude::*;
use study::{Outcome, Study, UncertainBrake as _};

/// Samples solved at a time.
const BLOCK: u64 = 64;

/// What the full solver says of some samples, and what the study says.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
struct Count {
    samples: u64,
    stable: u64,
    certified: u64,
    /// Samples of which the study says anything else: ranks of unstable modes, divergence, modes left open.
    disagree: u64,
    /// Whole spectra that the study solves for.
    spectra: u64,
}

impl Count {
    fn and(self, other: Self) -> Self {
        Self {
            samples: self.samples + other.samples,
            stable: self.stable + other.stable,
            certified: self.certified + other.certified,
            disagree: self.disagree + other.disagree,
            spectra: self.spectra + other.spectra,
        }
    }
}

/// Ranks of the unstable modes, divergent real eigenvalues, and modes that the error bound leaves open.
type Verdicts = (Vec<usize>, usize, usize);

fn full(system: &SecondOrder, spectrum: &Spectrum, work: &mut Workspace) -> Verdicts {
    let modes = Modes::classify(system, spectrum, work).unwrap();
    let (mut unstable, mut open) = (Vec::new(), 0);
    for (index, &lambda) in modes.oscillatory.iter().enumerate() {
        match verdict(system, lambda, spectrum, work).unwrap() {
            Verdict::Unstable => unstable.push(modes.rank(index)),
            Verdict::Stable => {}
            Verdict::Marginal { .. } | Verdict::Undecided { .. } => open += 1,
        }
    }
    (unstable, modes.real.iter().filter(|&&re| re > 0.0).count(), open)
}

fn of_study(outcome: &Outcome) -> Verdicts {
    let ranks = outcome.unstable.iter().map(|mode| usize::from(mode.rank.number())).collect();
    (ranks, outcome.divergent as usize, outcome.undecided as usize)
}

/// Counts `samples` draws in each scene.
fn count(case: LatticeCase, samples: u64) -> Vec<Count> {
    let brake = LatticeBrake::new(case).unwrap();
    let study = Study::new(&brake, &BatchSolver).unwrap();
    let plan = &brake.plan;
    // Not the draws of the anchors, which are the first of the case's own seed.
    let draw = |index| LatticeSample::draw(&brake.case, &mut stream(brake.case.header.seed + 1, index)).unwrap();
    let of_scene = |scene: usize| {
        let (mut count, mut work, mut spectra) = (Count::default(), Workspace::default(), Vec::new());
        let (mut scratch, mut outcomes) = (Default::default(), Vec::new());
        for first in (0..samples).step_by(BLOCK as usize) {
            let samples: Vec<LatticeSample> = (first..samples.min(first + BLOCK)).map(draw).collect();
            let system = |sample| brake.system(&plan.scenes[scene], sample).unwrap();
            let systems: Vec<SecondOrder> = samples.iter().map(system).collect();
            BatchSolver.eigenvalues_of_all(&systems, &mut work, &mut spectra);
            study.evaluate_block(scene, &samples.iter().collect::<Vec<_>>(), &mut scratch, &mut outcomes);
            for ((system, spectrum), outcome) in systems.iter().zip(&spectra).zip(outcomes.drain(..)) {
                let (full, outcome) = (full(system, spectrum.as_ref().unwrap(), &mut work), outcome.unwrap());
                count = count.and(Count {
                    samples: 1,
                    stable: (full == Verdicts::default()).into(),
                    certified: outcome.is_certified.into(),
                    disagree: (full != of_study(&outcome)).into(),
                    spectra: 0,
                });
            }
        }
        count.spectra = scratch.counters().eigenvalue_solves;
        count
    };
    (0..plan.scenes.len()).into_par_iter().map(of_scene).collect()
}

/// Less friction than the made-up case has, which is nearly always unstable.
const LESS: [(&str, &str); 3] = [
    ("from = 0.3, to = 0.7", "from = 0.02, to = 0.4"),
    ("mean = 0.55, deviation = 0.05", "mean = 0.25, deviation = 0.1"),
    ("mean = 0.45, deviation = 0.05", "mean = 0.2, deviation = 0.1"),
];

#[test]
fn a_study_has_the_verdicts_of_the_full_solver() {
    let one_for_each = ("draws = \"shared\"", "draws = \"each\"");
    let loads = ("preload = { per_contact = 500.0 }", "preload = { equilibrium = 500.0 }");
    for change in [None, Some(one_for_each), Some(loads)] {
        let changes: Vec<_> = LESS.into_iter().chain(change).collect();
        let counts = count(case("two-by-two.toml", &changes), 60);
        let all = counts.iter().copied().fold(Count::default(), Count::and);
        println!("{change:?}: {all:?}");
        assert_eq!(all.disagree, 0, "{change:?}: {all:?}");
        assert!(all.certified > all.samples / 10 && all.stable < all.samples, "{change:?}: {all:?}");
    }
}

#[test]
fn the_papers_samples_need_few_spectra_for_the_verdicts_of_the_full_solver() {
    let counts = count(case("paper.toml", &[("[9, 8, 7, 6]", "[9, 8]")]), 40);
    let all = counts.iter().copied().fold(Count::default(), Count::and);
    println!("{all:?}");
    assert_eq!(all.disagree, 0, "{all:?}");
    assert!(all.stable - all.certified > 100 && all.samples - all.stable > 1000, "{all:?}");
    assert!(100 * all.spectra < all.samples - all.certified, "{all:?}");
}

/// How far eigenvalues are from the axis in all matrices that the certificates of a case rest on.
fn margins(case: LatticeCase) -> AxisMargins {
    let brake = LatticeBrake::new(case).unwrap();
    let study = Study::new(&brake, &BatchSolver).unwrap();
    let margins = study.certificates().iter().map(|certificate| certificate.margins());
    let margins = margins.fold(AxisMargins::default(), AxisMargins::and);
    println!("{margins:?}");
    margins
}

#[test]
fn eigenvalues_keep_off_the_allowance_for_rounding_on_both_sides() {
    let found = margins(case("two-by-two.toml", &LESS));
    assert!(found.matrices > 10 && found.on_axis < 1e-12 && found.off_axis > 2e-8, "{found:?}");
}

/// `cargo test --release -p brake-squeal-study --test all allowance -- --ignored --nocapture`
#[test]
#[ignore = "reference modes of 675 scenes"]
fn eigenvalues_keep_off_the_allowance_for_rounding_in_the_papers_case() {
    let found = margins(case("paper.toml", &[]));
    assert!(found.matrices > 300 && found.on_axis < 1e-12 && found.off_axis > 2e-8, "{found:?}");
}

#[test]
fn friction_across_the_sliding_is_not_certified() {
    let counts = count(case("two-by-two.toml", &[("lateral = \"none\"", "lateral = \"vector\"")]), 4);
    assert!(counts.iter().all(|count| count.certified == 0));
}

#[test]
fn a_certified_sample_costs_nothing_and_an_open_one_of_like_contacts_no_spectrum() {
    for (draws, is_like) in [("draws = \"shared\"", true), ("draws = \"each\"", false)] {
        let changes: Vec<_> = LESS.into_iter().chain([("draws = \"shared\"", draws)]).collect();
        let brake = LatticeBrake::new(case("two-by-two.toml", &changes)).unwrap();
        let study = Study::new(&brake, &BatchSolver).unwrap();
        let (mut certified, mut open, mut handed_back) = (0, 0, 0);
        for index in 0..40 {
            let sample = study.draw(&mut stream(1, index)).unwrap();
            for (at, scene) in brake.plan.scenes.iter().enumerate() {
                let mut scratch = Default::default();
                let outcome = study.evaluate(at, &sample, &mut scratch).unwrap();
                let counters = scratch.counters();
                let point = brake.operating_point(scene, &sample).unwrap();
                if study.certificates()[scene.configuration].covers(&point) {
                    assert_eq!(outcome, Outcome { is_certified: true, ..Outcome::default() });
                    assert_eq!(counters, Counters::default());
                    certified += 1;
                    continue;
                }
                assert!(!outcome.is_certified && is_like == (counters.secular_values > 0));
                assert!(is_like || counters.eigenvalue_solves > 0);
                open += 1;
                handed_back += u32::from(counters.eigenvalue_solves > 0);
            }
        }
        println!("{draws}: {certified} certified, {open} open, {handed_back} with spectra");
        assert!(certified > 0 && open > 0 && (!is_like || 20 * handed_back < open));
    }
}

#[test]
#[ignore = "some minutes: cargo test --release -p brake-squeal-study --test all certificate:: -- --ignored --nocapture"]
fn a_million_samples_of_the_papers_case() {
    let case = case("paper.toml", &[]);
    let names: Vec<String> = case.constraints.iter().map(|set| set.name.clone()).collect();
    let plan = LatticeBrake::new(case.clone()).unwrap().plan;
    let counts = count(case, 1_000_000_u64.div_ceil(plan.scenes.len() as u64));
    for (constraints, name) in names.iter().enumerate() {
        let of_set = plan.scenes.iter().zip(&counts).filter(|(scene, _)| scene.key.constraints == constraints);
        println!("{name}: {:?}", of_set.map(|(_, &count)| count).fold(Count::default(), Count::and));
    }
    let all = counts.iter().copied().fold(Count::default(), Count::and);
    println!("all: {all:?}");
    assert!(all.samples >= 1_000_000 && all.certified > all.samples / 3);
    assert_eq!(all.disagree, 0);
}
