//! The paper's lattice with one law in a few arrangements, and its exact integral.

use std::path::Path;

use brakes::LatticeBrake;
use brakes::case::LatticeCase;
use cea::QrSolver;
use study::Study;
use study::estimators::{Exact, OneParameterFamily, exact};

/// The lattice in these arrangements under this law, with `edits` to the text of its case.
pub fn brake(arrangements: &str, law: &str, edits: &[(&str, &str)]) -> LatticeBrake {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../cases/paper.toml"));
    let mut text = std::fs::read_to_string(path)
        .unwrap()
        .replace("[\"amontons-coulomb\", \"velocity-dependent\", \"lugre\"]", &format!("[\"{law}\"]"))
        .replace("in_contact = [9, 8, 7, 6]", &format!("arrangements = {arrangements}"));
    let sets = text.find("[[constraints]]").unwrap()..text.find("[[speeds]]").unwrap();
    text.replace_range(sets, "");
    for (from, to) in edits {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    LatticeBrake::new(LatticeCase::parse(path, text).unwrap()).unwrap()
}

/// Every oscillator in contact, all but one, and six.
pub const SOME: &str = "[[1,2,3,4,5,6,7,8,9],[1,2,3,4,5,6,7,8],[1,3,4,5,6,8]]";

/// The exact integral of a scene under Amontons-Coulomb friction.
pub fn exact_of(study: &Study<'_, LatticeBrake>, scene: usize) -> Exact {
    let mut family = OneParameterFamily::new(study.brake(), &study.plan().scenes[scene], &QrSolver).unwrap();
    exact(&study.references()[scene], &mut family).unwrap()
}
