//! The parameters of a lattice, and their allowed ranges.

use super::Lean;
use crate::OscModelError;
use crate::error::Allowed;

/// Rows x columns of oscillators, numbered by rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grid {
    rows: usize,
    columns: usize,
}

impl Grid {
    /// The most oscillators that a grid may have; chosen, because the matrices are dense: all eigenvalues of 603 degrees of freedom
    /// take about half a minute.
    pub const MOST_OSCILLATORS: usize = 200;

    /// `rows` rows, stacked along y, of `columns` oscillators each, along x.
    ///
    /// # Errors
    /// No oscillators, or more than [`Grid::MOST_OSCILLATORS`].
    pub fn new(rows: usize, columns: usize) -> Result<Self, OscModelError> {
        match rows.checked_mul(columns) {
            Some(1..=Self::MOST_OSCILLATORS) => Ok(Self { rows, columns }),
            _ => Err(OscModelError::GridSize { rows, columns, most: Self::MOST_OSCILLATORS }),
        }
    }

    /// Rows, stacked along y.
    pub fn rows(self) -> usize {
        self.rows
    }

    /// Oscillators in a row, along x.
    pub fn columns(self) -> usize {
        self.columns
    }

    /// Number of oscillators.
    pub fn oscillators(self) -> usize {
        self.rows * self.columns
    }

    /// Number of springs in x: one chain wall - oscillators - wall per row.
    pub fn x_springs(self) -> usize {
        self.rows * (self.columns + 1)
    }

    /// Number of springs in y: one chain wall - oscillators - wall per column.
    pub fn y_springs(self) -> usize {
        self.columns * (self.rows + 1)
    }

    /// Values of the x chains: `wall` for the two outer springs of each row, `inner` for the others.
    pub fn x_chains(self, wall: f64, inner: f64) -> Vec<f64> {
        chains(self.rows, self.columns, wall, inner)
    }

    /// Values of the y chains: `wall` for the two outer springs of each column, `inner` for the others.
    pub fn y_chains(self, wall: f64, inner: f64) -> Vec<f64> {
        chains(self.columns, self.rows, wall, inner)
    }
}

fn chains(count: usize, oscillators: usize, wall: f64, inner: f64) -> Vec<f64> {
    let one = |place: usize| if place == 0 || place == oscillators { wall } else { inner };
    (0..count).flat_map(|_| (0..=oscillators).map(one)).collect()
}

/// Springs, dashpots and masses of the lattice. SI units; angles in radians.
///
/// The springs in x are listed row by row, each row from wall to wall: with three columns, entries 1 to 4 belong to row 1 and
/// entries 5 to 8 to row 2. The springs in y are listed column by column in the same way, and dashpots as the springs beside
/// them. Other lists have one entry per oscillator.
#[derive(Debug, Clone, PartialEq)]
pub struct LatticeParameters {
    /// Rows and columns.
    pub grid: Grid,
    /// Springs of the chains in x, N/m, [`Grid::x_springs`] of them; >= 0.
    pub x_stiffness: Vec<f64>,
    /// Springs of the chains in y, N/m, [`Grid::y_springs`] of them; >= 0.
    pub y_stiffness: Vec<f64>,
    /// Dashpots beside the x springs, Ns/m; >= 0.
    pub x_damping: Vec<f64>,
    /// Dashpots beside the y springs, Ns/m; >= 0.
    pub y_damping: Vec<f64>,
    /// Dashpots from each oscillator to the foundation in z, Ns/m; >= 0.
    pub z_damping: Vec<f64>,
    /// Inclined springs k_a from each oscillator to the foundation, N/m; >= 0.
    pub inclined_stiffness: Vec<f64>,
    /// theta, rad: the inclined springs' angle to the x-y plane.
    pub theta: f64,
    /// phi, rad: the angle between the x axis and the inclined springs' projection on the x-y plane.
    pub phi: f64,
    /// The direction in which the inclined springs lean.
    pub lean: Lean,
    /// Contact springs k_z between each oscillator and the plate, N/m; > 0. They act on oscillators in contact only.
    pub contact_stiffness: Vec<f64>,
    /// Mass of each oscillator, kg; > 0.
    pub oscillator_mass: Vec<f64>,
    /// The plate.
    pub plate: PlateParameters,
}

