//! Reduction to Hessenberg form by Householder reflections (Golub and Van Loan, Matrix Computations, section 7.4.3).
//!
//! A reflection P = I - beta w w^T takes A to `P A P = A - w p^T - q w^T`, where with u = A^T w, v = A w and g = w^T A w
//!
//! ```text
//! p = beta u - (beta^2 g / 2) w,    q = beta v - (beta^2 g / 2) w,
//! ```
//!
//! so that each reflection reads A once for its products and once for its change. w ends with the column that it was
//! made of: the reflections of companion matrices and band matrices are short at first.

use pulp::{Arch, Simd, WithSimd};

use super::columns::{COLUMNS, dots, subtract};
use super::lane::Lane;
use super::planar::{Planar, Reflector};
use crate::lanes::Ops;

/// `a`, square, made upper Hessenberg by an orthogonal similarity; what is below the subdiagonal is zero.
pub(crate) fn reduce_to_hessenberg<T: Lane>(a: &mut Planar<T>) {
    let (size, arch) = (a.rows(), Arch::new());
    for j in 0..size.saturating_sub(2) {
        let row = j + 1;
        let Some(reflector) = a.reflector(row, j) else { continue };
        a.reflect_column(row, j, &reflector);
        (j + 2..size).for_each(|i| a.set(i, j, T::default()));
        let (mut q, mut p) = (vec![0.0; T::PLANES * size], vec![0.0; T::PLANES * (size - row)]);
        let sums = [&mut q[..], &mut p[..]];
        arch.dispatch(Products { columns: a.columns_from(row), plane: size, row, reflector: &reflector, sums });
        turn_into_factors(&reflector, row, [&mut q, &mut p]);
        let columns = a.columns_from_mut(row);
        arch.dispatch(Change { columns, plane: size, row, reflector: &reflector, q: &q, p: &p });
    }
}

/// v becomes q, and u becomes p; w begins in this row.
fn turn_into_factors<T: Lane>(reflector: &Reflector<T>, row: usize, [v, u]: [&mut [f64]; 2]) {
    let (beta, length) = (reflector.beta(), reflector.len());
    let (rows, columns) = (v.len() / T::PLANES, u.len() / T::PLANES);
    let inner = (0..length).fold(T::default(), |g, i| g + reflector.at(i) * T::assembled(&u[i..], columns));
    let half = beta * beta * inner * T::from(0.5);
    for (sums, count, start) in [(v, rows, row), (u, columns, 0)] {
        for i in 0..count {
            let scaled = beta * T::assembled(&sums[i..], count);
            let inside = (start..start + length).contains(&i);
            let own = if inside { half * reflector.at(i - start) } else { T::default() };
            (scaled - own).disassembled(&mut sums[i..], count);
        }
    }
}

/// The products `v = A w` and `u = A^T w`; w begins in row `row`, and `columns` are the columns of A from there on.
struct Products<'a, T> {
    columns: &'a [f64],
    plane: usize,
    row: usize,
    reflector: &'a Reflector<T>,
    /// v and u, zero so far.
    sums: [&'a mut [f64]; 2],
}

impl<T: Lane> WithSimd for Products<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { columns, plane, row, reflector, sums: [v, u] } = self;
        let (o, count, length) = (Ops::new(simd), u.len() / T::PLANES, reflector.len());
        for (number, columns) in columns.chunks(COLUMNS * T::PLANES * plane).enumerate() {
            let first = number * COLUMNS;
            if first + COLUMNS <= length.min(count) {
                let dots = dots::<T, S, COLUMNS>(o, columns, plane, row, reflector.planes());
                dots.iter().enumerate().for_each(|(k, dot)| dot.disassembled(&mut u[first + k..], count));
                add_columns::<T, S, COLUMNS>(o, columns, plane, (reflector, first), v);
                continue;
            }
            for (k, column) in columns.chunks_exact(T::PLANES * plane).enumerate() {
                let [dot] = dots::<T, S, 1>(o, column, plane, row, reflector.planes());
                dot.disassembled(&mut u[first + k..], count);
                if first + k < length {
                    add_columns::<T, S, 1>(o, column, plane, (reflector, first + k), v);
                }
            }
        }
    }
}

/// `v += w[first] column + w[first + 1] next column + ...`, of `N` columns.
#[inline(always)]
fn add_columns<T: Lane, S: Simd, const N: usize>(
    o: Ops<S>,
    columns: &[f64],
    plane: usize,
    (reflector, first): (&Reflector<T>, usize),
    v: &mut [f64],
) {
    let mut factors = [T::splat(o, T::default()); N];
    for (k, factor) in factors.iter_mut().enumerate() {
        *factor = T::splat(o, reflector.at(first + k));
    }
    let mut at = 0;
    while at < plane {
        let part = (at, plane.min(at + S::F64_LANES));
        let mut sum = T::load(o, v, plane, part);
        for (&factor, column) in factors.iter().zip(columns.chunks_exact(T::PLANES * plane)) {
            sum = T::plus_times(o, sum, factor, T::load(o, column, plane, part));
        }
        T::store(o, v, plane, part, sum);
        at = part.1;
    }
}

/// `A - w p^T - q w^T` in the columns of A from `row` on, where w begins.
struct Change<'a, T> {
    columns: &'a mut [f64],
    plane: usize,
    row: usize,
    reflector: &'a Reflector<T>,
    q: &'a [f64],
    p: &'a [f64],
}

impl<T: Lane> WithSimd for Change<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { columns, plane, row, reflector, q, p } = self;
        let (o, length, count) = (Ops::new(simd), reflector.len(), p.len() / T::PLANES);
        for (k, column) in columns.chunks_exact_mut(T::PLANES * plane).enumerate() {
            let by = T::splat(o, T::assembled(&p[k..], count));
            subtract::<T, S>(o, (column, plane), row..row + length, (reflector.planes(), length), by);
            if k < length {
                subtract::<T, S>(o, (column, plane), 0..plane, (q, plane), T::splat(o, reflector.at(k)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dd::Dd;
    use crate::fixtures::wave;
    use nalgebra::DMatrix;

    /// Traces of powers stay, and the result has Hessenberg form: of a full matrix with columns beyond a group and a
    /// register, and of a band matrix, whose reflections are short.
    #[test]
    fn reduction_keeps_the_traces_of_powers() {
        let n = 23;
        let full = DMatrix::from_fn(n, n, wave);
        let band = DMatrix::from_fn(n, n, |i, j| if i <= j + 5 { wave(i, j) } else { 0.0 });
        for a in [full, band] {
            check::<f64>(&a);
            check::<Dd>(&a);
        }
    }

    fn check<T: Lane>(a: &DMatrix<f64>) {
        let n = a.nrows();
        let mut reduced = Planar::<T>::from(a);
        reduce_to_hessenberg(&mut reduced);
        let h = DMatrix::from_fn(n, n, |i, j| reduced.get(i, j).value());
        assert!((0..n).all(|j| (j + 2..n).all(|i| h[(i, j)] == 0.0)));
        assert!((h.norm() - a.norm()).abs() < 1e-14 * a.norm());
        let (mut left, mut right) = (DMatrix::identity(n, n), DMatrix::identity(n, n));
        for _ in 0..4 {
            (left, right) = (left * a, right * &h);
            assert!((left.trace() - right.trace()).abs() < 1e-13 * left.norm());
        }
    }
}
