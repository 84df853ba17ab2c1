//! What a study computes and what it leaves out, and that leaving it out changes nothing.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

use brakes::case::{LatticeCase, Law};
use brakes::{LatticeBrake, LatticeSample, sliding};
use cea::{Counters, EigenSolver, Mode, Modes, QrSolver, Workspace};
use linsys::SecondOrder;
use montecarlo::{Experiment as _, stream};
use study::{ModeLabel, Scene, SceneTally, Study, StudyTally, UncertainBrake as _, mode_work};

/// The paper's case with some of its text replaced.
fn case(changes: &[(&str, &str)]) -> LatticeCase {
    crate::common::case("paper.toml", changes)
}

/// One arrangement only: the reference modes of all take their time.
const ALL_IN_CONTACT: (&str, &str) = ("[9, 8, 7, 6]", "[9]");

/// Two rows of two and constraints that fit them.
const TWO_BY_TWO: [(&str, &str); 6] = [
    ("rows = 3", "rows = 2"),
    ("columns = 3", "columns = 2"),
    ("[9, 8, 7, 6]", "[4, 3, 2]"),
    ("[\"x1\", \"x3\", \"x7\", \"x9\"]", "[\"x1\", \"x4\"]"),
    ("[\"x1\", \"x3\", \"x7\", \"x9\", \"x4\", \"x6\"]", "[\"x1\", \"x2\", \"x3\", \"x4\"]"),
    ("corners = [1, 3, 7, 9]", "corners = [1, 2]"),
];

fn two_by_two(changes: &[(&str, &str)]) -> LatticeCase {
    let dominant = ("after_corners_dominant = [4, 6]", "after_corners_dominant = [1, 2]");
    case(&[&TWO_BY_TWO[..], &[dominant], changes].concat())
}

/// The counts of each scene after some samples.
fn tallies(brake: &LatticeBrake, samples: u64) -> Vec<SceneTally> {
    let study = Study::new(brake, &QrSolver).unwrap();
    let sampling = montecarlo::Sampling::new(brake.case.header.seed, samples);
    let summary = montecarlo::run(&study, &sampling, || StudyTally::empty(&brake.plan)).unwrap();
    assert_eq!(summary.failures.total(), 0);
    summary.tally.scenes
}

#[test]
fn a_symmetry_class_counts_as_each_of_its_arrangements_alone() {
    let samples = 8;
    let brake = LatticeBrake::new(two_by_two(&[])).unwrap();
    let (plan, whole) = (&brake.plan, tallies(&brake, samples));
    let (mut members, mut unstable) = (0, 0);
    for (panel, (_, arrangements)) in brake.case.panels.iter().enumerate() {
        for (at, arrangement) in arrangements.iter().enumerate() {
            // A representative is computed anyway.
            if !plan.scenes.iter().any(|scene| scene.key.panel == panel && scene.members[1..].contains(&at)) {
                continue;
            }
            let numbers: Vec<String> = arrangement.in_contact().iter().map(|i| (i + 1).to_string()).collect();
            let alone = format!("arrangements = [[{}]]", numbers.join(", "));
            let alone = LatticeBrake::new(two_by_two(&[("in_contact = [4, 3, 2]", &alone)])).unwrap();
            for (scene, counts) in alone.plan.scenes.iter().zip(tallies(&alone, samples)) {
                let alike = |other: &&Scene| {
                    let (a, b) = (scene.key, other.key);
                    (a.constraints, a.law, a.speed) == (b.constraints, b.law, b.speed)
                        && b.panel == panel
                        && other.members.contains(&at)
                };
                let stands_for = plan.scenes.iter().find(alike).unwrap();
                let of_class = &whole[plan.scenes.iter().position(|other| std::ptr::eq(other, stands_for)).unwrap()];
                let what = format!("{:?}, {arrangement}", scene.key);
                assert_eq!((counts.solved, of_class.solved), (samples, samples), "{what}");
                assert_eq!(counts.any_unstable, of_class.any_unstable, "{what}");
                assert_eq!(counts.unstable_modes, of_class.unstable_modes, "{what}");
                assert_eq!(counts.divergent, of_class.divergent, "{what}");
                assert_eq!(counts.ranked, of_class.ranked, "{what}");
                assert_eq!(counts.tracked, of_class.tracked, "{what}");
                members += usize::from(stands_for.members.len() > 1);
                unstable += counts.unstable_modes;
            }
        }
    }
    assert!(members > 0 && unstable > 0, "{members} members of classes, {unstable} unstable modes");
}

