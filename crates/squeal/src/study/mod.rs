//! The study of a case: every draw of the friction parameters in every scene.
//!
//! A *scene* is a constraint set, a friction law, a contact arrangement and a speed range. The hierarchy of the paper
//! (law, number in contact, arrangement, speed range, samples) is the hierarchy of the report; the run goes through it
//! the other way round, one draw in all scenes, so that scenes are compared on the same draws and memory does not grow
//! with the number of samples.

mod certificate;
mod compare;
mod draw;
mod evaluate;
mod growing;
mod memory;
mod near;
mod part;
mod reference;
mod scene;
mod tally;

pub use certificate::Certificate;
pub use compare::{Comparison, Kind, Panel, comparisons, panels};
pub use draw::{FrictionDraw, Sample};
pub use evaluate::{Outcome, Study, UnstableMode};
pub use growing::{ANCHORS, gain};
pub use memory::{Scratch, Spent, timed};
pub(crate) use near::NearAxis;
pub use reference::Reference;
pub use scene::{Plan, Scene, SceneKey, sliding};
pub(crate) use tally::unstable_names;
pub use tally::{Hits, SceneTally, Tally};
