//! The modes of small systems, for tests.

use cea::{EigenSolver, Mode, Modes, QrSolver, Workspace};
use linsys::SecondOrder;

/// Oscillating modes of a system, ascending in frequency.
pub fn modes(system: &SecondOrder) -> Vec<Mode> {
    let mut work = Workspace::default();
    let spectrum = QrSolver.eigenvalues(system, &mut work).unwrap();
    Mode::at(system, &Modes::classify(system, &spectrum, &mut work).unwrap().oscillatory, &mut work).unwrap()
}
