//! Cases of the project, and the paper's lattice with all of its oscillators in contact.

use std::path::{Path, PathBuf};

use brakes::LatticeBrake;
use brakes::case::{LatticeCase, Law};

/// The file of a case.
pub fn cases(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases").join(name)
}

/// The paper's lattice with every oscillator in contact, under one law.
pub fn paper(law: Law) -> LatticeBrake {
    let mut case = LatticeCase::read(&cases("paper.toml")).unwrap();
    case.laws = vec![law];
    case.constraints.truncate(1);
    case.panels.truncate(1);
    case.speeds.truncate(1);
    LatticeBrake::new(case).unwrap()
}
