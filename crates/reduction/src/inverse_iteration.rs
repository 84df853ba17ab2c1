//! Inverse iteration on both sides: from a guess to an eigenvalue of a dense nonlinear problem.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::dense;

/// Largest distance of two results of the iteration that are one eigenvalue, relative to |lambda|; chosen: settled eigenvalues differ by less.
const ONE_EIGENVALUE: f64 = 1e-7;
/// Least cosine between their shapes; chosen: shapes of a double eigenvalue may be any, and are two if they differ by more.
const ONE_SHAPE: f64 = 0.9;

/// An eigenvalue, rad/s, with its shape.
pub(super) type Pair = (Complex<f64>, DVector<Complex<f64>>);

/// Problem `T(lambda) x = 0`: T, its product with a vector, and the product of its derivative with a vector.
pub(super) struct Nonlinear<M, I, S> {
    pub matrix: M,
    pub image: I,
    pub slope: S,
}

impl<M, I, S> Nonlinear<M, I, S>
where
    M: Fn(Complex<f64>) -> DMatrix<Complex<f64>>,
    I: Fn(Complex<f64>, &DVector<Complex<f64>>) -> DVector<Complex<f64>>,
    S: Fn(Complex<f64>, &DVector<Complex<f64>>) -> DVector<Complex<f64>>,
{
    /// The eigenvalue, with its shape, to which a guess leads within `most` iterations, once it `is_settled`, given its last change; `None` where it does not
    /// settle, or moves farther than `error`, relative to |lambda|.
    pub fn led_from(
        &self,
        (guess, shape): Pair,
        (error, most): (f64, usize),
        is_settled: impl Fn(Complex<f64>, &DVector<Complex<f64>>, f64) -> bool,
    ) -> Option<Pair> {
        let (mut lambda, mut right, mut left) = (guess, shape.clone(), shape);
        for _ in 0..most {
            let factors = dense::Factored::new(&(self.matrix)(lambda));
            right = factors.solve(&(self.slope)(lambda, &right)).ok()?.normalize();
            left = factors.solve_adjoint(&left).ok()?.normalize();
            let step = left.dotc(&(self.image)(lambda, &right)) / left.dotc(&(self.slope)(lambda, &right));
            lambda -= step;
            let moved = (lambda - guess).norm();
            if moved.is_nan() || moved > error * guess.norm() {
                return None;
            }
            if is_settled(lambda, &right, step.norm()) {
                return Some((lambda, right));
            }
        }
        None
    }
}

/// True if two modes became one.
pub(super) fn have_merged(modes: &[Pair]) -> bool {
    let is_one = |i: usize, j: usize| {
        let ((lambda, shape), (other, other_shape)) = (&modes[i], &modes[j]);
        (lambda - other).norm() <= ONE_EIGENVALUE * lambda.norm() && shape.dotc(other_shape).norm() > ONE_SHAPE
    };
    (0..modes.len()).any(|i| (0..i).any(|j| is_one(i, j)))
}
