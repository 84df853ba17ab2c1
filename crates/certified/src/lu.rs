//! Factors of a dense complex matrix, real and imaginary part apart.
//!
//! The LU of one large matrix that is written here by hand: nalgebra's has no solve with the adjoint, and both nalgebra and faer take four
//! times the products where the matrix is real, as most are that have a real sigma. A pivot that vanishes becomes a small one, which
//! inverse iteration wants; the bits are the same on all processors.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use pulp::Arch;

mod solves;

pub(crate) use solves::real_product;

/// Columns that are eliminated one after the other instead of by halves: of 8, 16, 32 and 64 the fastest for n = 100 to 400.
const FEW: usize = 32;

/// Least pivot whose square does not underflow, as complex division needs.
pub const LEAST_PIVOT: f64 = 1e-150;

/// A complex vector.
pub type Vector = DVector<Complex<f64>>;

/// Factorisation `P A = L U` by partial pivoting, with solves from both sides.
#[derive(Debug)]
pub struct Lu {
    /// Real and imaginary parts apart: products of real matrices are the fast ones.
    parts: [DMatrix<f64>; 2],
    /// True if the imaginary part is zero, so that it is left alone: of a real sigma, a quarter of the work.
    is_real: bool,
    /// Row swapped with row k at step k.
    swaps: Vec<usize>,
}

impl Lu {
    /// A pivot below `least` is replaced by it: a perturbation of that size makes A regular.
    #[must_use]
    pub fn new(a: &DMatrix<Complex<f64>>, least: f64) -> Self {
        Self::of_parts([a.map(|z| z.re), a.map(|z| z.im)], least)
    }

    /// [`new`](Self::new) of a matrix whose real and imaginary parts stand apart.
    pub(crate) fn of_parts(parts: [DMatrix<f64>; 2], least: f64) -> Self {
        let n = parts[0].nrows();
        let is_real = parts[1].iter().all(|&x| x == 0.0);
        let mut lu = Self { parts, is_real, swaps: Vec::with_capacity(n) };
        lu.factorise(0..n, least);
        lu
    }

    /// Factorises these columns; all columns to the left of them are done with. First the left half, then what it changes in the right half, then the
    /// right half (Toledo, SIAM J. Matrix Anal. Appl. 18, 1997). Nearly all of the work is in products of matrices.
    fn factorise(&mut self, columns: Range<usize>, least: f64) {
        if columns.len() <= FEW {
            return Arch::new().dispatch(|| self.eliminate(columns, least));
        }
        let (start, end) = (columns.start, columns.end);
        let middle = start + columns.len() / 2;
        self.factorise(start..middle, least);
        self.swap_rows(start..middle, middle..end);
        self.solve_lower(start..middle, middle..end);
        self.subtract_product(middle..self.order(), start..middle, middle..end);
        self.factorise(middle..end, least);
        self.swap_rows(middle..end, start..middle);
    }

    /// Number of pivots that are no larger than `limit`: as many directions are nearly in the null space.
    pub(crate) fn pivots_up_to(&self, limit: f64) -> usize {
        let [re, im] = &self.parts;
        re.diagonal().iter().zip(im.diagonal().iter()).filter(|(re, im)| re.hypot(**im) <= limit).count()
    }

    fn order(&self) -> usize {
        self.parts[0].nrows()
    }

    /// The parts that are not zero.
    fn nonzero_parts(&mut self) -> &mut [DMatrix<f64>] {
        let count = if self.is_real { 1 } else { 2 };
        &mut self.parts[..count]
    }

    /// Does the swaps of `steps` in `columns`, which those steps did not see.
    fn swap_rows(&mut self, steps: Range<usize>, columns: Range<usize>) {
        let n = self.order();
        let swaps = self.swaps[steps.clone()].to_vec();
        for part in self.nonzero_parts() {
            for column in part.as_mut_slice()[columns.start * n..columns.end * n].chunks_exact_mut(n) {
                swaps.iter().zip(steps.clone()).for_each(|(&pivot, k)| column.swap(k, pivot));
            }
        }
    }

