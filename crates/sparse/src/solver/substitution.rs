//! Solutions with the factors of [`fronts`](super::fronts), a few right-hand sides at once.
//!
//! A factor is larger than the near caches: it is read once, from end to end, and what comes next is brought near meanwhile.

use faer::Mat;
use num_complex::Complex;
use pulp::Simd;

use super::branches::Part;
use super::fronts::{Eliminated, Elimination, Factors, PartFactors};
use super::in_threads::in_threads;
use super::lanes::{
    GROUP, Kernel, Row, add, bring, columns, compute, gathered, joined, minus, negative, plus, scatter, times, turned,
    zero,
};
use super::products::Side;

/// Coefficients that are brought near at once: many, so that memory is waited for rarely, and a small part of the second cache. Measured.
const PIECE: usize = 2048;

type Block = Mat<Complex<f64>>;

/// `A^-1 x`, or `A^-T x`, in place, of the columns of a block; the same with any number of threads.
pub(super) fn substitute(elimination: &Elimination, factors: &Factors, side: Side, x: &mut Block, threads: usize) {
    let (parts, order) = (elimination.parts(), elimination.order());
    let (Some((last, branches)), Some((of_last, of_branches))) = (parts.split_last(), factors.split_last()) else {
        return;
    };
    let begin = |part: &Part, x: &Block| {
        Mat::from_fn(part.rows.len() + part.border.len(), x.ncols(), |i, j| {
            part.rows.get(i).map_or(Complex::default(), |&place| x[(order[place], j)])
        })
    };
    let forward = |(part, factors): (&Part, &PartFactors)| {
        let mut own = begin(part, x);
        compute(Pass { factors, side, way: Way::Forward, x: &mut own });
        own
    };
    let with_factors = branches.iter().zip(of_branches);
    let begun = in_threads(threads, with_factors.clone().collect(), forward);
    let mut whole = begin(last, x);
    for (part, own) in branches.iter().zip(&begun) {
        for j in 0..x.ncols() {
            let change = &own.col_as_slice(j)[part.rows.len()..];
            part.border.iter().zip(change).for_each(|(&row, value)| whole[(row, j)] += value);
        }
    }
    compute(Pass { factors: of_last, side, way: Way::Both, x: &mut whole });
    let backward = |((part, factors), mut own): ((&Part, &PartFactors), Block)| {
        for j in 0..own.ncols() {
            let border = &mut own.col_as_slice_mut(j)[part.rows.len()..];
            part.border.iter().zip(border).for_each(|(&row, value)| *value = whole[(row, j)]);
        }
        compute(Pass { factors, side, way: Way::Backward, x: &mut own });
        own
    };
    let done = in_threads(threads, with_factors.zip(begun).collect(), backward);
    for (part, own) in branches.iter().zip(&done).chain([(last, &whole)]) {
        for j in 0..x.ncols() {
            part.rows.iter().zip(own.col_as_slice(j)).for_each(|(&place, value)| x[(order[place], j)] = *value);
        }
    }
}

/// Which factor a pass goes through.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    Forward,
    Backward,
    Both,
}

/// Pass through the factors of a part, in place, of the columns of a block of its rows.
struct Pass<'a> {
    factors: &'a PartFactors,
    side: Side,
    way: Way,
    x: &'a mut Block,
}

