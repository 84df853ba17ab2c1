//! Signs of the eigenvalues of a sparse symmetric matrix, and a solver with it, from one factorisation.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::sparse::linalg::SymbolicSupernodalParams;
use faer::sparse::linalg::cholesky::supernodal::SupernodalIntranodeLbltRef;
use faer::sparse::linalg::cholesky::{SymbolicCholesky, SymbolicCholeskyRaw};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Mat, Side, Spec};
use nalgebra::DMatrix;
use nalgebra_sparse::CscMatrix;

use super::norm;
use crate::SparseError;
use crate::ordering;
use crate::product::times;
use crate::solver::PAR;
use crate::unpatterned::unpatterned;

/// `A = P L B L^T P^T` of a symmetric matrix: L lower triangular with a unit diagonal, B of blocks of order 1 and 2, pivoted within
/// the supernodes. The pivot of a saddle point, such as a multiplier, may lie in another supernode: such a factorisation is unsound.
pub(crate) struct Factor {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    /// Subdiagonal of B.
    subdiagonal: Vec<f64>,
    forward: Vec<usize>,
    inverse: Vec<usize>,
    is_sound: bool,
}

/// Largest backward error of a solution with a sound factorisation; chosen, between rounding and the error of a pivot that was only rounding.
const SOUND: f64 = 1e-11;

