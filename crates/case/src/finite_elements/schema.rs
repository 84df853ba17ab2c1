//! The fields of a case file with a finite element brake. docs/case-files.md describes them.

use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

use montecarlo::Distribution;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::entries::{LateralEntry, Nodes, SlidingEntry};
use super::surface_schema::{AllContactsTable, FacesTable, ForceTable, RotationTable, SpringTable};
use super::units::UnitsTable;

use crate::check::Accuracy;
use crate::correlation::CorrelationTable;
use crate::expression::formulas::Formula;
use crate::heard::MeasuredTable;
use crate::parameter::ParameterTable;
use crate::schema::{BristleDampingEntry, SpeedsTable};
use crate::squeal::SquealTable;
use crate::symmetry::SymmetryEntry;
use crate::tables::PointsTable;
use crate::{Draws, Law};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FiniteElementsFile {
    pub study: StudyTable,
    pub brake: BrakeTable,
    pub units: Option<UnitsTable>,
    #[serde(default)]
    pub parameters: BTreeMap<String, ParameterTable>,
    #[serde(default)]
    pub tables: BTreeMap<String, PointsTable>,
    pub terms: Vec<TermTable>,
    #[serde(default)]
    pub holders: Vec<HolderTable>,
    pub contact: Option<ContactEntry>,
    #[serde(default)]
    pub all_contacts: Option<AllContactsTable>,
    #[serde(default)]
    pub forces: Vec<ForceTable>,
    #[serde(default)]
    pub rotation: Vec<RotationTable>,
    #[serde(default)]
    pub springs: Vec<SpringTable>,
    #[serde(default)]
    pub constraints: Vec<ConstraintsTable>,
    #[serde(default)]
    pub speeds: Vec<SpeedsTable>,
    pub friction: Option<FrictionTable>,
    pub reduction: ReductionTable,
    pub accuracy: Option<Accuracy>,
    pub squeal: Option<SquealTable>,
    pub measured: Option<MeasuredTable>,
    pub correlation: Option<CorrelationTable>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StudyTable {
    pub name: String,
    #[serde(default)]
    pub laws: Vec<Law>,
    pub samples: u64,
    pub seed: u64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BrakeTable {
    #[serde(rename = "kind")]
    pub _kind: FiniteElementsKind,
    pub mesh: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum FiniteElementsKind {
    FiniteElements,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TermTable {
    pub name: String,
    pub family: Option<String>,
    pub coefficient: Option<Formula>,
    pub mass: Option<PathBuf>,
    pub damping: Option<PathBuf>,
    pub stiffness: Option<PathBuf>,
    pub symmetry: Option<SymmetryEntry>,
    pub rayleigh: Option<RayleighTable>,
    pub loss_factor: Option<LossEntry>,
}

/// Structural damping: a loss factor in the middle of the band, or at a frequency.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(untagged, expecting = "expected a number, or { value = number, at_hz = Hz }")]
pub(super) enum LossEntry {
    Number(f64),
    At(LossTable),
}

/// Structural damping of the stiffness of the term as a dashpot that has it at one frequency.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LossTable {
    pub value: f64,
    pub at_hz: f64,
}

/// `C = mass M + stiffness K` of the term.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RayleighTable {
    pub mass: f64,
    pub stiffness: f64,
}

/// Springs and dashpots to ground, shared equally by the nodes.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct HolderTable {
    pub name: String,
    pub nodes: Nodes,
    pub stiffness: [f64; 3],
    #[serde(default)]
    pub damping: [f64; 3],
}

/// Table `[contact]`, of nodes at the same positions, or tables `[[contact]]`, of faces.
#[derive(Debug)]
pub(super) enum ContactEntry {
    OfNodes(Box<ContactTable>),
    OfFaces(Vec<FacesTable>),
}

impl<'de> Deserialize<'de> for ContactEntry {
    /// The entry by its kind, table or list of tables, so that a misspelt field is named.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = ContactEntry;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table [contact] or tables [[contact]]")
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ContactEntry, A::Error> {
                Ok(ContactEntry::OfNodes(Box::new(Deserialize::deserialize(MapAccessDeserializer::new(map))?)))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<ContactEntry, A::Error> {
                Ok(ContactEntry::OfFaces(Deserialize::deserialize(SeqAccessDeserializer::new(list))?))
            }
        }
        deserializer.deserialize_any(Either)
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ContactTable {
    pub pad: Nodes,
    pub disc: Nodes,
    pub tolerance: f64,
    pub normal: [f64; 3],
    pub sliding: SlidingEntry,
    pub stiffness: f64,
    pub stiffness_factor: Option<Formula>,
    pub friction_factor: Option<Formula>,
    pub load: f64,
    pub patches: Vec<String>,
    #[serde(default)]
    pub in_contact: Vec<usize>,
    #[serde(default)]
    pub arrangements: Vec<Vec<usize>>,
    #[serde(default = "shared")]
    pub draws: Draws,
    #[serde(default = "constant")]
    pub bristle_damping: BristleDampingEntry,
    pub lateral: Option<LateralEntry>,
}

fn shared() -> Draws {
    Draws::Shared
}

fn constant() -> BristleDampingEntry {
    BristleDampingEntry::Constant
}

/// Distributions of the friction parameters: of the coefficient of Amontons-Coulomb friction, at whose median modes are named, and of the parameters of the
/// study's laws.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FrictionTable {
    pub mu: Distribution,
    pub mu_s: Option<Distribution>,
    pub mu_k: Option<Distribution>,
    pub alpha: Option<Distribution>,
    pub v_s: Option<Distribution>,
    pub sigma0: Option<Distribution>,
    pub sigma1: Option<Distribution>,
    pub sigma2: Option<Distribution>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ConstraintsTable {
    pub name: String,
    #[serde(default)]
    pub fixed: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ReductionTable {
    pub frequencies: [f64; 2],
    pub growth: [f64; 2],
    #[serde(default = "residual")]
    pub residual: f64,
    #[serde(default = "training")]
    pub training: usize,
    #[serde(default = "full_checks")]
    pub full_checks: u64,
    #[serde(default = "full_verdicts")]
    pub full_verdicts: usize,
}

fn residual() -> f64 {
    1e-8
}

fn training() -> usize {
    16
}

fn full_checks() -> u64 {
    10
}

fn full_verdicts() -> usize {
    16
}
