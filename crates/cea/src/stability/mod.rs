//! Whether motions grow: the verdict on one eigenvalue, the census of a system.

mod census;
mod verdict;

pub use census::{Judged, StabilityCensus, stability_census};
pub use verdict::verdict;
