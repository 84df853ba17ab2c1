//! Eigenvalues of a system without damping that are on the imaginary axis, though the bounds of their real parts do not tell.
//!
//! Without damping `(lambda^2 M + K) phi = 0` with real matrices, so that with lambda also `-conj(lambda)` is an eigenvalue, as far from the axis on its
//! other side. Where a rectangle holds both and one alone is listed there, the two are the same.

use cea::Verdict;
use num_complex::Complex;

use super::types::{Eigenpair, Rectangle};
use crate::SparseSecondOrder;

/// Distance from all others, and from the border, as a multiple of its bound, from which on an eigenvalue is alone: its mirror image is within two bounds
/// of it, and the two computed ones within four; chosen twice that.
const ALONE: f64 = 8.0;

/// Says of each eigenvalue of a system without damping whose verdict is open, and that is alone, that it is marginal.
pub(super) fn settle_undamped(system: &SparseSecondOrder, rectangle: &Rectangle, pairs: &mut [Eigenpair]) {
    if !system.states.is_empty() || system.c.values().iter().any(|value| *value != 0.0) {
        return;
    }
    let known: Vec<_> = pairs.iter().map(|pair| (pair.lambda, pair.bound)).collect();
    for (at, pair) in pairs.iter_mut().enumerate() {
        let reach = |bound: f64| ALONE * pair.bound.max(bound);
        let is_apart = |(other, &(lambda, bound)): (usize, &(Complex<f64>, f64))| {
            other == at || (pair.lambda - lambda).norm() > reach(bound)
        };
        let is_inside = !pair.on_border && rectangle.border_distance(pair.lambda) > reach(0.0);
        if matches!(pair.verdict, Verdict::Undecided { .. }) && is_inside && known.iter().enumerate().all(is_apart) {
            pair.verdict = Verdict::Marginal { tolerance: pair.bound };
        }
    }
}
