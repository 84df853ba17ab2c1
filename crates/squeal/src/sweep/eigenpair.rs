//! One eigenvalue with its vectors, found from that of a neighbouring system: no spectrum is needed.

use cea::{CeaError, Eigentriple, Workspace, left_vector, right_vector};
use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

/// Change of an eigenvalue, relative to it, at which it stands; chosen: some roundings.
const SETTLED: f64 = 1e-14;
/// Change below which it stands as soon as it does not fall any more: rounding errors are left; chosen.
const ROUNDING: f64 = 1e-9;
/// Most iterations; chosen: convergence is cubic, and a guess that needs more is near another mode.
const MOST_ITERATIONS: usize = 8;

/// An eigenvalue and its right and left vector, of unit norm.
#[derive(Debug, Clone)]
pub(super) struct Eigenpair {
    /// rad/s.
    pub lambda: Complex<f64>,
    pub right: DVector<Complex<f64>>,
    left: DVector<Complex<f64>>,
}

impl Eigenpair {
    /// The vectors of an eigenvalue that is known.
    ///
    /// # Errors
    /// As [`right_vector`].
    pub fn of(system: &SecondOrder, lambda: Complex<f64>, work: &mut Workspace) -> Result<Self, CeaError> {
        Ok(Self { lambda, right: right_vector(system, lambda, work)?, left: left_vector(system, lambda, work)? })
    }

    /// The pair of `system` that is next to `guess` with the vectors of this pair, by two-sided Rayleigh iteration (Ostrowski 1959,
    /// for `Q(lambda)`: Schreiber 2008); `None` where that does not converge.
    pub fn of_neighbour(&self, system: &SecondOrder, guess: Complex<f64>) -> Option<Self> {
        let mut pair = Self { lambda: guess, ..self.clone() };
        let mut last = f64::INFINITY;
        for iteration in 0..MOST_ITERATIONS {
            let (q, slope) = pair.matrices(system);
            let step = pair.left.dotc(&(&q * &pair.right)) / pair.left.dotc(&(&slope * &pair.right));
            pair.lambda -= step;
            let change = step.norm() / pair.lambda.norm();
            // With the vectors of the other system the first step says nothing: it may be zero though lambda is no eigenvalue.
            if iteration > 0 && (change <= SETTLED || (change <= ROUNDING && change >= last)) {
                return Some(pair);
            }
            last = change;
            // At an eigenvalue that is exact there is nothing to solve: a little beside it the vectors are the same.
            let vectors = pair.iterated(system).or_else(|| {
                let beside = pair.lambda * (1.0 + ROUNDING);
                Self { lambda: beside, ..pair.clone() }.iterated(system)
            });
            [pair.right, pair.left] = vectors?;
        }
        None
    }

    /// The right and the left vector after one step of inverse iteration; `None` where Q is singular.
    fn iterated(&self, system: &SecondOrder) -> Option<[DVector<Complex<f64>>; 2]> {
        let (q, slope) = self.matrices(system);
        let left = unit(q.adjoint().lu().solve(&slope.ad_mul(&self.left))?)?;
        Some([unit(q.lu().solve(&(&slope * &self.right))?)?, left])
    }

    fn matrices(&self, system: &SecondOrder) -> (DMatrix<Complex<f64>>, DMatrix<Complex<f64>>) {
        (system.dynamic_stiffness(self.lambda), system.dynamic_stiffness_derivative(self.lambda))
    }

    /// d lambda / d p of `system` from two systems whose parameters are `distance` apart.
    pub fn rate(&self, system: &SecondOrder, [below, above]: [&SecondOrder; 2], distance: f64) -> Complex<f64> {
        let change = above.dynamic_stiffness(self.lambda) - below.dynamic_stiffness(self.lambda);
        Eigentriple::of_vectors(system, self.lambda, self.right.clone(), self.left.clone()).rate_over(&change, distance)
    }

    /// How alike two shapes are: 1 for parallel ones.
    pub fn likeness(&self, other: &Self) -> f64 {
        self.right.dotc(&other.right).norm()
    }
}

fn unit(vector: DVector<Complex<f64>>) -> Option<DVector<Complex<f64>>> {
    let norm = vector.norm();
    (norm.is_finite() && norm > 0.0).then(|| vector.unscale(norm))
}
