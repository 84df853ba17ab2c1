//! The fields of a case file with a lattice. docs/case-files.md describes them.

use serde::Deserialize;
use study::{ModeIdentity, ModeNaming};

use super::{Draws, FrictionDistributions, Law};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LatticeFile {
    #[serde(rename = "brake")]
    pub _brake: Option<BrakeTable>,
    pub study: StudyTable,
    pub lattice: LatticeTable,
    pub contact: ContactTable,
    #[serde(default)]
    pub constraints: Vec<ConstraintsTable>,
    pub speeds: Vec<SpeedsTable>,
    pub readings: ReadingsTable,
    pub friction: FrictionDistributions,
    #[serde(default)]
    pub alternatives: AlternativesTable,
    pub paper: Option<super::Paper>,
    pub accuracy: Option<super::check::Accuracy>,
    pub squeal: Option<super::squeal::SquealTable>,
    pub measured: Option<super::heard::MeasuredTable>,
    pub correlation: Option<super::correlation::CorrelationTable>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BrakeTable {
    #[serde(rename = "kind")]
    pub _kind: Option<LatticeKind>,
}

/// `kind = "lattice"`, which may be left out.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum LatticeKind {
    Lattice,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StudyTable {
    pub name: String,
    pub laws: Vec<Law>,
    pub samples: u64,
    pub seed: u64,
}

/// Values of a field: one for all, one for each, or one for the outer and one for the inner springs of each chain.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged, expecting = "expected a number, a list of numbers or { wall = number, inner = number }")]
pub(super) enum Values {
    All(f64),
    Each(Vec<f64>),
    Chain(Chain),
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Chain {
    pub wall: f64,
    pub inner: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LatticeTable {
    pub rows: usize,
    pub columns: usize,
    pub oscillator_mass: Values,
    pub x_stiffness: Values,
    pub y_stiffness: Values,
    pub x_damping: Values,
    pub y_damping: Values,
    pub z_damping: Values,
    pub inclined_stiffness: Values,
    pub theta: f64,
    pub phi: f64,
    pub contact_stiffness: Values,
    pub plate: PlateTable,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PlateTable {
    pub mass: f64,
    pub stiffness: [f64; 3],
    pub damping: [f64; 3],
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ContactTable {
    #[serde(default)]
    pub in_contact: Vec<usize>,
    #[serde(default)]
    pub arrangements: Vec<Vec<usize>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ConstraintsTable {
    pub name: String,
    pub fixed: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SpeedsTable {
    pub name: String,
    pub from: f64,
    pub to: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ReadingsTable {
    pub lean: LeanEntry,
    pub lateral: LateralEntry,
    pub draws: Draws,
    pub labels: ModeNaming,
    #[serde(default)]
    pub identity: ModeIdentity,
    pub preload: PreloadEntry,
    pub bristle_damping: BristleDampingEntry,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum LeanEntry {
    Against,
    Along,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum LateralEntry {
    None,
    Coupled,
    CoupledMinus,
    Vector,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum PreloadEntry {
    PerContact(f64),
    Clamp(f64),
    Equilibrium(f64),
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum BristleDampingEntry {
    Constant,
    Decaying,
    None,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct AlternativesTable {
    pub oscillator_mass: Vec<f64>,
    pub lateral: Vec<LateralEntry>,
    pub draws: Vec<Draws>,
    pub labels: Vec<ModeNaming>,
    pub preload: Vec<PreloadEntry>,
    pub bristle_damping: Vec<BristleDampingEntry>,
    pub in_place_of_lugre: Vec<Law>,
}
