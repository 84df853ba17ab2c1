//! Structures with feedback, such as friction: a bound of the feedback below which no mode becomes unstable, and the growing
//! modes without a spectrum.

mod h_infinity;
mod secular;

pub use h_infinity::{AxisMargins, Channels, NoNormBound, NormBound, h_infinity_norm_bound};
pub use secular::{Anchors, Feedback, Gain, GainPath, Growing, LeftOpen, NewtonStep, NoSecular, Secular};
