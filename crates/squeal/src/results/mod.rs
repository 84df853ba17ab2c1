//! Results of a study: counts turned into occurrences and intervals, tables, a summary, a manifest.

mod answer;
mod bands;
mod doubts;
mod estimates;
pub mod findings;
mod json;
mod manifest;
mod measured;
mod modes;
mod reasons;
mod strengths;
mod study_results;
mod summary;
mod summary_page;
mod tables;

pub use bands::LIGHT;
pub use estimates::Estimates;
pub use manifest::{Manifest, Source, Stopped, Times, VERSION};
pub use modes::set_letter;
pub use montecarlo::Estimate;
pub use reasons::{SceneReasons, reasons_and_links, time_for_reasons};
pub use strengths::UnstableHertz;
pub use study_results::{ArrangementOccurrence, Results};
pub use tables::write_tables;
