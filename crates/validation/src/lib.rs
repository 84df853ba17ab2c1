//! How right the answers are, and at what price: solver routes and verdicts against refined eigenvalues, estimators of an
//! occurrence against the exact integral, the lattice at its worst. Users of `squeal` never compile it.

mod coalescence;
mod compare;
mod error;
mod hard;
mod near;
mod peers;
mod perturbation;
mod refine;
mod report;
mod routes;
mod tenth;
mod worst;

pub use coalescence::{ExceptionalPoint, exceptional_point};
pub use compare::{EstimatorRow, Estimators, RouteRow, compare_estimators, compare_routes};
pub use error::ValidationError;
pub use hard::judge_folder;
pub use perturbation::{Expansion, TaylorOrder, expand, perturbation};
pub use refine::{Refined, refine, refine_all};
pub use report::{AccuracyReport, Effort, accuracy};
pub use routes::{Route, Spectra, relative_errors, routes};
pub use tenth::{TenthRow, time_to_a_tenth};
pub use worst::{HardCase, HardResult, Judged, approach, extremes, onset, with_lateral};
