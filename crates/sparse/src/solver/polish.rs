//! From Ritz values to eigenpairs: two-sided Rayleigh quotients, backward errors and condition numbers.

use faer::Mat;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::blocks::length;
use super::disc::{Candidate, Problem};
use super::factor::Factor;
use super::pencil::Pencil;
use super::products::{Parts, Side};
use super::types::{Counters, Eigenpair};
use crate::SparseError;

/// Steps of the Rayleigh quotient: it converges twice as many digits at each.
const STEPS: usize = 3;
/// Candidates whose products are formed together.
const TOGETHER: usize = 16;
/// Steps of inverse iteration with one factorisation.
const INVERSE_STEPS: usize = 3;
/// Fewest and most factorisations, each next to the eigenvalue that the one before found; chosen: from a neighbour three are enough, where
/// others are near it takes more.
const FACTORISATIONS: [usize; 2] = [2, 8];
/// Backward error at which no further one is made: some rounding errors.
const ENOUGH: f64 = 16.0 * f64::EPSILON;
/// Farthest that one factorisation moves an eigenvalue, relative to it; chosen.
const FARTHEST: f64 = 0.1;
/// Distance of two eigenvalues, relative, up to which their vectors may be any of a common space.
const ONE_GROUP: f64 = 1e-8;
/// Smallest reciprocal condition of the couplings of a group whose left vectors can be paired with its right ones.
const PAIRED: f64 = 1e-6;

type Vector = DVector<Complex<f64>>;

impl Problem {
    /// The eigenpairs that candidates stand for, each with a backward error of at most `tolerance`; that of the left vector is at
    /// most `left_tolerance`, or what inverse iteration gives.
    ///
    /// # Errors
    /// [`SparseError::NotConverged`] for a candidate that is none.
    pub(crate) fn polish(
        &self,
        candidates: Vec<Candidate>,
        [tolerance, left_tolerance]: [f64; 2],
        counters: &mut Counters,
    ) -> Result<Vec<Eigenpair>, SparseError> {
        let pencil = &self.pencil;
        let mut trials = Vec::with_capacity(candidates.len());
        for some in candidates.chunks(TOGETHER) {
            let right: Vec<_> = some.iter().map(|c| unit(&c.right)).collect();
            let left: Vec<_> = some.iter().map(|c| unit(c.left.as_ref().unwrap_or(&c.right))).collect();
            let parts = [(Side::Right, &right), (Side::Left, &left)].map(|(side, x)| pencil.parts(side, &columns(x)));
            let [right_parts, left_parts] = parts;
            let vectors = right.into_iter().zip(left).zip(right_parts.iter().zip(&left_parts));
            for (candidate, ((x, y), (right, left))) in some.iter().zip(vectors) {
                let trial = Trial::new(pencil, candidate.lambda, x, y, right);
                let left_error = left.sum(&pencil.weights(trial.lambda)).norm() / pencil.size(trial.lambda);
                let is_good = candidate.left.is_some() && trial.error <= tolerance && left_error <= left_tolerance;
                trials.push(if is_good {
                    trial
                } else {
                    self.by_inverse_iteration(candidate.lambda, trial.x, counters)?
                });
            }
        }
        pair_groups(&mut trials);
        trials.into_iter().map(|trial| trial.finish(pencil, tolerance)).collect()
    }

    /// Both vectors by solving with Q next to the eigenvalue, and again next to what their quotient says it is, while that helps.
    fn by_inverse_iteration(
        &self,
        lambda: Complex<f64>,
        right: Vector,
        counters: &mut Counters,
    ) -> Result<Trial, SparseError> {
        let [fewest, most] = FACTORISATIONS;
        let mut best: Option<Trial> = None;
        let (mut shift, mut x, mut y) = (lambda, right.clone(), right);
        for round in 1..=most {
            // Beside the eigenvalue, where the factors are regular.
            let beside = shift * (1.0 + 8.0 * f64::EPSILON);
            counters.factorisations += 1;
            let factor = match Factor::new(&self.symbolic, &self.pencil, beside) {
                Ok(factor) => factor,
                // What is known already stays.
                Err(error) => return best.ok_or(error),
            };
            for _ in 0..INVERSE_STEPS {
                x = unit(factor.solve(Side::Right, &columns(&[x]))?.col_as_slice(0));
                y = unit(factor.solve(Side::Left, &columns(&[y]))?.col_as_slice(0));
                counters.solves += 2;
            }
            let (trial, quotient) = Trial::with_quotient(&self.pencil, shift, x.clone(), y.clone());
            let (error, before) = (trial.error, best.as_ref().map_or(f64::INFINITY, |best| best.error));
            // Of two that differ by rounding the later one has the better left vector.
            if best.is_none() || error <= 2.0 * before.max(f64::EPSILON) {
                best = Some(trial);
            }
            if round >= fewest && (error <= ENOUGH || error.is_nan() || error > 0.5 * before) {
                break;
            }
            shift = quotient;
        }
        best.ok_or(SparseError::NotConverged { lambda, residual: f64::INFINITY })
    }
}

