//! Whether motions grow: the verdict on one eigenvalue, the census of a system.

mod census;
mod screen;

pub use census::{StabilityCensus, stability_census};
pub use screen::{verdict, verdicts};
