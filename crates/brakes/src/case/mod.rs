//! Case files: a study as data.

mod alternative;
mod arrangements;
mod check;
mod choice;
mod choices;
mod constants;
mod correlation;
mod error;
mod expression;
mod file;
mod finite_elements;
mod header;
mod identity;
mod matrices;
mod measured;
mod schema;
mod set;
mod squeal;
mod symmetry;
mod types;
mod validate;

pub use alternative::Alternative;
pub use check::{HALF_WIDTHS, TakenMatrix, is_half_width};
pub use choice::{ChosenSpeed, SceneChoice};
pub use choices::{Draws, Law};
pub use constants::with_constants;
pub use correlation::Correlation;
pub use error::CaseError;
pub use expression::{Expression, ExpressionError, is_parameter_name};
pub use file::CaseFile;
pub(crate) use finite_elements::{Acting, ContactState, EQUILIBRIUM, LOAD_FACTOR, OWN_SPEED, STIFFNESS_FACTOR};
pub use finite_elements::{
    ContactBalance, FiniteElementCase, MissingRows, NamesOnMesh, OwnSpeed, PairPlace, Patch, PatchContact,
    ReductionGoal, Side,
};
pub use header::CaseHeader;
pub use matrices::{BodyDofs, FixedDofs, GainExpressions, MatricesCase, Parameter};
pub use types::{ConstraintSet, FrictionDistributions, LatticeCase, LatticeReadings, Paper, SpeedRange};
