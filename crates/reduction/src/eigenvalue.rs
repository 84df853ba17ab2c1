//! `lambda - A` of a small complex matrix A, factored: its determinant, and the eigenvalue next to lambda.

use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd};

use super::elimination::Elimination;
use super::rows::Rows;
use cea::certified::lanes::Precision;

struct Factor<'a, T> {
    matrix: &'a mut Rows<T>,
    elimination: &'a mut Elimination<T>,
    order: usize,
}

impl<T: Precision> WithSimd for Factor<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.elimination.factor(simd, self.matrix, self.order);
    }
}

/// Factors of `lambda + B`; the matrix B, here -A, is overwritten.
pub(super) fn factor<T: Precision>(
    matrix: &mut Rows<T>,
    lambda: Complex<T>,
    elimination: &mut Elimination<T>,
    order: usize,
) {
    factor_with(matrix, |_| lambda, elimination, order);
}

/// Factors of `D + B` with a diagonal matrix D; the matrix B is overwritten.
pub(super) fn factor_with<T: Precision>(
    matrix: &mut Rows<T>,
    diagonal: impl Fn(usize) -> Complex<T>,
    elimination: &mut Elimination<T>,
    order: usize,
) {
    (0..order).for_each(|i| matrix.set(i, i, matrix.at(i, i) + diagonal(i)));
    Arch::new().dispatch(Factor { matrix, elimination, order });
}

/// The eigenvalue of A next to `lambda` by steps of inverse iteration from a vector, which is replaced by its own; A is overwritten.
pub(super) fn next_to(
    a: &mut Rows,
    lambda: Complex<f64>,
    vector: &mut [Complex<f64>],
    steps: usize,
    elimination: &mut Elimination,
) -> Complex<f64> {
    a.negate();
    factor(a, lambda, elimination, vector.len());
    lambda + apart(a, vector, steps, elimination)
}

/// How far the eigenvalue of A next to a number is from it, given factors of the number minus A, and its vector as in [`next_to`].
pub(super) fn apart<T: Precision>(
    factors: &Rows<T>,
    vector: &mut [Complex<T>],
    steps: usize,
    elimination: &Elimination<T>,
) -> Complex<T> {
    let (mut apart, mut next) = (Complex::default(), vector.to_vec());
    for _ in 0..steps {
        next.copy_from_slice(vector);
        elimination.solve(factors, &mut next);
        let along: Complex<T> = vector.iter().zip(&next).map(|(v, next)| v.conj() * next).sum();
        apart = -along.inv() * norm_squared(vector);
        normalise(&mut next);
        vector.copy_from_slice(&next);
    }
    apart
}

/// The left vector of the eigenvalue that [`next_to`] found, from what it left of A, up to a factor.
pub(super) fn left<T: Precision>(
    factors: &Rows<T>,
    right: &[Complex<T>],
    elimination: &Elimination<T>,
) -> Vec<Complex<T>> {
    let mut left = right.to_vec();
    for _ in 0..2 {
        elimination.solve_adjoint(factors, &mut left);
        normalise(&mut left);
    }
    left
}

fn normalise<T: Precision>(vector: &mut [Complex<T>]) {
    let size = norm_squared(vector).sqrt();
    vector.iter_mut().for_each(|entry| *entry /= size);
}

fn norm_squared<T: Precision>(vector: &[Complex<T>]) -> T {
    vector.iter().fold(T::default(), |sum, entry| sum + entry.norm_sqr())
}
