//! Estimators of the occurrences of a scene: the exact integral, a control variate, plain and quasi-Monte Carlo.
//!
//! **Which estimator applies.** Where friction is the same in all contacts, its parameters act through few numbers:
//!
//! | law, one draw for all contacts | acts through | occurrence |
//! | --- | --- | --- |
//! | Amontons-Coulomb | mu | one-dimensional integral: [`exact`] |
//! | velocity-dependent, Stribeck | mu, slope h | [`control_variate`] |
//! | LuGre | mu, complex slope H(i omega) | [`control_variate`] |
//!
//! [`control_variate`] predicts the unstable modes from response surfaces of the eigenvalues over mu and H ([`Surrogate`]),
//! computes the mean of the prediction over scrambled Sobol points without solving an eigenproblem, and corrects the mean by
//! full solutions of independent samples. Its interval follows from the counts of the correction alone and is valid for any
//! prediction. With lateral friction, which the surrogate neglects, the interval is valid and wider.

mod cell_builder;
mod cheapest;
mod contradiction;
mod control_variate;
#[cfg(test)]
mod coverage;
mod error;
mod evaluations;
mod exact;
mod friction_points;
mod integral;
mod interval;
mod kd_tree;
mod one_parameter_family;
mod response_surface;
mod sample_points;
mod sampling;
mod stratum;
mod surrogate;

pub use cheapest::{Estimator, SceneOccurrences, friction_points, scene_occurrences, scene_occurrences_beside};
pub use contradiction::Rejected;
pub use control_variate::control_variate;
pub use error::EstimatorError;
pub use evaluations::Evaluations;
pub use exact::{Exact, exact};
pub use friction_points::FrictionPoints;
pub use integral::{Integral, OccurrenceBounds, Piece, integrate};
pub use interval::ControlVariateEstimate;
pub use one_parameter_family::OneParameterFamily;
pub use sampling::{Estimated, Estimates, monte_carlo, quasi_monte_carlo};
pub use surrogate::Surrogate;
