//! Scenes solved by sectors against the same scenes solved whole.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

use std::sync::Mutex;

use crate::common::case;
use brakes::case::{LatticeCase, Law};
use brakes::{LatticeBrake, LatticeSample};
use cea::{BatchSolver, CeaError, EigenSolver, QrSolver, Spectrum, Workspace};
use linsys::SecondOrder;
use montecarlo::{Experiment as _, stream};
use osc_model::{Sector, Sectors};
use rayon::prelude::*;
use study::{Outcome, Plan, Scene, Study, UncertainBrake as _};

/// The brake of a case in which every lattice is its only sector.
fn whole(case: LatticeCase) -> LatticeBrake {
    let mut brake = LatticeBrake::new(case).unwrap();
    for configuration in &mut brake.plan.configurations {
        let brake = std::sync::Arc::make_mut(&mut configuration.brake);
        brake.sectors = Sectors::whole(brake.system.order(), brake.system.channels().len());
    }
    brake
}

fn sectors_of(plan: &Plan, scene: usize) -> usize {
    plan.brake(&plan.scenes[scene]).sectors.iter().len()
}

/// What two ways of solving the same samples say.
#[derive(Debug, Default, Clone, Copy)]
struct Count {
    samples: usize,
    modes: usize,
    /// Modes whose names the whole leaves open and the sectors do not, or not as far.
    closed: usize,
    /// Modes with other names.
    renamed: usize,
    /// Largest difference of a body's net work, relative to the largest of the mode.
    net_work: f64,
}

impl Count {
    fn and(self, other: Self) -> Self {
        Self {
            samples: self.samples + other.samples,
            modes: self.modes + other.modes,
            closed: self.closed + other.closed,
            renamed: self.renamed + other.renamed,
            net_work: self.net_work.max(other.net_work),
        }
    }

    fn of(sectors: &Outcome, whole: &Outcome) -> Self {
        let ranks = |outcome: &Outcome| outcome.unstable.iter().map(|mode| mode.rank).collect::<Vec<_>>();
        let verdicts = |outcome: &Outcome| (outcome.divergent, outcome.undecided, outcome.is_certified);
        assert_eq!((ranks(sectors), verdicts(sectors)), (ranks(whole), verdicts(whole)));
        let mut count = Self { samples: 1, modes: whole.unstable.len(), ..Self::default() };
        for (ours, theirs) in sectors.unstable.iter().zip(&whole.unstable) {
            if ours.names != theirs.names {
                let is_part = !ours.names.is_empty() && ours.names.iter().all(|name| theirs.names.contains(name));
                *(if is_part { &mut count.closed } else { &mut count.renamed }) += 1;
            }
            assert_eq!(ours.work.is_some(), theirs.work.is_some());
            if let (Some(ours), Some(theirs)) = (&ours.work, &theirs.work) {
                let (ours, theirs) = (ours.net(), theirs.net());
                let largest = theirs.iter().fold(0.0_f64, |most, work| most.max(work.abs()));
                let difference = |(a, b): (&f64, &f64)| (a - b).abs() / largest;
                count.net_work = ours.iter().zip(&theirs).map(difference).fold(count.net_work, f64::max);
            }
        }
        count
    }
}

