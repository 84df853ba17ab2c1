//! Sweeps: the modes of a brake as functions of one or two of its parameters, the others at their medians.
//!
//! | over | gives |
//! | --- | --- |
//! | one parameter | [`sweep`]: branches with the names of their modes, onsets to full accuracy, of divergence too, coalescences |
//! | two | [`stability_map`]: the curves on which a mode is neither growing nor decaying, or the stiffness singular, followed and not sampled, and how many modes are unstable between them |
//!
//! Any [`UncertainBrake`](study::UncertainBrake) that names its parameters can be swept. Systems are solved where the
//! branches ask for it: [`Evaluations`] counts them.

mod boundary;
mod change;
mod changes;
mod coalescence;
mod counting_solver;
mod crossing;
mod curve_point;
mod divergence;
mod double;
mod error;
mod family;
mod found;
mod found_openings;
mod found_tables;
mod found_text;
mod joint;
mod line_map;
mod map;
mod measure;
mod modes;
mod names;
mod one_parameter;
mod onset_words;
mod opening;
mod openings;
mod parameter;
mod part_map;
mod part_sweep;
mod pieces;
mod regions;
mod results;
mod sweep_onset;
mod words;

pub use boundary::{BoundaryCurve, BoundaryPoint, CurveEnd};
pub use change::ChangeOf;
pub use changes::{GrowingBeside, Marginal};
pub use coalescence::Coalescence;
pub use divergence::{DIVERGENCE, EXCHANGE, named};
pub use error::Error;
pub use family::Evaluations;
pub use found::Found;
pub use found_text::not_looked_for;
pub use line_map::{LineChange, MapLines};
pub use map::{StabilityMap, stability_map};
pub use modes::{BoundaryMode, boundary_modes};
pub use one_parameter::sweep;
pub use onset_words::event;
pub use opening::{Jump, Opening};
pub use parameter::{Over, SweptParameter, swept};
pub use regions::{CELLS, Region, Run};
pub use results::{Miscount, NamedBranch, Sweep};
pub use sweep_onset::SweepOnset;

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
