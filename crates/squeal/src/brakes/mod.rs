//! Makers of brakes: what a case file describes, as a [`UncertainBrake`](crate::study::UncertainBrake).

mod lattice;
mod matrices;

pub use lattice::{FrictionDraw, LatticeBrake, LatticeSample, lattice, sliding};
pub use matrices::MatricesBrake;
