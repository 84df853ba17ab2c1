//! Reproducible Monte Carlo: a random stream per sample, an ordered parallel merge, checkpoints, statistics with
//! intervals.
//!
//! One *sample* is one draw of the uncertain parameters. It is evaluated in every *scene* of the experiment (scenes share
//! the draws, so that they are compared on common random numbers), entered in a *tally* and then dropped: memory does not
//! grow with the number of samples. A sample depends on the seed and its global index alone, and tallies are merged in the
//! order of the indices, so that the result is the same bytes with any number of threads and after any number of kills and
//! resumes.
//!
//! The [`Experiment`] defines what a sample, a scene and an outcome are; this crate knows no matrix and no model.
//!
//! ```
//! use montecarlo::rand::RngExt;
//! use montecarlo::{Confidence, Experiment, Proportion, Sampling, StreamRng, Trial, run};
//!
//! /// Whether a point of the unit square lies in the quarter disc: with probability pi / 4.
//! struct QuarterDisc;
//! impl Experiment for QuarterDisc {
//!     type Sample = (f64, f64);
//!     type Outcome = Trial;
//!     type Error = std::convert::Infallible;
//!     type Scratch = ();
//!     fn draw(&self, rng: &mut StreamRng) -> Result<(f64, f64), Self::Error> { Ok((rng.random(), rng.random())) }
//!     fn evaluate(&self, _scene: usize, (x, y): &(f64, f64), _: &mut ()) -> Result<Trial, Self::Error> {
//!         Ok(if x * x + y * y < 1.0 { Trial::Yes } else { Trial::No })
//!     }
//! }
//!
//! let summary = run(&QuarterDisc, &Sampling::new(1, 20_000), Vec::<Proportion>::new)?;
//! let interval = summary.tally[0].interval(Confidence::P95);
//! assert!(4.0 * interval.lower < std::f64::consts::PI && std::f64::consts::PI < 4.0 * interval.upper);
//! # Ok::<(), montecarlo::MonteCarloError>(())
//! ```
//!
//! # Map
//!
//! | question | items |
//! | --- | --- |
//! | what is sampled, computed and kept? | [`Experiment`], [`Tally`], [`Merge`], [`Runs`] |
//! | which samples are drawn, by how many threads? | [`Sampling`], [`stream`], [`StreamRng`] |
//! | how is a run started, continued, extended? | [`run()`], [`run_with`], [`Checkpoint`], [`Progress`] |
//! | what is the result of a run? | [`Summary`], [`Failures`] |
//! | how is a parameter distributed? | [`Distribution`], [`GaussianCopula`], [`redraw_until_at_least`] |
//! | how often does an event occur? | [`Trial`], [`Proportion`], [`wilson`], [`clopper_pearson`], [`trials_for_half_width`] |
//! | when may a run stop? | [`interim_looks`], [`distance`] |
//! | how often does each of several labels occur? | [`LabelTally`], [`occurring_labels`] |
//! | how large is a quantity? | [`IntegerMean`], [`ReplicateMean`], [`QuantileSketch`], [`quantile`], [`not_exceeded`], [`BoxStatistics`] |
//! | do two quantities order things alike? | [`rank_correlation`] |
//! | which input makes an output vary? | [`first_order_by_ranks`], [`PickFreeze`], [`SobolIndex`] |
//! | how uncertain is an estimate? | [`Confidence`], [`Interval`], [`Estimate`] |
//!
//! Random number generators appear in public signatures, so [`rand`] is re-exported: [`StreamRng`] does not implement the
//! traits of another version of `rand`.

pub use rand;

mod block;
mod bounded_mean;
mod box_statistics;
mod checkpoint;
mod clopper_pearson;
mod confidence;
mod count_difference;
mod difference;
mod distribution;
mod error;
mod estimate;
mod experiment;
mod failures;
mod few_terms;
mod gaussian_copula;
mod integer_mean;
mod interim_looks;
mod label_tally;
mod merge;
mod parts;
mod progress;
mod proportion;
mod quantile_sketch;
mod rank_correlation;
mod redraw;
mod replicate_mean;
mod run;
mod sampling;
mod sealed;
mod sobol_index;
mod stream;
mod summary;

pub use bounded_mean::{BoundedMean, Bounds};
pub use box_statistics::{BoxStatistics, not_exceeded, quantile};
pub use checkpoint::Checkpoint;
pub use clopper_pearson::{clopper_pearson, exact_lower_limit, exact_upper_limit};
pub use confidence::{Confidence, Interval};
pub use count_difference::{CountDifference, CountedSide};
pub use difference::{Difference, PairedTrials, dependent_difference, independent_difference};
pub use distribution::Distribution;
pub use error::{Damage, DistributionFault, MonteCarloError};
pub use estimate::Estimate;
pub use experiment::{Experiment, Runs, Tally};
pub use failures::{Failure, Failures};
pub use few_terms::FewTerms;
pub use gaussian_copula::GaussianCopula;
pub use integer_mean::IntegerMean;
pub use interim_looks::{InterimLook, distance, interim_looks};
pub use label_tally::{LabelTally, occurring_labels};
pub use merge::Merge;
pub use parts::{part_of, tiled};
pub use progress::Progress;
pub use proportion::{Proportion, Trial, trials_for_half_width, wilson};
pub use quantile_sketch::QuantileSketch;
pub use rank_correlation::rank_correlation;
pub use redraw::redraw_until_at_least;
pub use replicate_mean::ReplicateMean;
pub use run::{run, run_with, workers};
pub use sampling::Sampling;
pub use sealed::Sealed;
pub use sobol_index::{PickFreeze, SobolIndex, first_order_by_ranks};
pub use stream::{StreamRng, index_of, stream};
pub use summary::Summary;

/// The example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
