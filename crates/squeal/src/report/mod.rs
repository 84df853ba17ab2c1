//! What a study found: tables, figures, and a manifest.

mod doubts;
mod estimates;
mod findings;
#[cfg(feature = "figures")]
mod html;
mod manifest;
mod modes;
#[cfg(feature = "figures")]
mod pictures;
mod reasons;
mod results;
mod summary;
mod summary_page;
mod tables;

pub use estimates::Estimates;
#[cfg(feature = "figures")]
pub use html::{BasisOf, Geometry, MeshMotion, MeshSurface, ModeOf, write_page};
#[cfg(feature = "figures")]
pub use html::{write_screen_page, write_sweep_page};
pub use manifest::{Manifest, Source, Stopped, Times};
pub use modes::set_letter;
#[cfg(feature = "figures")]
pub use pictures::{draw_occurrence, occurrence, set_heading};
pub use reasons::{SceneReasons, reasons};
pub use results::{ArrangementOccurrence, Estimate, Results};
pub use summary::hertz;
pub use tables::write_tables;
