//! A sparse LU of Q(sigma), whose every solution is checked in the true matrix.

use std::f64::consts::PI;
use std::sync::OnceLock;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::lu::{LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Mat, Spec};
use num_complex::Complex;

use super::blocks::{PAR, length, starting_block};
use super::fronts::{Eliminated, Elimination, Factors, factorised};
use super::pencil::Pencil;
use super::products::Side;
use super::substitution::substitute;
use crate::SparseError;

/// Largest backward error of a first solution whose pivots, in the symmetric order, were large enough; chosen: with a larger one Q is factorised again with any
/// pivots, which takes longer.
const STABLE: f64 = 1e-13;
/// Largest backward error of a solution, |Q x - b| / (|Q| |x| + |b|), that is not refined: some rounding errors.
const GOOD: f64 = 1e-15;
/// Largest backward error of a solution that is accepted; chosen: far below what an eigenpair is asked for.
const REFUSED: f64 = 1e-12;
/// Largest relative error of a known solution with which Q(sigma) is regular; with a larger one it is singular to rounding. Chosen.
const REGULAR: f64 = 1e-3;
/// Most steps of iterative refinement; where the second does not help none does. Chosen: it ends
/// earlier where a step does not halve the error, so that more would hardly ever be made.
const REFINEMENTS: usize = 4;

/// The elimination orders of a pattern, which serve every shift: an order of the symmetric pattern, and, where its pivots fail, an order for any
/// pivots, by column approximate minimum degree.
pub(crate) struct Symbolic {
    symmetric: Elimination,
    pivoted: OnceLock<SymbolicLu<usize>>,
    /// Number of threads for factors and solutions, which do not depend on it; those with any pivots have one.
    pub(super) threads: usize,
}

impl Symbolic {
    pub(crate) fn new(pencil: &Pencil) -> Result<Self, SparseError> {
        let symmetric = Elimination::new(pencil).ok_or(SparseError::Memory { order: pencil.order() })?;
        Ok(Self { symmetric, pivoted: OnceLock::new(), threads: 1 })
    }

    fn pivoted(&self, pencil: &Pencil) -> Result<&SymbolicLu<usize>, SparseError> {
        if let Some(symbolic) = self.pivoted.get() {
            return Ok(symbolic);
        }
        let failed = |_| SparseError::Memory { order: pencil.order() };
        let symbolic = factorize_symbolic_lu(pattern(pencil), LuSymbolicParams::default()).map_err(failed)?;
        Ok(self.pivoted.get_or_init(|| symbolic))
    }
}

/// The factors of one shift.
enum Numeric<'a> {
    Symmetric(&'a Elimination, Factors),
    Pivoted(&'a SymbolicLu<usize>, Box<NumericLu<usize, Complex<f64>>>),
}

/// The pattern as the library takes it.
fn pattern(pencil: &Pencil) -> SymbolicSparseColMatRef<'_, usize> {
    let (starts, rows) = pencil.pattern();
    SymbolicSparseColMatRef::new_checked(pencil.order(), pencil.order(), starts, None, rows)
}

/// Q(sigma), factored.
pub(crate) struct Factor<'a> {
    pencil: &'a Pencil,
    numeric: Numeric<'a>,
    /// Q(sigma), and transposed, as products read it.
    right: Vec<Complex<f64>>,
    left: Vec<Complex<f64>>,
    sigma: Complex<f64>,
    size: f64,
    threads: usize,
}

