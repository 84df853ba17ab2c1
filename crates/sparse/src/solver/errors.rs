//! Errors of Ritz vectors: how large they are, and how many blocks more make them small.

use super::blocks::length;
use super::krylov::Krylov;
use super::products::Parts;
use super::ritz::Ritz;

/// Least factor by which one more block divides backward errors; chosen: with less, more blocks than needed are made before the next look; with more, there are
/// more looks.
const FALL: f64 = 2.5;

/// The backward errors of the Ritz values `some`, by their indices, with their vectors.
pub(super) fn errors(krylov: &Krylov<'_>, ritz: &Ritz, some: &[usize]) -> Vec<f64> {
    let (pencil, vectors) = (krylov.pencil(), krylov.displacements(&ritz.vectors_of(some)));
    let parts = pencil.parts(krylov.side(), &vectors);
    let error = |(j, (parts, &at)): (usize, (&Parts<'_>, &usize))| {
        let lambda = ritz.lambdas[at];
        parts.sum(&pencil.weights(lambda)).norm() / (pencil.measure(lambda) * length(vectors.col_as_slice(j)))
    };
    parts.iter().zip(some).enumerate().map(error).collect()
}

/// Number of further blocks that an error needs to be as small as is wanted.
pub(super) fn blocks_until(wanted: f64, error: f64) -> usize {
    (error / wanted).log(FALL).ceil() as usize
}
