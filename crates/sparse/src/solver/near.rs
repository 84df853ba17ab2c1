//! Eigenvalues of which neighbours are known.

use nalgebra::DVector;
use num_complex::Complex;

use super::disc::{Candidate, Problem};
use super::factor::Factor;
use super::polish::{Trial, Vector, columns, unit};
use super::products::{Parts, Side};
use super::types::{Counters, Eigenpair};
use crate::SparseError;

/// Most guesses, next to each other in frequency, that have a factorisation; chosen: with fewer there are more factorisations, each of which takes as long as
/// some thirty solutions; with more, shifts are farther from the guesses and a step gains less.
const TOGETHER: usize = 12;

/// Number of steps from guesses; chosen: with one, bases of what guesses become have a tenth more columns; with more, they gain little.
const STEPS: usize = 2;

/// Guess of an eigenpair: eigenvalue, rad/s, right vector phi and left vector psi, over the n degrees of freedom, each of them nearly.
#[derive(Debug, Clone, PartialEq)]
pub struct Guess {
    /// Nearly the eigenvalue lambda, rad/s.
    pub lambda: Complex<f64>,
    /// Nearly phi, `Q(lambda) phi = 0`.
    pub right: DVector<Complex<f64>>,
    /// Nearly psi, `psi^H Q(lambda) = 0`.
    pub left: DVector<Complex<f64>>,
}

impl Problem {
    /// The eigenvalue next to `lambda`, rad/s, whose right vector is like `shape`, over the n degrees of freedom: by inverse iteration and
    /// Rayleigh quotients, with a factorisation for each of a few steps, one where `lambda` is very near. The pair has a backward error of at most
    /// `tolerance`.
    ///
    /// Which one is found follows from `shape` as much as from `lambda`: the modes of a reduced brake are good ones to begin with.
    ///
    /// # Errors
    /// A shape of another length, a factorisation that does not fit into memory, [`SparseError::NotConverged`], also where Q next to `lambda` is singular
    /// or cannot be solved with accurately.
    pub fn eigenpair_near(
        &self,
        lambda: Complex<f64>,
        shape: &DVector<Complex<f64>>,
        tolerance: f64,
    ) -> Result<Eigenpair, SparseError> {
        if shape.len() != self.pencil.order() {
            return Err(wrong_length(shape.len()));
        }
        let candidate = Candidate { lambda, right: shape.iter().copied().collect(), left: None };
        self.polish(candidate, [tolerance; 2], &mut Counters::default())
    }

    /// Eigenpairs from guesses, by two steps of residual inverse iteration on both sides, `x - Q(sigma)^-1 Q(lambda) x` with lambda the Rayleigh quotient
    /// (Neumaier, SIAM J. Numer. Anal. 22, 1985), by ascending Im lambda. A step leaves of another eigenvector in x the fraction
    /// `|lambda - sigma| / |other - sigma|`: little of those far away, all or more of those that are nearer to sigma. So it is the space of all vectors that
    /// comes nearer to the space of the eigenvectors, and the backward error of a pair says how near it is to one of its own.
    ///
    /// # Errors
    /// Vectors of another length, a factorisation that does not fit into memory, Q next to the guesses singular.
    pub fn eigenpairs_next_to(&self, mut guesses: Vec<Guess>) -> Result<Vec<Eigenpair>, SparseError> {
        let lengths = guesses.iter().flat_map(|guess| [guess.right.len(), guess.left.len()]);
        if let Some(other) = lengths.into_iter().find(|&length| length != self.pencil.order()) {
            return Err(wrong_length(other));
        }
        guesses.sort_by(|a, b| a.lambda.im.total_cmp(&b.lambda.im));
        let mut pairs = Vec::with_capacity(guesses.len());
        let groups = guesses.len().div_ceil(TOGETHER).max(1);
        for some in guesses.chunks(guesses.len().div_ceil(groups).max(1)) {
            let sigma = some.iter().map(|guess| guess.lambda).sum::<Complex<f64>>() / some.len() as f64;
            let factor = Factor::new(&self.symbolic, &self.pencil, sigma)?;
            let right = some.iter().map(|guess| unit(guess.right.as_slice())).collect();
            let left = some.iter().map(|guess| unit(guess.left.conjugate().as_slice())).collect();
            let mut trials = self.trials(some.iter().map(|guess| guess.lambda), right, left);
            for _ in 0..STEPS {
                let [right, left] = [Side::Right, Side::Left].map(|side| self.corrected(&factor, &trials, side));
                trials = self.trials(trials.into_iter().map(|trial| trial.lambda()), right, left);
            }
            pairs.extend(trials.into_iter().map(|trial| trial.finish(&self.pencil)));
        }
        Ok(pairs)
    }

    /// The vectors of trials on one side, `x - Q(sigma)^-1 Q(lambda) x`, of unit length.
    fn corrected(&self, factor: &Factor<'_>, trials: &[Trial], side: Side) -> Vec<Vector> {
        let vectors: Vec<_> = trials.iter().map(|trial| trial.vector(side).clone()).collect();
        let parts = self.pencil.parts(side, &columns(&vectors));
        let residual = |(parts, trial): (&Parts<'_>, &Trial)| parts.sum(&self.pencil.weights(trial.lambda()));
        let residuals: Vec<_> = parts.iter().zip(trials).map(residual).collect();
        let mut corrections = columns(&residuals);
        factor.substitute(side, &mut corrections);
        let corrected = |(at, x): (usize, &Vector)| {
            let correction = corrections.col_as_slice(at);
            let better = unit(&x.iter().zip(correction).map(|(x, correction)| x - correction).collect::<Vec<_>>());
            // Where the shift is an eigenvalue a correction may be no number.
            if better.iter().all(|entry| entry.is_finite()) { better } else { x.clone() }
        };
        vectors.iter().enumerate().map(corrected).collect()
    }

    /// Trials with vectors x and y, at the Rayleigh quotients of these next to `lambdas`.
    fn trials(&self, lambdas: impl Iterator<Item = Complex<f64>>, x: Vec<Vector>, y: Vec<Vector>) -> Vec<Trial> {
        let parts = self.pencil.parts(Side::Right, &columns(&x));
        let vectors = lambdas.zip(x.into_iter().zip(y)).zip(&parts);
        vectors.map(|((lambda, (x, y)), parts)| Trial::new(&self.pencil, lambda, x, y, parts)).collect()
    }
}

fn wrong_length(found: usize) -> SparseError {
    let (value, allowed) = (found as f64, "as many as degrees of freedom");
    SparseError::Option { option: "the number of entries of the shape", value, allowed }
}
