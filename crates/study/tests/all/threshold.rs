//! A threshold beside the bare sign: what a study counts, against whole spectra and the definition of the threshold.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

use brakes::{LatticeBrake, LatticeSample};
use cea::{BatchSolver, EigenSolver, QrSolver, Workspace};
use montecarlo::{Experiment as _, stream};
use num_complex::Complex;
use study::estimators::{EstimatorError, OneParameterFamily, friction_points, monte_carlo, scene_occurrences};
use study::{KeptSample, Outcome, Study, UncertainBrake as _};

/// A lattice with all laws, with the table `[squeal]` of this text.
fn brake(squeal: &str, changes: &[(&str, &str)]) -> LatticeBrake {
    let table = format!("[squeal]\n{squeal}\n[lattice]\n");
    LatticeBrake::new(crate::common::case("two-by-two.toml", &[&[("[lattice]\n", table.as_str())], changes].concat()))
        .unwrap()
}

/// The growth rates that are beyond both conditions, ascending, by a whole spectrum.
fn by_spectrum(brake: &LatticeBrake, scene: usize, sample: &LatticeSample, [growth, ratio]: [f64; 2]) -> Vec<f64> {
    let system = brake.system(&brake.plan.scenes[scene], sample).unwrap();
    let spectrum = QrSolver.eigenvalues(&system, &mut Workspace::default()).unwrap();
    let counts = |l: &Complex<f64>| l.im > 0.0 && l.re > growth && -l.re / l.norm() < ratio;
    let mut found: Vec<f64> = spectrum.eigenvalues.iter().filter(|lambda| counts(lambda)).map(|l| l.re).collect();
    found.sort_by(f64::total_cmp);
    found
}

/// Every scene at some draws.
fn outcomes(brake: &LatticeBrake, samples: &[LatticeSample]) -> Vec<Vec<Outcome>> {
    let study = Study::new(brake, &BatchSolver).unwrap();
    let samples: Vec<&LatticeSample> = samples.iter().collect();
    let of_scene = |scene| {
        let (mut scratch, mut out) = (Default::default(), Vec::new());
        study.evaluate_block(scene, &samples, &mut scratch, &mut out);
        out.into_iter().map(Result::unwrap).collect()
    };
    (0..brake.plan.scenes.len()).map(of_scene).collect()
}

fn draws(brake: &LatticeBrake, count: u64) -> Vec<LatticeSample> {
    (0..count).map(|index| brake.draw(&mut stream(brake.plan.seed, index)).unwrap()).collect()
}

#[test]
fn modes_beyond_a_threshold_are_those_of_whole_spectra() {
    let sign = brake("", &[]);
    let all: f64 = outcomes(&sign, &draws(&sign, 40)).iter().flatten().map(|o| o.unstable.len() as f64).sum();
    let each = &[("draws = \"shared\"", "draws = \"each\"")][..];
    let cases = [
        ("damping_ratio_below = -0.02", [0.0, -0.02], &[][..]),
        ("growth_above = 200.0", [200.0, 0.0], &[]),
        ("growth_above = 150.0\ndamping_ratio_below = -0.018", [150.0, -0.018], &[]),
        ("damping_ratio_below = -0.02", [0.0, -0.02], each),
    ];
    for (text, threshold, changes) in cases {
        let brake = brake(text, changes);
        let samples = draws(&brake, 40);
        let (mut found, mut certified) = (0, 0);
        for (scene, outcomes) in outcomes(&brake, &samples).into_iter().enumerate() {
            for (sample, outcome) in samples.iter().zip(outcomes) {
                let mut growths: Vec<f64> = outcome.unstable.iter().map(|mode| mode.lambda.re).collect();
                growths.sort_by(f64::total_cmp);
                let expected = by_spectrum(&brake, scene, sample, threshold);
                assert_eq!((growths.len(), outcome.undecided), (expected.len(), 0), "{text}: {growths:?} {expected:?}");
                for (growth, expected) in growths.iter().zip(&expected) {
                    assert!((growth - expected).abs() < 1e-6, "{text}: {growth} {expected}");
                }
                assert_eq!(outcome.growth, growths.last().copied().unwrap_or(0.0));
                found += growths.len();
                certified += usize::from(outcome.is_certified);
            }
        }
        // Some modes that grow are below the threshold and some beyond, and certificates still cover some samples.
        assert!(found > 20 && (!changes.is_empty() || (found as f64) < 0.95 * all), "{text}: {found} of {all}");
        assert!(certified > 0 || !changes.is_empty(), "{text}");
    }
}

