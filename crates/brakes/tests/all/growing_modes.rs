//! The growing modes of samples that differ in friction alone, beside whole spectra of the reduced brake, and beside the whole one: none may be missing.

use std::f64::consts::TAU;
use std::path::Path;

use brakes::FiniteElementBrake;
use brakes::case::{CaseFile, FiniteElementCase};
use montecarlo::stream;
use squeal::study::{BandMode, ModeSource, UncertainBrake};

/// Growth up to which modes are counted, as a fraction of the highest frequency of the band: as far as the line around it is. Under LuGre friction single
/// pairs of nodes may grow far faster, which the search does not find and the basis does not contain (docs/large-problems.md).
const COUNTED: f64 = 0.06;

/// The case with some arrangements of closed patches, with or without friction across the sliding (`contact.lateral`).
fn case(arrangements: &str, lateral: &str) -> FiniteElementCase {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/disc-pad/disc-pad.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let contact = text.lines().find(|line| line.starts_with("in_contact")).unwrap();
    let changed = format!("{arrangements}\nlateral = \"{lateral}\"");
    match CaseFile::parse(&path, text.replace(contact, &changed)).unwrap() {
        CaseFile::FiniteElements(case) => *case,
        other => panic!("{other:?}"),
    }
}

/// Brake of the case by the reduction alone.
fn brake(arrangements: &str, lateral: &str) -> FiniteElementBrake {
    let mut case = case(arrangements, lateral);
    case.reduction.full_verdicts = 0;
    FiniteElementBrake::new(case, &()).unwrap()
}

/// Compares some samples of every scene; returns the number of samples and of growing modes.
fn compared(brake: &FiniteElementBrake, samples: impl Iterator<Item = u64> + Clone) -> (usize, usize) {
    let (mut count, mut growing) = (0, 0);
    let fastest = COUNTED * brake.plan().band.unwrap()[1];
    let grows = |lambda: &nalgebra::Complex<f64>| lambda.re > 0.0 && lambda.re < fastest;
    for scene in &brake.plan().scenes {
        let drawn = samples.clone().map(|at| brake.draw(&mut stream(brake.case.header.seed, at)).unwrap());
        let points: Vec<_> = drawn.map(|sample| brake.operating_point(scene, &sample).unwrap()).collect();
        for (at, found) in points.iter().zip(brake.band_modes(scene, &points)) {
            let found = found.unwrap();
            let alone = brake.band_modes(scene, std::slice::from_ref(at)).remove(0).unwrap();
            assert_eq!(found, alone, "a sample does not depend on others, to the last bit: {scene:?} {at:?}");
            let whole = brake.part(scene).reduced.modes_by_spectrum(&brake.full_point(scene, at)).unwrap();
            for lambda in whole.lambdas.iter().filter(|lambda| grows(lambda)) {
                let is_it = |mode: &BandMode| (mode.lambda - lambda).norm() < 1e-6 * lambda.norm();
                assert_eq!(found.iter().filter(|mode| is_it(mode)).count(), 1, "{lambda} {scene:?} {at:?}");
                growing += 1;
            }
            let all = found.iter().filter(|mode| grows(&mode.lambda)).count();
            assert_eq!(all, whole.lambdas.iter().filter(|lambda| grows(lambda)).count(), "{scene:?} {at:?}");
            count += 1;
        }
    }
    (count, growing)
}

/// Samples in which an earlier search lost a mode: one that came from beyond where it looked, one of two that became one, and in the last
/// arrangement ones whose guess went to another mode while the guess of that one stood for both where modes are counted.
#[test]
fn no_growing_mode_is_missing() {
    let arrangements = "arrangements = [[1, 2, 3, 4, 5, 6, 7, 8], [1, 3, 4, 5, 6, 7, 8, 9], [1, 3, 4, 5, 6, 8, 9]]";
    let brake = brake(arrangements, "none");
    let (samples, growing) = compared(&brake, [0, 1, 2, 81, 281, 380, 209, 533, 616, 755, 978].into_iter());
    assert_eq!(samples, 198);
    assert!(growing > 100, "{growing}");
}

