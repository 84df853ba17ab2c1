//! What a study found: tables, figures, the scorecard of a paper's claims, and a manifest.

mod claims;
mod estimates;
mod manifest;
mod paper;
mod pictures;
mod results;
mod summary;
mod tables;

pub use claims::{Claim, Holds, claims_json, claims_markdown};
pub use estimates::Estimates;
pub use manifest::{Manifest, Times};
pub use paper::claims;
pub use pictures::{draw_occurrence, draw_paper};
pub use results::{ArrangementOccurrence, Estimate, Results};
pub use tables::write_tables;
