//! Case files: a study of a brake as data, read and checked. `brakes` makes brakes of them.
//!
//! | to | see |
//! | --- | --- |
//! | read a case of any kind | [`CaseFile::read`] |
//! | know its study | [`CaseHeader`] |
//! | read a case of one kind | [`LatticeCase`], [`MatricesCase`], [`FiniteElementCase`] |
//! | read its variants | [`Variant::read_all`] |
//! | choose one scene | [`SceneChoice`], [`CaseFile::only`] |

mod alternative;
mod arrangements;
mod check;
mod choice;
mod choices;
mod constants;
mod correlation;
mod draft;
mod error;
mod expression;
mod feeding;
mod file;
mod finite_elements;
mod header;
mod heard;
pub mod held;
mod identity;
pub mod input;
mod lattice;
mod matrices;
mod measured;
mod parameter;
mod random_field;
mod relaxing;
mod schema;
mod set;
mod squeal;
mod symmetry;
mod tables;
mod types;
mod variants;

pub use alternative::Alternative;
pub use check::{HALF_WIDTHS, TakenMatrix, is_half_width};
pub use choice::{ChosenSpeed, SceneChoice};
pub use choices::{Draws, Law};
pub use constants::with_constants;
pub use correlation::Correlation;
pub use draft::Draft;
pub use error::CaseError;
pub use expression::{Expression, ExpressionError, TableFunction, is_parameter_name};
pub use file::CaseFile;
pub use finite_elements::{
    Acting, ContactBalance, ContactState, DraftFiles, EQUILIBRIUM, FRICTION_FACTOR, FiniteElementCase, LOAD_FACTOR,
    MissingRows, NamesOnMesh, OWN_SPEED, OwnSpeed, PairPlace, Patch, PatchContact, ReductionGoal, STIFFNESS_FACTOR,
    Side, Spread, SpreadParameter, SpreadParameters,
};
pub use header::CaseHeader;
pub use matrices::{BodyDofs, FixedDofs, GainExpressions, MatricesCase};
pub use parameter::Parameter;
pub use relaxing::Branch;
pub use set::parameter_of;
pub use types::{ConstraintSet, FrictionDistributions, LatticeCase, LatticeReadings, Paper, SpeedRange};
pub use variants::Variant;

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
