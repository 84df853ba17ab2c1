//! The scaled standard form. Without scaling, a QR iteration loses eight digits on a physical system.
//!
//! Two exact changes of variables precede every solve. The mass matrix is eliminated symmetrically,
//! `y = L^T u` with `M = L L^T`, so that a symmetric stiffness stays symmetric; and time is measured in units of
//! `1 / gamma` with `gamma = sqrt(|K~| / |M~|)`, `M~ = I` (Fan, Lin, Van Dooren, SIAM J. Matrix Anal. Appl. 26,
//! 2004), so that stiffness and mass have the same norm in any units. With `p = y' / gamma` and internal
//! states scaled by d so that their rows and columns have the same norm:
//!
//! ```text
//!     d  [y]   [     0            I          0     ] [y]
//!     -- [p] = [ -K~/gamma^2  -C~/gamma   F~ d/g^2 ] [p]        eigenvalues sigma = lambda / gamma
//!     dt [z]   [     0          E~ / d     -a/g    ] [z]
//! ```

use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};

use super::split::split;
use crate::CeaError;

/// Largest `|C~| / gamma`, Frobenius norm, for which a QR iteration is used; chosen: the error of a slow eigenvalue grows with
/// the square of this ratio.
pub(crate) const STRONGEST_DAMPING: f64 = 100.0;
/// Largest `a / gamma` of an internal state that the scalar iteration does not split off; chosen: the iteration errs by rounding
/// errors of the fastest state, and a split costs little.
const FASTEST_STATE_UNSPLIT: f64 = 40.0;
/// Largest `a / gamma` of an internal state in the batched iteration, which has no split; chosen: up to here its largest error
/// was 128 times condition number times epsilon, and solving a system by the scalar route instead costs several spectra.
pub(crate) const FASTEST_STATE_IN_LANE: f64 = 100.0;

/// A state matrix with a norm of order one, and the unit of its eigenvalues.
#[derive(Debug, Clone)]
pub struct StandardForm {
    /// The scaled state matrix, (2 n + s) x (2 n + s), states ordered y, p, z.
    pub state: DMatrix<f64>,
    /// Unit gamma, rad/s: `lambda = gamma sigma`.
    pub gamma: f64,
    /// Units d of the internal states: `z = d z_scaled`, length s.
    pub state_weights: Vec<f64>,
}

impl StandardForm {
    /// Scales a system whose mass matrix is symmetric and positive definite.
    ///
    /// # Errors
    /// [`CeaError::MassNotPositiveDefinite`] where it is not.
    pub fn new(system: &SecondOrder) -> Result<Self, CeaError> {
        let (n, s) = (system.order(), system.states());
        let root = MassRoot::new(&system.m)?;
        let both = |a: &DMatrix<f64>| root.reading(&root.force(a)?);
        let (stiffness, damping) = (both(&system.k)?, both(&system.c)?);
        let (drive, force) = (root.reading(&system.internal.drive)?, root.force(&system.internal.force)?);

        let mut gamma = stiffness.norm().sqrt();
        if gamma == 0.0 {
            gamma = damping.norm();
        }
        if gamma == 0.0 {
            gamma = 1.0;
        }

        let mut state = DMatrix::zeros(2 * n + s, 2 * n + s);
        let square = gamma * gamma;
        for j in 0..n {
            state[(j, n + j)] = 1.0;
            for i in 0..n {
                state[(n + i, j)] = -stiffness[(i, j)] / square;
                state[(n + i, n + j)] = -damping[(i, j)] / gamma;
            }
        }
        let mut state_weights = Vec::with_capacity(s);
        for state_index in 0..s {
            let at = 2 * n + state_index;
            let (into, out_of) = (drive.row(state_index).norm(), force.column(state_index).norm() / square);
            let weight = match (into > 0.0, out_of > 0.0) {
                (true, true) => (into / out_of).sqrt(),
                (true, false) => into,
                (false, true) => 1.0 / out_of,
                (false, false) => 1.0,
            };
            state_weights.push(weight);
            for i in 0..n {
                state[(at, n + i)] = drive[(state_index, i)] / weight;
                state[(n + i, at)] = force[(i, state_index)] * weight / square;
            }
            state[(at, at)] = -system.internal.decay[state_index] / gamma;
        }
        Ok(Self { state, gamma, state_weights })
    }

    /// True if dashpots or internal states are so much faster than the vibrations that the batched iteration would lose digits.
    pub(crate) fn is_steep(&self) -> bool {
        self.is_strongly_damped() || self.fastest_state() > FASTEST_STATE_IN_LANE
    }

    /// Matrices for a QR iteration whose eigenvalues together are the eigenvalues of the state matrix; `None` where the dashpots are too
    /// strong, or some but not all internal states are too fast.
    pub(crate) fn into_blocks(self) -> Option<Vec<DMatrix<f64>>> {
        if self.is_strongly_damped() {
            None
        } else if self.fastest_state() > FASTEST_STATE_UNSPLIT {
            split(&self.state, self.state_weights.len()).map(Vec::from)
        } else {
            Some(vec![self.state])
        }
    }

    /// Ratio by which dashpots or internal states are faster than the rest.
    pub(crate) fn steepness(&self) -> f64 {
        self.damping().max(self.fastest_state())
    }

    fn is_strongly_damped(&self) -> bool {
        self.damping() > STRONGEST_DAMPING
    }

    /// `|C~| / gamma`, Frobenius norm.
    fn damping(&self) -> f64 {
        let n = (self.state.nrows() - self.state_weights.len()) / 2;
        self.state.view((n, n), (n, n)).norm()
    }

