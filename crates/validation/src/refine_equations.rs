//! The equations of [`crate::refine()`] in double-double arithmetic, and their Jacobian in double precision.

use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use twofloat::TwoFloat;

/// A complex number with twice the digits of doubles.
pub(crate) type Long = Complex<TwoFloat>;

/// The Jacobian of the equations with S = lambda I, (n + s + k) x (n + s + k).
pub(crate) fn bordered(
    system: &SecondOrder,
    lambda: Complex<f64>,
    w: &[DVector<Complex<f64>>],
) -> DMatrix<Complex<f64>> {
    let (n, s, k) = (system.order(), system.states(), w.len());
    let mut matrix = DMatrix::zeros(n + s + k, n + s + k);
    let square = lambda * lambda;
    for j in 0..n {
        for i in 0..n {
            matrix[(i, j)] = square * system.m[(i, j)] + lambda * system.c[(i, j)] + system.k[(i, j)];
            for (column, w) in w.iter().enumerate() {
                matrix[(i, n + s + column)] += (2.0 * lambda * system.m[(i, j)] + system.c[(i, j)]) * w[j];
            }
        }
        for i in 0..s {
            matrix[(n + i, j)] = -lambda * system.internal.drive[(i, j)];
            matrix[(j, n + i)] = Complex::from(-system.internal.force[(j, i)]);
            for (column, w) in w.iter().enumerate() {
                matrix[(n + i, n + s + column)] -= system.internal.drive[(i, j)] * w[j];
            }
        }
    }
    for (column, w) in w.iter().enumerate() {
        for i in 0..s {
            matrix[(n + i, n + i)] = lambda + system.internal.decay[i];
            matrix[(n + i, n + s + column)] += w[n + i];
        }
        for j in 0..n + s {
            matrix[(n + s + column, j)] = w[j].conj();
        }
    }
    matrix
}

/// The left-hand sides of the first two equations, from W, W S and W S^2, computed in double-double and rounded at the end.
pub(crate) fn residuals(
    system: &SecondOrder,
    w: &[Vec<Long>],
    first: &[Vec<Long>],
    second: &[Vec<Long>],
) -> Vec<DVector<Complex<f64>>> {
    let (n, s) = (system.order(), system.states());
    let of_column = |((w, first), second): ((&Vec<Long>, &Vec<Long>), &Vec<Long>)| {
        let mut sums = vec![long(Complex::default()); n + s];
        for j in 0..n {
            for (i, sum) in sums[..n].iter_mut().enumerate() {
                add(sum, second[j], system.m[(i, j)]);
                add(sum, first[j], system.c[(i, j)]);
                add(sum, w[j], system.k[(i, j)]);
            }
            for i in 0..s {
                add(&mut sums[n + i], first[j], -system.internal.drive[(i, j)]);
                add(&mut sums[j], w[n + i], -system.internal.force[(j, i)]);
            }
        }
        for i in 0..s {
            add(&mut sums[n + i], w[n + i], system.internal.decay[i]);
            sums[n + i] += first[n + i];
        }
        DVector::from_iterator(n + s, sums.into_iter().map(short))
    };
    w.iter().zip(first).zip(second).map(of_column).collect()
}

/// `W S`, where both matrices are given by columns.
pub(crate) fn product(w: &[Vec<Long>], small: &[Vec<Long>]) -> Vec<Vec<Long>> {
    let entry = |row: usize, column: &Vec<Long>| {
        w.iter().zip(column).fold(long(Complex::default()), |sum, (w, &s)| sum + w[row] * s)
    };
    small.iter().map(|column| (0..w[0].len()).map(|row| entry(row, column)).collect()).collect()
}

fn add(sum: &mut Long, factor: Long, entry: f64) {
    if entry != 0.0 {
        sum.re += factor.re * entry;
        sum.im += factor.im * entry;
    }
}

/// The number in double-double.
pub(crate) fn long(z: Complex<f64>) -> Long {
    Complex::new(TwoFloat::from(z.re), TwoFloat::from(z.im))
}

/// The number with each part rounded to a double.
pub(crate) fn short(z: Long) -> Complex<f64> {
    Complex::new(f64::from(z.re), f64::from(z.im))
}
