//! Eigenvalues of A at themselves, in double precision throughout.

use nalgebra::DMatrix;
use num_complex::Complex;

use super::coupling::{self, Coupled, Gains, Scratch};
use super::ports::Ports;
use crate::ReductionError;
use crate::dense;
use crate::eigenvalue;
use crate::nearest::is_apart;
use crate::rows::{Rows, product};

/// Most rounds in which an eigenvalue of A at another number becomes one of A at itself, and the relative size of the last step; chosen: each
/// round multiplies what is missing by how much A changes with lambda, a few hundredths, or a half where A has poles near.
const MOST_ROUNDS: usize = 40;
const CONVERGED: f64 = 1e-9;
/// Where A is evaluated for an eigenvalue that is known, relative to it: at the eigenvalue itself `lambda - A` is singular.
const BESIDE: f64 = 1e-9;
/// First step of the secant method, relative to a guess; chosen.
const FIRST_STEP: f64 = 1e-4;
/// Steps of inverse iteration in each round; chosen.
const STEPS: usize = 2;

/// A at some gains.
pub(super) struct Own<'a> {
    ports: &'a Ports,
    structure: &'a Coupled<f64>,
    pub gains: Gains<'a>,
    scratch: Scratch,
    matrix: Rows,
}

impl<'a> Own<'a> {
    pub fn new(ports: &'a Ports, structure: &'a Coupled<f64>, gains: Gains<'a>) -> Self {
        let p = ports.near();
        Self { ports, structure, gains, scratch: Scratch::new(ports), matrix: Rows::zeros(p, p) }
    }

    /// Eigenvalues and vectors of A at a number.
    ///
    /// # Errors
    /// Eigenvalues that do not converge.
    pub fn eigen(&mut self, lambda: Complex<f64>) -> Result<dense::Eigen, ReductionError> {
        self.at(lambda);
        let p = self.ports.near();
        dense::eigen_complex(&DMatrix::from_fn(p, p, |i, j| self.matrix.at(i, j)))
    }

    /// The forces of amplitudes, at the number where A was made last.
    pub fn forces(&self, vector: &[Complex<f64>]) -> Vec<Complex<f64>> {
        product(&self.scratch.solved, vector)
    }

    /// The eigenvalue that is one of A at itself next to one of A at another number, whose vector is replaced by its own; `None` where it does
    /// not converge.
    pub fn next_to(&mut self, mut lambda: Complex<f64>, vector: &mut [Complex<f64>]) -> Option<Complex<f64>> {
        for _ in 0..MOST_ROUNDS {
            self.at(lambda);
            let (beside, elimination) = (lambda * (1.0 + BESIDE), &mut self.scratch.elimination);
            let next = eigenvalue::next_to(&mut self.matrix, beside, vector, STEPS, elimination);
            let step = (next - lambda).norm();
            lambda = next;
            if step <= CONVERGED * lambda.norm() {
                return Some(lambda);
            }
        }
        None
    }

    /// An eigenvalue next to a guess that is none of some others, with its vector in the place of another; `None` where it does not converge.
    /// It is found as a zero of the determinant from which theirs are divided out.
    pub fn other_than(
        &mut self,
        others: &[Complex<f64>],
        guess: Complex<f64>,
        vector: &mut [Complex<f64>],
    ) -> Option<Complex<f64>> {
        let mut value = |lambda: Complex<f64>| {
            others.iter().fold(self.determinant(lambda), |value, other| value / ((lambda - other) / guess.norm()))
        };
        let (mut before, mut there) = (guess, value(guess));
        let mut lambda = guess * (1.0 + FIRST_STEP);
        for _ in 0..MOST_ROUNDS {
            let here = value(lambda);
            let step = -here * (lambda - before) / (here - there);
            (before, there) = (lambda, here);
            lambda += step;
            if step.norm() <= CONVERGED * lambda.norm() {
                return self.next_to(lambda, vector).filter(|&next| !is_apart(&[lambda], next));
            }
        }
        None
    }

    /// The determinants of `lambda - A` and of T, multiplied: it has all eigenvalues as zeros and no poles near the band. It is scaled by a
    /// factor that is always the same.
    pub fn determinant(&mut self, lambda: Complex<f64>) -> Complex<f64> {
        self.at(lambda);
        self.matrix.negate();
        let (scale, Scratch { elimination, factors, .. }) = (1.0 / self.ports.middle.norm(), &mut self.scratch);
        eigenvalue::factor(&mut self.matrix, lambda, elimination, self.ports.near());
        elimination.pivots.iter().map(|pivot| pivot * scale).chain(factors.pivots.iter().copied()).product()
    }

    fn at(&mut self, lambda: Complex<f64>) {
        coupling::at(self.structure, &self.ports.fine, lambda, self.gains, &mut self.scratch, &mut self.matrix);
    }
}
