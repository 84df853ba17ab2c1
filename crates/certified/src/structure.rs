//! Structure of a pencil: how many eigenvalues are exactly infinite or exactly zero, and in which Jordan chains.
//!
//! No tolerance decides a rank here. The matrices are mapped to a prime field without rounding (see `field`), and
//! the pencil is reduced there: each step takes the null space of the leading matrix out, as the staircase algorithm
//! does (Van Dooren, Linear Algebra Appl. 27, 1979). The dimensions found dictate the ranks of the floating-point
//! deflation. They belong to the numbers as given: a mass matrix that is singular only up to rounding is regular here,
//! and has huge eigenvalues whose condition numbers say what they are worth.

use linsys::SecondOrder;
use nalgebra::DMatrix;

use super::field::{PRIME, add, inverse, mul, residue, sub};
use crate::CertifiedError;

/// Dimensions of the null spaces that come off one after another: Jordan chains of length 1 or more, 2 or more, ...
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Structure {
    /// Dimensions for the eigenvalue at infinity.
    pub(crate) infinite: Vec<usize>,
    /// Dimensions for the eigenvalue zero.
    pub(crate) zero: Vec<usize>,
}

impl Structure {
    /// Counts of a regular quadratic matrix polynomial.
    pub(crate) fn of(system: &SecondOrder) -> Result<Self, CertifiedError> {
        let n = system.order();
        let image = |a: &DMatrix<f64>| a.map(residue);
        let (m, c, k) = (image(&system.m), image(&system.c), image(&system.k));
        // det Q is a polynomial of degree 2 n at most: it vanishes at a residue by chance once in 1e16.
        let regular = [0x1234_5678_9abc_def1, 0x0fed_cba9_8765_4321].into_iter().any(|s| {
            let s = s % PRIME;
            let q = DMatrix::from_fn(n, n, |i, j| add(mul(add(mul(m[(i, j)], s), c[(i, j)]), s), k[(i, j)]));
            rank(q) == n
        });
        if !regular {
            return Err(CertifiedError::SingularPencil { exactly: true });
        }
        let infinite = if rank(m.clone()) == n { Vec::new() } else { chain(&k, &c, &m) };
        let zero = if rank(k.clone()) == n { Vec::new() } else { chain(&m, &c, &k) };
        Ok(Self { infinite, zero })
    }
}

/// Eliminates downwards; returns the columns that hold pivots.
fn eliminate(a: &mut DMatrix<u64>) -> Vec<usize> {
    let (rows, columns) = a.shape();
    let mut pivots = Vec::new();
    for j in 0..columns {
        let top = pivots.len();
        let Some(row) = (top..rows).find(|&i| a[(i, j)] != 0) else { continue };
        a.swap_rows(top, row);
        let scale = inverse(a[(top, j)]);
        let factors: Vec<u64> = (top + 1..rows).map(|i| mul(a[(i, j)], scale)).collect();
        for mut column in a.columns_mut(j, columns - j).column_iter_mut() {
            let head = column[top];
            if head != 0 {
                for (x, &f) in column.rows_mut(top + 1, rows - top - 1).iter_mut().zip(&factors) {
                    *x = sub(*x, mul(f, head));
                }
            }
        }
        pivots.push(j);
    }
    pivots
}

fn rank(mut a: DMatrix<u64>) -> usize {
    eliminate(&mut a).len()
}

/// Dimension of the null space of a square matrix, exactly.
pub(crate) fn nullity(a: &DMatrix<f64>) -> usize {
    a.ncols() - rank(a.map(residue))
}

/// Null spaces that come off at infinity of `lambda^2 m + lambda c + k`, from its companion pencil A - lambda B.
fn chain(k: &DMatrix<u64>, c: &DMatrix<u64>, m: &DMatrix<u64>) -> Vec<usize> {
    let n = m.nrows();
    let (mut a, mut b) = (DMatrix::zeros(2 * n, 2 * n), DMatrix::zeros(2 * n, 2 * n));
    for i in 0..n {
        a[(i, n + i)] = 1;
        b[(i, i)] = 1;
        for j in 0..n {
            a[(n + i, j)] = sub(0, k[(i, j)]);
            a[(n + i, n + j)] = sub(0, c[(i, j)]);
            b[(n + i, n + j)] = m[(i, j)];
        }
    }
    let mut removed = Vec::new();
    while let Some((smaller_a, smaller_b, width)) = remove_null_space(&a, &b) {
        removed.push(width);
        (a, b) = (smaller_a, smaller_b);
    }
    removed
}

