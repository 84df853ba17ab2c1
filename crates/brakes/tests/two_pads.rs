//! A brake of two pads whose faces do not match the disc's, which turns: as a case file alone, against SciPy.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

use std::f64::consts::TAU;
use std::path::Path;

use brakes::case::{CaseFile, FiniteElementCase};
use linsys::OperatingPoint;
use num_complex::Complex;
use sparse::{Options, Rectangle, eigenpairs_in};

fn case(path: &Path) -> FiniteElementCase {
    let text = std::fs::read_to_string(path).unwrap();
    match CaseFile::parse(path, text).unwrap() {
        CaseFile::FiniteElements(case) => *case,
        other => panic!("{other:?}"),
    }
}

/// The large brake of a folder, `brake.toml` in it, and `reference.txt` with lines `Re Im` of all eigenvalues from 1 to 8 kHz by SciPy.
#[test]
#[ignore = "needs a folder with a brake of 5,000 degrees of freedom, named by SQUEAL_TWO_PADS"]
fn a_large_brake_has_the_eigenvalues_of_scipy() {
    let folder = std::env::var("SQUEAL_TWO_PADS").unwrap();
    let case = case(&Path::new(&folder).join("brake.toml"));
    case.notes.iter().for_each(|note| println!("{note}"));
    let contact = case.contact.as_ref().unwrap();
    println!("{} channels in {} patches", case.system.channels().len(), contact.patches.len());
    let (_, still) = brakes::frictionless(&case, &[]).unwrap();
    println!("{} degrees of freedom", still.order());
    let at: OperatingPoint = brakes::at_medians(&case).unwrap();
    let system = case.system.assemble(&at).unwrap();
    let rectangle = Rectangle { re: [-500.0, 4000.0], im: [TAU * 1e3, TAU * 8e3] };
    let found = eigenpairs_in(&system, &rectangle, &Options::default(), &mut |_| ()).unwrap();
    let text = std::fs::read_to_string(Path::new(&folder).join("reference.txt")).unwrap();
    let expected = text.lines().map(|line| {
        let mut numbers = line.split_whitespace().map(|word| word.parse::<f64>().unwrap());
        Complex::new(numbers.next().unwrap(), numbers.next().unwrap())
    });
    for expected in expected {
        let nearest = found.pairs.iter().map(|pair| (pair.lambda - expected).norm()).fold(f64::INFINITY, f64::min);
        println!("{expected:.6}: off by {:.1e}", nearest / expected.norm());
        assert!(nearest < 1e-6 * expected.norm());
    }
}
