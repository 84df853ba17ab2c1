//! Solutions with the factors of [`fronts`](super::fronts), a few right-hand sides at once.

use faer::Mat;
use num_complex::Complex;
use pulp::Simd;

use super::fronts::Eliminated;
use super::lanes::{
    GROUP, Kernel, PIECE, Row, add, bring, columns, gathered, joined, minus, negative, plus, scatter, times, turned,
    zero,
};
use super::products::Side;

/// `A^-1 x`, or `A^-T x`, in place, of the columns of a block.
pub(super) struct Substitution<'a> {
    pub(super) groups: &'a [Eliminated],
    /// The row at each place.
    pub(super) order: &'a [usize],
    pub(super) side: Side,
    pub(super) x: &'a mut Mat<Complex<f64>>,
}

impl Kernel for Substitution<'_> {
    #[inline(always)]
    fn run<S: Simd, const N: usize>(self, simd: S) {
        for from in (0..self.x.ncols()).step_by(columns::<S, N>()) {
            let mut rows: Vec<Row<S, N>> = gathered(simd, self.x, from, |i| self.order[i]);
            match self.side {
                Side::Right => right(simd, self.groups, &mut rows),
                Side::Left => left(simd, self.groups, &mut rows),
            }
            scatter::<S, N>(&rows, self.x, from, |i| self.order[i]);
        }
    }
}

#[inline(always)]
fn right<S: Simd, const N: usize>(simd: S, groups: &[Eliminated], x: &mut [Row<S, N>]) {
    let mut permuted = Vec::new();
    for group in groups {
        let width = group.pivots.len();
        let (own, rest) = x[group.from..].split_at_mut(width);
        permuted.clear();
        permuted.extend(group.pivots.iter().map(|&pivot| own[pivot]));
        own.copy_from_slice(&permuted);
        for k in 0..width {
            let (done, left) = own.split_at_mut(k + 1);
            subtract_column(simd, left, &group.diagonal.col_as_slice(k)[k + 1..], done[k]);
        }
        subtract_rows(simd, rest, group, &group.lower, own);
    }
    for group in groups.iter().rev() {
        let width = group.pivots.len();
        let (own, rest) = x[group.from..].split_at_mut(width);
        subtract_columns(simd, own, group, &group.upper, rest);
        for k in (0..width).rev() {
            let column = group.diagonal.col_as_slice(k);
            let (left, done) = own.split_at_mut(k);
            done[0] = times(simd, column[k], done[0]);
            subtract_column(simd, left, &column[..k], done[0]);
        }
    }
}

#[inline(always)]
fn left<S: Simd, const N: usize>(simd: S, groups: &[Eliminated], x: &mut [Row<S, N>]) {
    let mut permuted = Vec::new();
    for group in groups {
        let width = group.pivots.len();
        let (own, rest) = x[group.from..].split_at_mut(width);
        for k in 0..width {
            let column = group.diagonal.col_as_slice(k);
            let (done, left) = own.split_at_mut(k);
            left[0] = times(simd, column[k], minus(simd, left[0], dot(simd, &column[..k], done)));
        }
        subtract_rows(simd, rest, group, &group.upper, own);
    }
    for group in groups.iter().rev() {
        let width = group.pivots.len();
        let (own, rest) = x[group.from..].split_at_mut(width);
        subtract_columns(simd, own, group, &group.lower, rest);
        for k in (0..width).rev() {
            let (left, done) = own.split_at_mut(k + 1);
            left[k] = minus(simd, left[k], dot(simd, &group.diagonal.col_as_slice(k)[k + 1..], done));
        }
        permuted.clear();
        permuted.extend_from_slice(own);
        group.pivots.iter().zip(&permuted).for_each(|(&pivot, value)| own[pivot] = *value);
    }
}