/// An eigenvalue with unit vectors, y the conjugate of the left one.
struct Trial {
    lambda: Complex<f64>,
    x: Vector,
    y: Vector,
    error: f64,
    /// `Q'(lambda) x`.
    slope: Vector,
}

impl Trial {
    /// With the quotient of the vectors, whatever residual that has: vectors from a shift that is not yet the eigenvalue leave less of Q at the
    /// shift than at the eigenvalue, which they are next to all the same.
    fn with_quotient(pencil: &Pencil, shift: Complex<f64>, x: Vector, y: Vector) -> (Self, Complex<f64>) {
        let x = [x];
        let parts = pencil.parts(Side::Right, &columns(&x));
        let [x] = x;
        let [residual, slope] = [pencil.weights(shift), pencil.slope_weights(shift)].map(|at| parts[0].sum(&at));
        let quotient = shift - y_dot(&y, &residual) / y_dot(&y, &slope);
        let trial = Self::new(pencil, shift, x, y, &parts[0]);
        // What is no number, or far away, is no neighbour.
        let is_near = (quotient - shift).norm() <= FARTHEST * shift.norm();
        let next = if is_near { quotient } else { trial.lambda };
        (trial, next)
    }

    /// The eigenvalue by Rayleigh quotients, where they make the residual no larger.
    fn new(pencil: &Pencil, lambda: Complex<f64>, x: Vector, y: Vector, parts: &Parts<'_>) -> Self {
        let error_of = |lambda: Complex<f64>, residual: &Vector| residual.norm() / pencil.size(lambda);
        let mut residual = parts.sum(&pencil.weights(lambda));
        let (mut best, mut error) = (lambda, error_of(lambda, &residual));
        for _ in 0..STEPS {
            let slope = parts.sum(&pencil.slope_weights(best));
            let better = best - y_dot(&y, &residual) / y_dot(&y, &slope);
            if !(better.re.is_finite() && better.im.is_finite()) {
                break;
            }
            residual = parts.sum(&pencil.weights(better));
            let new_error = error_of(better, &residual);
            // Rounding of the residual is no reason to keep an eigenvalue of half the digits.
            if new_error > 2.0 * error.max(f64::EPSILON) {
                break;
            }
            let change = (better - best).norm();
            (best, error) = (better, new_error);
            if change <= f64::EPSILON * better.norm() {
                break;
            }
        }
        let slope = parts.sum(&pencil.slope_weights(best));
        Self { lambda: best, x, y, error, slope }
    }

    fn finish(mut self, pencil: &Pencil, tolerance: f64) -> Result<Eigenpair, SparseError> {
        if self.error.is_nan() || self.error > tolerance {
            return Err(SparseError::NotConverged { lambda: self.lambda, residual: self.error });
        }
        let coupling = y_dot(&self.y, &self.slope).norm();
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
fn pair_groups(trials: &mut [Trial]) {
    let mut is_done = vec![false; trials.len()];
    for first in 0..trials.len() {
        let lambda = trials[first].lambda;
        let is_near = |i: &usize| !is_done[*i] && (trials[*i].lambda - lambda).norm() <= ONE_GROUP * lambda.norm();
        let group: Vec<_> = (first..trials.len()).filter(is_near).collect();
        group.iter().for_each(|&i| is_done[i] = true);
        if group.len() < 2 {
            continue;
        }
        let coupling = |i: usize, j: usize| y_dot(&trials[group[i]].y, &trials[group[j]].slope);
        let couplings = DMatrix::from_fn(group.len(), group.len(), coupling);
        let size = couplings.norm();
        let Some(inverse) = couplings.try_inverse().filter(|inverse| inverse.norm() * size * PAIRED < 1.0) else {
            continue;
        };
        let turned: Vec<Vector> = (0..group.len())
            .map(|i| {
                let zero = Vector::zeros(trials[first].x.len());
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

fn unit(x: &[Complex<f64>]) -> Vector {
    let norm = Complex::from(length(x));
    DVector::from_iterator(x.len(), x.iter().map(|value| value / norm))
}

fn columns(vectors: &[Vector]) -> Mat<Complex<f64>> {
    Mat::from_fn(vectors.first().map_or(0, Vector::len), vectors.len(), |i, j| vectors[j][i])
}
