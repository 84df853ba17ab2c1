//! Reproducible Monte Carlo: a random stream per sample, an ordered parallel merge, checkpoints, statistics with
//! intervals.
//!
//! One *sample* is one draw of the uncertain parameters. It is evaluated in every *scene* of the study (scenes share the
//! draws, so they are compared on common random numbers) and then entered in a *tally*, after which it is forgotten:
//! memory does not grow with the number of samples. A sample depends on the seed and its global index alone, and tallies
//! are merged in the order of the indices, so the result is the same bytes with any number of threads, after any number
//! of kills and resumes.
//!
//! What a sample, a scene or an outcome *is* belongs to the [`Study`]; this crate knows nothing about it.
//!
//! ```
//! use montecarlo::{Confidence, Occurrence, Plan, Proportion, StreamRng, Study, run};
//! use rand::RngExt;
//!
//! /// Whether a point of the unit square lies in the quarter disc: with probability pi / 4.
//! struct QuarterDisc;
//! impl Study for QuarterDisc {
//!     type Sample = (f64, f64);
//!     type Outcome = Occurrence;
//!     type Error = std::convert::Infallible;
//!     type Scratch = ();
//!     fn draw(&self, rng: &mut StreamRng) -> Result<(f64, f64), Self::Error> { Ok((rng.random(), rng.random())) }
//!     fn evaluate(&self, _scene: usize, (x, y): &(f64, f64), _: &mut ()) -> Result<Occurrence, Self::Error> {
//!         Ok(if x * x + y * y < 1.0 { Occurrence::Yes } else { Occurrence::No })
//!     }
//! }
//!
//! let summary = run(&QuarterDisc, &Plan::new(1, 20_000), Vec::<Proportion>::new)?;
//! let interval = summary.tally[0].interval(Confidence::P95);
//! assert!(4.0 * interval.lower < std::f64::consts::PI && std::f64::consts::PI < 4.0 * interval.upper);
//! # Ok::<(), montecarlo::MonteCarloError>(())
//! ```
//!
//! Scenes, failures and what else can be counted are in [`Study`], [`Failures`] and [`Tally`]; [`run_with`] adds a
//! [`Checkpoint`] and a [`Progress`] bar.

mod block;
mod box_statistics;
mod checkpoint;
mod confidence;
mod error;
mod failures;
mod integer_mean;
mod plan;
mod progress;
mod proportion;
mod redraw;
mod run;
mod sketch;
mod stream;
mod study;
mod summary;

pub use box_statistics::{BoxStatistics, quantile};
pub use checkpoint::Checkpoint;
pub use confidence::{Confidence, Interval};
pub use error::{Damage, MonteCarloError};
pub use failures::{Failure, Failures};
pub use integer_mean::IntegerMean;
pub use plan::Plan;
pub use progress::{Bar, Progress};
pub use proportion::{Occurrence, Proportion, wilson};
pub use redraw::redraw_until_at_least;
pub use run::{run, run_with};
pub use sketch::Sketch;
pub use stream::{StreamRng, stream};
pub use study::{Merge, Runs, Study, Tally};
pub use summary::Summary;