#[test]
fn an_empty_table_is_the_bare_sign() {
    let (plain, empty) = (LatticeBrake::new(crate::common::case("two-by-two.toml", &[])).unwrap(), brake("", &[]));
    assert_eq!(plain.plan.identity, empty.plan.identity);
    assert_eq!(plain.plan.threshold, empty.plan.threshold);
    assert_ne!(plain.plan.threshold, brake("growth_above = 1.0", &[]).plan.threshold);
    let samples = draws(&plain, 8);
    assert_eq!(outcomes(&plain, &samples), outcomes(&empty, &samples));
}

#[test]
fn a_mode_on_the_threshold_is_undecided() {
    let sign = brake("", &[]);
    let samples = draws(&sign, 30);
    let outcomes_of_sign = outcomes(&sign, &samples);
    // The growth rate of a mode of the second scene, in which the secular equation finds the modes.
    let grows = |of: &&Outcome| of.unstable.len() == 1 && of.unstable[0].lambda.re > 10.0;
    let (at, mode) = outcomes_of_sign
        .iter()
        .enumerate()
        .find_map(|(at, of)| Some((at, of.iter().find(grows)?.unstable[0].clone())))
        .unwrap();
    let growth = mode.lambda.re;
    for (factor, undecided) in [(1.0, 1), (1.0 - 1e-7, 0), (1.0 + 1e-7, 0)] {
        let brake = brake(&format!("growth_above = {:?}", growth * factor), &[]);
        let found = &outcomes(&brake, &samples)[at];
        let of_sample =
            outcomes_of_sign[at].iter().position(|of| grows(&of) && of.unstable[0].lambda.re == growth).unwrap();
        assert_eq!(found[of_sample].undecided, undecided, "{factor}");
        // What is open is told by name.
        let open: Vec<_> = found[of_sample].open.iter().map(|open| (open.rank, &open.names)).collect();
        assert_eq!(open, if undecided == 1 { vec![(mode.rank, &mode.names)] } else { Vec::new() }, "{factor}");
        let kept = KeptSample::new(0, &found[of_sample]);
        let may_be: Vec<_> = kept.map(|kept| kept.may_be).into_iter().flatten().collect();
        assert_eq!(may_be, if undecided == 1 { vec![mode.names.clone()] } else { Vec::new() }, "{factor}");
        assert_eq!(found[of_sample].unstable.len(), usize::from(factor < 1.0), "{factor}");
        assert_eq!(found.iter().map(|of| of.undecided).sum::<u32>(), undecided);
    }
}

#[test]
fn estimators_keep_to_the_threshold() {
    let brake = brake("damping_ratio_below = -0.02", &[]);
    let study = Study::new(&brake, &BatchSolver).unwrap();
    let mut lower_than_sign = 0;
    for scene in 0..brake.plan.scenes.len().min(4) {
        // Onsets of the bare sign are of no use here.
        let family = OneParameterFamily::new(&brake, &brake.plan.scenes[scene], &QrSolver);
        assert!(matches!(family, Err(EstimatorError::NotOneParameter { .. })));
        let points = friction_points(&study, scene, 0.01).unwrap();
        let found = scene_occurrences(&study, scene, 0.01, points.as_ref()).unwrap();
        let plain = monte_carlo(&study, scene, 99, 4_000).unwrap();
        for (name, estimated) in &found.modes {
            let Some(plain) = plain.modes.get(name) else { continue };
            let apart = (estimated.occurrence.lower - plain.occurrence.lower).abs();
            assert!(
                apart <= estimated.half_width() + 1.5 * plain.half_width(),
                "{scene} {name}: {estimated:?} {plain:?}"
            );
            lower_than_sign += 1;
        }
    }
    assert!(lower_than_sign > 2);
}