/// Compares `samples` draws in each scene that falls apart.
fn compare(case: &LatticeCase, samples: u64) -> Count {
    let (split, whole) = (LatticeBrake::new(case.clone()).unwrap(), whole(case.clone()));
    let [split, whole] = [&split, &whole].map(|brake| Study::new(brake, &BatchSolver).unwrap());
    let draws: Vec<LatticeSample> = (0..samples).map(|index| split.draw(&mut stream(7, index)).unwrap()).collect();
    let draws: Vec<&LatticeSample> = draws.iter().collect();
    let of_scene = |scene: usize| {
        let outcomes = [&split, &whole].map(|study| {
            let mut out = Vec::new();
            study.evaluate_block(scene, &draws, &mut Default::default(), &mut out);
            out
        });
        let counts = outcomes[0].iter().zip(&outcomes[1]).map(|(a, b)| match (a, b) {
            (Ok(a), Ok(b)) => Count::of(a, b),
            (a, b) => {
                assert_eq!(a.as_ref().map_err(ToString::to_string), b.as_ref().map_err(ToString::to_string));
                Count::default()
            }
        });
        counts.fold(Count::default(), Count::and)
    };
    let scenes = (0..split.scenes()).into_par_iter().filter(|&scene| sectors_of(split.plan(), scene) > 1);
    scenes.map(of_scene).reduce(Count::default, Count::and)
}

#[test]
fn sectors_say_what_the_whole_says() {
    let readings = [
        vec![],
        vec![("lateral = \"none\"", "lateral = \"vector\"")],
        vec![("lateral = \"none\"", "lateral = \"coupled\"")],
        vec![("preload = { per_contact = 500.0 }", "preload = { equilibrium = 500.0 }")],
    ];
    let mut all = Count::default();
    for changes in &readings {
        let count = compare(&case("two-by-two.toml", changes), 60);
        println!("{changes:?}: {count:?}");
        all = all.and(count);
    }
    let nine = compare(&case("paper.toml", &[("[9, 8, 7, 6]", "[9]")]), 12);
    println!("nine in contact: {nine:?}");
    assert!(all.modes > 500 && nine.modes > 100, "{all:?}, {nine:?}");
    for count in [all, nine] {
        assert!(count.renamed == 0 && count.net_work < 1e-9, "{count:?}");
    }
}

#[test]
fn secular_equations_say_what_spectra_say() {
    let contacts = ("[9, 8, 7, 6]", "[9, 8]");
    let brake = LatticeBrake::new(case("paper.toml", &[contacts])).unwrap();
    let each = case("paper.toml", &[contacts, ("draws = \"shared\"", "draws = \"each\"")]);
    let study = Study::new(&brake, &BatchSolver).unwrap();
    let draws: Vec<LatticeSample> = (0..100).map(|index| study.draw(&mut stream(7, index)).unwrap()).collect();
    let of_scene = |at: usize| {
        let evaluated = |first: Option<&LatticeSample>| {
            let (mut scratch, mut out) = (Default::default(), Vec::new());
            let block: Vec<&LatticeSample> = first.into_iter().chain(&draws).collect();
            study.evaluate_block(at, &block, &mut scratch, &mut out);
            let outcomes = out.split_off(first.iter().len()).into_iter().map(Result::unwrap).collect::<Vec<Outcome>>();
            (outcomes, scratch.counters())
        };
        // One sample whose contacts differ, if no certificate covers it, leaves its whole block to spectra.
        let (scene, mut unlike) =
            (&brake.plan.scenes[at], (0..1000).map(|index| LatticeSample::draw(&each, &mut stream(8, index))));
        let is_open = |sample: &LatticeSample| {
            let point = brake.operating_point(scene, sample).unwrap();
            !study.certificates()[scene.configuration].covers(&point)
        };
        let Some(unlike) = unlike.find_map(|sample| sample.ok().filter(is_open)) else {
            return (Count::default(), [0; 2]);
        };
        let ((ours, by_equations), (theirs, by_spectra)) = (evaluated(None), evaluated(Some(&unlike)));
        let open = theirs.iter().filter(|outcome| !outcome.is_certified).count() as u64;
        assert!(by_spectra.secular_values == 0 && by_spectra.eigenvalue_solves >= open, "{:?}", scene.key);
        let counts = ours.iter().zip(&theirs).map(|(ours, theirs)| Count::of(ours, theirs));
        (counts.fold(Count::default(), Count::and), [by_equations, by_spectra].map(|all| all.eigenvalue_solves))
    };
    let counts: Vec<(Count, [u64; 2])> = (0..brake.plan.scenes.len()).into_par_iter().map(of_scene).collect();
    let count = counts.iter().fold(Count::default(), |all, (count, _)| all.and(*count));
    let [few, many] = [0, 1].map(|way| counts.iter().map(|(_, spectra)| spectra[way]).sum::<u64>());
    println!("{count:?}, {few} spectra instead of {many}");
    assert!(count.modes > 5000 && 10 * few < many);
    assert!(count.closed == 0 && count.renamed == 0 && count.net_work < 1e-9, "{count:?}");
}

