//! Factors of a dense complex matrix, real and imaginary part apart.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd};

use crate::lanes::Ops;

/// Columns eliminated before those to their right are: few enough that a panel of 500 rows stays in the cache. Chosen.
const PANEL: usize = 16;

/// Least pivot whose square does not underflow, as complex division needs.
pub(crate) const LEAST_PIVOT: f64 = 1e-150;

pub(crate) type Vector = DVector<Complex<f64>>;

/// `P A = L U` by partial pivoting, with solves from both sides.
#[derive(Debug)]
pub(crate) struct Lu {
    /// Real and imaginary parts apart: the inner loop vectorises.
    re: DMatrix<f64>,
    im: DMatrix<f64>,
    /// Whether the imaginary part is zero, so that it is left alone: of a real sigma, a quarter of the work.
    is_real: bool,
    /// Row swapped with row k at step k.
    swaps: Vec<usize>,
}

impl Lu {
    /// A pivot below `least` is replaced by it: a perturbation of that size makes A regular.
    ///
    /// [`PANEL`] columns at a time are eliminated, and then what they change in the columns to their right.
    pub(crate) fn new(a: &DMatrix<Complex<f64>>, least: f64) -> Self {
        Self::of_parts([a.map(|z| z.re), a.map(|z| z.im)], least)
    }

    /// [`new`](Self::new) of a matrix whose real and imaginary parts stand apart.
    pub(crate) fn of_parts([mut re, mut im]: [DMatrix<f64>; 2], least: f64) -> Self {
        let n = re.nrows();
        let is_real = im.iter().all(|&x| x == 0.0);
        let mut swaps = Vec::with_capacity(n);
        let arch = Arch::new();
        for start in (0..n).step_by(PANEL) {
            let end = n.min(start + PANEL);
            for k in start..end {
                swaps.push(eliminate([&mut re, &mut im], is_real, start..end, k, least));
            }
            for part in [&mut re, &mut im].into_iter().take(if is_real { 1 } else { 2 }) {
                swap_outside(part.as_mut_slice(), n, start..end, &swaps[start..]);
            }
            let (panel_re, right_re) = re.as_mut_slice().split_at_mut(end * n);
            let (panel_im, right_im) = im.as_mut_slice().split_at_mut(end * n);
            let panel = [&panel_re[start * n..], &panel_im[start * n..]];
            arch.dispatch(UpdateRight { n, start, end, is_real, panel, right: [right_re, right_im] });
        }
        Self { re, im, is_real, swaps }
    }

    fn at(&self, i: usize, j: usize) -> Complex<f64> {
        Complex::new(self.re[(i, j)], self.im[(i, j)])
    }

    /// x := A^-1 x.
    pub(crate) fn solve(&self, x: &mut Vector) {
        let n = x.len();
        for (k, &pivot) in self.swaps.iter().enumerate() {
            x.swap_rows(k, pivot);
        }
        for k in 0..n {
            self.subtract_column(k, k + 1..n, x[k], x);
        }
        for k in (0..n).rev() {
            x[k] /= self.at(k, k);
            self.subtract_column(k, 0..k, x[k], x);
        }
    }

    /// x -= column k times `head`, in some rows.
    fn subtract_column(&self, k: usize, rows: Range<usize>, head: Complex<f64>, x: &mut Vector) {
        let (re, im) = (self.re.column(k), self.im.column(k));
        if self.is_real {
            let factors = &re.as_slice()[rows.clone()];
            x.as_mut_slice()[rows].iter_mut().zip(factors).for_each(|(z, &re)| *z -= head * re);
            return;
        }
        let factors = re.as_slice()[rows.clone()].iter().zip(&im.as_slice()[rows.clone()]);
        for (z, (&re, &im)) in x.as_mut_slice()[rows].iter_mut().zip(factors) {
            *z -= Complex::new(re, im) * head;
        }
    }

    /// The sum of conjugate entries of column k times x, in some rows.
    fn column_dot(&self, k: usize, rows: Range<usize>, x: &Vector) -> Complex<f64> {
        let (re, im) = (self.re.column(k), self.im.column(k));
        if self.is_real {
            return x.as_slice()[rows.clone()].iter().zip(&re.as_slice()[rows]).map(|(z, &re)| z * re).sum();
        }
        let factors = re.as_slice()[rows.clone()].iter().zip(&im.as_slice()[rows.clone()]);
        x.as_slice()[rows].iter().zip(factors).map(|(z, (&re, &im))| Complex::new(re, -im) * z).sum()
    }

    /// x := A^-H x.
    pub(crate) fn solve_adjoint(&self, x: &mut Vector) {
        let n = x.len();
        for k in 0..n {
            let sum = self.column_dot(k, 0..k, x);
            x[k] = (x[k] - sum) / self.at(k, k).conj();
        }
        for k in (0..n).rev() {
            let sum = self.column_dot(k, k + 1..n, x);
            x[k] -= sum;
        }
        for (k, &pivot) in self.swaps.iter().enumerate().rev() {
            x.swap_rows(k, pivot);
        }
    }
}

/// Rows swapped in the columns outside a panel, column by column, as in the panel one after the other.
fn swap_outside(a: &mut [f64], n: usize, panel: Range<usize>, swaps: &[usize]) {
    for (_, column) in a.chunks_exact_mut(n).enumerate().filter(|(j, _)| !panel.contains(j)) {
        swaps.iter().zip(panel.start..).for_each(|(&pivot, k)| column.swap(k, pivot));
    }
}

