//! Case files: a study as data.

mod alternative;
mod error;
mod schema;
mod types;
mod validate;

pub use alternative::Alternative;
pub use error::CaseError;
pub use montecarlo::Distribution;
pub use schema::{Draws, Labels, Law};
pub use types::{Case, ConstraintSet, FrictionDistributions, LatticeReadings, Paper, SpeedRange};
