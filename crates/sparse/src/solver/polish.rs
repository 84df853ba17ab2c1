//! Eigenpairs from Ritz values: two-sided Rayleigh quotients, backward errors and condition numbers.

use cea::Verdict;
use faer::Mat;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::blocks::length;
use super::disc::{Candidate, Problem};
use super::factor::Factor;
use super::groups::groups;
use super::pencil::Pencil;
use super::products::{Parts, Side};
use super::types::{Counters, Eigenpair};
use crate::SparseError;

/// Steps of the Rayleigh quotient: it converges twice as many digits at each. Chosen: with fewer
/// digits may be left, with more none is won.
const STEPS: usize = 3;
/// Candidates whose products are formed together; chosen: with fewer the matrices are read more often, with more their vectors take more memory.
const TOGETHER: usize = 16;
/// Steps of inverse iteration with one factorisation; chosen: with fewer more factorisations are made, more gain nothing next to the eigenvalue.
const INVERSE_STEPS: usize = 3;
/// Most factorisations, each next to the eigenvalue that the one before found; chosen: from a neighbour three are enough, where
/// others are near it takes more.
const FACTORISATIONS: usize = 8;
/// Largest backward error, of both vectors after the first factorisation, with which no further one is made: some rounding errors.
const ENOUGH: f64 = 16.0 * f64::EPSILON;
/// Largest step of an eigenvalue by one factorisation, relative to it; chosen: where the quotient of the vectors leads farther, it is not taken.
const FARTHEST: f64 = 0.1;
/// Largest distance of two eigenvalues whose vectors may be any of a common space, relative to |lambda|; chosen:
/// with less, left vectors of a multiple eigenvalue are paired with wrong right ones; with more, vectors of neighbours are mixed.
const ONE_GROUP: f64 = 1e-8;
/// Smallest reciprocal condition of the couplings of a group whose left vectors can be paired with its right ones; chosen: below,
/// the pairs would keep less than half of their digits and the vectors stay as they are.
const PAIRED: f64 = 1e-6;
/// Factor on motion times backward error, a first-order estimate; the factor of `cea::certified`, docs/error-bounds.md.
const FIRST_ORDER_SAFETY: f64 = 4.0;
/// Largest backward error that is nothing but rounding.
pub(super) const ROUNDING_ONLY: f64 = 16.0 * f64::EPSILON;
/// Largest tolerance of a marginal eigenvalue, relative to |lambda|; the tolerance of `cea::certified`.
const LARGEST_MARGINAL_TOLERANCE: f64 = 1e-6;

pub(super) type Vector = DVector<Complex<f64>>;

/// Eigenpair that a Ritz value became.
pub(super) struct Polished {
    /// The Ritz value.
    pub(super) ritz: Complex<f64>,
    pub(super) pair: Eigenpair,
    /// True if the backward error of the right vector is as small as asked for, and that of the left one too, which is not looked at again after inverse
    /// iteration.
    pub(super) is_good: bool,
}

impl Problem {
    /// The eigenpair that a candidate stands for, with a backward error of at most `tolerance`; the backward error of the left vector is at most
    /// `left_tolerance`, or what inverse iteration gives.
    ///
    /// # Errors
    /// [`SparseError::NotConverged`] for a candidate that stands for no eigenpair.
    pub(crate) fn polish(
        &self,
        candidate: Candidate,
        [tolerance, left_tolerance]: [f64; 2],
        counters: &mut Counters,
    ) -> Result<Eigenpair, SparseError> {
        let lambda = candidate.lambda;
        let found = self.polished(vec![candidate], [tolerance, left_tolerance], counters)?;
        let residual = found.first().map_or(f64::INFINITY, |polished| polished.pair.backward_error);
        match found.into_iter().next() {
            Some(polished) if polished.is_good => Ok(polished.pair),
            polished => {
                let lambda = polished.map_or(lambda, |polished| polished.pair.lambda);
                Err(SparseError::NotConverged { lambda, residual })
            }
        }
    }

