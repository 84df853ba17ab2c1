//! Work per cycle of any number of force families in a complex mode, and its energy.
//!
//! In a mode `u(t) = Re(phi e^{lambda t})` a force `Re(f e^{lambda t})` on degree of freedom j does, in one period at
//! frozen amplitude, the work
//!
//! ```text
//! W_j = pi Im(conj(phi_j) f_j),    f = -(lambda C + K) phi + F z,    z = lambda E phi / (lambda + a)
//! ```
//!
//! with C, K, F, E and a of one family of forces. `W > 0` feeds energy into the mode, `W < 0` takes energy from it. All results
//! are divided by `phi^H M phi`, so that they do not depend on the scale of phi: J/(kg m^2) = 1/s^2.
//!
//! The caller chooses the families, for example *friction*, the contribution of friction to a system; *damping*, the dashpots
//! of the structure; *gyroscopic* forces of a rotor. Elastic forces have a symmetric K and do no net work. Without them the
//! identity `sum W = 2 pi Re(lambda) Im(lambda) phi^H M phi` holds: the growth rate follows from the net work.
//! [`ModeWork::identity_residual`] tells how well it holds.
//!
//! [`mode_energy`] says where the energy is that the work goes to: kinetic and strain energy of each part and body.
//!
//! This crate knows linear systems only: no brake, no friction law, no eigenvalue solver. Its functions are [`family_work`],
//! [`work_of_forces`] where forces are known without matrices, and [`mode_energy`], each with an example.

mod energy;
mod error;
mod family_work;

pub use energy::{Energy, ModeEnergy, StructurePart, mode_energy};
pub use error::WorkError;
pub use family_work::{FamilyForces, FamilyWork, ForceFamily, ModeWork, family_work, work_of_forces};

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
