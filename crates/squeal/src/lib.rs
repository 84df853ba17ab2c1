//! Which modes of a brake will squeal, how sure are we, and what stops them.
//!
//! This crate puts the stages together. Whoever makes a brake, a lattice or matrices of a [`case`] file or a type of one's own,
//! implements [`study::UncertainBrake`]; a [`study::Study`] of it is sampled, and its counts become a [`report`]:
//!
//! brake + draw -> [`linsys`] -> [`cea`] -> [`tracking`] -> [`work`] -> [`montecarlo`] -> tables and figures
//!
//! | to | see |
//! | --- | --- |
//! | read a case, of either kind | [`case::CaseFile`] |
//! | make it a brake | [`brakes::LatticeBrake`], [`brakes::MatricesBrake`] |
//! | study a brake of one's own | [`study::UncertainBrake`], [`study::Plan`], and `examples/` |
//! | run a study in memory | [`report::Results::sampled`] |
//! | run one in a folder, with checkpoints and tables | [`run_study`] |
//! | know an occurrence to a half width | [`estimators::scene_occurrences`] |
//! | know which input makes squeal vary | [`influence::influence`] |
//! | sweep one or two parameters | [`sweep::sweep`], [`sweep::stability_map`] |
//! | know why a mode grows | [`why::Explainer`] |
//! | rank what can be changed, and confirm what helps | [`screen::rank`], [`screen::confirm`] |
//! | draw it | [`report::draw_occurrence`], [`figures`] |
//!
//! # Features
//!
//! All are on by default. With `default-features = false` what is left is the [`study`] of a brake of one's own type, the
//! [`estimators`] and the tables of [`report`]; `examples/hoffmann.rs` takes no more.
//!
//! | feature | adds | depends on |
//! | --- | --- | --- |
//! | `case-files` | [`case`], [`brakes`], the scorecard of a paper's claims | toml, exmex |
//! | `figures` | [`figures`], pictures of results in [`report`] | svg, tiny-skia, png, ttf-parser |
//! | `program` | [`commands`], the program, a progress bar; both of the above | clap, indicatif |
//!
//! # Examples
//!
//! Two frequencies that friction couples, the flutter at the bottom of brake squeal:
//!
//! ```
//! use nalgebra::dmatrix;
//! use squeal::cea::{EigenSolver, QrSolver, Verdict, Workspace, verdict};
//! use squeal::linsys::SecondOrder;
//!
//! // A mass of 0.4 kg in x and z; friction, mu = 0.5 on a contact of 3.5e7 N/m, makes the stiffness unsymmetric.
//! let k = dmatrix![4.6e7, -6.7e6 + 0.5 * 3.5e7; -6.7e6, 5.8e7];
//! let system = SecondOrder::new(dmatrix![0.4, 0.0; 0.0, 0.4], dmatrix![100.0, 0.0; 0.0, 100.0], k)?;
//! let mut work = Workspace::default();
//! let spectrum = QrSolver.eigenvalues(&system, &mut work)?;
//! let verdicts = spectrum.oscillatory().map(|lambda| verdict(&system, lambda, &spectrum, &mut work));
//! assert_eq!(verdicts.collect::<Result<Vec<_>, _>>()?, [Verdict::Unstable, Verdict::Stable]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A study, as `squeal run` runs it:
//!
//! ```
//! use squeal::brakes::LatticeBrake;
//! use squeal::case::LatticeCase;
//!
//! # std::env::set_current_dir("../..")?;
//! # let folder = tempfile::tempdir()?;
//! # let dir = folder.path();
//! let mut case = LatticeCase::read("cases/two-by-two.toml".as_ref())?;
//! case.samples = 8;
//! let brake = LatticeBrake::new(case)?;
//! let manifest = squeal::run_study(&brake, dir, None, &mut |_, results, _| {
//!     for panel in results.panels() {
//!         println!("{}: {:?} unstable modes per CEA", results.describe(panel), results.mean_unstable(panel));
//!     }
//!     Ok(())
//! })?;
//! assert_eq!(manifest.failures, 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#[cfg(feature = "case-files")]
pub mod brakes;
#[cfg(feature = "case-files")]
pub mod case;
mod error;
pub mod estimators;
mod fingerprint;
pub mod folder;
#[cfg(feature = "case-files")]
pub mod held;
pub mod identity;
pub mod influence;
#[cfg(feature = "case-files")]
pub mod input;
pub mod memory;
pub mod report;
mod run;
pub mod screen;
pub mod study;
pub mod sweep;
pub mod why;

pub use error::Error;
#[cfg(feature = "figures")]
pub use figures;
pub use fingerprint::fingerprint;
pub use run::{DrawResults, RunOptions, RunProgress, estimate, run_study, run_study_with, workers};
pub use {cea, friction, linsys, montecarlo, nalgebra, num_complex, osc_model, output, tracking, work};

/// The README's example, compiled and run as a doctest.
#[cfg(all(doctest, feature = "case-files"))]
#[doc = include_str!("../../../README.md")]
struct Readme;

/// The example of this crate's own README.
#[cfg(all(doctest, feature = "case-files"))]
#[doc = include_str!("../README.md")]
struct CrateReadme;