impl Kernel for Pass<'_> {
    #[inline(always)]
    fn run<S: Simd, const N: usize>(self, simd: S) {
        let PartFactors { groups, lower, upper } = self.factors;
        let (first, last) = if self.side == Side::Right { (lower, upper) } else { (upper, lower) };
        let mut permuted = Vec::new();
        for from in (0..self.x.ncols()).step_by(columns::<S, N>()) {
            let mut x: Vec<Row<S, N>> = gathered(simd, self.x, from);
            let mut near = Near { factor: first, border: 0 };
            for group in groups.iter().filter(|_| self.way != Way::Backward) {
                let own = &mut x[group.from..group.from + group.width()];
                if self.side == Side::Right {
                    permuted.clear();
                    permuted.extend(group.pivots.iter().map(|&pivot| own[pivot]));
                    own.copy_from_slice(&permuted);
                }
                forward(simd, group, &mut near, &mut x[group.from..]);
            }
            let mut near = Near { factor: last, border: last.len() };
            for group in groups.iter().rev().filter(|_| self.way != Way::Forward) {
                backward(simd, group, &mut near, &mut x[group.from..]);
                let own = &mut x[group.from..group.from + group.width()];
                if self.side == Side::Left {
                    permuted.clear();
                    permuted.extend_from_slice(own);
                    group.pivots.iter().zip(&permuted).for_each(|(&pivot, value)| own[pivot] = *value);
                }
            }
            scatter::<S, N>(&x, self.x, from);
        }
    }
}

/// `own = T^-1 own`, `below -= B own`, then `own = D^-1 own`, with the rows T and B of a factor; x begins with the rows of the group.
#[inline(always)]
fn forward<S: Simd, const N: usize>(simd: S, group: &Eliminated, near: &mut Near<'_>, x: &mut [Row<S, N>]) {
    let factor = near.factor;
    let width = group.width();
    let whole = width - width % GROUP;
    let (own, rest) = x.split_at_mut(width);
    for k in (0..whole).step_by(GROUP) {
        let (done, left) = own.split_at_mut(k);
        let rows: [&[Complex<f64>]; GROUP] = std::array::from_fn(|i| &factor[group.own_row(k + i)]);
        near.up_to(group.own_row(k + GROUP).start);
        for (x, sum) in left.iter_mut().zip(dots(simd, rows, done)) {
            *x = minus(simd, *x, sum);
        }
        for (i, row) in rows.iter().enumerate() {
            let (done, left) = left.split_at_mut(i);
            left[0] = minus(simd, left[0], dot(simd, &row[k..], done));
        }
    }
    for k in whole..width {
        let (done, left) = own.split_at_mut(k);
        left[0] = minus(simd, left[0], dot(simd, &factor[group.own_row(k)], done));
    }
    let first = group.from + width;
    for (at, below) in group.below.chunks(GROUP).enumerate() {
        let at = at * GROUP;
        near.up_to(group.row_below(at + below.len()).start);
        if below.len() == GROUP {
            let rows = std::array::from_fn(|i| &factor[group.row_below(at + i)]);
            for (&row, sum) in below.iter().zip(dots(simd, rows, own)) {
                rest[row - first] = minus(simd, rest[row - first], sum);
            }
        } else {
            for (i, &row) in below.iter().enumerate() {
                let sum = dot(simd, &factor[group.row_below(at + i)], own);
                rest[row - first] = minus(simd, rest[row - first], sum);
            }
        }
    }
    for (x, &inverse) in own.iter_mut().zip(&group.inverses) {
        *x = times(simd, inverse, *x);
    }
}

/// `own = T^-T (own - B^T below)`, with the rows T and B of a factor; x begins with the rows of the group.
#[inline(always)]
fn backward<S: Simd, const N: usize>(simd: S, group: &Eliminated, near: &mut Near<'_>, x: &mut [Row<S, N>]) {
    let factor = near.factor;
    let width = group.width();
    let whole = width - width % GROUP;
    let (own, rest) = x.split_at_mut(width);
    let first = group.from + width;
    for (at, below) in group.below.chunks(GROUP).enumerate().rev() {
        let at = at * GROUP;
        near.down_to(group.row_below(at).start);
        if below.len() == GROUP {
            let rows = std::array::from_fn(|i| &factor[group.row_below(at + i)]);
            subtract_all(simd, own, rows, std::array::from_fn(|i| rest[below[i] - first]));
        } else {
            for (i, &row) in below.iter().enumerate() {
                subtract(simd, own, &factor[group.row_below(at + i)], rest[row - first]);
            }
        }
    }
    for k in (whole..width).rev() {
        let (left, done) = own.split_at_mut(k);
        subtract(simd, left, &factor[group.own_row(k)], done[0]);
    }
    for k in (0..whole).step_by(GROUP).rev() {
        let (left, done) = own.split_at_mut(k);
        let rows: [&[Complex<f64>]; GROUP] = std::array::from_fn(|i| &factor[group.own_row(k + i)]);
        near.down_to(group.own_row(k).start);
        for (i, row) in rows.iter().enumerate().rev() {
            let (left, done) = done.split_at_mut(i);
            subtract(simd, left, &row[k..], done[0]);
        }
        subtract_all(simd, left, rows, std::array::from_fn(|i| done[i]));
    }
}

