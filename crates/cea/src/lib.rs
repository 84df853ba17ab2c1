//! Complex eigenvalue analysis of second-order systems.
//!
//! This crate finds the eigenvalues lambda of `Q(lambda) phi = (lambda^2 M + lambda C + K) phi = 0`, where Q includes the internal
//! states of [`linsys::SecondOrder`]. Convention everywhere: `u(t) = Re(phi e^{lambda t})`, so that a mode with `Re lambda > 0`
//! grows and `f = Im lambda / 2 pi`; eigenvalues are in rad/s.
//!
//! | to find | use | in |
//! | --- | --- | --- |
//! | which eigenvalues grow, are damped, or are undecided | [`stability_census`] | `stability` |
//! | how many modes of a spectrum are unstable, those on the axis told apart | [`CountedSpectrum`] | `stability` |
//! | all eigenvalues, fast, of one system or of many | [`QrSolver`], [`BatchSolver`] | `dense` |
//! | which eigenvalues are modes; shapes of chosen modes | [`Modes`], [`right_vectors`], [`Mode`] | `dense` |
//! | eigenvalues of any M, C, K, singular or not, each with backward error, condition number, bound | [`certified`] | a crate of its own |
//! | the growing modes of a structure with friction, without a spectrum | [`Secular`] | `condensed_friction` |
//! | how an eigenvalue moves with the numbers of its system, and how far that holds | [`Eigentriple`], [`Expansion`] | `sensitivity` |
//! | the real modes of an undamped structure, and how much of each is in a complex mode | [`RealModes`] | `real_modes` |
//! | how strong feedback may be before a mode can grow | [`h_infinity_norm_bound`] | `h_infinity` |
//!
//! ```
//! use cea::{EigenSolver, QrSolver, Workspace, frequency_hz, stability_census};
//! use linsys::SecondOrder;
//! use nalgebra::dmatrix;
//!
//! // A mass of 0.4 kg in x and z; friction, mu = 0.5 on a contact of 3.5e7 N/m, makes the stiffness unsymmetric: flutter.
//! let k = dmatrix![4.6e7, -6.7e6 + 0.5 * 3.5e7; -6.7e6, 5.8e7];
//! let system = SecondOrder::new(dmatrix![0.4, 0.0; 0.0, 0.4], dmatrix![100.0, 0.0; 0.0, 100.0], k)?;
//! let mut work = Workspace::default();
//! let census = stability_census(&system, &mut work)?;
//! assert_eq!((census.growing.len(), census.damped, census.is_open()), (1, 1, false));
//! assert_eq!(frequency_hz(census.growing[0].lambda).round(), 1818.0);
//!
//! let spectrum = QrSolver.eigenvalues(&system, &mut work)?; // all four, in conjugate pairs
//! assert_eq!(spectrum.eigenvalues.len(), 4);
//! assert_eq!(work.counters.eigenvalue_solves, 2); // what was computed is counted
//! # Ok::<(), cea::CeaError>(())
//! ```
//!
//! This crate never sees a lattice, a friction law or a random number; modes are followed from system to system in `tracking`.
//! Matrices are [`nalgebra`]'s and complex numbers [`num_complex`]'s. Both crates are re-exported, because the types of another
//! version would not be accepted.

mod condensed_friction;
mod dense;
mod eigenvalue_pair;
mod error;
mod h_infinity;
mod real_modes;
mod sensitivity;
mod spectrum;
mod stability;
mod workspace;

pub use certified;
pub use nalgebra;
pub use num_complex;

pub use certified::{CertifiedError, JudgedEigenvalue, Verdict, by_frequency, sort};
pub use condensed_friction::{Anchors, Feedback, Gain, GainPath, Growing, LeftOpen, NewtonStep, NoSecular, Secular};
pub use dense::{
    BatchSolver, EigenSolver, Mode, Modes, QrSolver, StandardForm, WholeSpectra, backward_error, check_mass, fix_phase,
    left_vector, mass_norm_squared, pair_numbers, ranks_together, right_and_left_vectors_of_all, right_vector,
    right_vectors, right_vectors_of_all, singular_vectors,
};
#[cfg(feature = "lapack")]
pub use dense::{LapackSolver, dgeev, dggev};
pub use eigenvalue_pair::{EigenvaluePair, OnPath, eigenvalue_pairs};
pub use error::CeaError;
pub use h_infinity::{AxisMargins, Channels, NoNormBound, NormBound, h_infinity_norm_bound};
pub use real_modes::{NoRealModes, RealModes};
pub use sensitivity::{Eigentriple, Expansion, Perturbation, Rates, Separation};
pub use spectrum::{EQUAL_BUT_FOR_ROUNDING, Spectrum, damping_ratio, frequency_hz, rank_order, real_count};
pub use stability::{
    CountedSpectrum, ROUNDED_DATA, StabilityCensus, Threshold, grows_too_fast, is_alone, stability_census, verdict,
    verdicts, verdicts_beyond,
};
pub use workspace::{Counters, Workspace};

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
