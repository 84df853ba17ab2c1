//! Case files: a study as data.

mod distribution;
mod error;
mod schema;
mod validate;

pub use distribution::Distribution;
pub use error::CaseError;
pub use schema::{Draws, Labels, Law};
pub use validate::{Case, ConstraintSet, FrictionDistributions, LatticeReadings, Paper, SpeedRange};