#[test]
fn no_reference_mode_loses_its_name() {
    // With fewer in contact the sectors are others than where the names come from.
    for contacts in ["[9, 8]", "[6]"] {
        let brake = LatticeBrake::new(case("paper.toml", &[("[9, 8, 7, 6]", contacts)])).unwrap();
        let study = Study::new(&brake, &BatchSolver).unwrap();
        for (scene, reference) in study.references().iter().enumerate() {
            assert_eq!(reference.names.len(), reference.modes.len());
            assert!(reference.names.iter().all(|names| !names.is_empty()), "scene {scene}: {:?}", reference.names);
        }
    }
}

/// Loads that differ from contact to contact: samples of a law whose forces change with speed are left to spectra.
const UNLIKE: (&str, &str) = ("preload = { per_contact = 600.0 }", "preload = { equilibrium = 600.0 }");

/// A solver that notes how large its systems are.
#[derive(Default)]
struct Noting(Mutex<Vec<usize>>);

impl EigenSolver for Noting {
    fn eigenvalues(&self, system: &SecondOrder, work: &mut Workspace) -> Result<Spectrum, CeaError> {
        self.0.lock().unwrap().push(system.dimension());
        QrSolver.eigenvalues(system, work)
    }
}

#[test]
fn a_sample_costs_small_systems_only() {
    let sizes = |changes: &[(&str, &str)], law: Law| {
        let brake = LatticeBrake::new(case("paper.toml", &[&[("[9, 8, 7, 6]", "[9]")], changes].concat())).unwrap();
        let solver = Noting::default();
        let study = Study::new(&brake, &solver).unwrap();
        let scene = brake.plan.scenes.iter().position(|scene| brake.law(scene.key) == law).unwrap();
        // One whose modes are told by their shapes alone.
        for index in 0..16 {
            let sample = study.draw(&mut stream(1, index)).unwrap();
            solver.0.lock().unwrap().clear();
            let mut scratch = Default::default();
            let outcome = study.evaluate(scene, &sample, &mut scratch).unwrap();
            if !outcome.is_certified && scratch.counters().continuations == 0 {
                return solver.0.lock().unwrap().clone();
            }
        }
        Vec::new()
    };
    // Twice the shapes of each sector, and its bristles; the second is yp alone.
    assert_eq!(sizes(&[UNLIKE], Law::VelocityDependent), [28, 2, 12, 12, 6]);
    assert_eq!(sizes(&[UNLIKE], Law::LuGre), [32, 2, 14, 14, 7]);
    assert_eq!(sizes(&[("draws = \"shared\"", "draws = \"each\"")], Law::AmontonsCoulomb), [60]);
}