impl<'a> Factor<'a> {
    /// LU of Q(sigma).
    ///
    /// # Errors
    /// [`SparseError::Singular`] where a pivot is zero for every value of the entries, [`SparseError::Memory`].
    pub(crate) fn new(symbolic: &'a Symbolic, pencil: &'a Pencil, sigma: Complex<f64>) -> Result<Self, SparseError> {
        let values = pencil.values(&pencil.weights(sigma));
        let threads = symbolic.threads;
        let factors = factorised(&symbolic.symmetric, pencil, &values, threads)
            .ok_or(SparseError::Memory { order: pencil.order() })?;
        let numeric = Numeric::Symmetric(&symbolic.symmetric, factors);
        let [right, left] = [Side::Right, Side::Left].map(|side| pencil.by_rows(&values, side));
        let mut factor = Self { pencil, numeric, right, left, sigma, size: pencil.size(sigma), threads };
        let b = factor.product(Side::Right, &starting_block(pencil.order(), 1));
        let mut x = b.clone();
        factor.substitute(Side::Right, &mut x);
        let residual = factor.residual(Side::Right, &b, &x);
        let error = factor.backward_error(&b, &x, &residual);
        if error.is_nan() || error > STABLE {
            factor.numeric = pivoted(symbolic.pivoted(pencil)?, pencil, sigma, &values)?;
        }
        Ok(factor)
    }

    pub(crate) fn shift(&self) -> Complex<f64> {
        self.sigma
    }

    pub(crate) fn pencil(&self) -> &Pencil {
        self.pencil
    }

    /// The logarithm of det Q(sigma), but for whole turns: rows and columns are in one order, so that exchanges of rows inside the
    /// groups alone change its sign. `None` for factors with any pivots, which the library does not show, and where a pivot is zero.
    pub(super) fn determinant(&self) -> Option<Complex<f64>> {
        let Numeric::Symmetric(_, factors) = &self.numeric else { return None };
        let of_group =
            |group: &Eliminated| sign(&group.pivots) - group.inverses.iter().map(|d| d.ln()).sum::<Complex<f64>>();
        let logarithm: Complex<f64> = factors.iter().flat_map(|part| &part.groups).map(of_group).sum();
        logarithm.is_finite().then_some(logarithm)
    }

    /// True if a solution known beforehand is found again. A small residual says nothing of it where Q(sigma) is singular.
    ///
    /// # Errors
    /// As [`solve`](Self::solve), but for a solution that is not accurate.
    pub(crate) fn is_regular(&self, known: &Mat<Complex<f64>>) -> Result<bool, SparseError> {
        self.errors(known).map(|(_, forward)| forward <= REGULAR)
    }

    /// The backward and the relative forward error of the solution for `Q(sigma) x`, for a vector x that is known, a block of one column. The forward error
    /// is infinite where refinement does not make the backward error small.
    ///
    /// # Errors
    /// As [`solve`](Self::solve), but for a solution that is not accurate.
    pub(crate) fn errors(&self, known: &Mat<Complex<f64>>) -> Result<(f64, f64), SparseError> {
        let b = self.product(Side::Right, known);
        match self.solve(Side::Right, &b) {
            Ok(x) => {
                let residual = self.residual(Side::Right, &b, &x);
                let forward = length((&x - known).col_as_slice(0)) / length(known.col_as_slice(0));
                Ok((self.backward_error(&b, &x, &residual), forward))
            }
            Err(SparseError::Solve { residual, .. }) => Ok((residual, f64::INFINITY)),
            Err(other) => Err(other),
        }
    }

    /// `Q(sigma)^-1 b`, or `Q(sigma)^-T b`, of a block b.
    ///
    /// # Errors
    /// A solution whose backward error stays above 1e-12.
    pub(crate) fn solve(&self, side: Side, b: &Mat<Complex<f64>>) -> Result<Mat<Complex<f64>>, SparseError> {
        let mut x = b.clone();
        self.substitute(side, &mut x);
        let (mut best, mut error_of_best) = (None, f64::INFINITY);
        for _ in 0..=REFINEMENTS {
            let mut residual = self.residual(side, b, &x);
            let error = self.backward_error(b, &x, &residual);
            // A NaN is no small error.
            if error <= GOOD || (error <= REFUSED && error > 0.5 * error_of_best) {
                return Ok(x);
            }
            if !error.is_finite() {
                break;
            }
            if error < error_of_best {
                (best, error_of_best) = (Some(x.clone()), error);
            }
            self.substitute(side, &mut residual);
            x += residual;
        }
        let residual = error_of_best;
        best.filter(|_| residual <= REFUSED).ok_or(SparseError::Solve { shift: self.sigma, residual })
    }

