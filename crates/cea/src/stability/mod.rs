//! Stability: the verdict on one eigenvalue, the census of a system, thresholds beyond which growth counts.

mod alone;
mod census;
mod counted;
mod coupling;
mod judge;
mod threshold;
mod too_fast;

pub use alone::is_alone;
pub use census::{StabilityCensus, stability_census};
pub use counted::CountedSpectrum;
pub use judge::{ROUNDED_DATA, verdict, verdicts, verdicts_beyond};
pub use threshold::Threshold;
pub use too_fast::grows_too_fast;
