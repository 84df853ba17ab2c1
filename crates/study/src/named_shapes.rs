//! Names by MAC with modes that have names: the other way to know a mode again, where none is followed.

use cea::Mode;
use linsys::real_times_complex;
use nalgebra::{DMatrix, RowDVector};
use tracking::mac;

use super::ModeLabel;

/// Least MAC with the mode that gives its name, so that both share more than half of the kinetic energy: of shapes that are orthogonal in
/// M no two can do so with the same mode.
const LEAST_MAC: f64 = 0.5;

/// Modes that give their names to all modes that resemble them by MAC.
#[derive(Debug, Clone)]
pub(super) struct NamedShapes {
    /// The modes, mass-normalised where they got their names.
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

    /// The shapes in other coordinates, in which `between` has those of the shapes as columns. They are not normalised again: what the other coordinates lack of a
    /// shape is in no mode there, and so is not shared.
    pub fn in_coordinates(&self, between: &DMatrix<f64>) -> Self {
        let within = |mode: &Mode| Mode { lambda: mode.lambda, shape: real_times_complex(between, &mode.shape) };
        Self { modes: self.modes.iter().map(within).collect(), names: self.names.clone() }
    }

    /// The shapes of all parts of a brake together.
    pub fn joined(parts: Vec<Self>) -> Self {
        let (modes, names): (Vec<_>, Vec<_>) = parts.into_iter().map(|part| (part.modes, part.names)).unzip();
        Self { modes: modes.concat(), names: names.concat() }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DVector, dmatrix};
    use num_complex::Complex;

    use super::*;

    /// A shape of which other coordinates hold a part gives its name where that part is more than half of its energy, however alike the part is to the mode.
    #[test]
    fn a_shape_counts_with_what_other_coordinates_hold_of_it() {
        let mode = |shape: [f64; 2]| Mode {
            lambda: Complex::new(0.0, 1.0),
            shape: DVector::from_row_slice(&shape).map(Complex::from),
        };
        for degree in (0..=90).filter(|&degree| degree != 45) {
            let (sine, cosine) = f64::from(degree).to_radians().sin_cos();
            let shapes = NamedShapes { modes: vec![mode([cosine, sine])], names: vec![vec![ModeLabel::new(7)]] };
            // The other coordinates are the first of these alone.
            let found = shapes.in_coordinates(&dmatrix![1.0, 0.0]);
            let same = Mode { lambda: Complex::new(0.0, 1.0), shape: DVector::from_element(1, Complex::from(1.0)) };
            let names = found.names_of(&[same], &dmatrix![1.0]);
            assert_eq!(names[0].is_empty(), degree > 45, "{degree}");
        }
    }
}
