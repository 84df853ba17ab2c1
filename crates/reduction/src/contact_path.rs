//! The way from one system to another that differs from it in a few directions only: in contacts that open, say.
//!
//! ```text
//! Q(lambda, t) = Q_0(lambda) + t F S(lambda) R,    S = diag(1, lambda or lambda^2),    F: n x r,  R: r x n
//! ```
//!
//! Of the system at the beginning all eigenvalues Lambda are known, with right and left vectors Y and V. Its modes in and near the band are
//! kept and all others eliminated, so that at any place there remains a problem of as many equations as there are modes in the band:
//!
//! ```text
//! (lambda - Lambda + V^H F K R Y) a = 0,    K = W (1 + G W)^-1,  W = t S,  G = R Q_others^-1 F
//! ```
//!
//! An evaluation costs a small part of a factorisation of Q, and next to none of a spectrum.

use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::dense;
use super::nearest::{nearest, nearest_of};
use super::outer_products::outer_products;
use super::state_modes::StateModes;
use crate::ReductionError;

/// Highest frequency of the modes that are kept, as a multiple of the highest frequency of the band; chosen: more modes change nothing but the cost.
const KEPT: f64 = 1.2;
/// Most directions in which the systems differ, as a fraction of their order; chosen: with more, the matrices themselves cost no more.
const MOST_DIRECTIONS: f64 = 0.34;
/// Relative distance from the guess at which the problem is factored; chosen, as for paths that are evaluated by matrices: at an eigenvalue itself nothing may
/// be left of a pivot.
const BESIDE: f64 = 1e-7;
/// Largest relative correction of an eigenvalue that has converged; chosen likewise.
const CONVERGED: f64 = 5e-5;
/// Most corrections of an eigenvalue; chosen likewise.
const MOST_CORRECTIONS: usize = 4;
/// Largest relative correction of an eigenvalue that is to be told apart from others; chosen.
const LAST_DIGITS: f64 = 1e-6;
/// Most corrections of an eigenvalue that is to be told apart from others; chosen: where one needs more, the eigenvalues are not told apart.
const MOST_ROUNDS: usize = 8;
/// Number of inverse iterations for a vector that is not known; chosen.
const STEPS_FROM_ANY: usize = 3;
/// Number of inverse iterations for a vector that is nearly right; chosen.
const STEPS: usize = 1;

type Matrix = DMatrix<Complex<f64>>;
type Vector = DVector<Complex<f64>>;

/// The straight line between two systems that differ in a few directions.
#[derive(Debug, Clone)]
pub struct ContactPath {
    kept: Part,
    others: Part,
    /// The power of lambda of each direction.
    powers: Vec<i32>,
    /// Unit of eigenvalues, rad/s: the `highest` of [`ContactPath::new`].
    size: f64,
}

/// Modes of the system at the beginning: those that are kept, or the others.
#[derive(Debug, Clone)]
struct Part {
    /// Lambda, rad/s.
    lambdas: Vec<Complex<f64>>,
    /// Y, `R Y` and `V^H F`.
    right: Matrix,
    read: Matrix,
    driven: Matrix,
}

/// An eigenvalue on a [`ContactPath`].
#[derive(Debug, Clone, PartialEq)]
pub struct OnContactPath {
    /// rad/s.
    pub lambda: Complex<f64>,
    /// `d lambda / d t`, rad/s.
    pub rate: Complex<f64>,
    /// The shape, up to a factor.
    pub shape: Vector,
}

/// Matrices at one place of a path and one number.
struct Place {
    /// lambda to its powers, and W.
    powers: Vector,
    w: Vector,
    g: Matrix,
    /// `(1 + G W)^-1`, and its determinant before it was inverted.
    inverse: Matrix,
    determinant: Complex<f64>,
    /// `lambda - Lambda + V^H F K R Y`.
    matrix: Matrix,
}

