//! Complex eigenvalue analysis of second-order systems.
//!
//! Convention everywhere: `u(t) = Re(phi e^{lambda t})`, so `Re lambda > 0` grows and `f = Im lambda / 2 pi`.
//! This crate never sees a lattice, a friction law or a random number.

pub mod certified;
mod dense;
mod error;
mod feedback;
mod francis;
mod lanes;
mod spectrum;
mod stability;
mod verdict;
mod workspace;

pub use dense::{
    BatchSolver, EigenSolver, Mode, Modes, QrSolver, StandardForm, backward_error, left_vector, mass_norm_squared,
    pair_numbers, ranks_together, right_vector, right_vectors, right_vectors_of_all, singular_vectors,
};
#[cfg(feature = "lapack")]
pub use dense::{LapackSolver, dgeev, dggev};
pub use error::CeaError;
pub use feedback::{Channels, EigenvaluePair, Feedback, Gain, Growing, Line, NewtonStep, Pilots, Secular, peak_gain};
pub use spectrum::{Spectrum, by_frequency, damping_ratio, frequency_hz, sort};
pub use stability::{Judged, StabilityCensus, stability_census, verdict};
pub use verdict::Verdict;
pub use workspace::{Counters, Workspace};
