//! Complex vectors as the columns of a real matrix, so that products with real matrices are real products.
//!
//! m vectors of length n are an n x 2 m matrix: column j holds the real part of vector j, column m + j its imaginary part.

use nalgebra::{DMatrix, DVector, DVectorView};
use num_complex::Complex;

use super::dense::product;

/// Vectors of length n, split.
pub(super) fn zeros(length: usize, vectors: usize) -> DMatrix<f64> {
    DMatrix::zeros(length, 2 * vectors)
}

/// Splits the columns of a complex matrix.
pub(super) fn from_columns(columns: &DMatrix<Complex<f64>>) -> DMatrix<f64> {
    let mut out = zeros(columns.nrows(), columns.ncols());
    for (at, column) in columns.column_iter().enumerate() {
        set(&mut out, at, column.iter().copied());
    }
    out
}

/// The number of vectors.
pub(super) fn count(split: &DMatrix<f64>) -> usize {
    split.ncols() / 2
}

/// The parts of vector `at`.
pub(super) fn parts(split: &DMatrix<f64>, at: usize) -> (DVectorView<'_, f64>, DVectorView<'_, f64>) {
    (split.column(at), split.column(count(split) + at))
}

/// Vector `at` as complex numbers.
pub(super) fn vector(split: &DMatrix<f64>, at: usize) -> DVector<Complex<f64>> {
    let (re, im) = parts(split, at);
    DVector::from_iterator(split.nrows(), re.iter().zip(im.iter()).map(|(&re, &im)| Complex::new(re, im)))
}

/// Replaces vector `at`.
pub(super) fn set(split: &mut DMatrix<f64>, at: usize, values: impl Iterator<Item = Complex<f64>>) {
    let (rows, vectors) = (split.nrows(), count(split));
    let (re, im) = split.as_mut_slice().split_at_mut(rows * vectors);
    let (re, im) = (&mut re[at * rows..(at + 1) * rows], &mut im[at * rows..(at + 1) * rows]);
    for ((re, im), value) in re.iter_mut().zip(im).zip(values) {
        (*re, *im) = (value.re, value.im);
    }
}

/// The vectors `wanted`, by their indices.
pub(super) fn selected(split: &DMatrix<f64>, wanted: &[usize]) -> DMatrix<f64> {
    let half = count(split);
    let columns: Vec<usize> = wanted.iter().copied().chain(wanted.iter().map(|&at| half + at)).collect();
    split.select_columns(&columns)
}

/// The vectors of `split`, then those of `more`.
pub(super) fn joined(split: &DMatrix<f64>, more: &DMatrix<f64>) -> DMatrix<f64> {
    let (own, others) = (count(split), count(more));
    let mut out = zeros(split.nrows(), own + others);
    for (half, first) in [(0, 0), (1, own + others)] {
        out.columns_mut(first, own).copy_from(&split.columns(half * own, own));
        out.columns_mut(first + own, others).copy_from(&more.columns(half * others, others));
    }
    out
}

/// The squared 2-norm of vector `at`.
pub(super) fn norm_squared(split: &DMatrix<f64>, at: usize) -> f64 {
    let (re, im) = parts(split, at);
    re.norm_squared() + im.norm_squared()
}

/// The norm of each vector.
pub(super) fn norms(split: &DMatrix<f64>) -> Vec<f64> {
    (0..count(split)).map(|at| norm_squared(split, at).sqrt()).collect()
}

/// `(lambda_j^2 M + lambda_j C + K) y_j` of each vector j, for real matrices of any number of rows.
pub(super) fn quadratic([m, c, k]: [&DMatrix<f64>; 3], lambdas: &[Complex<f64>], y: &DMatrix<f64>) -> DMatrix<f64> {
    combined([&product(m, y), &product(c, y)], product(k, y), lambdas)
}

/// The same of the products of the vectors with M, C and K.
pub(super) fn combined(
    [inertia, damping]: [&DMatrix<f64>; 2],
    stiffness: DMatrix<f64>,
    lambdas: &[Complex<f64>],
) -> DMatrix<f64> {
    let mut out = stiffness;
    let (rows, vectors) = (out.nrows(), lambdas.len());
    let (re, im) = out.as_mut_slice().split_at_mut(rows * vectors);
    for (at, &lambda) in lambdas.iter().enumerate() {
        let square = lambda * lambda;
        let ((c_re, c_im), (m_re, m_im)) = (parts(damping, at), parts(inertia, at));
        let out = re[at * rows..(at + 1) * rows].iter_mut().zip(&mut im[at * rows..(at + 1) * rows]);
        let parts = c_re.iter().zip(c_im.iter()).zip(m_re.iter().zip(m_im.iter()));
        for ((re, im), ((c_re, c_im), (m_re, m_im))) in out.zip(parts) {
            *re += lambda.re * c_re - lambda.im * c_im + square.re * m_re - square.im * m_im;
            *im += lambda.re * c_im + lambda.im * c_re + square.re * m_im + square.im * m_re;
        }
    }
    out
}

/// Adds i times other vectors.
pub(super) fn add_times_i(split: &mut DMatrix<f64>, other: &DMatrix<f64>) {
    let half = count(split);
    let (re, im) = (other.columns(0, half), other.columns(half, half));
    split.columns_mut(0, half).zip_apply(&im, |own, im| *own -= im);
    split.columns_mut(half, half).zip_apply(&re, |own, re| *own += re);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_split_product_is_the_complex_one() {
        let of = |seed: usize| DMatrix::from_fn(3, 2, |i, j| ((seed + 5 * i + 3 * j * i + j) % 7) as f64 - 2.5);
        let [m, c, k] = [of(1), of(2), of(4)];
        let y = DMatrix::from_fn(2, 3, |i, j| Complex::new(i as f64 - 0.3, j as f64 + 0.7 * i as f64));
        let lambdas: Vec<_> = (0..3).map(|j| Complex::new(-0.2 * j as f64, 3.0 + j as f64)).collect();
        let split = from_columns(&y);
        let found = quadratic([&m, &c, &k], &lambdas, &split);
        for (at, &lambda) in lambdas.iter().enumerate() {
            let q = m.map(Complex::from) * lambda * lambda + c.map(Complex::from) * lambda + k.map(Complex::from);
            let expected = q * y.column(at);
            assert!((vector(&found, at) - &expected).norm() < 1e-14 * expected.norm());
            assert!((norm_squared(&found, at) - expected.norm_squared()).abs() < 1e-13 * expected.norm_squared());
        }
        assert_eq!((count(&split), vector(&split, 1)), (3, y.column(1).into_owned()));
    }
}
