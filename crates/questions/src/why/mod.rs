//! Why a mode of a scene has the growth that it has.
//!
//! Answers hold at the medians of a scene, for any brake: the change of a mode with each named parameter, term and contact, by
//! [`cea::Eigentriple`]; the forces that feed and drain it, and where its energy is, by [`work`]; and the modes of the structure
//! without friction of which it is made, by [`cea::RealModes`].
//!
//! [`Explainer`] is a scene made ready; [`Explainer::why`] answers for any number of its modes.

mod balance;
mod explainer;
mod influence;

pub use balance::{Balance, BodyShare, Contribution, TermShare};
pub use explainer::{Explainer, StructureMode, Why, least_damped};
pub use influence::{Influence, InfluenceKind};
