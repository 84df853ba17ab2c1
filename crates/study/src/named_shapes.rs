//! Names by MAC with modes that have names: the other way to know a mode again, where none is followed.

use cea::Mode;
use nalgebra::{DMatrix, RowDVector};
use tracking::mac;

use super::ModeLabel;

/// Least MAC with the mode that gives its name, so that both share more than half of the kinetic energy: of shapes that are orthogonal in
/// M no two can do so with the same mode.
const LEAST_MAC: f64 = 0.5;

/// Modes that give their names to all modes that resemble them by MAC.
#[derive(Debug, Clone)]
pub(super) struct NamedShapes {
    /// The modes, mass-normalised.
    pub modes: Vec<Mode>,
    /// Names of each mode.
    pub names: Vec<Vec<ModeLabel>>,
}

impl NamedShapes {
    /// The names of each of `modes`, of a system with this mass matrix: the names of the mode of the origin with the largest MAC, if it exceeds one
    /// half; else empty.
    pub fn names_of(&self, modes: &[Mode], mass: &DMatrix<f64>) -> Vec<Vec<ModeLabel>> {
        let like = |of_mode: RowDVector<f64>| {
            let best = (0..of_mode.len()).max_by(|&i, &j| of_mode[i].total_cmp(&of_mode[j]))?;
            (of_mode[best] > LEAST_MAC).then(|| self.names[best].clone())
        };
        mac(modes, &self.modes, mass).row_iter().map(|row| like(row.into_owned()).unwrap_or_default()).collect()
    }

    /// The shapes of all parts of a brake together.
    pub fn joined(parts: Vec<Self>) -> Self {
        let (modes, names): (Vec<_>, Vec<_>) = parts.into_iter().map(|part| (part.modes, part.names)).unzip();
        Self { modes: modes.concat(), names: names.concat() }
    }
}
