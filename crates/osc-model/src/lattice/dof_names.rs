//! Degrees of freedom from their names, and their indices in a lattice.

use std::str::FromStr;

use super::{Axis, Dof, LatticeBody};
use crate::OscModelError;

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
