//! A structure under its loads as its contact points see it.

use nalgebra::{DMatrix, DVector};
use nalgebra_sparse::{CooMatrix, CscMatrix};
use num_complex::Complex;
use sparse::{Problem, SparseError, SparseSecondOrder};

use crate::sliding::value;
use crate::{ContactError, Row};

/// A solution that is larger by this factor than forces and stiffness ask for is one of a singular stiffness; chosen: a structure that is held has 1e10 at
/// most, one that is not 1e15 and more.
const NOT_HELD: f64 = 1e13;

/// Largest ratio of the smallest to the largest pivot of the LU decomposition of `I + A D`, D the change of the points' stiffnesses, with which nothing holds a
/// body any more; chosen: above rounding of A, below what soft holders leave.
const LET_GO: f64 = 1e-9;

/// Most right-hand sides that are solved together, which each need a vector of the structure in memory; chosen: beyond, the structure is factored
/// once more for as many.
const AT_ONCE: usize = 512;

/// Structure condensed on its contact points: how their gaps answer to normal forces, friction and loads.
///
/// With the points' springs k in it, as if all were closed, the structure has the stiffness `K_s = K + sum k g g^T`. With a gap h at each
/// point before the loads, its normal force N and friction `mu N` along the sliding, `K u = f + sum N (g + mu s)` and gaps `h + g^T u` become
///
/// ```text
/// gap = h + G^T K_s^-1 (f - G k h) + A (N + k gap) + B mu N,       A = G^T K_s^-1 G,   B = G^T K_s^-1 S
/// ```
///
/// which holds for any law between gap and N, any mu and any multiple of the loads: one factorisation serves all of them. A body that its
/// contact alone holds is allowed.
#[derive(Debug, Clone, PartialEq)]
pub struct Condensed {
    /// Stiffness k of each point as if it were closed, N/m.
    pub(crate) stiffness: DVector<f64>,
    /// Matrix A: gaps by normal forces.
    pub(crate) normal: DMatrix<f64>,
    /// Matrix B: gaps by friction.
    pub(crate) friction: DMatrix<f64>,
    /// `G^T K_s^-1 f` of each load, a column each.
    pub(crate) loads: DMatrix<f64>,
}

impl Condensed {
    /// The structure of stiffness K (without any contact) with contact points by their rows of gap and slip, the stiffness of each closed point, N/m, and
    /// loads, a column for each of them that is scaled by itself. The indices of rows have to be below the order of K, which is not checked.
    ///
    /// # Errors
    /// No points, other numbers of slip rows or stiffnesses than points, loads of another order, a stiffness that is not > 0; bodies that nothing holds
    /// though all points are closed; more memory than there is.
    pub fn new(
        structure: &CscMatrix<f64>,
        gaps: &[Row],
        slips: &[Row],
        stiffness: &[f64],
        loads: &DMatrix<f64>,
    ) -> Result<Self, ContactError> {
        let (order, points) = (structure.nrows(), gaps.len());
        let counts = [
            ("slip rows", slips.len(), points),
            ("stiffnesses", stiffness.len(), points),
            ("rows of the loads", loads.nrows(), order),
        ];
        for (what, found, expected) in counts {
            if found != expected {
                return Err(ContactError::Count { what, found, expected });
            }
        }
        if points == 0 {
            return Err(ContactError::Count { what: "contact points", found: 0, expected: 1 });
        }
        if let Some(&k) = stiffness.iter().find(|k| !(k.is_finite() && **k > 0.0)) {
            return Err(value("the stiffness of a contact point", k, "a finite number > 0"));
        }
        let mut closed = CooMatrix::new(order, order);
        structure.triplet_iter().for_each(|(row, column, &value)| closed.push(row, column, value));
        for (row, k) in gaps.iter().zip(stiffness) {
            for &(i, a) in row {
                row.iter().for_each(|&(j, b)| closed.push(i, j, k * (a * b)));
            }
        }
        let closed = CscMatrix::from(&closed);
        let norm = norm(&closed);
        // The mass plays no part at lambda = 0.
        let zero = || CscMatrix::zeros(order, order);
        let problem = Problem::new(&SparseSecondOrder::new(zero(), zero(), closed)?)?;
        // Right-hand sides: the loads, then the rows of gap, then the rows of slip; of a solution only what the points see is kept.
        let columns = loads.ncols() + 2 * points;
        let mut seen = DMatrix::zeros(points, columns);
        for first in (0..columns).step_by(AT_ONCE) {
            let mut right = DMatrix::zeros(order, AT_ONCE.min(columns - first));
            for (at, mut column) in right.column_iter_mut().enumerate() {
                match (first + at).checked_sub(loads.ncols()) {
                    None => column.copy_from(&loads.column(first + at)),
                    Some(row) => {
                        let row = if row < points { &gaps[row] } else { &slips[row - points] };
                        row.iter().for_each(|&(dof, value)| column[dof] += value);
                    }
                }
            }
            let solution = match problem.solve(Complex::from(0.0), &right) {
                Ok(solution) => solution.map(|z| z.re),
                Err(error @ SparseError::Memory { .. }) => return Err(error.into()),
                Err(_) => return Err(ContactError::NothingHolds { growth: f64::INFINITY }),
            };
            for (force, found) in right.column_iter().zip(solution.column_iter()) {
                let growth = norm * found.amax() / force.amax();
                let is_held = growth < NOT_HELD;
                if force.amax() > 0.0 && !is_held {
                    return Err(ContactError::NothingHolds { growth });
                }
            }
            for (at, found) in solution.column_iter().enumerate() {
                for (point, row) in gaps.iter().enumerate() {
                    seen[(point, first + at)] = row.iter().map(|&(dof, value)| value * found[dof]).sum();
                }
            }
        }
        let of_loads = loads.ncols();
        Ok(Self {
            stiffness: DVector::from_column_slice(stiffness),
            normal: seen.columns(of_loads, points).into_owned(),
            friction: seen.columns(of_loads + points, points).into_owned(),
            loads: seen.columns(0, of_loads).into_owned(),
        })
    }

