//! Products of the columns of a basis with a block, and of a basis with coordinates.

use std::ops::Range;

use faer::Mat;
use num_complex::Complex;
use pulp::Simd;

use super::lanes::{
    Halves, Kernel, Row, add, columns, compute, gathered, joined_conjugate, negative, plus, scatter, turned, zero,
};

/// Number of rows that are multiplied with all columns of a basis before the next ones; chosen: they stay in the nearest cache.
const CHUNK: usize = 256;

type Block = Mat<Complex<f64>>;

/// `V^H X` of the columns of V, with as many of its rows as X has; `X - V V^H X` takes the place of X.
pub(super) fn remove(v: &[Vec<Complex<f64>>], x: &mut Block) -> Block {
    let mut product = Mat::zeros(v.len(), x.ncols());
    let columns: Vec<_> = v.iter().map(|column| &column[..x.nrows()]).collect();
    compute(Removal { columns: &columns, x, product: &mut product });
    product
}

/// `X + V C` with as many columns of V as C has rows, and as many of its rows as X has.
pub(super) fn add_times(x: &mut Block, v: &[Vec<Complex<f64>>], c: &Block) {
    let columns: Vec<_> = v[..c.nrows()].iter().map(|column| &column[..x.nrows()]).collect();
    compute(Sums { columns: &columns, c, x });
}

struct Removal<'a> {
    columns: &'a [&'a [Complex<f64>]],
    x: &'a mut Block,
    product: &'a mut Block,
}

impl Kernel for Removal<'_> {
    #[inline(always)]
    fn run<S: Simd, const N: usize>(self, simd: S) {
        let starts = (0..self.x.ncols()).step_by(columns::<S, N>());
        let mut groups: Vec<Vec<Row<S, N>>> = starts.clone().map(|from| gathered(simd, self.x, from)).collect();
        let mut dots = vec![vec![[zero::<S, N>(simd); 2]; self.columns.len()]; groups.len()];
        for from in (0..self.x.nrows()).step_by(CHUNK) {
            let chunk = from..self.x.nrows().min(from + CHUNK);
            for (x, dots) in groups.iter().zip(&mut dots) {
                // As many sums at once as registers hold.
                if N == 1 {
                    add_dots::<S, N, 8>(simd, self.columns, chunk.clone(), x, dots);
                } else {
                    add_dots::<S, N, 2>(simd, self.columns, chunk.clone(), x, dots);
                }
            }
        }
        let mut factors: Vec<Vec<Row<S, N>>> = Vec::with_capacity(groups.len());
        for (from, dots) in starts.clone().zip(dots) {
            let mut rows: Vec<Row<S, N>> = Vec::with_capacity(dots.len());
            for halves in dots {
                rows.push(joined_conjugate(simd, halves));
            }
            scatter::<S, N>(&rows, self.product, from);
            for row in &mut rows {
                *row = negative(simd, *row);
            }
            factors.push(rows);
        }
        add_all(simd, self.columns, &factors, &mut groups);
        starts.zip(&groups).for_each(|(from, rows)| scatter::<S, N>(rows, self.x, from));
    }
}

/// Adds the products of `rows`, T columns at a time.
#[inline(always)]
fn add_dots<S: Simd, const N: usize, const T: usize>(
    simd: S,
    columns: &[&[Complex<f64>]],
    rows: Range<usize>,
    x: &[Row<S, N>],
    dots: &mut [Halves<S, N>],
) {
    let x = &x[rows.clone()];
    let (together, rest) = columns.as_chunks::<T>();
    let (sums, rest_sums) = dots.as_chunks_mut::<T>();
    for (columns, dots) in together.iter().zip(sums) {
        let columns = columns.map(|column| &column[rows.clone()]);
        let mut sums = *dots;
        for (i, &x) in x.iter().enumerate() {
            for (sum, column) in sums.iter_mut().zip(columns) {
                add(simd, sum, column[i], x);
            }
        }
        *dots = sums;
    }
    for (column, sum) in rest.iter().zip(rest_sums) {
        for (&value, &x) in column[rows.clone()].iter().zip(x) {
            add(simd, sum, value, x);
        }
    }
}

struct Sums<'a> {
    columns: &'a [&'a [Complex<f64>]],
    c: &'a Block,
    x: &'a mut Block,
}

impl Kernel for Sums<'_> {
    #[inline(always)]
    fn run<S: Simd, const N: usize>(self, simd: S) {
        let starts = (0..self.x.ncols()).step_by(columns::<S, N>());
        let mut groups: Vec<Vec<Row<S, N>>> = starts.clone().map(|from| gathered(simd, self.x, from)).collect();
        let factors: Vec<Vec<Row<S, N>>> = starts.clone().map(|from| gathered(simd, self.c, from)).collect();
        add_all(simd, self.columns, &factors, &mut groups);
        starts.zip(&groups).for_each(|(from, rows)| scatter::<S, N>(rows, self.x, from));
    }
}

/// Adds the columns times their factors to groups of rows.
#[inline(always)]
fn add_all<S: Simd, const N: usize>(
    simd: S,
    columns: &[&[Complex<f64>]],
    factors: &[Vec<Row<S, N>>],
    groups: &mut [Vec<Row<S, N>>],
) {
    let rows = groups.first().map_or(0, Vec::len);
    for from in (0..rows).step_by(CHUNK) {
        let chunk = from..rows.min(from + CHUNK);
        for (x, factors) in groups.iter_mut().zip(factors) {
            // As many factors at once as registers hold.
            if N == 1 {
                add_columns::<S, N, 8>(simd, columns, chunk.clone(), factors, x);
            } else {
                add_columns::<S, N, 4>(simd, columns, chunk.clone(), factors, x);
            }
        }
    }
}

/// Adds the columns times their factors to `rows`, T columns at a time.
#[inline(always)]
fn add_columns<S: Simd, const N: usize, const T: usize>(
    simd: S,
    columns: &[&[Complex<f64>]],
    rows: Range<usize>,
    factors: &[Row<S, N>],
    x: &mut [Row<S, N>],
) {
    let x = &mut x[rows.clone()];
    let (together, rest) = columns.as_chunks::<T>();
    let (factors, rest_factors) = factors.as_chunks::<T>();
    for (columns, &factors) in together.iter().zip(factors) {
        let columns = columns.map(|column| &column[rows.clone()]);
        let mut others = factors;
        for other in &mut others {
            *other = turned(simd, *other);
        }
        for (i, x) in x.iter_mut().enumerate() {
            let mut sum = *x;
            for ((column, factor), other) in columns.iter().zip(factors).zip(others) {
                sum = plus(simd, sum, column[i], factor, other);
            }
            *x = sum;
        }
    }
    for (column, &factor) in rest.iter().zip(rest_factors) {
        let other = turned(simd, factor);
        for (&value, x) in column[rows.clone()].iter().zip(&mut *x) {
            *x = plus(simd, *x, value, factor, other);
        }
    }
}
