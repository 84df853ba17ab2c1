//! Accuracy and cost of solvers and estimators. Users of `squeal` never compile this crate.
//!
//! | where | what |
//! | --- | --- |
//! | `accuracy`, `report`, `markdown`, `tolerance_table` | all measurements in one run, its files, its text |
//! | `refine`, `refine_equations`, `conditioning` | [`refine()`]: eigenvalues to more digits than a double has, their condition and backward error |
//! | `problem`, `judge` | [`ReferenceProblem`]: a system with reference eigenvalues, on which routes are judged |
//! | `stress_cases`, `exceptional_point` | systems of the lattice that are hard for a solver or a verdict |
//! | `nlevp` | problems from files, with references of 25 digits |
//! | `library_baselines` | LAPACK and nalgebra on the textbook matrices |
//! | `routes`, `route_comparison` | [`SolverRoute`]: methods for all eigenvalues, time against error |
//! | `perturbation`, `branch_points`, `estimator_comparison` | estimators of an occurrence against the exact integral; modes whose Taylor series does not reach the onset |
//! | `time_to_tolerance` | [`TimeToTolerance`]: cost of every occurrence to 0.1 percentage points, against plain Monte Carlo |
//!
//! ```
//! use nalgebra::dmatrix;
//! use num_complex::Complex;
//! use squeal::linsys::SecondOrder;
//!
//! // lambda^2 + 2e-21 lambda + 1 = 0: a real part that no double-precision solver can see.
//! let system = SecondOrder::new(dmatrix![1.0], dmatrix![2e-21], dmatrix![1.0])?;
//! let refined = validation::refine(&system, Complex::new(1e-12, 1.0))?;
//! assert!((refined.lambda.re + 1e-21).abs() < 1e-27);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

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
mod tolerance_table;

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