    /// The rows of U right of a triangle of L.
    fn solve_lower(&mut self, triangle: Range<usize>, columns: Range<usize>) {
        if triangle.len() <= FEW {
            return Arch::new().dispatch(|| self.substitute(triangle, columns));
        }
        let middle = triangle.start + triangle.len() / 2;
        self.solve_lower(triangle.start..middle, columns.clone());
        self.subtract_product(middle..triangle.end, triangle.start..middle, columns.clone());
        self.solve_lower(middle..triangle.end, columns);
    }

    /// [`solve_lower`](Self::solve_lower) column by column.
    #[inline(always)]
    fn substitute(&mut self, triangle: Range<usize>, columns: Range<usize>) {
        let n = self.order();
        let is_real = self.is_real;
        let [re, im] = &mut self.parts;
        let (left_re, right_re) = re.as_mut_slice().split_at_mut(columns.start * n);
        let (left_im, right_im) = im.as_mut_slice().split_at_mut(columns.start * n);
        let columns = right_re.chunks_exact_mut(n).zip(right_im.chunks_exact_mut(n)).take(columns.len());
        for (re, im) in columns {
            for k in triangle.clone() {
                let below = k + 1..triangle.end;
                let l = [&left_re[k * n..][below.clone()], &left_im[k * n..][below.clone()]];
                let head = [re[k], im[k]];
                subtract_multiple([&mut re[below.clone()], &mut im[below]], l, head, is_real);
            }
        }
    }

    /// `A[rows, columns] -= A[rows, inner] A[inner, columns]`; rows and columns come after the inner ones. What is zero at the
    /// ends of the factors is left out: matrices of finite elements have bands.
    fn subtract_product(&mut self, rows: Range<usize>, inner: Range<usize>, columns: Range<usize>) {
        let is_nonzero = |&x: &f64| x != 0.0;
        let [mut height, mut width] = [0, 0];
        for part in self.nonzero_parts() {
            let left = part.view((rows.start, inner.start), (rows.len(), inner.len()));
            let last = (height..rows.len()).rfind(|&i| left.row(i).iter().any(is_nonzero));
            height = last.map_or(height, |i| i + 1);
            let upper = part.view((inner.start, columns.start), (inner.len(), columns.len()));
            let last = (width..columns.len()).rfind(|&j| upper.column(j).iter().any(is_nonzero));
            width = last.map_or(width, |j| j + 1);
        }
        let is_real = self.is_real;
        let [re, im] = &mut self.parts;
        let columns = columns.start..columns.start + width;
        let (left_re, mut right_re) = re.columns_range_pair_mut(inner.clone(), columns.clone());
        let (left_im, mut right_im) = im.columns_range_pair_mut(inner.clone(), columns);
        let (left_re, left_im) = (left_re.rows(rows.start, height), left_im.rows(rows.start, height));
        let below = rows.start..rows.start + height;
        let (upper_re, mut re) = right_re.rows_range_pair_mut(inner.clone(), below.clone());
        let (upper_im, mut im) = right_im.rows_range_pair_mut(inner, below);
        re.gemm(-1.0, &left_re, &upper_re, 1.0);
        if !is_real {
            re.gemm(1.0, &left_im, &upper_im, 1.0);
            im.gemm(-1.0, &left_re, &upper_im, 1.0);
            im.gemm(-1.0, &left_im, &upper_re, 1.0);
        }
    }

