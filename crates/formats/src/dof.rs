//! Names of rows and columns: a node and a direction.

use std::fmt;
use std::str::FromStr;

/// A degree of freedom: the row or column of a matrix, as the finite element model names it.
///
/// The text of a degree of freedom is `node.direction`, such as `1042.z`. Directions 1 to 6 are x, y, z, rx, ry, rz in Abaqus, CalculiX and Nastran
/// alike; others (0 of a scalar point, 8 of an acoustic pressure, 11 of a temperature, ...) are written as numbers. A negative
/// node is one that Abaqus made itself; it carries stiffness and mass like any other.
///
/// ```
/// use formats::Dof;
/// let dof: Dof = "1042.3".parse()?;
/// assert_eq!((dof.node, dof.direction, dof.to_string()), (1042, 3, "1042.z".to_owned()));
/// assert_eq!("12.10".parse::<Dof>()?.direction, 10);
/// # Ok::<(), formats::BadDof>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Dof {
    /// Number of the node.
    pub node: i64,
    /// Number of the direction: 1 to 6 as above, others as the program that wrote the file counts them.
    pub direction: u32,
}

/// The names of the directions 1 to 6.
const DIRECTIONS: [&str; 6] = ["x", "y", "z", "rx", "ry", "rz"];

impl fmt::Display for Dof {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.direction as usize).checked_sub(1).and_then(|at| DIRECTIONS.get(at)) {
            Some(name) => write!(f, "{}.{name}", self.node),
            None => write!(f, "{}.{}", self.node, self.direction),
        }
    }
}

/// A text that names no degree of freedom.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{found:?} is no degree of freedom; allowed: a node and a direction, as in \"1042.z\" or \"1042.3\"")]
pub struct BadDof {
    /// The text, shortened.
    pub found: String,
}

/// Text `node.direction`, the direction by its name in any case or by its number: `12.X`, `12.x` and `12.1` are equal, and print as `12.x`.
impl FromStr for Dof {
    type Err = BadDof;

    fn from_str(text: &str) -> Result<Self, BadDof> {
        let parsed = text.split_once('.').and_then(|(node, direction)| {
            let named = DIRECTIONS.iter().position(|name| name.eq_ignore_ascii_case(direction));
            let direction = match named {
                Some(at) => at as u32 + 1,
                None if direction.bytes().all(|b| b.is_ascii_digit()) => direction.parse().ok()?,
                None => return None,
            };
            Some(Self { node: node.parse().ok()?, direction })
        });
        parsed.ok_or_else(|| BadDof { found: crate::shortened::cut(text) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_read_as_text() {
        for (text, node, direction) in
            [("1.x", 1, 1), ("-3.rz", -3, 6), ("12.10", 12, 10), ("12.1", 12, 1), ("7.0", 7, 0)]
        {
            assert_eq!(text.parse(), Ok(Dof { node, direction }), "{text}");
        }
        for text in ["", "12", "12.", ".3", "12.w", "12.-1", "1.2.3", "1e3.x", "99999999999999999999.x"] {
            assert!(text.parse::<Dof>().is_err(), "{text}");
        }
        assert_eq!(Dof { node: -3, direction: 6 }.to_string(), "-3.rz");
        assert_eq!(Dof { node: 12, direction: 10 }.to_string(), "12.10");
    }
}
