//! The brakes that [case files](case) make, as [`UncertainBrake`](study::UncertainBrake)s.
//!
//! | to | see |
//! | --- | --- |
//! | read a case, of any kind | [`case::CaseFile`] |
//! | make it a brake | [`make`]; [`LatticeBrake`], [`MatricesBrake`], [`FiniteElementBrake`] |
//! | make what takes long once | [`make_prepared`], [`Prepared`] |
//!
//! A study, as `squeal run` runs it:
//!
//! ```
//! use brakes::LatticeBrake;
//! use brakes::case::LatticeCase;
//!
//! # std::env::set_current_dir("../..")?;
//! # let folder = tempfile::tempdir()?;
//! # let dir = folder.path();
//! let mut case = LatticeCase::read("cases/two-by-two.toml".as_ref())?;
//! case.header.samples = 8;
//! let brake = LatticeBrake::new(case)?;
//! let manifest = squeal::run_study(&brake, dir, None, &mut |_, results, _| {
//!     for panel in results.panels() {
//!         println!("{}: {:?} unstable modes per CEA", results.describe(panel), results.mean_unstable(panel));
//!     }
//!     Ok(())
//! })?;
//! assert_eq!(manifest.failures, 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod any;
mod bits;
mod error;
mod finite_elements;
mod friction_parameters;
mod labels;
mod lattice;
mod matrices;
mod prepared;

pub use any::{AnyBrake, CaseBrake, Purpose, cost_of_making, make, make_prepared};
pub use case;
pub use error::Error;
pub use finite_elements::{
    Bases, Diverging, FiniteElementBrake, FiniteElementSample, Part, ReducedSet, at_medians, check_motion,
    frictionless, loads_at_medians,
};
pub use lattice::{FrictionDraw, LatticeBrake, LatticeSample, lattice, sliding};
pub use matrices::MatricesBrake;
pub use prepared::{Prepared, PreparedCounts};

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
