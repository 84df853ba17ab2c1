//! The study of a brake: every draw of its uncertain parameters in every scene.
//!
//! A *scene* is a constraint set, a friction law, a contact arrangement and a speed range. The hierarchy of a report
//! (law, number in contact, arrangement, speed range, samples) is gone through the other way round: one draw in all
//! scenes, so that scenes are compared on the same draws and memory does not grow with the number of samples.
//!
//! Nothing here knows what the brake is: it runs on the affine form of [`osc_model::Brake`], and on what an
//! [`UncertainBrake`] computes.

mod band;
mod brake;
mod certificate;
mod check;
mod comparison;
mod contradiction;
mod cost;
mod divergence;
mod drawn_inputs;
mod erased;
mod error;
pub mod estimators;
mod evaluate;
mod fingerprint;
mod full_checks;
pub mod identity;
mod independent;
mod kept_samples;
mod measured;
pub mod memory;
mod mode_label;
mod mode_naming;
mod mode_source;
mod modifiable;
mod named_shapes;
mod near_axis;
mod net_work;
mod outer_faces;
mod parametrised;
mod plan;
mod reduced_doubts;
mod reference;
mod scene;
mod scene_tally;
mod scratch;
mod sector_modes;
mod secular_equations;
mod set_links;
mod sliding_contacts;
mod strength;
mod tally;
mod third_octave;
mod units;
mod unstable_names;

pub use brake::UncertainBrake;
pub use certificate::Certificate;
pub use check::check;
pub use comparison::{Comparison, ComparisonKind, Panel, comparisons, panels};
pub use contradiction::Contradiction;
pub use cost::{Cost, samples_together, solutions_together};
pub use divergence::{divergence_doubt, divergence_of_reduced};
pub use drawn_inputs::{DrawnInputs, Input, SingleParameter};
pub use erased::{AnySample, Erased};
pub use error::Error;
pub use evaluate::{OpenMode, Outcome, SampledMode, Study, StudyOptions, UnstableMode};
pub use fingerprint::{fingerprint, hexadecimal};
pub use full_checks::{DivergenceCounts, FullChecks, wider};
pub use independent::{Drawn, IndependentBrake};
pub use kept_samples::{KeptMode, KeptSample, KeptSamples};
pub use measured::{Measured, MeasuredFrequency};
pub use mode_label::ModeLabel;
pub use mode_naming::{ModeIdentity, ModeNaming};
pub use mode_source::{BandMode, Bridge, CoarsePath, ModeResidual, ModeSource, WholeEigenvalue};
pub use modifiable::{Direction, Modifiable, ModifiablePlan, Moves, OwnSize, Place, Symmetry, WholeContact};
pub(crate) use near_axis::NearAxis;
pub use net_work::mode_work;
pub use outer_faces::{FacesInMotion, OuterFaces};
pub use parametrised::{NamedParameter, Parametrised};
pub use plan::{Configuration, Origin, Plan, StudySource};
pub use reduced_doubts::{doubts_of, doubts_of_checks, is_untrusted, unknown_errors};
pub use reference::Reference;
pub use scene::{LawLabel, PanelLabel, Scene, SceneKey, SceneLabels, SpeedLabel};
pub use scene_tally::SceneTally;
pub use scratch::{Scratch, Spent, timed};
pub use sector_modes::check_range;
pub use secular_equations::{ANCHORS_PER_SCENE, common_gain};
pub use set_links::{SetLinks, origin_of_set, set_links};
pub use sliding_contacts::{DrawnContacts, SlidingContacts};
pub use strength::Strength;
pub use tally::{StudyTally, TwiceNamedTally};
pub use third_octave::{InThirdOctave, ThirdOctave};
pub use units::Units;
pub(crate) use unstable_names::unstable_names;

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
