//! Which modes of a brake will squeal, how sure are we, and what stops them.
//!
//! This crate puts the stages together: a [`case`] file becomes a [`study`], its samples become a [`report`]. The
//! stages themselves are crates of their own, re-exported here:
//!
//! parameters -> [`osc_model`] with [`friction`] -> [`linsys`] -> [`cea`] -> [`work`] -> [`montecarlo`] -> figures

pub mod accuracy;
pub mod case;
pub mod commands;
mod error;
pub mod figures;
pub mod output;
pub mod report;
mod run;
pub mod study;

pub use error::Error;
pub use run::{estimate, fingerprint, run_study};
pub use {cea, friction, linsys, montecarlo, osc_model, work};