#[test]
fn a_law_without_speed_is_solved_once_for_all_speeds() {
    let brake = LatticeBrake::new(case(&[])).unwrap();
    let plan = &brake.plan;
    let count = |law: Law| plan.scenes.iter().filter(|scene| brake.law(scene.key) == law).count();
    assert_eq!(count(Law::AmontonsCoulomb), plan.configurations.len());
    assert_eq!(count(Law::LuGre), 2 * plan.configurations.len());
    assert_eq!(plan.analyses_per_sample(), 3 * 130 * 3 * 2);

    // The same system to the last bit at any speed, so once is the same as once per speed.
    let sample = brake.draw(&mut stream(1, 0)).unwrap();
    let scene = plan.scenes.iter().find(|scene| brake.law(scene.key) == Law::AmontonsCoulomb).unwrap();
    let lattice = brake.lattice(scene);
    let at = |speed| {
        let at = sliding(&brake.case, lattice, Law::AmontonsCoulomb, speed, &sample).unwrap();
        lattice.linearised(&at).unwrap()
    };
    assert!(at(0.1) == at(10.0));

    // Not so where friction across the sliding is a dashpot mu N0 / v.
    let vector = LatticeBrake::new(case(&[("lateral = \"none\"", "lateral = \"vector\"")])).unwrap();
    assert!(vector.plan.scenes.iter().all(|scene| scene.key.speed.is_some()));
}

#[test]
fn a_certified_block_costs_no_solve() {
    let calm = ("mean = 0.50, deviation = 0.10", "mean = 0.03, deviation = 0.001");
    let one_law = (", \"velocity-dependent\", \"lugre\"]", "]");
    let brake = LatticeBrake::new(case(&[calm, one_law, ALL_IN_CONTACT])).unwrap();
    let study = Study::new(&brake, &QrSolver).unwrap();
    let samples: Vec<LatticeSample> = (0..8).map(|index| study.draw(&mut stream(1, index)).unwrap()).collect();
    let scene = brake.plan.scenes.iter().position(|scene| brake.law(scene.key) == Law::AmontonsCoulomb).unwrap();
    let (mut scratch, mut out) = (Default::default(), Vec::new());
    study.evaluate_block(scene, &samples.iter().collect::<Vec<_>>(), &mut scratch, &mut out);
    assert!(out.iter().all(|outcome| outcome.as_ref().is_ok_and(|outcome| outcome.unstable.is_empty())));
    let counters = scratch.counters();
    assert_eq!(counters, Counters::default());
}

#[test]
fn only_unstable_modes_cost_eigenvectors() {
    // What is not alike in all contacts is solved by spectra, sector by sector. Loads are of no account without a slope.
    let loads = ("preload = { per_contact = 600.0 }", "preload = { equilibrium = 600.0 }");
    for (changes, law, has_spectra) in [
        (&[ALL_IN_CONTACT][..], Law::AmontonsCoulomb, false),
        (&[ALL_IN_CONTACT, loads], Law::AmontonsCoulomb, false),
        (&[ALL_IN_CONTACT, loads], Law::VelocityDependent, true),
    ] {
        let brake = LatticeBrake::new(case(changes)).unwrap();
        let study = Study::new(&brake, &QrSolver).unwrap();
        let scene = brake.plan.scenes.iter().position(|scene| brake.law(scene.key) == law).unwrap();
        let sectors = brake.plan.brake(&brake.plan.scenes[scene]).sectors.iter().len() as u64;
        let mut seen = 0;
        for index in 0..16 {
            let sample = study.draw(&mut stream(1, index)).unwrap();
            let mut scratch = Default::default();
            let outcome = study.evaluate(scene, &sample, &mut scratch).unwrap();
            let counters = scratch.counters();
            if counters.continuations == 0 && !outcome.unstable.is_empty() {
                assert_eq!(counters.eigenvalue_solves, if has_spectra { sectors } else { 0 });
                assert_eq!(counters.secular_values > 0, !has_spectra);
                assert_eq!(counters.eigenvectors, outcome.unstable.len() as u64);
                seen += outcome.unstable.len();
            }
        }
        assert!(seen > 0);
    }
}