/// Takes null(B) out: what is left of A and B on the other columns, in rows that A null(B) does not reach.
fn remove_null_space(a: &DMatrix<u64>, b: &DMatrix<u64>) -> Option<(DMatrix<u64>, DMatrix<u64>, usize)> {
    let size = b.nrows();
    let mut echelon = b.clone();
    let pivots = eliminate(&mut echelon);
    let free: Vec<usize> = (0..size).filter(|j| !pivots.contains(j)).collect();
    let width = free.len();
    if width == 0 {
        return None;
    }
    // Null vectors by back substitution, one for each free column; the pivot columns complete the basis.
    let mut null = DMatrix::zeros(size, width);
    for (v, &f) in free.iter().enumerate() {
        null[(f, v)] = 1;
        for (row, &p) in pivots.iter().enumerate().rev() {
            let sum = (p + 1..=f.max(p)).fold(0, |s, j| add(s, mul(echelon[(row, j)], null[(j, v)])));
            null[(p, v)] = mul(sub(0, sum), inverse(echelon[(row, p)]));
        }
    }
    // [A null(B) | A pivots | B pivots], eliminated together: the rows below the first `width` are what is left.
    let rest = pivots.len();
    let mut all = DMatrix::zeros(size, width + 2 * rest);
    for v in 0..width {
        for j in (0..size).filter(|&j| null[(j, v)] != 0) {
            for i in 0..size {
                all[(i, v)] = add(all[(i, v)], mul(a[(i, j)], null[(j, v)]));
            }
        }
    }
    for (at, &p) in pivots.iter().enumerate() {
        all.set_column(width + at, &a.column(p));
        all.set_column(width + rest + at, &b.column(p));
    }
    reduce_leading(&mut all, width);
    let below = |from: usize| all.view((width, from), (rest, rest)).into_owned();
    Some((below(width), below(width + rest), width))
}

/// Eliminates the first `width` columns only, which are independent for a regular pencil.
fn reduce_leading(all: &mut DMatrix<u64>, width: usize) {
    let rows = all.nrows();
    for j in 0..width {
        let Some(row) = (j..rows).find(|&i| all[(i, j)] != 0) else { continue };
        all.swap_rows(j, row);
        let scale = inverse(all[(j, j)]);
        let factors: Vec<u64> = (j + 1..rows).map(|i| mul(all[(i, j)], scale)).collect();
        for mut column in all.column_iter_mut().skip(j) {
            let head = column[j];
            if head != 0 {
                for (x, &f) in column.rows_mut(j + 1, rows - j - 1).iter_mut().zip(&factors) {
                    *x = sub(*x, mul(f, head));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    fn structure(m: DMatrix<f64>, c: DMatrix<f64>, k: DMatrix<f64>) -> Result<Structure, CertifiedError> {
        Structure::of(&SecondOrder::new(m, c, k).unwrap())
    }

    #[test]
    fn a_massless_degree_of_freedom_and_a_rigid_body() {
        // A massless damped joint has one infinite eigenvalue, an undamped one two; a free body two zeros.
        let s = structure(dmatrix![1.0, 0.0; 0.0, 0.0], dmatrix![0.0, 0.0; 0.0, 0.1], dmatrix![0.1, -0.1; -0.1, 0.1]);
        assert_eq!(s, Ok(Structure { infinite: vec![1], zero: vec![1] }));
        let s = structure(dmatrix![1.0, 0.0; 0.0, 0.0], DMatrix::zeros(2, 2), dmatrix![0.1, -0.1; -0.1, 0.3]);
        assert_eq!(s, Ok(Structure { infinite: vec![1, 1], zero: vec![] }));
        let s = structure(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), dmatrix![0.1, -0.1; -0.1, 0.1]);
        assert_eq!(s, Ok(Structure { infinite: vec![], zero: vec![1, 1] }));
    }

    #[test]
    fn a_constraint_has_a_chain_of_four_at_infinity() {
        // u'' + 2 u = p, u = 0: the multiplier of a position constraint (index 3).
        let s = structure(dmatrix![1.0, 0.0; 0.0, 0.0], DMatrix::zeros(2, 2), dmatrix![2.0, -1.0; 1.0, 0.0]);
        assert_eq!(s, Ok(Structure { infinite: vec![1, 1, 1, 1], zero: vec![] }));
    }

    #[test]
    fn a_singular_pencil_is_an_error_and_rounding_does_not_make_one() {
        let one = dmatrix![1.0, 1.0; 1.0, 1.0];
        assert_eq!(
            structure(one.clone(), one.clone(), one.clone()),
            Err(CertifiedError::SingularPencil { exactly: true })
        );
        let nearly = dmatrix![1.0, 1.0; 1.0, 1.0 + f64::EPSILON];
        assert_eq!(structure(one.clone(), one, nearly), Ok(Structure { infinite: vec![1, 1], zero: vec![] }));
    }
}
