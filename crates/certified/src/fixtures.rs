//! Matrices that tests of several files share.

use nalgebra::{DMatrix, dmatrix, dvector};
use num_complex::Complex;

/// An entry of a matrix without structure, between -0.5 and 0.5.
pub(super) fn wave(i: usize, j: usize) -> f64 {
    ((7 * i + 13 * j * j + 3 * i * j) % 31) as f64 / 31.0 - 0.5
}

/// `Q D Z` and `Q Z` of n rows, n even, and their eigenvalues, pairs along a line.
pub(super) fn long_pencil(n: usize) -> (DMatrix<f64>, DMatrix<f64>, Vec<Complex<f64>>) {
    let q = DMatrix::from_fn(n, n, |i, j| wave(i, j) + if i == j { 8.0 } else { 0.0 });
    let z = DMatrix::from_fn(n, n, |i, j| wave(j, i + 5) + if i == j { 8.0 } else { 0.0 });
    let mut d = DMatrix::zeros(n, n);
    let mut expected = Vec::new();
    for k in 0..n / 2 {
        let (re, im) = (0.1 * k as f64 - 1.0, 1.0 + 0.2 * k as f64);
        d.view_mut((2 * k, 2 * k), (2, 2)).copy_from(&dmatrix![re, im; -im, re]);
        expected.extend([Complex::new(re, im), Complex::new(re, -im)]);
    }
    (&q * &d * &z, &q * &z, expected)
}

/// Six known eigenvalues, from 1e-3 to 50, on the diagonal of D, and two matrices that are far from singular.
pub(super) struct Known {
    pub(super) q: DMatrix<f64>,
    pub(super) d: DMatrix<f64>,
    pub(super) z: DMatrix<f64>,
    pub(super) expected: Vec<Complex<f64>>,
}

impl Known {
    /// Known eigenvalues from 72 entries of Q and Z, between -1 and 1, and the angle of the complex pair.
    pub(super) fn new(entries: &[f64], angle: f64) -> Self {
        let q = DMatrix::from_column_slice(6, 6, &entries[..36]) + DMatrix::identity(6, 6) * 5.0;
        let z = DMatrix::from_column_slice(6, 6, &entries[36..]) + DMatrix::identity(6, 6) * 5.0;
        let mut d = DMatrix::from_diagonal(&dvector![0.0, 0.0, 1e-3, 2.0, -3.0, 50.0]);
        let (sin, cos) = angle.sin_cos();
        d.view_mut((0, 0), (2, 2)).copy_from(&dmatrix![cos, sin; -sin, cos]);
        let mut expected: Vec<_> = [1e-3, 2.0, -3.0, 50.0].map(Complex::from).into();
        expected.extend([Complex::new(cos, sin), Complex::new(cos, -sin)]);
        Self { q, d, z, expected }
    }
}
