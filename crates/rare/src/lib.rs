//! Probabilities of rare failure in standard normal space.
//!
//! A [`LimitState`] says which modes fail at a point; [`estimate`] how probable that is, down to 1e-9 with some thousand evaluations:
//!
//! 1. design points, the likeliest failures, from both directions of every input and random ones;
//! 2. points elsewhere, a fixed part of the budget, whose failures must lead to a design point that is known;
//! 3. lines in the direction of each design point, with every interval of failure on them, until their mean has the error that is asked for.
//!
//! A system of one input has all its failure on one line, which is scanned instead.
//!
//! What contradicts is an [`Error`] and no number; what is not proven widens the interval upwards.

mod answer;
mod elsewhere;
mod error;
mod estimate;
mod limit_state;
mod line_intervals;
mod line_sampling;
mod normal;
mod one_input;
mod options;
mod search;
mod spread;
mod vector;
mod window;

pub use answer::{Estimate, Probability};
pub use error::Error;
pub use estimate::estimate;
pub use limit_state::{LimitState, Mode};
pub use line_sampling::Witness;
pub use normal::{tail, tail_point};
pub use options::Options;
pub use search::DesignPoint;

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
