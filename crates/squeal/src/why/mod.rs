//! Why a mode of a scene has the growth that it has.
//!
//! At the medians of a scene, for any brake: what a change of each named parameter, term and contact does to a mode, by
//! [`cea::Eigentriple`]; who feeds it and who drains it, and where its energy is, by [`work`]; and of which modes of the structure
//! without friction it is made, by [`cea::RealModes`].
//!
//! [`Explainer`] is a scene made ready; [`Explainer::why`] answers for any number of its modes.

mod balance;
mod explainer;
mod influence;

pub use balance::{Balance, BodyShare, Contribution, TermShare};
pub use explainer::{Explainer, StructureMode, Why};
pub use influence::{Influence, InfluenceKind};
