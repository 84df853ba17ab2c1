//! What a study found: tables, figures, the scorecard of a paper's claims, and a manifest.

#[cfg(feature = "case-files")]
mod claims;
mod doubts;
mod estimates;
mod findings;
#[cfg(feature = "figures")]
mod html;
mod manifest;
mod modes;
#[cfg(feature = "case-files")]
mod paper;
#[cfg(all(feature = "case-files", feature = "figures"))]
mod paper_pictures;
#[cfg(feature = "figures")]
mod pictures;
mod reasons;
mod results;
mod summary;
mod summary_page;
mod tables;

#[cfg(feature = "case-files")]
pub use claims::{Claim, Holds, claims_json, claims_markdown};
pub use estimates::Estimates;
#[cfg(feature = "figures")]
pub use html::{BasisOf, Geometry, MeshMotion, MeshSurface, ModeOf, write_page};
#[cfg(feature = "figures")]
pub use html::{write_screen_page, write_sweep_page};
pub use manifest::{Manifest, Source, Stopped, Times};
pub use modes::set_letter;
#[cfg(feature = "case-files")]
pub use paper::{Judgement, Subject, claims, claims_judged};
#[cfg(all(feature = "case-files", feature = "figures"))]
pub use paper_pictures::draw_paper;
#[cfg(feature = "figures")]
pub use pictures::draw_occurrence;
pub use reasons::{SceneReasons, reasons};
pub use results::{ArrangementOccurrence, Estimate, Results};
pub use summary::hertz;
pub use tables::write_tables;
