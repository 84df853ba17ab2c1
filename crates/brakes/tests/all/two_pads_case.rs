//! The shipped brake of two pads against SciPy, which makes contact, equilibrium and rotation by itself.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use brakes::case::{CaseFile, FiniteElementCase};
use num_complex::Complex;
use sparse::{Options, Rectangle, eigenpairs_in};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/two-pads")
}

fn case() -> FiniteElementCase {
    let path = folder().join("two-pads.toml");
    match CaseFile::read(&path).unwrap() {
        CaseFile::FiniteElements(case) => *case,
        other => panic!("{other:?}"),
    }
}

/// The eigenvalues of a file of `reference.py`.
fn reference(name: &str) -> Vec<Complex<f64>> {
    let text = std::fs::read_to_string(folder().join(name)).unwrap();
    let number = |line: &str| {
        let (re, im) = line.split_once(',').unwrap();
        Complex::new(re.parse().unwrap(), im.parse().unwrap())
    };
    text.lines().skip(1).map(number).collect()
}

/// All modes of the band, and no others: at the medians of the case, and at another friction and pressure, where other points are open.
#[test]
fn modes_are_those_of_scipy_at_two_frictions() {
    let constant = |value: f64| montecarlo::Distribution::Constant { value };
    for (name, mu, pressure) in [("reference.csv", 0.5, 2.0), ("reference-2.csv", 0.6, 3.0)] {
        let mut case = case();
        case.contact.as_mut().unwrap().friction.mu = constant(mu);
        case.parameters.iter_mut().filter(|own| own.name == "pressure").for_each(|own| {
            own.distribution = constant(pressure);
        });
        let system = case.system.assemble(&brakes::at_medians(&case).unwrap()).unwrap();
        let rectangle = Rectangle { re: [-500.0, 2e4], im: [TAU * 1e3, TAU * 7e3] };
        let found = eigenpairs_in(&system, &rectangle, &Options::default(), &mut |_| ()).unwrap();
        let expected = reference(name);
        let inside = |lambda: Complex<f64>| rectangle.im[0] < lambda.im && lambda.im < rectangle.im[1];
        assert_eq!(found.pairs.iter().filter(|pair| inside(pair.lambda)).count(), expected.len(), "{name}");
        for expected in expected {
            let distance = |lambda: Complex<f64>| (lambda - expected).norm() / expected.norm();
            let nearest = found.pairs.iter().map(|pair| distance(pair.lambda)).fold(f64::INFINITY, f64::min);
            println!("{name} {expected:.6}: off by {nearest:.1e}");
            assert!(nearest < 1e-8, "{name} {expected}: {nearest:e}");
        }
    }
}

/// Pads that are pressed on with kN in the place of N: what is unstable changes, and nothing else would tell.
#[test]
fn a_load_of_which_no_brake_has_the_pressure_is_asked_about() {
    let text = std::fs::read_to_string(folder().join("two-pads.toml")).unwrap();
    let asked = |pressure: &str| {
        let changed = text.replacen("pressure = 1.0 ", &format!("pressure = {pressure} "), 1).replacen(
            "pressure = 1.0\n",
            &format!("pressure = {pressure}\n"),
            1,
        );
        assert_eq!(changed == text, pressure == "1.0");
        let case = CaseFile::parse(&folder().join("two-pads.toml"), changed).unwrap();
        case.header().notes.iter().filter(|note| note.contains("is the load in N?")).count()
    };
    assert_eq!([asked("1.0"), asked("1e-3"), asked("1e3")], [0, 2, 2]);
}
