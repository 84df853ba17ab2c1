//! From Ritz values to eigenpairs: two-sided Rayleigh quotients, backward errors and condition numbers.

use faer::Mat;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::disc::{Candidate, Problem};
use super::factor::{Factor, length};
use super::pencil::{Pencil, Side};
use super::types::{Counters, Eigenpair};
use crate::SparseError;

/// Steps of the Rayleigh quotient: it converges twice as many digits at each.
const STEPS: usize = 3;
/// Steps of inverse iteration with a factorisation at the eigenvalue itself.
const INVERSE_STEPS: usize = 3;
/// Distance of two eigenvalues, relative, up to which their vectors may be any of a common space.
const ONE_GROUP: f64 = 1e-8;
/// Smallest reciprocal condition of the couplings of a group whose left vectors can be paired with its right ones.
const PAIRED: f64 = 1e-6;

type Vector = DVector<Complex<f64>>;

impl Problem {
    /// The eigenpairs that candidates stand for, each with a backward error of at most `tolerance`.
    ///
    /// # Errors
    /// [`SparseError::NotConverged`] for a candidate that is none.
    pub(crate) fn polish(
        &self,
        candidates: Vec<Candidate>,
        tolerance: f64,
        counters: &mut Counters,
    ) -> Result<Vec<Eigenpair>, SparseError> {
        let pencil = &self.pencil;
        let mut trials = Vec::with_capacity(candidates.len());
        for Candidate { lambda, right, left } in candidates {
            let right = unit(right);
            let trial = left.map(|left| Trial::new(pencil, lambda, right.clone(), unit(left)));
            trials.push(match trial {
                Some(trial) if trial.error.max(trial.left_error(pencil)) <= tolerance => trial,
                _ => self.by_inverse_iteration(lambda, right, counters)?,
            });
        }
        pair_groups(pencil, &mut trials);
        trials.into_iter().map(|trial| trial.finish(pencil, tolerance)).collect()
    }

    /// Both vectors by solving with Q next to the eigenvalue.
    fn by_inverse_iteration(
        &self,
        lambda: Complex<f64>,
        right: Vector,
        counters: &mut Counters,
    ) -> Result<Trial, SparseError> {
        let (mut x, mut y) = (right.clone(), right);
        let mut shift = lambda;
        for _ in 0..2 {
            // Beside the eigenvalue, where the factors are regular.
            let beside = shift * (1.0 + 8.0 * f64::EPSILON);
            counters.factorisations += 1;
            let factor = Factor::new(&self.symbolic, &self.pencil, beside)?;
            for _ in 0..INVERSE_STEPS {
                x = unit(factor.solve(Side::Right, &column(&x))?.col_as_slice(0).to_vec());
                y = unit(factor.solve(Side::Left, &column(&y))?.col_as_slice(0).to_vec());
                counters.solves += 2;
            }
            shift = Trial::new(&self.pencil, shift, x.clone(), y.clone()).lambda;
        }
        Ok(Trial::new(&self.pencil, shift, x, y))
    }
}

/// An eigenvalue with unit vectors, y the conjugate of the left one.
struct Trial {
    lambda: Complex<f64>,
    x: Vector,
    y: Vector,
    error: f64,
}

impl Trial {
    /// The eigenvalue by Rayleigh quotients, where they make the residual no larger.
    fn new(pencil: &Pencil, lambda: Complex<f64>, x: Vector, y: Vector) -> Self {
        let residual_at = |lambda: Complex<f64>, x: &Vector| pencil.times(&pencil.weights(lambda), x);
        let error_of = |lambda: Complex<f64>, residual: &Vector| residual.norm() / pencil.size(lambda);
        let mut residual = residual_at(lambda, &x);
        let mut trial = Self { lambda, error: error_of(lambda, &residual), x, y };
        for _ in 0..STEPS {
            let value = y_dot(&trial.y, &residual);
            let slope = y_dot(&trial.y, &pencil.times(&pencil.slope_weights(trial.lambda), &trial.x));
            let better = trial.lambda - value / slope;
            if !(better.re.is_finite() && better.im.is_finite()) {
                break;
            }
            residual = residual_at(better, &trial.x);
            let error = error_of(better, &residual);
            // Rounding of the residual is no reason to keep an eigenvalue of half the digits.
            if error > 2.0 * trial.error.max(f64::EPSILON) {
                break;
            }
            let change = (better - trial.lambda).norm();
            (trial.lambda, trial.error) = (better, error);
            if change <= f64::EPSILON * better.norm() {
                break;
            }
        }
        trial
    }

    /// The backward error of the left vector.
    fn left_error(&self, pencil: &Pencil) -> f64 {
        pencil.times_transposed(&pencil.weights(self.lambda), &self.y).norm() / pencil.size(self.lambda)
    }

    fn finish(mut self, pencil: &Pencil, tolerance: f64) -> Result<Eigenpair, SparseError> {
        if self.error.is_nan() || self.error > tolerance {
            return Err(SparseError::NotConverged { lambda: self.lambda, residual: self.error });
        }
        let coupling = y_dot(&self.y, &pencil.times(&pencil.slope_weights(self.lambda), &self.x)).norm();
        let condition = pencil.size(self.lambda) / (self.lambda.norm() * coupling);
        cea::fix_phase(&mut self.x);
        let mut left = self.y.conjugate();
        cea::fix_phase(&mut left);
        let condition = if condition.is_nan() { f64::INFINITY } else { condition };
        let (lambda, right, backward_error) = (self.lambda, self.x, self.error);
        Ok(Eigenpair { lambda, right, left, backward_error, condition, on_border: false })
    }
}

/// Left vectors of nearly equal eigenvalues, turned so that each couples with its right vector alone.
fn pair_groups(pencil: &Pencil, trials: &mut [Trial]) {
    let mut is_done = vec![false; trials.len()];
    for first in 0..trials.len() {
        let lambda = trials[first].lambda;
        let is_near = |i: &usize| !is_done[*i] && (trials[*i].lambda - lambda).norm() <= ONE_GROUP * lambda.norm();
        let group: Vec<_> = (first..trials.len()).filter(is_near).collect();
        group.iter().for_each(|&i| is_done[i] = true);
        if group.len() < 2 {
            continue;
        }
        let slopes: Vec<_> = group.iter().map(|&i| pencil.times(&pencil.slope_weights(lambda), &trials[i].x)).collect();
        let couplings = DMatrix::from_fn(group.len(), group.len(), |i, j| y_dot(&trials[group[i]].y, &slopes[j]));
        let size = couplings.norm();
        let Some(inverse) = couplings.try_inverse().filter(|inverse| inverse.norm() * size * PAIRED < 1.0) else {
            continue;
        };
        let turned: Vec<Vector> = (0..group.len())
            .map(|i| {
                let zero = Vector::zeros(pencil.order());
                let sum =
                    group.iter().enumerate().fold(zero, |sum, (k, &member)| sum + &trials[member].y * inverse[(i, k)]);
                sum.normalize()
            })
            .collect();
        group.iter().zip(turned).for_each(|(&i, y)| trials[i].y = y);
    }
}

/// `y^T v`.
fn y_dot(y: &Vector, v: &Vector) -> Complex<f64> {
    y.dot(v)
}

fn unit(x: Vec<Complex<f64>>) -> Vector {
    let norm = length(&x);
    DVector::from_vec(x) / Complex::from(norm)
}

fn column(x: &Vector) -> Mat<Complex<f64>> {
    Mat::from_fn(x.len(), 1, |i, _| x[i])
}