    fn fastest_state(&self) -> f64 {
        let dimension = self.state.nrows();
        (dimension - self.state_weights.len()..dimension).map(|i| self.state[(i, i)].abs()).fold(0.0, f64::max)
    }
}

/// Checks that a mass matrix is symmetric and positive definite, as the standard form needs it.
///
/// # Errors
/// [`CeaError::MassNotPositiveDefinite`] where it is not.
pub fn check_mass(m: &DMatrix<f64>) -> Result<(), CeaError> {
    MassRoot::new(m).map(drop)
}

/// The factor L of a mass matrix `M = L L^T`: in the coordinates `y = L^T u` the mass matrix is the identity.
pub(crate) enum MassRoot {
    /// `L^-1` of a diagonal mass matrix.
    Diagonal(DVector<f64>),
    /// L, lower triangular.
    Full(DMatrix<f64>),
}

impl MassRoot {
    pub(crate) fn new(m: &DMatrix<f64>) -> Result<Self, CeaError> {
        match diagonal(m) {
            Some(masses) => match masses.iter().position(|&x| x <= 0.0) {
                Some(row) => Err(CeaError::MassNotPositiveDefinite { row: row + 1 }),
                None => Ok(Self::Diagonal(masses.map(|x| 1.0 / x.sqrt()))),
            },
            None => cholesky(m).map(Self::Full),
        }
    }

    /// `L^-1 a`, the transformation of forces.
    pub(crate) fn force(&self, a: &DMatrix<f64>) -> Result<DMatrix<f64>, CeaError> {
        match self {
            Self::Diagonal(w) => Ok(DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] * w[i])),
            Self::Full(lower) => {
                lower.solve_lower_triangular(a).ok_or(CeaError::MassNotPositiveDefinite { row: lower.nrows() })
            }
        }
    }

    /// `a L^-T`, the transformation of readings of displacements or velocities.
    pub(crate) fn reading(&self, a: &DMatrix<f64>) -> Result<DMatrix<f64>, CeaError> {
        match self {
            Self::Diagonal(w) => Ok(DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] * w[j])),
            // a L^-T = (L^-1 a^T)^T.
            Self::Full(_) => Ok(self.force(&a.transpose())?.transpose()),
        }
    }
}

fn diagonal(m: &DMatrix<f64>) -> Option<DVector<f64>> {
    let off_diagonal = |(at, &x): (usize, &f64)| at % m.nrows() != at / m.nrows() && x != 0.0;
    (!m.iter().enumerate().any(off_diagonal)).then(|| m.diagonal())
}

fn cholesky(m: &DMatrix<f64>) -> Result<DMatrix<f64>, CeaError> {
    let tolerance = f64::EPSILON * m.amax() * m.nrows() as f64;
    if let Some(row) = (0..m.nrows()).find(|&i| (0..i).any(|j| (m[(i, j)] - m[(j, i)]).abs() > tolerance)) {
        return Err(CeaError::MassNotPositiveDefinite { row: row + 1 });
    }
    let first_bad =
        || (1..=m.nrows()).find(|&k| m.view((0, 0), (k, k)).into_owned().cholesky().is_none()).unwrap_or(m.nrows());
    match m.clone().cholesky() {
        Some(factor) => Ok(factor.unpack()),
        None => Err(CeaError::MassNotPositiveDefinite { row: first_bad() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linsys::Internal;
    use nalgebra::{dmatrix, dvector};

    #[test]
    fn a_full_mass_matrix_gives_the_same_eigenvalues_as_its_diagonal_twin() {
        // The same system in coordinates q = T u with T a rotation: M full on one side, diagonal on the other.
        let (sin, cos) = 0.7_f64.sin_cos();
        let turn = dmatrix![cos, -sin; sin, cos];
        let internal = |drive, force| Internal { decay: dvector![3.0], drive, force };
        let (e, f) = (dmatrix![0.5, -1.0], dmatrix![2.0; 0.3]);
        let (m, c, k) = (dmatrix![2.0, 0.0; 0.0, 5.0], dmatrix![0.3, 0.1; 0.0, 0.2], dmatrix![40.0, -9.0; 3.0, 70.0]);
        let there = |a: &DMatrix<f64>| &turn * a * turn.transpose();
        let plain =
            SecondOrder::with_internal(m.clone(), c.clone(), k.clone(), internal(e.clone(), f.clone())).unwrap();
        let turned =
            SecondOrder::with_internal(there(&m), there(&c), there(&k), internal(&e * turn.transpose(), &turn * &f))
                .unwrap();
        let spectrum = |s: &SecondOrder| {
            let form = StandardForm::new(s).unwrap();
            let mut values: Vec<_> =
                (form.state.complex_eigenvalues() * num_complex::Complex::from(form.gamma)).iter().copied().collect();
            crate::sort(&mut values);
            values
        };
        for (a, b) in spectrum(&plain).into_iter().zip(spectrum(&turned)) {
            assert!((a - b).norm() < 1e-12 * a.norm(), "{a} {b}");
        }
    }

    #[test]
    fn refuses_a_mass_matrix_that_is_not_positive_definite() {
        let system = |m| SecondOrder::new(m, DMatrix::zeros(2, 2), DMatrix::identity(2, 2)).unwrap();
        let row = |m| match StandardForm::new(&system(m)) {
            Err(CeaError::MassNotPositiveDefinite { row }) => row,
            other => unreachable!("{other:?}"),
        };
        assert_eq!(row(dmatrix![1.0, 0.0; 0.0, 0.0]), 2);
        assert_eq!(row(dmatrix![1.0, 2.0; 2.0, 1.0]), 2);
        assert_eq!(row(dmatrix![1.0, 0.1; 0.2, 1.0]), 2);
    }
}
