//! Whether motions grow: the verdict on one eigenvalue, the census of a system.

mod census;
mod first_order;

pub use census::{JudgedEigenvalue, StabilityCensus, stability_census};
pub use first_order::verdict;
