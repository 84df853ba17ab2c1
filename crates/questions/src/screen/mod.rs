//! Screening: which small change of a brake leaves the fewest unstable modes.
//!
//! Single changes (a constraint, a mass, a spring or a dashpot to ground, a contact taken out, a part scaled) and sets of them are ranked by a few
//! analyses each, on the same draws: [`rank`]. The best are confirmed by the study of all scenes on other draws, again the same for
//! all, so that each difference has an interval: [`confirm`]. What changes more than that is another brake, a variant: [`Joined`] is a brake with its
//! variants, which are confirmed on the same draws.
//!
//! Nothing here is of first order: a constraint is not small, and the number of unstable modes has no derivative. Any
//! [`UncertainBrake`](study::UncertainBrake) can be screened; [`Modified`] is such a brake again.

mod candidates;
mod change;
mod confirm;
mod criterion;
mod growing;
mod joined;
mod modified;
mod predict;
mod ranking;
mod run;
mod screened;
mod screened_tables;
mod screened_text;
mod sounded;

pub use candidates::{Candidates, ChangeKind, SingleChange, Sizes};
pub use change::{Attached, Change, Scaled};
pub use confirm::Confirmed;
pub use criterion::{Criterion, Form};
pub use growing::GrowingMode;
pub use joined::Joined;
pub use modified::{ChangeSet, Modified};
pub use predict::Prediction;
pub use ranking::{KindRanking, Ranked};
pub use run::{Confirmation, Ranking, ScreenOptions, confirm, rank};
pub use screened::{Screen, ScreenedSet};
