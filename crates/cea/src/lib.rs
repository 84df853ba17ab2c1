//! Complex eigenvalue analysis of second-order systems.
//!
//! Convention everywhere: `u(t) = Re(phi e^{lambda t})`, so `Re lambda > 0` grows and `f = Im lambda / 2 pi`.
//! This crate never sees a lattice, a friction law or a random number.

mod batch;
mod error;
mod francis;
mod gain;
pub mod general;
#[cfg(feature = "lapack")]
mod lapack;
mod mode;
mod modes;
mod qr;
mod scaling;
mod secular;
mod solver;
mod spectrum;
mod split;
mod stability;
mod vectors;

pub use batch::BatchSolver;
pub use error::CeaError;
pub use gain::{Channels, peak_gain};
#[cfg(feature = "lapack")]
pub use lapack::{LapackSolver, dgeev, dggev};
pub use mode::Mode;
pub use modes::{Modes, mass_norm_squared, mass_times, pair_numbers, ranks_together};
pub use qr::QrSolver;
pub use scaling::StandardForm;
pub use secular::{Anchors, EigenvaluePair, Feedback, Gain, GainPath, Growing, NewtonStep, Secular};
pub use solver::{Counters, EigenSolver, Workspace};
pub use spectrum::{Spectrum, Verdict, by_frequency, damping_ratio, frequency_hz, sort};
pub use stability::verdict;
pub use vectors::{backward_error, left_vector, right_vector, right_vectors, right_vectors_of_all, singular_vectors};
