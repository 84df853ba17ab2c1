//! The shipped finite element brake: its modes against SciPy's, unreduced and reduced.

#![allow(clippy::unwrap_used, clippy::panic)] // Test code, which the lints do not recognise outside test functions.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use nalgebra::Complex;
use squeal::brakes::FiniteElementBrake;
use squeal::case::{CaseFile, FiniteElementCase};
use squeal::study::UncertainBrake;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/disc-pad")
}

/// The case with all patches in contact, one set of constraints, mu = 0.5 at its median, and modes up to 10 kHz.
fn nine_in_contact() -> FiniteElementCase {
    let text = std::fs::read_to_string(folder().join("disc-pad.toml")).unwrap();
    let text = text.replace("in_contact = [9, 8]", "in_contact = [9]").replace("[500.0, 8000.0]", "[500.0, 10000.0]");
    let text = text.replace("residual = 1e-8", "residual = 1e-8\ntraining = 3");
    let held = text.find("[[constraints]]\nname = \"ends").unwrap();
    let text = format!("{}{}", &text[..held], &text[text.find("[[speeds]]").unwrap()..]);
    match CaseFile::parse(&folder().join("nine.toml"), text).unwrap() {
        CaseFile::FiniteElements(case) => *case,
        other => panic!("{other:?}"),
    }
}

/// The eigenvalues of reference.csv, rad/s; its condition numbers are at most 2e5.
fn reference() -> Vec<Complex<f64>> {
    let text = std::fs::read_to_string(folder().join("reference.csv")).unwrap();
    let number = |field: Option<&str>| field.unwrap().parse::<f64>().unwrap();
    text.lines()
        .skip(1)
        .map(|line| {
            let mut fields = line.split(',');
            Complex::new(number(fields.next()), number(fields.next()))
        })
        .collect()
}

fn assert_equal_sets(found: &[Complex<f64>], tolerance: f64) {
    let reference = reference();
    assert_eq!(found.len(), reference.len(), "{found:?}");
    for expected in &reference {
        let nearest = found.iter().map(|l| (l - expected).norm()).fold(f64::INFINITY, f64::min);
        assert!(nearest <= tolerance * expected.norm(), "{expected}: {nearest:e}");
    }
}

#[test]
fn modes_of_the_whole_and_of_the_reduced_brake_are_those_of_scipy() {
    let brake = FiniteElementBrake::new(nine_in_contact(), &()).unwrap();
    let scene = &brake.plan.scenes[0];
    let at = brake.operating_point(scene, &brake.median()).unwrap();
    let (set, full) = (&brake.sets[0], brake.full_point(scene, &at));
    let rectangle = sparse::Rectangle { re: [-500.0, 1000.0], im: [500.0 * TAU, 10_000.0 * TAU] };
    let whole = set.system.assemble(&full).unwrap();
    let found = sparse::eigenpairs_in(&whole, &rectangle, &sparse::Options::default(), &mut |_| {}).unwrap();
    assert_equal_sets(&found.pairs.iter().map(|pair| pair.lambda).collect::<Vec<_>>(), 1e-11);
    assert!(found.pairs.iter().all(|pair| pair.backward_error < 1e-14));

    let modes = set.reduction.reduced.modes(&full).unwrap();
    assert_equal_sets(&modes.lambdas, 1e-6);
    assert!(modes.largest_residual() <= 1e-8);
    // Friction alone can make it unstable: one mode of twelve.
    assert_eq!(modes.lambdas.iter().filter(|lambda| lambda.re > 0.0).count(), 1);
}