    /// The largest of the columns.
    fn backward_error(&self, b: &Mat<Complex<f64>>, x: &Mat<Complex<f64>>, residual: &Mat<Complex<f64>>) -> f64 {
        let error = |j: usize| {
            let [r, x, b] = [residual, x, b].map(|m| length(m.col_as_slice(j)));
            if r == 0.0 { 0.0 } else { r / (self.size * x + b) }
        };
        (0..b.ncols()).map(error).fold(0.0, |largest: f64, e| if e <= largest { largest } else { e })
    }

    fn product(&self, side: Side, x: &Mat<Complex<f64>>) -> Mat<Complex<f64>> {
        let values = if side == Side::Right { &self.right } else { &self.left };
        self.pencil.times(values, x)
    }

    /// `b - Q(sigma) x`.
    fn residual(&self, side: Side, b: &Mat<Complex<f64>>, x: &Mat<Complex<f64>>) -> Mat<Complex<f64>> {
        let mut residual = self.product(side, x);
        for j in 0..b.ncols() {
            residual.col_as_slice_mut(j).iter_mut().zip(b.col_as_slice(j)).for_each(|(r, b)| *r = b - *r);
        }
        residual
    }

    /// `Q(sigma)^-1 b`, or `Q(sigma)^-T b`, in the place of b, as the factors give it: where nobody asks for the last digits.
    pub(super) fn substitute(&self, side: Side, x: &mut Mat<Complex<f64>>) {
        match &self.numeric {
            Numeric::Symmetric(elimination, factors) => {
                substitute(elimination, factors, side, x, self.threads);
            }
            Numeric::Pivoted(symbolic, numeric) => {
                let lu = LuRef::new_unchecked(symbolic, numeric);
                let mut buffer = MemBuffer::new(symbolic.solve_in_place_scratch::<Complex<f64>>(x.ncols(), PAR));
                let stack = MemStack::new(&mut buffer);
                match side {
                    Side::Right => lu.solve_in_place_with_conj(Conj::No, x.as_mut(), PAR, stack),
                    Side::Left => lu.solve_transpose_in_place_with_conj(Conj::No, x.as_mut(), PAR, stack),
                }
            }
        }
    }
}

/// Factors with any pivots.
fn pivoted<'a>(
    symbolic: &'a SymbolicLu<usize>,
    pencil: &Pencil,
    sigma: Complex<f64>,
    values: &[Complex<f64>],
) -> Result<Numeric<'a>, SparseError> {
    let memory = || SparseError::Memory { order: pencil.order() };
    let matrix = SparseColMatRef::new(pattern(pencil), values);
    let request = symbolic.factorize_numeric_lu_scratch::<Complex<f64>>(PAR, Spec::default());
    let mut buffer = MemBuffer::try_new(request).map_err(|_| memory())?;
    let mut numeric = NumericLu::new();
    symbolic.factorize_numeric_lu(&mut numeric, matrix, PAR, MemStack::new(&mut buffer), Spec::default()).map_err(
        |error| match error {
            LuError::SymbolicSingular { .. } => SparseError::Singular { shift: sigma },
            LuError::Generic(_) => memory(),
        },
    )?;
    Ok(Numeric::Pivoted(symbolic, Box::new(numeric)))
}

