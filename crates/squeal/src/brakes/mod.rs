//! The brakes of case files, as [`UncertainBrake`](crate::study::UncertainBrake)s.

mod lattice;
mod matrices;

pub use lattice::{FrictionDraw, LatticeBrake, LatticeSample, lattice, sliding};
pub use matrices::MatricesBrake;
