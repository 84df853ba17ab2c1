//! All eigenvalues of the dense problem `(lambda^2 M + lambda C + K) x = 0`, each with a bound of its error: any real M, C and K, singular or
//! not, in any units.
//!
//! [`solve`] finds all eigenvalues, [`certify`] how right each one is. How a problem is solved depends on what the
//! matrices are and is told in [`Route`]:
//!
//! 1. What is exactly singular is found exactly: infinite and zero eigenvalues are counted in a prime field, without a
//!    tolerance, and a pencil that is singular for every lambda is an error.
//! 2. The problem is equilibrated and scaled by powers of two.
//! 3. Where the scaled M is well conditioned and K regular, the eigenvalues are found from the standard form by the QR
//!    iteration; otherwise the infinite and zero eigenvalues are deflated and the QZ iteration does the rest. Where double has too
//!    few digits double-double arithmetic does it, by the QR iteration where one of the matrices can be inverted.
//!
//! ```
//! use certified::{Counters, Verdict, certify, solve};
//! use nalgebra::dmatrix;
//!
//! // A mass on a damped spring with a massless, undamped joint in between: M is singular.
//! let system = linsys::SecondOrder::new(
//!     dmatrix![1.0, 0.0; 0.0, 0.0],
//!     dmatrix![0.2, 0.0; 0.0, 0.0],
//!     dmatrix![2.0, -2.0; -2.0, 4.0],
//! )?;
//! let mut counters = Counters::default();
//! let spectrum = solve(&system, &mut counters)?;
//! assert_eq!((spectrum.eigenvalues.len(), spectrum.infinite), (2, 2));
//!
//! let certified = certify(&system, &spectrum, &mut counters)?;
//! assert!(certified.eigenvalues.iter().all(|e| e.verdict == Verdict::Stable && e.backward_error < 1e-15));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod balance;
mod blur;
mod certify;
mod chase;
mod clusters;
mod columns;
mod counters;
mod dd;
mod eliminate;
pub mod enclosures;
mod error;
mod expansion;
mod factors;
mod field;
#[cfg(test)]
mod fixtures;
pub mod francis;
mod groups;
mod hessenberg;

mod kernels;
mod lane;
pub mod lanes;
pub mod lu;
mod measure;
mod order;
mod pencil;
mod planar;
mod qz;
mod real;
mod refine;
mod residual;
mod scaled;
mod solve;
mod standard;
mod structure;
mod vectors;
mod verdict;
mod verdict_by_bound;

pub use certify::{Certified, CertifiedEigenvalue, SingleCertifier, certify, improved};
pub use clusters::{Cluster, ClusterKind};
pub use counters::Counters;
pub use error::CertifiedError;
pub use order::{by_frequency, sort};
pub use solve::{GeneralSpectrum, Route, solve};
pub use verdict::{JudgedEigenvalue, Verdict};

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