#[test]
fn a_sample_of_like_contacts_costs_few_values_of_its_secular_equations() {
    let brake = LatticeBrake::new(case("paper.toml", &[("[9, 8, 7, 6]", "[9]")])).unwrap();
    let study = Study::new(&brake, &BatchSolver).unwrap();
    let (mut samples, mut spectra) = (0, 0);
    for (at, scene) in brake.plan.scenes.iter().enumerate() {
        let (mut open, mut values) = (0, 0);
        for index in 0..100 {
            let mut scratch = Default::default();
            let outcome = study.evaluate(at, &study.draw(&mut stream(1, index)).unwrap(), &mut scratch).unwrap();
            // Following a mode whose name is in doubt takes values of its own, and may take spectra.
            if scratch.counters().continuations == 0 {
                open += u64::from(!outcome.is_certified);
                values += scratch.counters().secular_values;
                spectra += scratch.counters().eigenvalue_solves;
            }
        }
        let order: usize = brake.plan.brake(scene).sectors.iter().map(Sector::order).sum();
        // Nine contacts, however they are shared out among the sectors.
        let most = 1.6 * (order + 9) as f64;
        println!("{:?}: {open} open, {values} values", scene.key);
        assert!(values as f64 <= most * open as f64, "{:?}: {values} for {open}", scene.key);
        assert!(values >= open * order as u64 / 2, "{:?}: {values} for {open}", scene.key);
        samples += open;
    }
    println!("{spectra} spectra of sectors for {samples} open samples");
    assert!(samples > 700 && 100 * spectra < samples, "{spectra} for {samples}");
}

#[test]
fn bristles_that_hardly_couple_are_no_obstacle() {
    // At 8 m/s the coupling of the bristles is a factor of 1e-138, far below rounding and far above the smallest number.
    let one = ("in_contact = [9, 8, 7, 6]", "arrangements = [[1, 3, 4, 5, 6, 8]]");
    let brake = LatticeBrake::new(case("paper.toml", &[one])).unwrap();
    let wanted =
        |scene: &&Scene| brake.law(scene.key) == Law::LuGre && scene.key.speed == Some(1) && scene.key.constraints == 0;
    let scene = brake.plan.scenes.iter().find(wanted).unwrap();
    let sample = brake.draw(&mut stream(2, 5184)).unwrap();
    let (sectors, mut whole) = (&brake.plan.brake(scene).sectors, SecondOrder::zeros(1, 0));
    let mut parts = vec![SecondOrder::zeros(1, 0); sectors.iter().len()];
    let point = brake.operating_point(scene, &sample).unwrap();
    sectors.assemble_into(&brake.plan.brake(scene).system, &point, &mut whole, parts.iter_mut()).unwrap();
    for part in &parts {
        let spectrum = QrSolver.eigenvalues(part, &mut Workspace::default()).unwrap();
        assert_eq!(spectrum.eigenvalues.len(), part.dimension());
    }
}

#[test]
fn a_sector_without_friction_is_solved_once_for_a_block() {
    let brake = LatticeBrake::new(case("paper.toml", &[("[9, 8, 7, 6]", "[9]"), UNLIKE])).unwrap();
    let solver = Noting::default();
    let study = Study::new(&brake, &solver).unwrap();
    let draws: Vec<LatticeSample> = (0..16).map(|index| study.draw(&mut stream(1, index)).unwrap()).collect();
    solver.0.lock().unwrap().clear();
    let scene = brake.plan.scenes.iter().position(|scene| brake.law(scene.key) == Law::VelocityDependent).unwrap();
    let mut out = Vec::new();
    study.evaluate_block(scene, &draws.iter().collect::<Vec<_>>(), &mut Default::default(), &mut out);
    let open = out.iter().filter(|outcome| outcome.as_ref().is_ok_and(|outcome| !outcome.is_certified)).count();
    let sizes = solver.0.lock().unwrap();
    let count = |size| sizes.iter().filter(|&&other| other == size).count();
    // yp alone; the sector that turns round with rows and columns, which an uncertain name may need more often.
    assert!(open > 8 && count(2) == 1 && count(6) >= open, "{open} open: {sizes:?}");
}

#[test]
#[ignore = "some minutes: cargo test --release -p brake-squeal-study --test all sectors:: -- --ignored --nocapture"]
fn thousands_of_samples_of_the_papers_case() {
    let count = compare(&case("paper.toml", &[]), 200);
    println!("{count:?}");
    assert!(count.samples > 60_000 && count.renamed == 0 && count.net_work < 1e-9, "{count:?}");
}
