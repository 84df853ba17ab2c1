//! Eigenpairs of the full system and where they are wanted.

use num_complex::Complex;

use crate::{Eigenpair, Rectangle, SparseError, SparseSecondOrder, eigenpairs_in};

/// All eigenpairs of a full system in a rectangle, and the factorisations that they took.
pub(super) fn solve(
    system: &SparseSecondOrder,
    rectangle: &Rectangle,
    options: &crate::Options,
) -> Result<(Vec<Eigenpair>, u64), SparseError> {
    let found = eigenpairs_in(system, rectangle, options, &mut |_| ())?;
    Ok((found.pairs, found.counters.factorisations as u64))
}

/// The distance of a number from a rectangle, zero inside.
pub(super) fn outside(rectangle: &Rectangle, lambda: Complex<f64>) -> f64 {
    let beyond = |x: f64, [low, high]: [f64; 2]| (low - x).max(x - high).max(0.0);
    beyond(lambda.re, rectangle.re).hypot(beyond(lambda.im, rectangle.im))
}

/// The largest |lambda| in a rectangle.
pub(super) fn largest(rectangle: &Rectangle) -> f64 {
    let greatest = |[low, high]: [f64; 2]| low.abs().max(high.abs());
    greatest(rectangle.re).hypot(greatest(rectangle.im))
}
