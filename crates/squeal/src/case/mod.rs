//! LatticeCase files: a study as data.

mod alternative;
mod distribution;
mod error;
mod schema;
mod types;
mod validate;

pub use alternative::Alternative;
pub use distribution::Distribution;
pub use error::CaseError;
pub use schema::{Draws, Labels, Law};
pub use types::{ConstraintSet, FrictionDistributions, LatticeCase, LatticeReadings, Paper, SpeedRange};
