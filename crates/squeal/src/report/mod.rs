//! What a study found: tables, figures, the scorecard of a paper's claims, and a manifest.

mod claims;
mod manifest;
mod paper;
mod pictures;
mod results;
mod tables;

pub use claims::{Claim, Holds, claims_json, claims_markdown};
pub use manifest::{Manifest, Times};
pub use paper::claims;
pub use pictures::{draw_occurrence, draw_paper};
pub use results::{ArrangementOccurrence, Estimate, Results};
pub use tables::write_tables;
