//! Questions about a brake and its study, each with an answer in memory.
//!
//! | question | see |
//! | --- | --- |
//! | why does a mode grow? | [`why::Explainer`] |
//! | which input makes squeal vary? | [`influence::influence`] |
//! | how probable is squeal that is rare? | [`rare::rare`] |
//! | which motion does an unstable mode grow into? | [`cycles::cycles`], [`cycles::branches`], [`cycles::CyclesOfDraws`] |
//! | what stops it? | [`screen::rank`], [`screen::confirm`] |
//! | what are all modes of all samples? | [`write_every_mode`] |
//!
//! A brake is any [`study::UncertainBrake`]. Answers that take long are kept in a file where one is given, so that a run that was killed goes on. Studies in folders
//! and their results are in the crate `squeal`, which re-exports the modules here.

pub mod cycles;
mod error;
mod every_mode;
pub mod influence;
mod kept;
pub mod rare;
mod real_system;
pub mod screen;
pub mod why;

pub use error::Error;
pub use every_mode::{EVERY_MODE, write_every_mode};
pub use real_system::check_real;

/// The example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
