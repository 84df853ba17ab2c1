//! Which modes of a brake will squeal, how sure are we, and what stops them.
//!
//! This crate puts the stages together. A brake is a type that implements [`study::UncertainBrake`]: one that `brakes` makes of a case file, or your own.
//! A [`study::Study`] of it is sampled, and its counts become [`results::Results`]:
//!
//! brake + draw -> [`linsys`] -> [`cea`] -> [`tracking`] -> [`work`] -> [`montecarlo`] -> tables
//!
//! Figures and the page are drawn by whom a run is given: the crates `figures` and `report` are above this one, and [`run_study_with`] takes what draws as a
//! [`DrawResults`]. Crates whose types stand in signatures here are re-exported.
//!
//! | to | see |
//! | --- | --- |
//! | study a brake of one's own | [`study::UncertainBrake`], [`study::Plan`], and `examples/` |
//! | run a study in memory | [`results::Results::sampled`] |
//! | run one in a folder, with checkpoints and tables | [`run_study`] |
//! | run one in parts on many machines, and put them together | [`parts`] |
//! | compare two studies on the same draws | [`compare`] |
//! | estimate occurrences until their 95 % intervals have a given half width | [`estimators::scene_occurrences`] |
//! | know which input makes squeal vary | [`influence::influence`] |
//! | estimate a probability of squeal that is too small for plain samples | [`rare::rare`] |
//! | sweep one or two parameters | [`sweep::sweep`], [`sweep::stability_map`] |
//! | know the motion that an unstable mode grows into | [`cycles::cycles`], [`cycles::branches`] |
//! | know why a mode grows | [`why::Explainer`] |
//! | rank what can be changed, and confirm what helps | [`screen::rank`], [`screen::confirm`] |
//!
//! # Examples
//!
//! Flutter of two modes that friction couples, the mechanism of brake squeal in its smallest form:
//!
//! ```
//! use nalgebra::dmatrix;
//! use squeal::cea::{EigenSolver, QrSolver, Verdict, Workspace, verdict};
//! use squeal::linsys::SecondOrder;
//!
//! // A mass of 0.4 kg in x and z. A contact of k = 3.5e7 N/m along z has friction along x, mu = 0.5: mu k is added to K_xz alone.
//! let k = dmatrix![4.6e7, -6.7e6 + 0.5 * 3.5e7; -6.7e6, 5.8e7];
//! let system = SecondOrder::new(dmatrix![0.4, 0.0; 0.0, 0.4], dmatrix![100.0, 0.0; 0.0, 100.0], k)?;
//! let mut work = Workspace::default();
//! let spectrum = QrSolver.eigenvalues(&system, &mut work)?;
//! let verdicts = spectrum.oscillatory().map(|lambda| verdict(&system, lambda, &spectrum, &mut work));
//! assert_eq!(verdicts.collect::<Result<Vec<_>, _>>()?, [Verdict::Unstable, Verdict::Stable]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod compare;
mod error;
pub mod folder;
mod part_manifest;
pub mod parts;
pub mod results;
mod run;

pub use error::Error;
pub use montecarlo::workers;
pub use questions::{EVERY_MODE, check_real, cycles, influence, rare, screen, why, write_every_mode};
pub use run::{DrawResults, ExpectedTime, RunOptions, RunProgress, expected_time, run_study, run_study_with};
pub use study::{estimators, fingerprint, identity, memory};
pub use {
    cea, cycle, friction, linsys, montecarlo, nalgebra, num_complex, osc_model, output, questions, study, sweep,
    tracking, work,
};

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;

/// The example of this crate's own README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct CrateReadme;
