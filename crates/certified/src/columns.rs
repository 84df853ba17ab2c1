//! Products and sums of long columns of [`Planar`](super::planar::Planar) matrices in vector registers.

use std::marker::PhantomData;
use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::lane::Lane;
use crate::lanes::Ops;

/// Number of columns that a product takes together; chosen: their sums hide how long one of them takes.
pub(super) const COLUMNS: usize = 4;

/// The products of w, which begins in this row, with `N` columns.
#[inline(always)]
pub(super) fn dots<T: Lane, S: Simd, const N: usize>(
    o: Ops<S>,
    columns: &[f64],
    plane: usize,
    row: usize,
    w: &[f64],
) -> [T; N] {
    let length = w.len() / T::PLANES;
    let mut sums = [T::splat(o, T::default()); N];
    let mut at = 0;
    while at < length {
        let end = length.min(at + S::F64_LANES);
        let factor = T::load(o, w, length, (at, end));
        for (sum, column) in sums.iter_mut().zip(columns.chunks_exact(T::PLANES * plane)) {
            *sum = T::plus_times(o, *sum, factor, T::load(o, column, plane, (row + at, row + end)));
        }
        at = end;
    }
    let mut found = [T::default(); N];
    found.iter_mut().zip(sums).for_each(|(found, sum)| *found = T::sum(o, sum));
    found
}

/// `column - by vector` in these rows of the column, of which the vector has the first `rows.len()` entries.
#[inline(always)]
pub(super) fn subtract<T: Lane, S: Simd>(
    o: Ops<S>,
    (column, plane): (&mut [f64], usize),
    rows: Range<usize>,
    (vector, length): (&[f64], usize),
    by: T::In<S::f64s>,
) {
    let mut at = rows.start;
    while at < rows.end {
        let end = rows.end.min(at + S::F64_LANES);
        let vector = T::load(o, vector, length, (at - rows.start, end - rows.start));
        let x = T::minus_times(o, T::load(o, column, plane, (at, end)), vector, by);
        T::store(o, column, plane, (at, end), x);
        at = end;
    }
}

/// `I - beta w w^T` applied to the rows from `row` on of each column of `columns`.
pub(super) struct ReflectManyRows<'a, T> {
    /// The columns, one after the other, and the length of one plane of them.
    pub(super) columns: &'a mut [f64],
    pub(super) plane: usize,
    pub(super) row: usize,
    /// w in planes of its own length.
    pub(super) w: &'a [f64],
    pub(super) beta: T,
}

impl<T: Lane> WithSimd for ReflectManyRows<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { columns, plane, row, w, beta } = self;
        let o = Ops::new(simd);
        let mut groups = columns.chunks_exact_mut(COLUMNS * T::PLANES * plane);
        for columns in groups.by_ref() {
            reflect_columns::<T, S, COLUMNS>(o, columns, (plane, row), (w, beta));
        }
        for column in groups.into_remainder().chunks_exact_mut(T::PLANES * plane) {
            reflect_columns::<T, S, 1>(o, column, (plane, row), (w, beta));
        }
    }
}

#[inline(always)]
fn reflect_columns<T: Lane, S: Simd, const N: usize>(
    o: Ops<S>,
    columns: &mut [f64],
    (plane, row): (usize, usize),
    (w, beta): (&[f64], T),
) {
    let (size, length) = (T::PLANES * plane, w.len() / T::PLANES);
    // Blocks of zeros stand in companion matrices, and in what their reduction leaves.
    if columns.chunks_exact(size).all(|column| column[row..row + length].iter().all(|&x| x == 0.0)) {
        return;
    }
    let sums: [T; N] = dots::<T, S, N>(o, columns, plane, row, w);
    for (column, sum) in columns.chunks_exact_mut(size).zip(sums) {
        subtract::<T, S>(o, (column, plane), row..row + length, (w, length), T::splat(o, sum * beta));
    }
}

/// R^-1 applied to each column of `columns`; R is upper triangular.
pub(super) struct SolveTriangle<'a, T> {
    pub(super) columns: &'a mut [f64],
    /// The columns of R, as long.
    pub(super) r: &'a [f64],
    pub(super) plane: usize,
    /// R's diagonal.
    pub(super) diagonal: &'a [T],
}

impl<T: Lane> WithSimd for SolveTriangle<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { columns, r, plane, diagonal } = self;
        let (o, size) = (Ops::new(simd), T::PLANES * plane);
        // A companion pencil has a unit matrix in B.
        let is_unit = |i: usize| r[i * size..i * size + i].iter().all(|&x| x == 0.0);
        let alone: Vec<bool> = (0..plane).map(is_unit).collect();
        // A division takes as long as the rest of a short column.
        let inverses: Vec<T> = diagonal.iter().map(|&d| T::from(1.0) / d).collect();
        for column in columns.chunks_exact_mut(size) {
            for i in (0..plane).rev() {
                let x = T::assembled(&column[i..], plane) * inverses[i];
                if x.value() == 0.0 {
                    continue;
                }
                x.disassembled(&mut column[i..], plane);
                if !alone[i] {
                    let above = &r[i * size..(i + 1) * size];
                    subtract::<T, S>(o, (column, plane), 0..i, (above, plane), T::splat(o, x));
                }
            }
        }
    }
}

/// `A B` added to `columns`.
pub(super) struct AddProduct<'a, T> {
    pub(super) columns: &'a mut [f64],
    /// The columns of A, as long.
    pub(super) a: &'a [f64],
    pub(super) plane: usize,
    /// The columns of B, as long as A is wide.
    pub(super) b: &'a [f64],
    pub(super) entry: PhantomData<T>,
}

impl<T: Lane> WithSimd for AddProduct<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { columns, a, plane, b, .. } = self;
        let (o, size) = (Ops::new(simd), T::PLANES * plane);
        let inner = a.len() / size;
        for (column, b) in columns.chunks_exact_mut(size).zip(b.chunks_exact(T::PLANES * inner)) {
            for (k, a) in a.chunks_exact(size).enumerate() {
                subtract::<T, S>(o, (column, plane), 0..plane, (a, plane), T::splat(o, -T::assembled(&b[k..], inner)));
            }
        }
    }
}
