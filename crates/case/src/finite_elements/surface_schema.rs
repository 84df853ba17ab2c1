//! The fields of contacts between faces, of what turns, of springs and of forces. docs/case-files.md describes them.

use std::path::PathBuf;

use serde::Deserialize;

use super::entries::{LateralEntry, Nodes, SlidingEntry};
use crate::Draws;
use crate::expression::formulas::Formula;
use crate::relaxing::BranchTable;
use crate::schema::BristleDampingEntry;

/// A contact between faces that need not match.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FacesTable {
    pub name: String,
    pub slave: Nodes,
    pub master: Nodes,
    pub reach: f64,
    pub sliding: SlidingEntry,
    pub stiffness: StiffnessEntry,
    pub load: LoadEntry,
    #[serde(default)]
    pub patches: Vec<String>,
    #[serde(default)]
    pub integration: IntegrationEntry,
    pub friction_factor: Option<Formula>,
    #[serde(default)]
    pub overhang: bool,
}

impl FacesTable {
    pub fn is_in_equilibrium(&self) -> bool {
        matches!(self.load, LoadEntry::Word(LoadWord::Equilibrium))
    }

    /// By which power of the load its stiffness grows.
    pub fn load_exponent(&self) -> f64 {
        match self.stiffness {
            StiffnessEntry::Power(table) => 1.0 - 1.0 / table.m,
            StiffnessEntry::PerArea(_) | StiffnessEntry::InAll(_) => 0.0,
        }
    }
}

/// Stiffness of a contact.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(
    untagged,
    expecting = "expected { per_area = N/m^3 }, { in_all = N/m } or { c = number, m = number } of p = c g^m"
)]
pub(super) enum StiffnessEntry {
    PerArea(PerAreaTable),
    InAll(InAllTable),
    Power(PowerTable),
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PerAreaTable {
    pub per_area: f64,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct InAllTable {
    pub in_all: f64,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PowerTable {
    pub c: f64,
    pub m: f64,
}

/// Normal load of a contact.
#[derive(Debug, Clone, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a force in N, { pressure = Pa }, { pressures = \"a file with a pressure for each node\" } or \"equilibrium\""
)]
pub(super) enum LoadEntry {
    Total(f64),
    Pressure(PressureTable),
    Pressures(PressuresTable),
    Word(LoadWord),
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PressureTable {
    pub pressure: f64,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PressuresTable {
    pub pressures: PathBuf,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum LoadWord {
    Equilibrium,
}

#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum IntegrationEntry {
    #[default]
    GaussPoints,
    Segments,
}

/// Table `[all_contacts]`: fields that all tables `[[contact]]` share.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct AllContactsTable {
    pub speed: Option<Formula>,
    pub load_factor: Option<Formula>,
    pub stiffness_factor: Option<Formula>,
    pub friction_factor: Option<Formula>,
    pub in_contact: Vec<usize>,
    pub arrangements: Vec<Vec<usize>>,
    pub draws: Option<Draws>,
    pub bristle_damping: Option<BristleDampingEntry>,
    pub lateral: Option<LateralEntry>,
}

/// A force on nodes, shared equally, or a pressure on faces.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ForceTable {
    pub name: String,
    pub nodes: Option<Nodes>,
    pub force: Option<[f64; 3]>,
    pub faces: Option<Nodes>,
    pub pressure: Option<f64>,
    pub coefficient: Option<Formula>,
}

/// A body that turns.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RotationTable {
    pub name: String,
    pub elements: Nodes,
    pub density: f64,
    pub axis: [f64; 3],
    #[serde(default)]
    pub through: [f64; 3],
    pub speed: Formula,
    pub stress: Option<MaterialTable>,
}

/// The material whose centrifugal stress stiffens the body.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialTable {
    pub young: f64,
    pub poisson: f64,
}

/// Springs and dashpots in a direction: of each node to ground, or between the means of two sets.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SpringTable {
    pub name: String,
    pub nodes: Nodes,
    pub to: Option<Nodes>,
    pub direction: [f64; 3],
    #[serde(default)]
    pub stiffness: f64,
    #[serde(default)]
    pub damping: f64,
    #[serde(default)]
    pub acts: ActsEntry,
    pub coefficient: Option<Formula>,
    #[serde(default)]
    pub viscoelastic: Vec<BranchTable>,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum ActsEntry {
    /// A spring at each node by itself.
    #[default]
    Each,
    /// A spring on the mean motion of the nodes.
    Mean,
    /// On the mean motion of the faces that the names are of, by their area: what a column of fluid sees.
    Area,
}
