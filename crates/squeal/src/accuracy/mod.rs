//! How right the answers are, and at what price: estimators of an occurrence against the exact integral, solver routes
//! against refined eigenvalues, the lattice at its worst.
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
mod coalescence;
mod compare;
mod control;
mod critical;
mod draws;
mod error;
mod exact;
mod family;
mod hard;
mod integral;
mod interval;
mod near;
mod node;
mod peers;
mod perturbation;
mod refine;
mod report;
mod routes;
mod sampling;
mod sheet;
mod stratum;
mod table;
mod tenth;
mod worst;

pub use coalescence::{ExceptionalPoint, exceptional_point};
pub use compare::{EstimatorRow, Estimators, RouteRow, compare_estimators, compare_routes};
pub use control::{Controlled, controlled};
pub use critical::{Crossing, Crossings};
pub use draws::FrictionPoints;
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
pub use table::Table;
pub use tenth::{TenthRow, time_to_a_tenth};
pub use worst::{HardCase, HardResult, Judged, approach, extremes, onset, with_lateral};
