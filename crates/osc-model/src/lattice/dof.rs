//! Names of the degrees of freedom: `x1`, `z9`, `xp`.

use std::fmt;
use std::str::FromStr;

use crate::OscModelError;

/// A direction: x along a row (and the sliding), y along a column, z from the plate to the foundation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Axis {
    /// Along a row, the direction in which the plate slides.
    X,
    /// Along a column.
    Y,
    /// Normal to the contact, from the plate to the foundation.
    Z,
}

impl Axis {
    /// All three, in the order of the degrees of freedom of a body.
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
    /// Index, from 0, in `u = [x1 y1 z1 x2 ... xp yp zp]` of a lattice with `oscillators` oscillators.
    ///
    /// # Errors
    /// An oscillator that does not exist.
    pub fn index(self, oscillators: usize) -> Result<usize, OscModelError> {
        let body = match self.body {
            LatticeBody::Oscillator(i) if i < oscillators => i,
            LatticeBody::Oscillator(_) => return Err(OscModelError::UnknownDof { dof: self, oscillators }),
            LatticeBody::Plate => oscillators,
        };
        Ok(3 * body + self.axis as usize)
    }

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

impl FromStr for Dof {
    type Err = OscModelError;

    fn from_str(text: &str) -> Result<Self, OscModelError> {
        let refused = || OscModelError::DofSyntax { text: text.to_owned() };
        let mut characters = text.chars();
        let axis = match characters.next() {
            Some('x') => Axis::X,
            Some('y') => Axis::Y,
            Some('z') => Axis::Z,
            _ => return Err(refused()),
        };
        let body = match characters.as_str() {
            "p" => LatticeBody::Plate,
            // `parse` alone would accept a sign.
            digits if digits.starts_with(|c: char| c.is_ascii_digit()) => {
                let number: usize = digits.parse().map_err(|_| refused())?;
                LatticeBody::Oscillator(number.checked_sub(1).ok_or_else(refused)?)
            }
            _ => return Err(refused()),
        };
        Ok(Self { axis, body })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_has_a_name_that_leads_back() {
        for index in 0..30 {
            let dof = Dof::at(index, 9).unwrap();
            assert_eq!(dof.to_string().parse::<Dof>().unwrap().index(9).unwrap(), index);
        }
        assert_eq!(Dof::at(30, 9), None);
    }

    #[test]
    fn says_which_name_it_refuses() {
        for text in ["", "x", "x0", "p", "xq", "x+1", "x1 ", "X1", "x99999999999999999999999"] {
            assert_eq!(text.parse::<Dof>(), Err(OscModelError::DofSyntax { text: text.to_owned() }), "{text}");
        }
        let error = "y10".parse::<Dof>().unwrap().index(9).unwrap_err();
        assert_eq!(error.to_string(), "y10 is not there; allowed: oscillators 1 to 9, and p");
    }
}