    /// Eigenpairs that the candidates of one disc become. One that does not converge keeps the backward error that it has.
    ///
    /// # Errors
    /// A factorisation that does not fit into memory.
    pub(super) fn polished(
        &self,
        candidates: Vec<Candidate>,
        [tolerance, left_tolerance]: [f64; 2],
        counters: &mut Counters,
    ) -> Result<Vec<Polished>, SparseError> {
        let pencil = &self.pencil;
        let lambdas: Vec<_> = candidates.iter().map(|candidate| candidate.lambda).collect();
        let mut is_alone = vec![true; lambdas.len()];
        let together = groups(&lambdas, |lambda| pencil.blur(lambda)).into_iter().filter(|group| group.len() > 1);
        together.flatten().for_each(|i| is_alone[i] = false);
        let mut is_alone = is_alone.into_iter();
        let mut next_is_alone = || is_alone.next().unwrap_or(true);
        let (mut trials, mut good) = (Vec::with_capacity(lambdas.len()), Vec::with_capacity(lambdas.len()));
        for some in candidates.chunks(TOGETHER) {
            let right: Vec<_> = some.iter().map(|c| unit(&c.right)).collect();
            let left: Vec<_> = some.iter().map(|c| unit(c.left.as_ref().unwrap_or(&c.right))).collect();
            let parts = [(Side::Right, &right), (Side::Left, &left)].map(|(side, x)| pencil.parts(side, &columns(x)));
            let [right_parts, left_parts] = parts;
            let vectors = right.into_iter().zip(left).zip(right_parts.iter().zip(&left_parts));
            for (candidate, ((x, y), (right, left))) in some.iter().zip(vectors) {
                let is_alone = next_is_alone();
                let mut trial = Trial::new(pencil, candidate.lambda, x, y, right);
                let left_error = left.sum(&pencil.weights(trial.lambda)).norm() / pencil.measure(trial.lambda);
                let mut is_good = candidate.left.is_some() && trial.error <= tolerance && left_error <= left_tolerance;
                // One vector of several that rounding does not tell apart would become any of their space.
                if !is_good && is_alone {
                    match self.by_inverse_iteration(candidate.lambda, trial.x.clone(), counters) {
                        Ok(better) => {
                            trial = better;
                            is_good = trial.error <= tolerance;
                        }
                        Err(SparseError::Solve { .. } | SparseError::Singular { .. }) => {}
                        Err(other) => return Err(other),
                    }
                }
                trials.push(trial);
                good.push(is_good);
            }
        }
        pair_groups(&mut trials);
        let finished = trials.into_iter().map(|trial| trial.finish(pencil));
        let all = finished.zip(good).zip(lambdas);
        Ok(all.map(|((pair, is_good), ritz)| Polished { ritz, pair, is_good }).collect())
    }

    /// Right and left vector by solving with Q next to the eigenvalue, and again next to what their quotient says it is, while that helps. Apart from
    /// [`cea::Eigentriple::of_neighbour`]: a sparse factorisation is dear, so that each makes several steps, and what is best of them stays.
    fn by_inverse_iteration(
        &self,
        lambda: Complex<f64>,
        right: Vector,
        counters: &mut Counters,
    ) -> Result<Trial, SparseError> {
        let mut best: Option<Trial> = None;
        let (mut shift, mut x, mut y) = (lambda, right.clone(), right);
        for round in 1..=FACTORISATIONS {
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
            let is_first_enough =
                || trial.error <= ENOUGH && left_error(&self.pencil, trial.lambda, &trial.y) <= ENOUGH;
            let is_enough = if round == 1 { is_first_enough() } else { trial.error <= ENOUGH };
            let (error, before) = (trial.error, best.as_ref().map_or(f64::INFINITY, |best| best.error));
            // Of two that differ by rounding the later one has the better left vector.
            if best.is_none() || error <= 2.0 * before.max(f64::EPSILON) {
                best = Some(trial);
            }
            if is_enough || round > 1 && (error.is_nan() || error > 0.5 * before) {
                break;
            }
            shift = quotient;
        }
        best.ok_or(SparseError::NotConverged { lambda, residual: f64::INFINITY })
    }
}

/// An eigenvalue with unit vectors, y the conjugate of the left one.
pub(super) struct Trial {
    lambda: Complex<f64>,
    x: Vector,
    y: Vector,
    error: f64,
    /// `Q'(lambda) x`.
    slope: Vector,
}