/// With friction across the sliding, where the gains of all ports differ.
#[test]
fn no_growing_mode_is_missing_where_friction_acts_across_the_sliding() {
    let brake = brake("arrangements = [[1, 2, 3, 4, 5, 6, 7, 8, 9], [2, 4, 5, 6, 7, 8]]", "vector");
    let (samples, growing) = compared(&brake, 0..6);
    assert_eq!(samples, 72);
    assert!(growing > 40, "{growing}");
}

/// SAMPLES of every scene with the arrangements in ARRANGEMENTS, or those of the case, and friction across the sliding as in LATERAL; minutes.
#[test]
#[ignore = "minutes"]
fn no_growing_mode_is_missing_in_any_scene() {
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    let arrangements = std::env::var("ARRANGEMENTS").map(|of| format!("arrangements = {of}"));
    let lateral = std::env::var("LATERAL").unwrap_or_else(|_| "vector".into());
    let brake = brake(&arrangements.unwrap_or_else(|_| "in_contact = [9, 8]".into()), &lateral);
    let (samples, growing) = compared(&brake, 0..number("SAMPLES").unwrap_or(20));
    println!("{samples} samples, {growing} growing modes, none missing and none invented");
}

/// SAMPLES draws in every twentieth scene of the case, on bases of TRAINING draws: each verdict of a mode that is not open is that of the whole brake, and none of its
/// growing modes is missing. What the reduction alone leaves open is counted.
#[test]
#[ignore = "minutes"]
fn verdicts_are_those_of_the_whole_brake() {
    let number = |name: &str, default: u64| std::env::var(name).map_or(default, |text| text.parse().unwrap());
    let mut case = case("in_contact = [9, 8]", "vector");
    case.reduction.training = number("TRAINING", 1) as usize;
    let most = case.reduction.full_verdicts;
    let mut brake = FiniteElementBrake::new(case, &()).unwrap();
    let [low, high] = brake.case.reduction.frequencies.map(|hz| TAU * hz);
    let band = sparse::Rectangle { re: [-2.0, 20_000.0], im: [low, high] };
    let is_open = |mode: &BandMode| mode.lambda.re.abs() <= mode.bound;
    let [mut modes, mut before, mut after] = [0; 3];
    for at in 0..number("SAMPLES", 20) {
        let sample = brake.draw(&mut stream(brake.case.header.seed, at)).unwrap();
        for number in (at as usize..brake.plan.scenes.len()).step_by(20) {
            let scene = brake.plan.scenes[number].clone();
            let point = brake.operating_point(&scene, &sample).unwrap();
            let mut found = |most: usize| {
                brake.case.reduction.full_verdicts = most;
                brake.band_modes(&scene, std::slice::from_ref(&point)).remove(0).unwrap()
            };
            before += found(0).iter().filter(|mode| is_open(mode)).count();
            let found = found(most);
            let whole = brake.sets[brake.part(&scene).set].system.assemble(&brake.full_point(&scene, &point)).unwrap();
            let whole = sparse::eigenpairs_in(&whole, &band, &sparse::Options::default(), &mut |_| {}).unwrap().pairs;
            after += found.iter().filter(|mode| is_open(mode)).count();
            for mode in found.iter().filter(|mode| !is_open(mode) && mode.lambda.re > -1.0) {
                let near = |pair: &&sparse::Eigenpair| (pair.lambda - mode.lambda).norm() <= mode.bound + pair.bound;
                let own: Vec<bool> = whole.iter().filter(near).map(|pair| pair.lambda.re > 0.0).collect();
                assert!(own.contains(&(mode.lambda.re > 0.0)), "{scene:?} {mode:?}");
            }
            let grow = |pair: &&sparse::Eigenpair| pair.lambda.re > pair.bound && pair.lambda.re < pair.lambda.im;
            for pair in whole.iter().filter(grow) {
                let is_it = |mode: &&BandMode| (pair.lambda - mode.lambda).norm() <= mode.bound + pair.bound;
                assert!(found.iter().any(|mode| is_it(&mode)), "{scene:?} {}", pair.lambda);
                modes += 1;
            }
        }
    }
    println!("{modes} growing modes, none missing; open before {before}, with the whole brake {after}");
}
