//! The degrees of freedom of a lattice, and their names: `x1`, `z9`, `xp`.

use std::fmt;

/// A direction: x along a row (and the sliding), y along a column, z from the plate to the foundation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Axis {
    /// Along a row, the direction in which the plate slides.
    X,
    /// Along a column, across the direction in which the plate slides.
    Y,
    /// Normal to the contact, from the plate to the foundation.
    Z,
}

impl Axis {
    /// The three axes, in the order of the degrees of freedom of a body.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];
}

/// A body of the lattice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LatticeBody {
    /// An oscillator by its index, from 0.
    Oscillator(usize),
    /// The plate.
    Plate,
}

/// A degree of freedom of the lattice.
///
/// ```
/// use osc_model::{Axis, LatticeBody, Dof};
///
/// let dof: Dof = "x7".parse()?;
/// assert_eq!(dof, Dof { axis: Axis::X, body: LatticeBody::Oscillator(6) });
/// assert_eq!(dof.index(9)?, 18);
/// assert_eq!("zp".parse::<Dof>()?.to_string(), "zp");
/// assert!("w1".parse::<Dof>().is_err());
/// # Ok::<(), osc_model::OscModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Dof {
    /// The direction.
    pub axis: Axis,
    /// The body that moves.
    pub body: LatticeBody,
}

impl Dof {
    /// The degree of freedom with this index in u of a lattice with `oscillators` oscillators; `None` past the last.
    pub fn at(index: usize, oscillators: usize) -> Option<Self> {
        let body = match index / 3 {
            i if i < oscillators => LatticeBody::Oscillator(i),
            i if i == oscillators => LatticeBody::Plate,
            _ => return None,
        };
        Some(Self { axis: Axis::ALL[index % 3], body })
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
        })
    }
}

impl fmt::Display for Dof {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.body {
            LatticeBody::Oscillator(i) => write!(f, "{}{}", self.axis, i + 1),
            LatticeBody::Plate => write!(f, "{}p", self.axis),
        }
    }
}
