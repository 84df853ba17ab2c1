//! How right the answers are, and at what price: estimators of an occurrence against the exact integral, solver routes
//! against refined eigenvalues, the lattice at its worst.

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
pub use hard::{HardResult, judge_folder};
pub use integral::{Integral, Occurrence, Piece};
pub use perturbation::{Expansion, TaylorOrder, perturbation};
pub use refine::{Refined, refine, refine_all};
pub use report::{AccuracyReport, Effort, accuracy};
pub use routes::{Route, Spectra, relative_errors, routes};
pub use sampling::{Estimated, Estimates, monte_carlo, quasi_monte_carlo};
pub use worst::{HardCase, Judged, approach, extremes, onset, with_lateral};
