//! Friction laws for stability analysis: the coefficient of friction in steady sliding and its linearisation.
//!
//! | law | steady coefficient | tangent |
//! | --- | --- | --- |
//! | [`AmontonsCoulomb`] | `mu` | slope 0 |
//! | [`VelocityDependent`] | `mu_k + (mu_s - mu_k) e^{-alpha v}` | slope `-alpha (mu_s - mu_k) e^{-alpha v}` |
//! | [`Stribeck`] | `g(v) + sigma2 v` | slope `g'(v) + sigma2` |
//! | [`LuGre`] | `g(v) + sigma2 v` | slope and one internal state, the bristle |
//!
//! with `g(v) = mu_k + (mu_s - mu_k) e^{-(v / v_s)^2}`. This crate knows scalars only: neither a brake nor a matrix.
//! A new law is one file with one `impl` of [`FrictionLaw`].
//!
//! ```
//! use friction::{FrictionLaw, VelocityDependent, VelocityDependentParameters};
//!
//! let law = VelocityDependent::new(VelocityDependentParameters { mu_s: 0.55, mu_k: 0.45, alpha: 1.5 })?;
//! let tangent = law.tangent(&law.steady(2.0)?);
//! assert!((tangent.mu - (0.45 + 0.10 * (-3.0_f64).exp())).abs() < 1e-15);
//! assert!(tangent.slope < 0.0); // friction that falls with speed feeds vibration
//! # Ok::<(), friction::FrictionError>(())
//! ```

mod amontons_coulomb;
mod error;
mod law;
mod lugre;
mod series;
mod stribeck;
mod velocity_dependent;

pub use amontons_coulomb::AmontonsCoulomb;
pub use error::{Allowed, FrictionError};
pub use law::{FrictionLaw, InternalTangent, Steady, Tangent};
pub use lugre::{BristleDamping, BristleMotion, LuGre, LuGreParameters};
pub use series::{FrictionSeries, product_term};
pub use stribeck::{Stribeck, StribeckParameters};
pub use velocity_dependent::{VelocityDependent, VelocityDependentParameters};

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