    /// The same structure with other springs in its points, N/m each: with the change D of their stiffness, `A` becomes `(I + A D)^-1 A`, and so do
    /// B and what the loads open. Points of stiffness 0 are taken out, and the others stay in their order.
    ///
    /// # Errors
    /// Not a stiffness of each point, one that is below 0 or not finite, none above it; bodies that nothing holds any more.
    pub fn with_stiffness(&self, stiffness: &[f64]) -> Result<Self, ContactError> {
        if stiffness == self.stiffness.as_slice() {
            return Ok(self.clone());
        }
        let points = self.points();
        if stiffness.len() != points {
            return Err(ContactError::Count { what: "stiffnesses", found: stiffness.len(), expected: points });
        }
        if let Some(&k) = stiffness.iter().find(|k| !(k.is_finite() && **k >= 0.0)) {
            return Err(value("the stiffness of a contact point", k, "a finite number >= 0"));
        }
        let kept: Vec<usize> = (0..points).filter(|&at| stiffness[at] > 0.0).collect();
        if kept.is_empty() {
            return Err(ContactError::Count { what: "contact points", found: 0, expected: 1 });
        }
        let stiffness = DVector::from_column_slice(stiffness);
        let change = DMatrix::from_diagonal(&(&stiffness - &self.stiffness));
        let factors = (DMatrix::identity(points, points) + &self.normal * change).lu();
        let pivots = factors.u().diagonal().map(f64::abs);
        let let_go = || ContactError::NothingHolds { growth: pivots.max() / pivots.min() };
        if pivots.min() <= LET_GO * pivots.max() {
            return Err(let_go());
        }
        let solved = |of: &DMatrix<f64>| factors.solve(of).map(|all| all.select_rows(&kept)).ok_or_else(let_go);
        Ok(Self {
            normal: solved(&self.normal)?.select_columns(&kept),
            friction: solved(&self.friction)?.select_columns(&kept),
            loads: solved(&self.loads)?,
            stiffness: stiffness.select_rows(&kept),
        })
    }

    /// Number of contact points.
    #[must_use]
    pub fn points(&self) -> usize {
        self.stiffness.len()
    }

    /// Number of loads.
    #[must_use]
    pub fn load_cases(&self) -> usize {
        self.loads.ncols()
    }
}

/// The largest sum of a column's absolute values.
fn norm(a: &CscMatrix<f64>) -> f64 {
    let sums = a.col_iter().map(|column| column.values().iter().map(|value| value.abs()).sum());
    sums.fold(0.0, f64::max)
}
