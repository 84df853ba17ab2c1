//! How right the answers are, and at what price: solver routes and verdicts against refined eigenvalues, estimators of an
//! occurrence against the exact integral, the lattice at its worst. Users of `squeal` never compile it.

mod accuracy;
mod branch_points;
mod conditioning;
mod error;
mod estimator_comparison;
mod exceptional_point;
mod judge;
mod library_baselines;
mod markdown;
mod nlevp;
mod perturbation;
mod problem;
mod refine;
mod refine_equations;
mod report;
mod route_comparison;
mod routes;
mod stress_cases;
mod time_to_tolerance;

pub use accuracy::{Effort, accuracy};
pub use error::ValidationError;
pub use estimator_comparison::{EstimatorAccuracy, Estimators, compare_estimators};
pub use exceptional_point::{ExceptionalPoint, exceptional_point};
pub use nlevp::judge_folder;
pub use perturbation::{Expansion, TaylorOrder, expand, perturbation};
pub use problem::{Judgement, ReferenceProblem, RouteOutcome};
pub use refine::{RefinedEigenvalue, refine, refine_all};
pub use report::AccuracyReport;
pub use route_comparison::{RouteAccuracy, SystemGroup, compare_routes};
pub use routes::{SolverRoute, Spectra, relative_errors, routes};
pub use stress_cases::{around_exceptional_point, around_onset, extremes, with_lateral};
pub use time_to_tolerance::{TimeToTolerance, time_to_tolerance};