impl Trial {
    /// A trial with the quotient of the vectors, whatever residual that has: vectors from a shift that is not yet the eigenvalue leave less of Q
    /// at the shift than at the eigenvalue, which they are next to all the same.
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

    pub(super) fn lambda(&self) -> Complex<f64> {
        self.lambda
    }

    /// x or y.
    pub(super) fn vector(&self, side: Side) -> &Vector {
        match side {
            Side::Right => &self.x,
            Side::Left => &self.y,
        }
    }

    /// The eigenvalue by Rayleigh quotients, where they make the residual no larger.
    pub(super) fn new(pencil: &Pencil, lambda: Complex<f64>, x: Vector, y: Vector, parts: &Parts<'_>) -> Self {
        let error_of = |lambda: Complex<f64>, residual: &Vector| residual.norm() / pencil.measure(lambda);
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

    pub(super) fn finish(mut self, pencil: &Pencil) -> Eigenpair {
        let coupling = y_dot(&self.y, &self.slope).norm();
        let (lambda, size, backward_error) = (self.lambda, pencil.measure(self.lambda), self.error);
        let condition = size / (lambda.norm() * coupling);
        cea::fix_phase(&mut self.x);
        let mut left = self.y.conjugate();
        cea::fix_phase(&mut left);
        let condition = if condition.is_nan() { f64::INFINITY } else { condition };
        let (bound, verdict) = judged(lambda, size / coupling, backward_error);
        Eigenpair { lambda, right: self.x, left, backward_error, condition, bound, verdict, on_border: false }
    }
}

/// Backward error of a left eigenvector, by its conjugate y.
fn left_error(pencil: &Pencil, lambda: Complex<f64>, y: &Vector) -> f64 {
    let parts = pencil.parts(Side::Left, &columns(std::slice::from_ref(y)));
    parts[0].sum(&pencil.weights(lambda)).norm() / pencil.measure(lambda)
}

/// The pair of an eigenvalue and its vectors, y the conjugate of the left one, as they are.
pub(super) fn pair_of(pencil: &Pencil, lambda: Complex<f64>, x: &Vector, y: &Vector) -> Eigenpair {
    let [x, y] = [x, y].map(|vector| unit(vector.as_slice()));
    let x = [x];
    let parts = pencil.parts(Side::Right, &columns(&x));
    let [x] = x;
    let error = parts[0].sum(&pencil.weights(lambda)).norm() / pencil.measure(lambda);
    let slope = parts[0].sum(&pencil.slope_weights(lambda));
    Trial { lambda, x, y, error, slope }.finish(pencil)
}

/// The first-order bound of an eigenvalue, rad/s, and the verdict by it. `motion` is how far the eigenvalue moves per relative change of the matrices,
/// rad/s.
pub(super) fn judged(lambda: Complex<f64>, motion: f64, backward_error: f64) -> (f64, Verdict) {
    let (bound, tolerance) = (first_order(motion, backward_error), first_order(motion, 0.0));
    // An eigenvalue that the roundings of an assembly move by all of its size may be any other, and a double zero.
    let rounded = cea::ROUNDED_DATA * tolerance;
    let bound = if rounded >= lambda.norm() { bound.max(rounded) } else { bound };
    let is_marginal = backward_error <= ROUNDING_ONLY
        && lambda.re.abs() <= tolerance
        && tolerance <= LARGEST_MARGINAL_TOLERANCE * lambda.norm();
    (bound, if is_marginal { Verdict::Marginal { tolerance } } else { Verdict::of(lambda, bound) })
}

/// Error bound of an eigenvalue, rad/s, to first order: its distance from the exact one of these matrices or of any that round to them. `motion` as in
/// [`judged`].
fn first_order(motion: f64, backward_error: f64) -> f64 {
    let bound = FIRST_ORDER_SAFETY * motion * backward_error.max(0.5 * f64::EPSILON);
    if bound.is_nan() { f64::INFINITY } else { bound }
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

pub(super) fn unit(x: &[Complex<f64>]) -> Vector {
    let norm = Complex::from(length(x));
    DVector::from_iterator(x.len(), x.iter().map(|value| value / norm))
}

pub(super) fn columns(vectors: &[Vector]) -> Mat<Complex<f64>> {
    Mat::from_fn(vectors.first().map_or(0, Vector::len), vectors.len(), |i, j| vectors[j][i])
}
