//! Where modes are wanted.

use num_complex::Complex;
use sparse::Rectangle;

/// The distance of a number from where modes are wanted, zero there: in the rectangle, or to its right
/// ([`Rectangle::contains_to_the_right`]). No mode grows too fast to be wanted; the upper limit of growth only says how far full problems
/// are solved.
pub(super) fn outside(rectangle: &Rectangle, lambda: Complex<f64>) -> f64 {
    let [low, high] = rectangle.im;
    (rectangle.re[0] - lambda.re).max(0.0).hypot((low - lambda.im).max(lambda.im - high).max(0.0))
}

/// The largest |lambda| in a rectangle.
pub(super) fn largest(rectangle: &Rectangle) -> f64 {
    let greatest = |[low, high]: [f64; 2]| low.abs().max(high.abs());
    greatest(rectangle.re).hypot(greatest(rectangle.im))
}
