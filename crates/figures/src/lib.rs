//! Figures for print: plain data in, SVG, PNG, PDF and CSV out.
//!
//! Each function takes one struct of numbers and labels and returns a [`Figure`], 180 mm wide (A4 less its margins), with
//! no text below 8 pt. [`Figure::save`] writes the picture three times, from one display list, and its numbers as one table in
//! long format. The bytes depend on the data alone: no clock, no system font, no randomness.
//!
//! Colours are from the palette of Okabe and Ito (<https://jfly.uni-koeln.de/color/>), which colour-blind readers can
//! tell apart; lightness, hatching and marker shapes say the same in grey print.
//!
//! Pixels come from tiny-skia, outlines of letters from skrifa, the document from the svg crate. A plotting library
//! would add little here (axes) and lack the rest (shared scales over rows of panels, hatched boxes side by side, mode
//! shapes on a lattice), at three to five times the compile time.
//!
//! ```
//! use figures::{LogLogFigure, LogLogPanel, LogLogSeries, loglog};
//!
//! let series = LogLogSeries {
//!     name: "plain Monte Carlo".into(),
//!     points: vec![[1e-3, 0.1], [1e-1, 0.01], [10.0, 0.001]],
//!     joined: true,
//! };
//! let data = LogLogFigure {
//!     title: "Time against error".into(),
//!     x_label: "time (s)".into(),
//!     y_label: "error of the occurrence (1)".into(),
//!     panels: vec![LogLogPanel { title: String::new(), series: vec![series] }],
//! };
//! let figure = loglog(&data)?;
//! assert!(figure.svg().contains("plain Monte Carlo"));
//! // figure.save("figures".as_ref(), "time_error") writes time_error.svg, .png, .pdf and .csv into the folder.
//! # Ok::<(), figures::FigureError>(())
//! ```

mod axis;
mod canvas;
mod cycle_branches;
mod cycle_contacts;
mod cycle_spectrum;
mod damping;
mod drops;
mod error;
mod figure;
mod font;
mod index_bars;
mod legend;
mod loglog;
mod loudness;
mod mode_work;
mod model_diagram;
mod occurrence;
mod paths;
mod pdf;
mod plot;
mod point_names;
mod raster;
mod root_locus;
mod scale;
mod stability_map;
mod style;
mod vector;

pub use cycle_branches::{CycleBranch, CycleBranchesFigure, CyclePoint, cycle_branches_figure};
pub use cycle_contacts::{ContactDoes, ContactPoint, ContactsOfCycle, CycleContactsFigure, cycle_contacts_figure};
pub use cycle_spectrum::{CycleSpectrumFigure, SpectrumOfCycle, cycle_spectrum_figure};
pub use damping::{DampingFigure, UnstableRange, damping_figure};
pub use drops::{DropBar, DropGroup, DropsFigure, drops};
pub use error::FigureError;
pub use figure::Figure;
pub use index_bars::{IndexBar, IndexFigure, IndexPanel, index_bars};
pub use loglog::{LogLogFigure, LogLogPanel, LogLogSeries, loglog};
pub use loudness::{LoudMotion, LoudnessFigure, LoudnessPanel, loudness_figure};
pub use mode_work::{BodyInMode, LawMode, ModeWorkFigure, NetWork, mode_and_work};
pub use model_diagram::{ModelDiagram, model_diagram};
pub use occurrence::{
    Occurrence, OccurrenceArrangement, OccurrenceBox, OccurrenceFigure, OccurrenceLaw, OccurrenceMark, OccurrenceMode,
    OccurrencePanel, OccurrenceSeries, occurrence_boxes,
};
pub use root_locus::{LocusBranch, LocusEvent, LocusMark, RootLocusFigure, root_locus_figure};
pub use stability_map::{MapAxis, MapCurve, MapFigure, stability_map_figure};

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
