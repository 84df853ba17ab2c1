//! Uniqueness of the solution of a complementarity problem.

use std::fmt;

use nalgebra::{Cholesky, DMatrix, DVector};

use crate::complementarity::{MOST_ENUMERATED, all_solutions};

/// Largest absolute value of an eigenvalue that counts as zero, as a fraction of the norm; chosen, above rounding.
const ZERO: f64 = 1e-11;

/// Uniqueness of the forces of an equilibrium, and how it is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Uniqueness {
    /// Unique: the symmetric part of the matrix is positive definite, or it is symmetric and positive semi-definite.
    Definite,
    /// Unique: all 2^n principal minors are positive (a P-matrix).
    PrincipalMinors,
    /// Unique at these loads: of all 2^n states of open and closed contacts this alone is in balance.
    Enumerated,
    /// Not unique, with the number of states that are in balance.
    Several(usize),
    /// Not decided: the symmetric part is indefinite, and there are too many contacts to look at all states, or none of them was found in balance. Under a
    /// law with friction it is not looked at.
    NotDecided,
}

impl fmt::Display for Uniqueness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Definite => write!(f, "unique: the symmetric part of its matrix is not indefinite"),
            Self::PrincipalMinors => write!(f, "unique: its matrix is a P-matrix"),
            Self::Enumerated => write!(f, "unique at these loads: no other state is in balance"),
            Self::Several(count) => write!(f, "not unique: {count} states are in balance"),
            Self::NotDecided => write!(f, "whether it is unique was not decided"),
        }
    }
}

/// The uniqueness of the solution w of `w = q + M z`.
pub(crate) fn uniqueness(q: &DVector<f64>, m: &DMatrix<f64>) -> Uniqueness {
    let symmetric = (m + m.transpose()) * 0.5;
    let is_symmetric = (m - &symmetric).amax() <= ZERO * m.amax();
    if is_above(symmetric, if is_symmetric { -ZERO } else { ZERO }) {
        return Uniqueness::Definite;
    }
    if m.nrows() > MOST_ENUMERATED {
        return Uniqueness::NotDecided;
    }
    let are_positive = (1_u64..1 << m.nrows()).all(|set| {
        let places: Vec<usize> = (0..m.nrows()).filter(|at| set >> at & 1 == 1).collect();
        m.select_rows(&places).select_columns(&places).determinant() > 0.0
    });
    if are_positive {
        return Uniqueness::PrincipalMinors;
    }
    match all_solutions(q, m).map(|all| all.len()) {
        Ok(0) | Err(_) => Uniqueness::NotDecided,
        Ok(1) => Uniqueness::Enumerated,
        Ok(count) => Uniqueness::Several(count),
    }
}

/// True if the symmetric part is positive semi-definite, where a ray of Lemke's method means that there is no solution.
pub(crate) fn is_monotone(m: &DMatrix<f64>) -> bool {
    is_above((m + m.transpose()) * 0.5, -ZERO)
}

/// True if all eigenvalues of a symmetric matrix are above the fraction `part` of its norm, by a Cholesky decomposition.
fn is_above(mut symmetric: DMatrix<f64>, part: f64) -> bool {
    let norm = symmetric.row_iter().map(|row| row.iter().map(|value| value.abs()).sum::<f64>()).fold(0.0, f64::max);
    (0..symmetric.nrows()).for_each(|at| symmetric[(at, at)] -= part * norm);
    Cholesky::new(symmetric).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{dmatrix, dvector};

    #[test]
    fn how_it_is_known_is_said() {
        let q = dvector![-1.0, 0.5];
        assert_eq!(uniqueness(&q, &dmatrix![2.0, 1.0; 0.0, 2.0]), Uniqueness::Definite);
        assert_eq!(uniqueness(&q, &dmatrix![1.0, -1.0; -1.0, 1.0]), Uniqueness::Definite);
        assert_eq!(uniqueness(&q, &dmatrix![1.0, 5.0; 0.0, 1.0]), Uniqueness::PrincipalMinors);
        let reverse = dmatrix![1.0, -2.0; -2.0, 1.0];
        assert_eq!(uniqueness(&dvector![1.0, 1.0], &reverse), Uniqueness::Several(2));
        assert_eq!(uniqueness(&dvector![-1.0, -1.0], &dmatrix![1.0, 2.0; 3.0, 1.0]), Uniqueness::Several(3));
        assert_eq!(uniqueness(&dvector![-1.0, 1.0], &dmatrix![1.0, 2.0; 3.0, 1.0]), Uniqueness::Enumerated);
        let large = DMatrix::from_fn(20, 20, |i, j| if i == j { 1.0 } else { -1.0 });
        assert_eq!(uniqueness(&DVector::repeat(20, 1.0), &large), Uniqueness::NotDecided);
    }
}