    /// A few columns one after the other.
    #[inline(always)]
    fn eliminate(&mut self, columns: Range<usize>, least: f64) {
        let n = self.order();
        let is_real = self.is_real;
        let [re, im] = &mut self.parts;
        for k in columns.clone() {
            let mut pivot = k;
            let mut largest = 0.0;
            for i in k..n {
                let size = re[(i, k)].abs() + if is_real { 0.0 } else { im[(i, k)].abs() };
                if size > largest {
                    (pivot, largest) = (i, size);
                }
            }
            self.swaps.push(pivot);
            for part in [&mut *re, &mut *im] {
                part.columns_mut(columns.start, columns.len()).swap_rows(k, pivot);
            }
            let mut head = Complex::new(re[(k, k)], im[(k, k)]);
            if head.norm() < least {
                head = Complex::from(least);
                (re[(k, k)], im[(k, k)]) = (least, 0.0);
            }
            let inverse = head.inv();
            let (left_re, right_re) = re.as_mut_slice().split_at_mut((k + 1) * n);
            let (left_im, right_im) = im.as_mut_slice().split_at_mut((k + 1) * n);
            let (l_re, l_im) = (&mut left_re[k * n + k + 1..], &mut left_im[k * n + k + 1..]);
            if is_real {
                l_re.iter_mut().for_each(|x| *x *= inverse.re);
            } else {
                for (re, im) in l_re.iter_mut().zip(&mut *l_im) {
                    let l = Complex::new(*re, *im) * inverse;
                    (*re, *im) = (l.re, l.im);
                }
            }
            let right = right_re.chunks_exact_mut(n).zip(right_im.chunks_exact_mut(n));
            for (re, im) in right.take(columns.end - k - 1) {
                let head = [re[k], im[k]];
                subtract_multiple([&mut re[k + 1..], &mut im[k + 1..]], [l_re, l_im], head, is_real);
            }
        }
    }
}

/// `x -= l head` of numbers in parts, all complex or all real.
#[inline(always)]
fn subtract_multiple([re, im]: [&mut [f64]; 2], [l_re, l_im]: [&[f64]; 2], head: [f64; 2], is_real: bool) {
    if is_real {
        return subtract_real(re, l_re, head[0]);
    }
    subtract_complex([re, im], [l_re, l_im], head);
}

#[inline(always)]
fn subtract_complex([re, im]: [&mut [f64]; 2], [l_re, l_im]: [&[f64]; 2], head: [f64; 2]) {
    for ((re, im), (&l_re, &l_im)) in re.iter_mut().zip(im).zip(l_re.iter().zip(l_im)) {
        *re -= l_re * head[0] - l_im * head[1];
        *im -= l_re * head[1] + l_im * head[0];
    }
}

#[inline(always)]
fn subtract_real(x: &mut [f64], l: &[f64], head: f64) {
    x.iter_mut().zip(l).for_each(|(x, l)| *x -= l * head);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn both_solves_invert_the_matrix(entries in prop::collection::vec(-1.0..1.0f64, 60)) {
            let a = DMatrix::from_fn(5, 5, |i, j| Complex::new(entries[5 * i + j], entries[25 + 5 * i + j]));
            let b = DVector::from_fn(5, |i, _| Complex::new(entries[50 + i], entries[55 + i]));
            let lu = Lu::new(&a, 1e-300);
            prop_assume!(a.determinant().norm() > 1e-3);
            let (mut x, mut y) = (b.clone(), b.clone());
            lu.solve(&mut x);
            lu.solve_adjoint(&mut y);
            prop_assert!((&a * x - &b).norm() < 1e-10);
            prop_assert!((a.adjoint() * y - &b).norm() < 1e-10);
        }
    }

    #[test]
    fn matrices_of_several_halves_are_solved_from_both_sides() {
        let n = 2 * FEW + 5;
        let wave = |i: usize, j: usize| ((5 * i + 11 * j * j + 3 * i * j) % 97) as f64 / 97.0 - 0.5;
        let b = DVector::from_fn(n, |i, _| Complex::new(wave(i, 1), wave(2, i)));
        let complex = DMatrix::from_fn(n, n, |i, j| Complex::new(wave(i, j), wave(j, i + 3)));
        for a in [complex.map(|z| Complex::from(z.re + z.im)), complex] {
            let lu = Lu::new(&a, 1e-300);
            let (mut x, mut y) = (b.clone(), b.clone());
            lu.solve(&mut x);
            lu.solve_adjoint(&mut y);
            assert!((&a * &x - &b).norm() < 1e-13 * a.norm() * x.norm());
            assert!((a.adjoint() * &y - &b).norm() < 1e-13 * a.norm() * y.norm());
        }
    }
}
