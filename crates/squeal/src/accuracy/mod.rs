//! How right the answers are, and at what price: estimators of an occurrence against the exact integral, solver routes
//! against refined eigenvalues, the lattice at its worst.
//!
//! **Which laws have an exact integral.** With one draw shared by all contacts the friction parameters act through few
//! coefficients, because all contacts have the same tangent:
//!
//! | law | coefficients of the system | integral |
//! | --- | --- | --- |
//! | Amontons-Coulomb | mu | one-dimensional: [`exact`] |
//! | velocity-dependent, Stribeck | mu, mu_y, slope h | three-dimensional |
//! | LuGre | mu, mu_y, slope, decay a, drive x force | five-dimensional |
//!
//! Where `K = K_0 + mu_y K_y` is linear in the lateral coefficient, which these laws draw on its own, the integral over mu_y
//! given the other coefficients is again one of [`exact`]'s: a smooth function of two (or four) coefficients is left, whose
//! mean quasi-Monte Carlo or a tensor grid finds with far fewer points than the jump of an indicator takes. Both speed
//! ranges share that function. This is not implemented: for these laws the occurrences come from [`monte_carlo`] and
//! [`quasi_monte_carlo`], each with the error that it states.

mod branches;
mod coalescence;
mod compare;
mod critical;
mod distribution;
mod error;
mod exact;
mod family;
mod hard;
mod integral;
mod peers;
mod perturbation;
mod refine;
mod report;
mod routes;
mod sampling;
mod worst;

pub use coalescence::{ExceptionalPoint, exceptional_point};
pub use compare::{EstimatorRow, Estimators, RouteRow, compare_estimators, compare_routes};
pub use critical::{Crossing, Crossings};
pub use distribution::{cumulative, quantile, support};
pub use error::AccuracyError;
pub use exact::{Exact, exact};
pub use family::{Derivative, Family};
pub use hard::judge_folder;
pub use integral::{Integral, Occurrence, Piece};
pub use perturbation::{Expansion, TaylorOrder, perturbation};
pub use refine::{Refined, refine, refine_all};
pub use report::{AccuracyReport, Effort, accuracy};
pub use routes::{Route, Spectra, relative_errors, routes};
pub use sampling::{Estimated, Estimates, monte_carlo, quasi_monte_carlo};
pub use worst::{HardCase, HardResult, Judged, approach, extremes, onset, with_lateral};