/// The plate: one mass on a spring and a dashpot to ground in each direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlateParameters {
    /// Mass, kg; > 0.
    pub mass: f64,
    /// Stiffness in x, y, z, N/m; >= 0.
    pub stiffness: [f64; 3],
    /// Damping in x, y, z, Ns/m; >= 0.
    pub damping: [f64; 3],
}

impl LatticeParameters {
    /// Checks lengths and ranges.
    ///
    /// # Errors
    /// The first list of a wrong length or value out of the range that its field states.
    pub fn check(&self) -> Result<(), OscModelError> {
        let Grid { rows, columns } = self.grid;
        let (x, y, each) = (self.grid.x_springs(), self.grid.y_springs(), self.grid.oscillators());
        let lists = [
            ("x_stiffness", &self.x_stiffness, x, Allowed::NonNegative),
            ("y_stiffness", &self.y_stiffness, y, Allowed::NonNegative),
            ("x_damping", &self.x_damping, x, Allowed::NonNegative),
            ("y_damping", &self.y_damping, y, Allowed::NonNegative),
            ("z_damping", &self.z_damping, each, Allowed::NonNegative),
            ("inclined_stiffness", &self.inclined_stiffness, each, Allowed::NonNegative),
            ("contact_stiffness", &self.contact_stiffness, each, Allowed::Positive),
            ("oscillator_mass", &self.oscillator_mass, each, Allowed::Positive),
        ];
        for (field, list, expected, allowed) in lists {
            if list.len() != expected {
                return Err(OscModelError::Length { field, found: list.len(), expected, rows, columns });
            }
            check_each(field, list, allowed)?;
        }
        check_value("theta", self.theta, Allowed::Finite)?;
        check_value("phi", self.phi, Allowed::Finite)?;
        check_value("plate.mass", self.plate.mass, Allowed::Positive)?;
        check_each("plate.stiffness", &self.plate.stiffness, Allowed::NonNegative)?;
        check_each("plate.damping", &self.plate.damping, Allowed::NonNegative)
    }
}

fn check_each(field: &str, list: &[f64], allowed: Allowed) -> Result<(), OscModelError> {
    match list.iter().position(|&value| !allowed.contains(value)) {
        Some(place) => {
            Err(OscModelError::Value { field: format!("{field}[{}]", place + 1), value: list[place], allowed })
        }
        None => Ok(()),
    }
}

pub(crate) fn check_value(field: &str, value: f64, allowed: Allowed) -> Result<(), OscModelError> {
    if allowed.contains(value) { Ok(()) } else { Err(OscModelError::Value { field: field.to_owned(), value, allowed }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_have_their_walls_at_the_ends() {
        let grid = Grid::new(3, 3).unwrap();
        let walls: Vec<usize> = (1..=12)
            .zip(grid.x_chains(1.0, 0.0))
            .filter(|&(_, value)| value == 1.0)
            .map(|(number, _)| number)
            .collect();
        assert_eq!(walls, [1, 4, 5, 8, 9, 12]);
        let grid = Grid::new(1, 2).unwrap();
        assert_eq!(grid.x_chains(7.0, 3.0), [7.0, 3.0, 7.0]);
        assert_eq!(grid.y_chains(7.0, 3.0), [7.0, 7.0, 7.0, 7.0]);
        assert_eq!((grid.x_springs(), grid.y_springs()), (3, 4));
    }

    #[test]
    fn refuses_grids_without_oscillators_and_beyond_dense_matrices() {
        for (rows, columns) in [(0, 3), (3, 0), (usize::MAX, 2), (11, 100)] {
            assert_eq!(Grid::new(rows, columns), Err(OscModelError::GridSize { rows, columns, most: 200 }));
        }
    }
}