impl ContactPath {
    /// The way between two systems for eigenvalues up to `highest`, rad/s; `None` where they differ nowhere or in many directions, differ in the number of
    /// degrees of freedom, or where one has internal states.
    ///
    /// # Errors
    /// A mass matrix that is singular.
    pub fn new([from, to]: [&SecondOrder; 2], highest: f64) -> Result<Option<Self>, ReductionError> {
        let order = from.order();
        if order != to.order() || from.states() + to.states() > 0 {
            return Ok(None);
        }
        let most = (MOST_DIRECTIONS * order as f64) as usize;
        let (mut force, mut reading, mut powers) = (Vec::new(), Vec::new(), Vec::new());
        for (power, change) in [(0, &to.k - &from.k), (1, &to.c - &from.c), (2, &to.m - &from.m)] {
            let Some(products) = outer_products(change, most) else { return Ok(None) };
            for [column, row] in products {
                force.push(column);
                reading.push(row);
                powers.push(power);
            }
        }
        if powers.len() > most || powers.is_empty() {
            return Ok(None);
        }
        let [force, reading] = [force, reading].map(|columns| DMatrix::from_columns(&columns).map(Complex::from));
        let StateModes { lambdas, y, lower, .. } = StateModes::new(from, highest)?;
        let is_kept = |at: &usize| lambdas[*at].im > 0.0 && lambdas[*at].im <= KEPT * highest;
        let (kept, others): (Vec<usize>, Vec<usize>) = (0..lambdas.len()).partition(is_kept);
        let part = |of: &[usize]| {
            let right = y.select_columns(of);
            Part {
                lambdas: of.iter().map(|&at| lambdas[at]).collect(),
                read: reading.tr_mul(&right),
                driven: lower.select_rows(of) * &force / Complex::from(highest),
                right,
            }
        };
        Ok(Some(Self { kept: part(&kept), others: part(&others), powers, size: highest }))
    }

    /// Values of a function of lambda, rad/s, and of the place t, 0 at the beginning and 1 at the end, that has the eigenvalues in the band
    /// as zeros and no poles there: the determinants of what is kept and of what is eliminated, up to a factor that is always the same.
    #[must_use]
    pub fn characteristic(&self, at: &[(f64, Complex<f64>)]) -> Vec<Complex<f64>> {
        let value = |&(t, lambda): &(f64, Complex<f64>)| {
            let Some(Place { matrix, determinant, .. }) = self.at(t, lambda) else { return Complex::from(f64::NAN) };
            (matrix / Complex::from(self.size)).lu().determinant() * determinant
        };
        at.iter().map(value).collect()
    }

    /// The eigenvalue next to a guess, rad/s, at a place t of the path, by Newton's method; `None` where it does not converge in a few
    /// corrections.
    ///
    /// With the right and left singular vectors x and y of the smallest singular value of the matrix N of the problem a correction is
    /// `-y^H N x / y^H (d N / d lambda) x`, and the rate `-y^H (d N / d t) x / y^H (d N / d lambda) x`.
    #[must_use]
    pub fn next_to(&self, t: f64, guess: Complex<f64>) -> Option<OnContactPath> {
        self.corrected(t, guess, CONVERGED, MOST_CORRECTIONS)
    }

    /// The `count` eigenvalues at a place of the path that are nearest to each number in `to`, rad/s, at least one, each eigenvalue once, with rates and
    /// shapes; `None` where they are not told apart.
    ///
    /// Guesses are the eigenvalues of the problem with its matrix taken at the mean of the numbers: what is eliminated hardly changes over the band.
    #[must_use]
    pub fn nearest(&self, t: f64, to: &[Complex<f64>], count: usize) -> Option<Vec<OnContactPath>> {
        let middle = to.iter().sum::<Complex<f64>>() / to.len() as f64;
        let mut matrix = -self.at(t, middle)?.matrix;
        (0..matrix.nrows()).for_each(|entry| matrix[(entry, entry)] += middle);
        let guesses = dense::eigen_complex(&matrix).ok()?.0;
        // One more of each: the order of the last ones may be another.
        let likely = nearest(to, &guesses, count + 1);
        let found = likely.into_iter().map(|at| self.corrected(t, guesses[at], LAST_DIGITS, MOST_ROUNDS));
        nearest_of(to, found.collect::<Option<_>>()?, |found| found.lambda, count)
    }

