//! The brakes of case files, as [`UncertainBrake`](crate::study::UncertainBrake)s.

mod finite_elements;
mod friction_parameters;
mod labels;
mod lattice;
mod matrices;

pub use finite_elements::{BESIDE, Bases, FiniteElementBrake, FiniteElementSample, Part, ReducedSet, frictionless};
pub use lattice::{FrictionDraw, LatticeBrake, LatticeSample, lattice, sliding};
pub use matrices::MatricesBrake;
