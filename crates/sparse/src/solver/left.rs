//! Left vectors of eigenvalues whose right ones are known.

use faer::Mat;
use num_complex::Complex;

use super::blocks::starting_block;
use super::errors::{blocks_until, errors};
use super::factor::Factor;
use super::krylov::Krylov;
use super::products::Side;
use super::ritz::Ritz;
use super::types::{Counters, Options};
use crate::SparseError;

/// Largest relative residual of a left Ritz vector that is good enough, as a fraction of g, the distance of its eigenvalue from the next one over that from
/// the shift; chosen, so that a condition number has two digits or is one of a group.
const OF_GAP: f64 = 1e-2;
/// Least and largest value of that residual, whatever g is; chosen likewise.
const CONVERGED_LEFT: [f64; 2] = [1e-6, 1e-4];
/// Largest backward error of the worst left vectors at which the space ends, as a fraction of the error that all are allowed; chosen: only those that are the
/// worst by their residuals are looked at.
const OF_TOLERANCE_LEFT: f64 = 0.1;
/// Number of columns of the left basis at the first look, as a fraction of the columns of the right basis; chosen: with less, there are more looks; with more,
/// columns may be made that are not needed.
const LEFT_LOOK: f64 = 0.7;
/// Factor on that number from one look to the next; chosen likewise.
const LEFT_GROWTH: f64 = 1.08;
/// Largest distance of a left from a right Ritz value of the same eigenvalue, as a fraction of the distance from the shift; chosen, between
/// [`CONVERGED_LEFT`]: with less, a left value that is good enough finds no partner; with more, it may take the partner of a neighbour.
const SAME_AS_RIGHT: f64 = 1e-5;

type Block = Mat<Complex<f64>>;

/// Conjugates of left vectors: right ones of the transposed system, whose Krylov space starts with combinations of the right vectors, which they are where
/// the matrices are symmetric. The block of `options` has to have more columns than any of the eigenvalues has copies. `None` for an eigenvalue whose left
/// vector is not accurate enough when the space is full.
pub(super) fn left_vectors(
    factor: &Factor<'_>,
    scale: f64,
    lambdas: &[Complex<f64>],
    right: &Block,
    columns: usize,
    options: &Options,
    counters: &mut Counters,
) -> Result<Vec<Option<Vec<Complex<f64>>>>, SparseError> {
    let (pencil, sigma) = (factor.pencil(), factor.shift());
    let (n, block) = (pencil.order(), options.block);
    let mix = starting_block(lambdas.len(), block);
    let mut start: Block = Mat::zeros(2 * n + pencil.states().len(), block);
    for (j, &lambda) in lambdas.iter().enumerate() {
        let phi = right.col_as_slice(j);
        let states: Vec<_> = pencil
            .states()
            .iter()
            .map(|state| {
                let driven: Complex<f64> = state.force.iter().map(|&(dof, f)| phi[dof] * f).sum();
                driven * lambda / (lambda + state.decay)
            })
            .collect();
        for column in 0..block {
            let weight = mix[(j, column)];
            let target = start.col_as_slice_mut(column);
            for (i, &value) in phi.iter().enumerate() {
                target[i] += weight * value;
                target[n + i] += weight * lambda * value / scale;
            }
            target[2 * n..].iter_mut().zip(&states).for_each(|(t, z)| *t += weight * z);
        }
    }
    let capacity = options.columns.max(2 * block);
    let mut krylov = Krylov::new(factor, Side::Left, scale, &start, capacity, block)?;
    let mut next = (LEFT_LOOK * columns as f64) as usize;
    loop {
        krylov.step()?;
        let is_last = krylov.is_complete() || krylov.dimension() + krylov.pending() > capacity;
        if krylov.dimension() < next && !is_last {
            continue;
        }
        let ritz = Ritz::of(&krylov, sigma)?;
        let partners = partners(lambdas, sigma, &ritz);
        let found: Vec<usize> = partners.iter().flatten().copied().collect();
        if found.len() < lambdas.len() && !is_last {
            next = ((next as f64 * LEFT_GROWTH) as usize).max(next + block);
            continue;
        }
        let allowed = OF_TOLERANCE_LEFT * options.left_tolerance;
        let error = errors(&krylov, &ritz, &ritz.worst(&found)).into_iter().fold(0.0, f64::max);
        if is_last || error <= allowed {
            counters.solves += krylov.dimension() + block;
            let vectors = krylov.displacements(&ritz.vectors_of(&found));
            let mut vectors = (0..found.len()).map(|j| vectors.col_as_slice(j).to_vec());
            return Ok(partners.iter().map(|partner| partner.and_then(|_| vectors.next())).collect());
        }
        next = krylov.dimension() + blocks_until(allowed, error).max(1) * block;
    }
}

/// The left Ritz value of each right one, each used once, if it has converged.
fn partners(lambdas: &[Complex<f64>], sigma: Complex<f64>, left: &Ritz) -> Vec<Option<usize>> {
    let mut is_free = vec![true; left.lambdas.len()];
    let enough = |at: usize| {
        let own = left.lambdas[at];
        let distance = |(j, other): (usize, &Complex<f64>)| if j == at { f64::INFINITY } else { (other - own).norm() };
        let gap = left.lambdas.iter().enumerate().map(distance).fold(f64::INFINITY, f64::min);
        let [least, most] = CONVERGED_LEFT;
        (OF_GAP * gap / (own - sigma).norm()).clamp(least, most)
    };
    let mut partner = |lambda: &Complex<f64>| {
        let distance = |&j: &usize| (left.lambdas[j] - lambda).norm();
        let free = (0..is_free.len()).filter(|&j| is_free[j]);
        let nearest = free.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let is_same =
            distance(&nearest) <= SAME_AS_RIGHT * (lambda - sigma).norm() && left.residuals[nearest] <= enough(nearest);
        is_same.then(|| {
            is_free[nearest] = false;
            nearest
        })
    };
    lambdas.iter().map(&mut partner).collect()
}