#[test]
fn identity_by_mac_names_each_mode_after_the_origin_that_it_looks_like() {
    let by_mac = ("labels = \"tracked\"", "labels = \"tracked\"\nidentity = \"mac\"");
    let brake = LatticeBrake::new(two_by_two(&[by_mac])).unwrap();
    let (study, mut work) = (Study::new(&brake, &QrSolver).unwrap(), Workspace::default());
    let modes = |system: &SecondOrder, work: &mut Workspace| {
        let spectrum = QrSolver.eigenvalues(system, work).unwrap();
        Mode::at(system, &Modes::classify(system, &spectrum, work).unwrap().oscillatory, work).unwrap()
    };
    let (mut named, mut nameless) = (0, 0);
    for (index, scene) in brake.plan.scenes.iter().enumerate() {
        let origin = &brake.plan.origins[brake.plan.configuration(scene).origin];
        let shapes = modes(&origin.brake.system.assemble(&origin.naming_point).unwrap(), &mut work);
        let sample = brake.draw(&mut stream(3, index as u64)).unwrap();
        let system = brake.system(scene, &sample).unwrap();
        let unstable: Vec<Mode> = modes(&system, &mut work).into_iter().filter(|mode| mode.lambda.re > 0.0).collect();
        let outcome = study.evaluate(index, &sample, &mut Default::default()).unwrap();
        let expected = tracking::mac(&unstable, &shapes, &system.m);
        for (row, found) in expected.row_iter().zip(&outcome.unstable) {
            let alike = (1..).zip(row.iter()).filter(|(_, mac)| **mac > 0.5);
            let alike: Vec<ModeLabel> = alike.map(|(rank, _)| ModeLabel::new(rank)).collect();
            // A pair that flutters has shapes alike: the more alike one gives the name.
            assert!(alike.is_empty() || found.names.iter().any(|name| alike.contains(name)), "{alike:?} {found:?}");
            assert_eq!(found.names.is_empty(), alike.is_empty());
            *(if alike.is_empty() { &mut nameless } else { &mut named }) += 1;
        }
    }
    println!("{named} named, {nameless} like none");
    assert!(named >= 15);
}

#[test]
fn every_unstable_mode_of_the_papers_samples_gains_its_net_work() {
    let brake = LatticeBrake::new(case(&[])).unwrap();
    let (mut modes, mut worst, mut work) = (0, 0.0_f64, Workspace::default());
    // Every number in contact, law, speed and constraint set in turn.
    for (index, scene) in brake.plan.scenes.iter().enumerate().step_by(7) {
        let sample = brake.draw(&mut stream(brake.case.header.seed, index as u64)).unwrap();
        let system = brake.system(scene, &sample).unwrap();
        let spectrum = QrSolver.eigenvalues(&system, &mut work).unwrap();
        let found = Modes::classify(&system, &spectrum, &mut work).unwrap();
        let unstable: Vec<_> = found.oscillatory.iter().copied().filter(|lambda| lambda.re > 0.0).collect();
        let point = brake.operating_point(scene, &sample).unwrap();
        for mode in Mode::at(&system, &unstable, &mut work).unwrap() {
            let energy = mode_work(brake.plan.brake(scene), &point, &mode).unwrap();
            worst = worst.max(energy.identity_residual());
            modes += 1;
        }
    }
    println!("{modes} unstable modes, largest residual {worst:.1e}");
    assert!(modes >= 30 && worst < 1e-8, "{modes} modes, residual {worst:e}");
}
