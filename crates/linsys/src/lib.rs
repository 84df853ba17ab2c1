//! The type that every stage passes on: a linear second-order system with optional internal states.
//!
//! ```text
//! M u'' + C u' + K u = F z        u: n displacements,  M, C, K: n x n
//!                 z' = -a z + E u'  z: s internal states, a: s, E: s x n, F: n x s
//! ```
//!
//! Internal states are first order: LuGre's bristles, a Maxwell element of a viscoelastic shim. With
//! `u(t) = Re(phi e^{lambda t})` they can be eliminated exactly, which leaves the n x n matrix
//! `Q(lambda) = lambda^2 M + lambda C + K - lambda F diag(1 / (lambda + a)) E`; see
//! [`SecondOrder::dynamic_stiffness`].
//!
//! This crate knows neither brakes nor eigenvalues.
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
mod market;
mod second_order;

pub use affine::{AffineSystem, Channel, ChannelGain, Lag, OperatingPoint, Term};
pub use dof::DofMap;
pub use error::{LinsysError, Matrix};
pub use market::{LARGEST_ORDER, MarketProblem, read_market};
pub use second_order::{Internal, SecondOrder};
