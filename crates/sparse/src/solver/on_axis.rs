//! Eigenvalues of a system without damping that are on the imaginary axis, though the bounds of their real parts do not tell.
//!
//! Without damping `(lambda^2 M + K) phi = 0` with real matrices, so that with lambda also `-conj(lambda)` is an eigenvalue, as far from the axis on its
//! other side. Where a rectangle holds both and one alone is listed there, the two are the same.

use cea::{Verdict, is_alone};

use super::types::{Eigenpair, Rectangle};
use crate::SparseSecondOrder;

/// Least distance from the border, in error bounds, of an eigenvalue whose mirror image is in the rectangle too; chosen: as far as others are from one that
/// is alone.
const INSIDE: f64 = 8.0;

/// Says of each eigenvalue of a system without damping whose verdict is open, and that is alone, that it is marginal.
pub(super) fn settle_undamped(system: &SparseSecondOrder, rectangle: &Rectangle, pairs: &mut [Eigenpair]) {
    if !system.states.is_empty() || system.h.is_some() || system.c.values().iter().any(|value| *value != 0.0) {
        return;
    }
    let known: Vec<_> = pairs.iter().map(|pair| (pair.lambda, pair.bound)).collect();
    for (at, pair) in pairs.iter_mut().enumerate() {
        let is_inside = !pair.on_border && rectangle.border_distance(pair.lambda) > INSIDE * pair.bound;
        if matches!(pair.verdict, Verdict::Undecided { .. }) && is_inside && is_alone(&known, at) {
            pair.verdict = Verdict::Marginal { tolerance: pair.bound };
        }
    }
}
