//! Linear second-order systems with optional internal states, the type that all other crates exchange.
//!
//! ```text
//! M u'' + C u' + K u = F z        u: n displacements,  M, C, K: n x n
//!                 z' = -a z + E u'  z: s internal states, a: s, E: s x n, F: n x s
//! ```
//!
//! Internal states are first order, such as the bristles of LuGre friction or a Maxwell element of a viscoelastic shim. With
//! `u(t) = Re(phi e^{lambda t})` the internal states can be eliminated exactly, which leaves the n x n matrix
//! `Q(lambda) = lambda^2 M + lambda C + K - lambda F diag(1 / (lambda + a)) E`; see
//! [`SecondOrder::dynamic_stiffness`].
//!
//! | where | what |
//! | --- | --- |
//! | [`SecondOrder`] | M, C, K and internal states as numbers; `Q(lambda)` and its derivative |
//! | [`AffineSystem`] | a system as a sum of named terms and friction channels, with coefficients that are drawn |
//! | [`DofMap`] | which degrees of freedom are free; constrained ones are eliminated |
//! | [`real_times_complex`] | the product of a real matrix and a complex vector |
//! | [`reciprocal`] | that of a complex number of any size |
//!
//! This crate knows neither brakes nor eigenvalues. Matrices are [`nalgebra`]'s and complex numbers [`num_complex`]'s. Both
//! crates are re-exported, because the types of another version would not be accepted.
//!
//! ```
//! use linsys::SecondOrder;
//! use nalgebra::dmatrix;
//!
//! // One kilogram on a spring of 4 N/m: eigenvalues +-2i.
//! let system = SecondOrder::new(dmatrix![1.0], dmatrix![0.0], dmatrix![4.0])?;
//! let q = system.dynamic_stiffness(num_complex::Complex::new(0.0, 2.0));
//! assert!(q[(0, 0)].norm() < 1e-15);
//! # Ok::<(), linsys::LinsysError>(())
//! ```

mod affine;
mod dof;
mod error;
mod product;
mod reciprocal;
mod second_order;

pub use nalgebra;
pub use num_complex;

pub use affine::{AffineSystem, Channel, ChannelGain, Lag, OperatingPoint, Term};
pub use dof::DofMap;
pub use error::{LinsysError, Matrix};
pub use product::{form_of_sizes, real_times_complex};
pub use reciprocal::reciprocal;
pub use second_order::{Internal, SecondOrder};

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
