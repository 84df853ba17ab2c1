//! Coordinates of nodes in local systems.

use crate::problem::Problem;

/// Meaning of the three numbers of a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Coordinates {
    /// Cartesian x, y, z.
    Rectangular,
    /// Radius, angle in degrees from x to y, z.
    Cylindrical,
}

impl Coordinates {
    /// Cartesian x, y and z of three numbers so meant.
    pub fn rectangular(self, given: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Rectangular => given,
            Self::Cylindrical => {
                let (sine, cosine) = given[1].to_radians().sin_cos();
                [given[0] * cosine, given[0] * sine, given[2]]
            }
        }
    }
}

/// A rectangular system: its origin, and its axes in the global one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frame {
    origin: [f64; 3],
    axes: [[f64; 3]; 3],
}

impl Frame {
    /// The global system: origin 0, axes x, y, z.
    pub const GLOBAL: Self = Self { origin: [0.0; 3], axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] };

    /// The system of the data lines of `*SYSTEM`: its origin a and a point b of its first axis in one line, a point c on the side of its
    /// second axis in the other. Without lines it is the global one, with a alone that is moved, with a and b it keeps z.
    pub fn of_points(lines: &[Vec<f64>]) -> Result<Self, Problem> {
        let (first, second) = match lines {
            [] => return Ok(Self::GLOBAL),
            [first] => (first, None),
            [first, second] if second.len() <= 3 => (first, Some(point(second, 0))),
            _ => return Err(refused(format!("{} lines", lines.len()))),
        };
        let origin = point(first, 0);
        let (b, z) = match (first.len(), second) {
            (..=3, None) => return Ok(Self { origin, ..Self::GLOBAL }),
            (4..=6, second) => (point(first, 3), second),
            (found, _) => return Err(refused(format!("{found} numbers"))),
        };
        let along = less(b, origin);
        let (x, z) = match z {
            Some(c) => (unit(along), unit(cross(along, less(c, origin)))),
            None => (unit([along[0], along[1], 0.0]), Some([0.0, 0.0, 1.0])),
        };
        match (x, z) {
            (Some(x), Some(z)) => Ok(Self { origin, axes: [x, cross(z, x), z] }),
            _ => Err(refused("points on one line".to_owned())),
        }
    }

    /// The global coordinates of a point, from its local ones.
    pub fn global(&self, local: [f64; 3]) -> [f64; 3] {
        if *self == Self::GLOBAL {
            return local;
        }
        [0, 1, 2].map(|d| self.origin[d] + self.axes.iter().zip(local).map(|(axis, x)| axis[d] * x).sum::<f64>())
    }
}

fn refused(found: String) -> Problem {
    let allowed =
        "no line, or x, y, z of an origin and of a point on the first axis, and in a second line of a point beside it";
    Problem::field("*SYSTEM", found, allowed)
}

/// Three numbers of a line, 0 where they are missing.
fn point(numbers: &[f64], from: usize) -> [f64; 3] {
    [0, 1, 2].map(|d| numbers.get(from + d).copied().unwrap_or(0.0))
}

fn less(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|d| a[d] - b[d])
}

fn cross(u: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

/// The direction of a vector; `None` for a vector of length 0 or not finite.
fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length > 0.0 && length.is_finite()).then(|| v.map(|x| x / length))
}
