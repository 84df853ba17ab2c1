//! Estimators of the occurrences of a scene: the exact integral, a control variate, plain and quasi-Monte Carlo.
//!
//! **Which laws have an exact integral.** With one draw shared by all contacts the friction parameters act through few
//! coefficients, because all contacts have the same tangent:
//!
//! | law | acts through | occurrence |
//! | --- | --- | --- |
//! | Amontons-Coulomb | mu | one-dimensional integral: [`exact`] |
//! | velocity-dependent, Stribeck | mu, slope h | [`controlled`] |
//! | LuGre | mu, complex slope H(i omega) | [`controlled`] |
//!
//! [`controlled`] guesses from a table of eigenvalues over mu and H which modes are unstable, has the mean of the guess
//! from scrambled Sobol points without an eigenproblem, and corrects it by full solutions of independent samples. Its
//! interval rests on the counts of the correction alone and holds for any guess. With lateral friction, which the guess
//! does not know, the interval is as right and wider.

mod branches;
mod cells;
mod control;
mod critical;
mod distribution;
mod draws;
mod error;
mod exact;
mod family;
mod integral;
mod interval;
mod node;
mod sampling;
mod sheet;
mod stratum;
mod table;

pub use branches::Link;
pub use control::{Controlled, controlled};
pub use critical::{Crossing, Crossings};
pub use distribution::{cumulative, quantile, support};
pub use draws::FrictionPoints;
pub use error::EstimatorError;
pub use exact::{Exact, exact};
pub use family::{Derivative, Family};
pub use integral::{Integral, Occurrence, Piece, integrate};
pub use sampling::{Estimated, Estimates, monte_carlo, quasi_monte_carlo};
pub use table::Table;