#[inline(always)]
fn subtract_column<S: Simd, const N: usize>(simd: S, x: &mut [Row<S, N>], column: &[Complex<f64>], factor: Row<S, N>) {
    let factor = negative(simd, factor);
    let other = turned(simd, factor);
    for (x, &value) in x.iter_mut().zip(column) {
        *x = plus(simd, *x, value, factor, other);
    }
}

#[inline(always)]
fn dot<S: Simd, const N: usize>(simd: S, column: &[Complex<f64>], x: &[Row<S, N>]) -> Row<S, N> {
    let mut sum = [zero(simd); 2];
    for (&value, &x) in column.iter().zip(x) {
        add(simd, &mut sum, value, x);
    }
    joined(simd, sum)
}

/// The rows of a group of [`GROUP`], each of the width of the group.
#[inline(always)]
fn split(values: &[Complex<f64>], width: usize) -> [&[Complex<f64>]; GROUP] {
    std::array::from_fn(|k| &values[k * width..(k + 1) * width])
}

/// Some rows below the group at a time, with their parts of a factor.
#[inline(always)]
fn pieces<'a>(group: &'a Eliminated, a: &'a [Complex<f64>]) -> impl Iterator<Item = (&'a [usize], &'a [Complex<f64>])> {
    let width = group.pivots.len();
    let rows = GROUP * (PIECE / (GROUP * width)).max(1);
    group.below.chunks(rows).zip(a.chunks(rows * width))
}

/// `x_below -= A own`, A by rows.
#[inline(always)]
fn subtract_rows<S: Simd, const N: usize>(
    simd: S,
    rest: &mut [Row<S, N>],
    group: &Eliminated,
    a: &[Complex<f64>],
    own: &[Row<S, N>],
) {
    let width = own.len();
    let first = group.from + width;
    for (below, a) in pieces(group, a) {
        bring(a);
        for (rows, values) in below.chunks(GROUP).zip(a.chunks(GROUP * width)) {
            if rows.len() == GROUP {
                let values = split(values, width);
                let mut sums = [zero(simd); GROUP];
                for (at, &x) in own.iter().enumerate() {
                    let y = turned(simd, x);
                    for (sum, values) in sums.iter_mut().zip(values) {
                        *sum = plus(simd, *sum, values[at], x, y);
                    }
                }
                for (&row, sum) in rows.iter().zip(sums) {
                    rest[row - first] = minus(simd, rest[row - first], sum);
                }
            } else {
                for (&row, values) in rows.iter().zip(values.chunks(width)) {
                    rest[row - first] = minus(simd, rest[row - first], dot(simd, values, own));
                }
            }
        }
    }
}

/// `own -= A x_below`, A by columns.
#[inline(always)]
fn subtract_columns<S: Simd, const N: usize>(
    simd: S,
    own: &mut [Row<S, N>],
    group: &Eliminated,
    a: &[Complex<f64>],
    rest: &[Row<S, N>],
) {
    let width = own.len();
    let first = group.from + width;
    for (below, a) in pieces(group, a) {
        bring(a);
        for (rows, values) in below.chunks(GROUP).zip(a.chunks(GROUP * width)) {
            if rows.len() == GROUP {
                let values = split(values, width);
                let (mut factors, mut others) = ([zero(simd); GROUP], [zero(simd); GROUP]);
                for ((factor, other), &row) in factors.iter_mut().zip(&mut others).zip(rows) {
                    *factor = negative(simd, rest[row - first]);
                    *other = turned(simd, *factor);
                }
                for (at, x) in own.iter_mut().enumerate() {
                    let mut sum = *x;
                    for ((values, &factor), &other) in values.iter().zip(&factors).zip(&others) {
                        sum = plus(simd, sum, values[at], factor, other);
                    }
                    *x = sum;
                }
            } else {
                for (&row, values) in rows.iter().zip(values.chunks(width)) {
                    subtract_column(simd, own, values, rest[row - first]);
                }
            }
        }
    }
}