/// The logarithm of the sign of a permutation.
pub(super) fn sign(permutation: &[usize]) -> Complex<f64> {
    let (mut is_seen, mut cycles) = (vec![false; permutation.len()], 0);
    for start in 0..permutation.len() {
        let mut at = start;
        cycles += usize::from(!is_seen[start]);
        while !is_seen[at] {
            is_seen[at] = true;
            at = permutation[at];
        }
    }
    Complex::new(0.0, if (permutation.len() - cycles).is_multiple_of(2) { 0.0 } else { PI })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use nalgebra::DMatrix;
    use nalgebra_sparse::{CooMatrix, CscMatrix};

    use super::*;
    use crate::SparseSecondOrder;
    use crate::unpatterned::unpatterned;

    /// Rows that all couple, without any symmetry, and `ties` rows with a zero diagonal that hold one of them each; a few rows that
    /// couple to their neighbours alone.
    fn system(ties: usize) -> SparseSecondOrder {
        let (coupled, chain) = (40, 60);
        let n = coupled + chain + ties;
        let value = |i: usize, j: usize| unpatterned((1 + i * n + j) as f64) - 0.5;
        let mut k = DMatrix::from_fn(n, n, |i, j| match i.max(j) {
            last if last < coupled => value(i, j) + if i == j { 3.0 } else { 0.0 },
            last if last < coupled + chain && i.abs_diff(j) < 2 => value(i, j) + if i == j { 3.0 } else { 0.0 },
            _ => 0.0,
        });
        let mut m = DMatrix::identity(n, n);
        for tie in coupled + chain..n {
            m[(tie, tie)] = 0.0;
            (k[(tie, tie - coupled - chain)], k[(tie - coupled - chain, tie)]) = (1.0, 1.0);
        }
        let c = DMatrix::from_fn(n, n, |i, j| if i.max(j) < coupled { 0.1 * value(j, i) } else { 0.0 });
        SparseSecondOrder::new(CscMatrix::from(&m), CscMatrix::from(&c), CscMatrix::from(&k)).unwrap()
    }

    /// Masses on a square grid, coupled to their neighbours, one way more than the other.
    fn grid(side: usize) -> SparseSecondOrder {
        let n = side * side;
        let [mut m, mut c, mut k] = [(); 3].map(|()| CooMatrix::new(n, n));
        for i in 0..n {
            m.push(i, i, 1.0 + 0.1 * unpatterned(i as f64));
            c.push(i, i, 0.02);
            k.push(i, i, 4.0 + unpatterned((n + i) as f64));
            for other in
                [(i % side + 1 < side).then_some(i + 1), (i + side < n).then_some(i + side)].into_iter().flatten()
            {
                k.push(i, other, -1.1);
                k.push(other, i, -0.9);
            }
        }
        SparseSecondOrder::new((&m).into(), (&c).into(), (&k).into()).unwrap()
    }

    #[test]
    fn parts_of_a_large_matrix_give_the_same_with_any_number_of_threads() {
        let pencil = Pencil::new(&grid(90));
        let mut symbolic = Symbolic::new(&pencil).unwrap();
        let parts = symbolic.symmetric.parts();
        assert!(parts.len() > 4, "{}", parts.len());
        let mut rows: Vec<usize> = parts.iter().flat_map(|part| part.rows.iter().copied()).collect();
        rows.sort_unstable();
        assert!(rows.into_iter().eq(0..pencil.order()));
        let known = starting_block(pencil.order(), 5);
        let mut solved = |threads: usize| {
            symbolic.threads = threads;
            let factor = Factor::new(&symbolic, &pencil, Complex::new(-0.1, 1.3)).unwrap();
            assert!(matches!(factor.numeric, Numeric::Symmetric(..)));
            [Side::Right, Side::Left].map(|side| factor.solve(side, &factor.product(side, &known)).unwrap())
        };
        let one = solved(1);
        assert!(one.iter().all(|solved| (solved - &known).norm_l2() < 1e-11 * known.norm_l2()));
        for threads in [2, 3, 16] {
            assert!(solved(threads) == one, "{threads}");
        }
    }

    #[test]
    fn known_solutions_are_found_again_whatever_the_pivots() {
        for (ties, is_symmetric) in [(0, true), (12, false)] {
            let pencil = Pencil::new(&system(ties));
            let symbolic = Symbolic::new(&pencil).unwrap();
            let factor = Factor::new(&symbolic, &pencil, Complex::new(-0.1, 1.3)).unwrap();
            assert_eq!(matches!(factor.numeric, Numeric::Symmetric(..)), is_symmetric, "{ties}");
            // More columns than lanes, and not a multiple of them.
            let known = starting_block(pencil.order(), 7);
            for side in [Side::Right, Side::Left] {
                let solved = factor.solve(side, &factor.product(side, &known)).unwrap();
                assert!((&solved - &known).norm_l2() < 1e-11 * known.norm_l2(), "{ties} {side:?}");
            }
        }
    }
}
