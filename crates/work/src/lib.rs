//! Work per cycle of any number of force families in a complex mode.
//!
//! In a mode `u(t) = Re(phi e^{lambda t})` a force `Re(f e^{lambda t})` on degree of freedom j does, in one period at
//! frozen amplitude, the work
//!
//! ```text
//! W_j = pi Im(conj(phi_j) f_j),    f = -(lambda C + K) phi + F z,    z = lambda E phi / (lambda + a)
//! ```
//!
//! with C, K, F, E and a of one family of forces. `W > 0` feeds the mode, `W < 0` drains it. All results are divided by
//! `phi^H M phi`, so they do not depend on how phi is scaled: J/(kg m^2) = 1/s^2.
//!
//! Which families there are is the caller's choice: *friction*, all of a system that friction makes; *damping*, the
//! dashpots of the structure; *gyroscopic* forces of a rotor. Elastic forces are symmetric and do no net work, so they
//! are left out, which leaves the identity
//! `sum W = 2 pi Re(lambda) Im(lambda) phi^H M phi`: a mode grows exactly as fast as the net work feeds it.
//! [`ModeWork::identity_residual`] says how well it holds.
//!
//! This crate knows linear systems only: no brake, no friction law, no eigenvalue solver. [`family_work`] is its one
//! function and has an example.

mod error;
mod family_work;

pub use error::WorkError;
pub use family_work::{FamilyWork, ForceFamily, ModeWork, family_work};

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