/// Column k eliminated, in the columns of its panel; the row that was swapped with row k.
fn eliminate([re, im]: [&mut DMatrix<f64>; 2], is_real: bool, panel: Range<usize>, k: usize, least: f64) -> usize {
    let n = re.nrows();
    let size = |i: usize| re[(i, k)].abs() + im[(i, k)].abs();
    let pivot = (k..n).fold(k, |best, i| if size(i) > size(best) { i } else { best });
    for part in [&mut *re, &mut *im] {
        part.columns_mut(panel.start, panel.len()).swap_rows(k, pivot);
    }
    let mut head = Complex::new(re[(k, k)], im[(k, k)]);
    if head.norm() < least {
        head = Complex::from(least);
        (re[(k, k)], im[(k, k)]) = (least, 0.0);
    }
    let inverse = head.inv();
    for i in k + 1..n {
        let l = Complex::new(re[(i, k)], im[(i, k)]) * inverse;
        (re[(i, k)], im[(i, k)]) = (l.re, l.im);
    }
    for j in k + 1..panel.end {
        let (ur, ui) = (re[(k, j)], im[(k, j)]);
        if is_real {
            (k + 1..n).for_each(|i| re[(i, j)] -= re[(i, k)] * ur);
            continue;
        }
        for i in k + 1..n {
            let (lr, li) = (re[(i, k)], im[(i, k)]);
            re[(i, j)] -= lr * ur - li * ui;
            im[(i, j)] -= lr * ui + li * ur;
        }
    }
    pivot
}

/// The columns right of a panel of L: its triangle solved, and what is below it subtracted.
struct UpdateRight<'a> {
    n: usize,
    /// The panel's first column, and the first one after it.
    start: usize,
    end: usize,
    is_real: bool,
    panel: [&'a [f64]; 2],
    right: [&'a mut [f64]; 2],
}

impl WithSimd for UpdateRight<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (Self { n, start, end, is_real, panel, right: [re, im] }, o) = (self, Ops(simd));
        let place = (n, start, end);
        let (mut fours_re, mut fours_im) = (re.chunks_exact_mut(4 * n), im.chunks_exact_mut(4 * n));
        for (re, im) in fours_re.by_ref().zip(fours_im.by_ref()) {
            if is_real {
                update::<4, true, S>(o, place, panel, [re, im]);
            } else {
                update::<4, false, S>(o, place, panel, [re, im]);
            }
        }
        let rest = fours_re.into_remainder().chunks_exact_mut(n).zip(fours_im.into_remainder().chunks_exact_mut(n));
        for (re, im) in rest {
            update::<1, false, S>(o, place, panel, [re, im]);
        }
    }
}

/// [`UpdateRight`] for `COLUMNS` columns: enough of them hide how long one sum takes.
#[inline(always)]
fn update<const COLUMNS: usize, const REAL: bool, S: Simd>(
    o: Ops<S>,
    (n, start, end): (usize, usize, usize),
    [panel_re, panel_im]: [&[f64]; 2],
    [re, im]: [&mut [f64]; 2],
) {
    // Most of the matrices of finite elements is zero.
    let is_zero = |part: &[f64]| part.chunks_exact(n).all(|x| x[start..end].iter().all(|&x| x == 0.0));
    if is_zero(re) && (REAL || is_zero(im)) {
        return;
    }
    let mut upper = [[[0.0; 2]; COLUMNS]; PANEL];
    for (column, (re, im)) in re.chunks_exact_mut(n).zip(im.chunks_exact_mut(n)).enumerate() {
        for p in start..end {
            let (ur, ui) = (re[p], im[p]);
            upper[p - start][column] = [ur, ui];
            let left = (p - start) * n;
            for i in p + 1..end {
                let (lr, li) = (panel_re[left + i], panel_im[left + i]);
                re[i] -= lr * ur - li * ui;
                im[i] -= lr * ui + li * ur;
            }
        }
    }
    let mut at = end;
    while at < n {
        let next = n.min(at + S::F64_LANES);
        let mut sums = [[o.splat(0.0); 2]; COLUMNS];
        for (p, upper) in upper[..end - start].iter().enumerate() {
            let lr = o.load(&panel_re[p * n + at..p * n + next]);
            if REAL {
                sums.iter_mut().zip(upper).for_each(|(sum, u)| sum[0] = o.fma(lr, o.splat(u[0]), sum[0]));
                continue;
            }
            let li = o.load(&panel_im[p * n + at..p * n + next]);
            for (sum, u) in sums.iter_mut().zip(upper) {
                let (ur, ui) = (o.splat(u[0]), o.splat(u[1]));
                sum[0] = o.fnma(li, ui, o.fma(lr, ur, sum[0]));
                sum[1] = o.fma(li, ur, o.fma(lr, ui, sum[1]));
            }
        }
        for (column, sum) in sums.iter().enumerate() {
            let rows = column * n + at..column * n + next;
            for (part, &sum) in [&mut *re, &mut *im].into_iter().zip(sum).take(if REAL { 1 } else { 2 }) {
                let x = o.load(&part[rows.clone()]);
                o.store(&mut part[rows.clone()], o.sub(x, sum));
            }
        }
        at = next;
    }
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
    fn matrices_of_several_panels_are_solved_from_both_sides() {
        let n = 3 * PANEL + 5;
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