/// A factor, the part of it that is near.
struct Near<'a> {
    factor: &'a [Complex<f64>],
    border: usize,
}

impl Near<'_> {
    /// Brings what is before `to`, of a factor that is read from the first entry on.
    #[inline(always)]
    fn up_to(&mut self, to: usize) {
        while self.border < to {
            let from = self.border;
            self.border = (from + PIECE).min(self.factor.len());
            bring(self.factor[from..self.border].iter());
        }
    }

    /// Brings what is from `from` on, of a factor that is read from the last entry on.
    #[inline(always)]
    fn down_to(&mut self, from: usize) {
        while self.border > from {
            let to = self.border;
            self.border = to.saturating_sub(PIECE);
            bring(self.factor[self.border..to].iter().rev());
        }
    }
}

/// `a^T x`.
#[inline(always)]
fn dot<S: Simd, const N: usize>(simd: S, a: &[Complex<f64>], x: &[Row<S, N>]) -> Row<S, N> {
    let mut sum = [zero(simd); 2];
    for (&value, &x) in a.iter().zip(x) {
        add(simd, &mut sum, value, x);
    }
    joined(simd, sum)
}

/// `a^T x` of a few rows, which may be longer than x.
#[inline(always)]
fn dots<S: Simd, const N: usize>(simd: S, rows: [&[Complex<f64>]; GROUP], x: &[Row<S, N>]) -> [Row<S, N>; GROUP] {
    let rows = rows.map(|row| &row[..x.len()]);
    let mut sums = [zero(simd); GROUP];
    // As many sums at once as registers hold.
    if N == 1 {
        let mut halves = [[zero(simd); 2]; GROUP];
        for (at, &x) in x.iter().enumerate() {
            for (sum, row) in halves.iter_mut().zip(rows) {
                add(simd, sum, row[at], x);
            }
        }
        for (sum, halves) in sums.iter_mut().zip(halves) {
            *sum = joined(simd, halves);
        }
    } else {
        for (at, &x) in x.iter().enumerate() {
            let other = turned(simd, x);
            for (sum, row) in sums.iter_mut().zip(rows) {
                *sum = plus(simd, *sum, row[at], x, other);
            }
        }
    }
    sums
}

/// `x -= a factor`.
#[inline(always)]
fn subtract<S: Simd, const N: usize>(simd: S, x: &mut [Row<S, N>], a: &[Complex<f64>], factor: Row<S, N>) {
    let factor = negative(simd, factor);
    let other = turned(simd, factor);
    for (x, &value) in x.iter_mut().zip(a) {
        *x = plus(simd, *x, value, factor, other);
    }
}

/// `x -= a factor` of a few rows a, which may be longer than x, each with its factor.
#[inline(always)]
fn subtract_all<S: Simd, const N: usize>(
    simd: S,
    x: &mut [Row<S, N>],
    rows: [&[Complex<f64>]; GROUP],
    mut factors: [Row<S, N>; GROUP],
) {
    let rows = rows.map(|row| &row[..x.len()]);
    let mut others = factors;
    for (factor, other) in factors.iter_mut().zip(&mut others) {
        *factor = negative(simd, *factor);
        *other = turned(simd, *factor);
    }
    for (at, x) in x.iter_mut().enumerate() {
        let mut sum = *x;
        for ((row, &factor), &other) in rows.iter().zip(&factors).zip(&others) {
            sum = plus(simd, sum, row[at], factor, other);
        }
        *x = sum;
    }
}