    fn corrected(&self, t: f64, guess: Complex<f64>, tolerance: f64, most: usize) -> Option<OnContactPath> {
        let mut at = guess;
        let mut x = Vector::from_element(self.kept.lambdas.len(), Complex::new(1.0, 0.0));
        for round in 0..most {
            let number = at * (1.0 + BESIDE);
            let place = self.at(t, number)?;
            let steps = if round == 0 { STEPS_FROM_ANY } else { STEPS };
            inverse_iteration(&place.matrix, &mut x, steps)?;
            let mut y = dense::image(&place.matrix, &x);
            let miss = y.norm();
            y.unscale_mut(miss);
            let state = dense::image(&place.inverse, &dense::image(&self.kept.read, &x));
            let pulled = state.component_mul(&place.w);
            // The left vector at the directions, `(1 + W G)^-H F^H V y`, where `(1 + W G)^-1 = 1 - W (1 + G W)^-1 G`.
            let driven = self.kept.driven.ad_mul(&y);
            let left = &driven - (&place.inverse * &place.g).ad_mul(&driven.component_mul(&place.w.conjugate()));
            let by_w = |change: &Vector| left.dotc(&state.component_mul(change));
            let by_number = Vector::from_iterator(
                self.powers.len(),
                place.w.iter().zip(&self.powers).map(|(w, &power)| w * f64::from(power) / number),
            );
            let by_others = left.component_mul(&place.w.conjugate()).dotc(&self.others.smooth_change(number, &pulled));
            let slope = y.dotc(&x) + by_w(&by_number) + by_others;
            let lambda = number - miss / slope;
            if !lambda.is_finite() {
                return None;
            }
            let is_converged = (lambda - at).norm() <= tolerance * lambda.norm();
            if is_converged {
                let rate = -by_w(&place.powers) / slope;
                let shape = dense::image(&self.kept.right, &x) - self.others.response(lambda, &pulled);
                return rate.is_finite().then_some(OnContactPath { lambda, rate, shape });
            }
            at = lambda;
        }
        None
    }

    /// `None` where what is eliminated has an eigenvalue there.
    fn at(&self, t: f64, lambda: Complex<f64>) -> Option<Place> {
        let powers = Vector::from_iterator(self.powers.len(), self.powers.iter().map(|&power| lambda.powi(power)));
        let w = &powers * Complex::from(t);
        let g = self.others.smooth(lambda);
        let times_w = |mut a: Matrix| {
            a.column_iter_mut().zip(&w).for_each(|(mut column, &w)| column *= w);
            a
        };
        let through = (times_w(g.clone()) + Matrix::identity(w.len(), w.len())).lu();
        let (determinant, inverse) = (through.determinant(), through.try_inverse()?);
        let mut matrix = dense::product(&times_w(self.kept.driven.clone()), &dense::product(&inverse, &self.kept.read));
        for (entry, own) in (0..matrix.nrows()).zip(&self.kept.lambdas) {
            matrix[(entry, entry)] += lambda - own;
        }
        Some(Place { powers, w, g, inverse, determinant, matrix })
    }
}

impl Part {
    /// `R Q^-1 F` of these modes.
    fn smooth(&self, lambda: Complex<f64>) -> Matrix {
        let mut driven = self.driven.clone();
        driven.row_iter_mut().zip(&self.lambdas).for_each(|(mut row, own)| row /= lambda - own);
        dense::product(&self.read, &driven)
    }

    /// `-(d / d lambda) R Q^-1 F` of these modes, times a vector.
    fn smooth_change(&self, lambda: Complex<f64>, x: &Vector) -> Vector {
        let mut states = dense::image(&self.driven, x);
        states.iter_mut().zip(&self.lambdas).for_each(|(state, own)| *state /= (lambda - own).powi(2));
        dense::image(&self.read, &states)
    }

    /// `Q^-1 F` of these modes, times a vector.
    fn response(&self, lambda: Complex<f64>, x: &Vector) -> Vector {
        let mut states = dense::image(&self.driven, x);
        states.iter_mut().zip(&self.lambdas).for_each(|(state, own)| *state /= lambda - own);
        dense::image(&self.right, &states)
    }
}

/// Makes x the right singular vector of the smallest singular value of a matrix, by iteration with `(N^H N)^-1`.
fn inverse_iteration(matrix: &Matrix, x: &mut Vector, steps: usize) -> Option<()> {
    let factors = dense::Factored::new(matrix);
    for _ in 0..steps {
        *x = factors.solve_adjoint(x).ok()?.normalize();
        *x = factors.solve(x).ok()?.normalize();
    }
    Some(())
}

#[cfg(test)]
mod tests;
