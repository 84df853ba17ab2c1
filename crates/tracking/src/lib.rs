//! Following modes from one system to another: which mode of the first system becomes which mode of the second.
//!
//! Frequencies cross and shapes change, so neither its rank by frequency nor its shape identifies a mode. A mode is followed
//! along a [`Path`] between two systems by four methods in order; each is tried on the modes that the method before left in
//! doubt:
//!
//! 1. **MAC** ([`mac`]): the assignment of shapes with the largest sum of the modal assurance criterion;
//! 2. **single-mode continuation**: predictor and corrector by the derivative of the eigenvalue, with step-size control;
//! 3. **continuation of a pair** next to a coalescence, where the two eigenvalues are not smooth functions of the path but
//!    their mean and their squared distance are;
//! 4. **adaptive subdivision**: spectra at sample points, in steps that are cut until every match is clear.
//!
//! A mode that subdivision leaves in doubt passes a coalescence; it is reported with all its candidates. When a step is beyond
//! doubt is a rule, not a proof: docs/error-bounds.md, section 14, gives the rule and how often it was checked.
//!
//! | module | what it holds |
//! | --- | --- |
//! | `path` | [`Path`], from a system or a gain to a system |
//! | `follow` | [`identify`], [`identify_all`], [`follow`](fn@follow) |
//! | `mac` | the criterion and the assignment |
//! | `continuation` | single-mode continuation: the predictor and the end of a continuation |
//! | `corrector` | Newton's method from a predicted eigenvalue |
//! | `evaluator` | the three ways to evaluate a path: the secular equation, matrices and its owner |
//! | `step_control` | predictor errors, and the length of the next step |
//! | `coalescence` | continuation of a pair |
//! | `subdivision` | adaptive subdivision |
//! | `branch` | branches over one real parameter: [`link`], [`follow_branch`] of any [`Branches`] |
//! | `onset_search` | where branches cross the imaginary axis: [`find_onsets`] |
//! | `sample_point` | what is known of the modes at a position of a path |
//! | `kept_spectra` | spectra over a parameter, each computed once |
//! | `tuning` | chosen numbers of single-mode continuation |
//! | `locus` | the root locus: [`root_locus`] |
//! | `family` | onsets and root locus of any function that makes a system from a number: [`onsets`], [`branches`] |
//!
//! Example: friction couples two modes, and a stiffness grows until their frequencies have changed order.
//!
//! ```
//! use cea::{EigenSolver, Mode, Modes, QrSolver, Workspace};
//! use linsys::SecondOrder;
//! use nalgebra::dmatrix;
//! use tracking::{Path, PathEnd, PathStart, follow};
//!
//! let system = |k: f64| {
//!     let (m, c) = (dmatrix![1.0, 0.0; 0.0, 1.0], dmatrix![0.02, 0.0; 0.0, 0.5]);
//!     SecondOrder::new(m, c, dmatrix![k, 0.1; -0.1, 4.0])
//! };
//! let mut work = Workspace::default();
//! let mut modes = |system: &SecondOrder| {
//!     let spectrum = QrSolver.eigenvalues(system, &mut work)?;
//!     Mode::at(system, &Modes::classify(system, &spectrum, &mut work)?.oscillatory, &mut work)
//! };
//! let (soft, stiff) = (system(1.0)?, system(9.0)?);
//! let (from, to) = (modes(&soft)?, modes(&stiff)?);
//! let path = Path {
//!     start: PathStart::System(&soft),
//!     start_modes: &from,
//!     end: PathEnd { system: &stiff, modes: &to },
//! };
//! // The lower mode has become the upper one: damping keeps the two apart where their frequencies cross.
//! assert_eq!(follow(&QrSolver, path, &mut work)?, [vec![1], vec![0]]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! This crate never sees a lattice, a friction law or a random number.

mod branch;
mod coalescence;
mod continuation;
mod corrector;
mod error;
mod escalation;
mod evaluator;
mod family;
mod kept_spectra;
mod locus;
mod mac;
mod onset_search;
mod path;
mod sample_point;
mod step_control;
mod subdivision;
#[cfg(test)]
mod test_modes;
mod tuning;

pub use branch::{BranchLink, BranchPoint, Branches, OrderedParameter, RefinedPoint, follow_branch, link, link_error};
pub use error::TrackingError;
pub use escalation::{follow, identify, identify_all};
pub use family::{branches, onsets};
pub use kept_spectra::{KeptSpectra, SystemAt, SystemChange};
pub use locus::{Ambiguity, Branch, RootLocus, root_locus, root_locus_in_steps};
pub use mac::{clear_matches, mac};
pub use onset_search::{Onset, Onsets, find_onsets, onset_between};
pub use path::{Eigenpair, Links, OwnedPath, Path, PathEnd, PathStart};

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