impl Factor {
    /// # Errors
    /// A factorisation that does not fit into memory.
    pub(crate) fn new(a: &CscMatrix<f64>) -> Result<Self, SparseError> {
        let n = a.nrows();
        let memory = || SparseError::Memory { order: n };
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, a.col_offsets(), None, a.row_indices());
        let symbolic = ordering::symbolic(pattern, SymbolicSupernodalParams::default()).ok_or_else(memory)?;
        let request = symbolic.factorize_numeric_intranode_lblt_scratch::<f64>(PAR, Spec::default());
        let mut buffer = MemBuffer::try_new(request).map_err(|_| memory())?;
        let (mut values, mut subdiagonal) = (vec![0.0; symbolic.len_val()], vec![0.0; n]);
        let (mut forward, mut inverse) = (vec![0; n], vec![0; n]);
        symbolic.factorize_numeric_intranode_lblt(
            &mut values,
            &mut subdiagonal,
            &mut forward,
            &mut inverse,
            SparseColMatRef::new(pattern, a.values()),
            Side::Lower,
            PAR,
            MemStack::new(&mut buffer),
            Spec::default(),
        );
        let mut factor = Self { symbolic, values, subdiagonal, forward, inverse, is_sound: false };
        factor.is_sound = factor.backward_error(a) <= SOUND;
        Ok(factor)
    }

    /// Backward error of the solution for a right-hand side without pattern; infinite where there is no solution, as with a pivot that is zero.
    fn backward_error(&self, a: &CscMatrix<f64>) -> f64 {
        let b = DMatrix::from_fn(a.nrows(), 1, |i, _| unpatterned((i + 1) as f64) - 0.3);
        let x = self.solve(&b);
        if x.iter().any(|value| !value.is_finite()) {
            return f64::INFINITY;
        }
        (times(a, &x) - &b).norm() / (norm(a) * x.norm() + b.norm())
    }

    /// Number of negative eigenvalues, by Sylvester's law of inertia: as many as B has. `None` where the factorisation is unsound.
    pub(crate) fn negative(&self) -> Option<usize> {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else { return None };
        if !self.is_sound {
            return None;
        }
        let factor = SupernodalIntranodeLbltRef::new(symbolic, &self.values, &self.subdiagonal, self.permutation());
        let mut negative = 0;
        for supernode in (0..symbolic.n_supernodes()).map(|s| factor.supernode(s)) {
            let (b, order) = (supernode.val(), supernode.val().ncols());
            let mut at = 0;
            while at < order {
                let below = self.subdiagonal[supernode.start() + at];
                if below == 0.0 {
                    negative += usize::from(b[(at, at)] < 0.0);
                    at += 1;
                } else {
                    // A block of order 2 is pivoted on because its determinant is negative or its entries are large; both
                    // eigenvalues have the sign of the trace where the determinant is positive.
                    let (first, second) = (b[(at, at)], b[(at + 1, at + 1)]);
                    negative += match first * second - below * below {
                        determinant if determinant < 0.0 => 1,
                        _ if first + second < 0.0 => 2,
                        _ => 0,
                    };
                    at += 2;
                }
            }
        }
        Some(negative)
    }

    /// Number of rows of A.
    pub(crate) fn order(&self) -> usize {
        self.forward.len()
    }

    /// `A^-1 X`, whether the factorisation is sound or not. The permutations are applied here: the library's own solver for this factorisation (0.24.4)
    /// takes B for diagonal.
    pub(crate) fn solve(&self, x: &DMatrix<f64>) -> DMatrix<f64> {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else { return x.clone() };
        let factor = SupernodalIntranodeLbltRef::new(symbolic, &self.values, &self.subdiagonal, self.permutation());
        let order: Vec<usize> = match self.symbolic.perm() {
            Some(elimination) => self.forward.iter().map(|&i| elimination.arrays().0[i]).collect(),
            None => self.forward.clone(),
        };
        let mut permuted = Mat::from_fn(x.nrows(), x.ncols(), |i, j| x[(order[i], j)]);
        let mut buffer = MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(x.ncols(), PAR));
        let stack = MemStack::new(&mut buffer);
        factor.solve_in_place_no_numeric_permute_with_conj(Conj::No, permuted.as_mut(), PAR, stack);
        let mut solution = DMatrix::zeros(x.nrows(), x.ncols());
        for (i, &row) in order.iter().enumerate() {
            (0..x.ncols()).for_each(|j| solution[(row, j)] = permuted[(i, j)]);
        }
        solution
    }

    fn permutation(&self) -> PermRef<'_, usize> {
        PermRef::new_checked(&self.forward, &self.inverse, self.forward.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SymmetricEigen;
    use proptest::prelude::*;

    /// A symmetric matrix of order n with a few entries in each row, some diagonals zero: it needs pivots of order 2.
    fn symmetric(n: usize, entries: &[(usize, usize, f64)]) -> DMatrix<f64> {
        let mut a = DMatrix::zeros(n, n);
        for &(row, column, value) in entries {
            let (row, column) = (row % n, column % n);
            a[(row, column)] = value;
            a[(column, row)] = value;
        }
        a
    }

    #[test]
    fn a_diagonal_matrix_is_its_own_factor() {
        for (diagonal, negative) in
            [(vec![3.0], 0), (vec![1.0; 5], 0), (vec![2.0, -1e-9, 4.0, -8.0], 2), (vec![-1.0; 3], 3)]
        {
            let factor = Factor::new(&CscMatrix::from(&DMatrix::from_diagonal(&diagonal.clone().into()))).unwrap();
            assert_eq!(factor.negative(), Some(negative), "{diagonal:?}");
            let x = DMatrix::from_fn(diagonal.len(), 2, |i, j| (1 + i + 3 * j) as f64);
            let expected = DMatrix::from_fn(diagonal.len(), 2, |i, j| x[(i, j)] / diagonal[i]);
            assert!((factor.solve(&x) - &expected).norm() <= 1e-15 * expected.norm());
        }
        // Semidefinite: nothing can be solved, so nothing is said of the signs; shifted off zero it has them.
        let singular = CscMatrix::from(&DMatrix::from_diagonal(&vec![1.0, 0.0, 2.0].into()));
        assert_eq!(Factor::new(&singular).unwrap().negative(), None);
        for (shift, negative) in [(1e-13, 0), (-1e-13, 1)] {
            assert_eq!(Factor::new(&crate::symmetric::shifted(&singular, shift)).unwrap().negative(), Some(negative));
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn signs_and_solutions_are_those_of_the_full_matrix(
            n in 2_usize..40,
            entries in prop::collection::vec((0_usize..40, 0_usize..40, -4.0..4.0_f64), 10..120),
        ) {
            let a = symmetric(n, &entries);
            let spectrum = SymmetricEigen::new(a.clone()).eigenvalues;
            let gap = spectrum.iter().fold(f64::INFINITY, |least: f64, l| least.min(l.abs()));
            prop_assume!(gap > 1e-6 * spectrum.amax());
            let factor = Factor::new(&CscMatrix::from(&a)).unwrap();
            let Some(negative) = factor.negative() else { return Ok(()) };
            prop_assert_eq!(negative, spectrum.iter().filter(|l| **l < 0.0).count());
            let x = DMatrix::from_fn(n, 2, |i, j| (1 + i + 3 * j) as f64);
            let error = (factor.solve(&(&a * &x)) - &x).norm() / x.norm();
            prop_assert!(error < 1e2 * SOUND * spectrum.amax() / gap, "{}", error);
        }

        /// A diagonal as large as the rest of its row, as after scaling: a factorisation that is always sound.
        #[test]
        fn matrices_with_a_strong_diagonal_are_sound(
            n in 2_usize..40,
            entries in prop::collection::vec((0_usize..40, 0_usize..40, -4.0..4.0_f64), 10..120),
            signs in prop::collection::vec(prop::bool::weighted(0.1), 40),
        ) {
            let mut a = symmetric(n, &entries);
            for i in 0..n {
                let rest: f64 = a.row(i).iter().map(|value| value.abs()).sum();
                a[(i, i)] = if signs[i] { -1.0 } else { 1.0 } * (1e-3 + rest);
            }
            let negative = Factor::new(&CscMatrix::from(&a)).unwrap().negative();
            prop_assert_eq!(negative, Some(signs[..n].iter().filter(|sign| **sign).count()));
        }
    }
}
