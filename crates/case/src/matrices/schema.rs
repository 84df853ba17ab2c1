//! The fields of a case file with a brake given by matrices. docs/case-files.md describes them.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::Deserialize;

use crate::check::Accuracy;
use crate::correlation::CorrelationTable;
use crate::expression::formulas::Formula;
use crate::heard::MeasuredTable;
use crate::parameter::ParameterTable;
use crate::relaxing::BranchTable;
use crate::squeal::SquealTable;
use crate::symmetry::SymmetryEntry;
use crate::tables::PointsTable;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MatricesFile {
    pub study: StudyTable,
    pub brake: BrakeTable,
    #[serde(default)]
    pub parameters: BTreeMap<String, ParameterTable>,
    #[serde(default)]
    pub tables: BTreeMap<String, PointsTable>,
    pub terms: Vec<TermTable>,
    #[serde(default)]
    pub contacts: Vec<ContactTable>,
    #[serde(default)]
    pub bodies: Vec<BodyTable>,
    #[serde(default)]
    pub constraints: Vec<ConstraintsTable>,
    pub accuracy: Option<Accuracy>,
    pub squeal: Option<SquealTable>,
    pub measured: Option<MeasuredTable>,
    pub correlation: Option<CorrelationTable>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StudyTable {
    pub name: String,
    pub samples: u64,
    pub seed: u64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BrakeTable {
    #[serde(rename = "kind")]
    pub _kind: MatricesKind,
    pub dofs: Option<Vec<String>>,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum MatricesKind {
    Matrices,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TermTable {
    pub name: String,
    pub family: Option<String>,
    pub coefficient: Option<Formula>,
    pub symmetry: Option<SymmetryEntry>,
    pub mass: Option<MatrixEntry>,
    pub damping: Option<MatrixEntry>,
    pub stiffness: Option<MatrixEntry>,
    pub loss_factor: Option<f64>,
    #[serde(default)]
    pub viscoelastic: Vec<BranchTable>,
}

/// Rows, or a file with a matrix.
#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "expected rows of numbers, as [[1.0, 0.0], [0.0, 1.0]], or the name of a file in quotes")]
pub(super) enum MatrixEntry {
    Rows(Vec<Vec<f64>>),
    File(PathBuf),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ContactTable {
    pub name: String,
    pub family: Option<String>,
    pub force: BTreeMap<String, f64>,
    #[serde(default)]
    pub reading: BTreeMap<String, f64>,
    pub mu: Option<Formula>,
    pub slope: Option<Formula>,
    pub lag: Option<LagTable>,
    pub load: Option<Formula>,
    pub speed: Option<Formula>,
    pub stiffness: Option<Formula>,
}

/// An internal state, with all its numbers.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LagTable {
    pub decay: Formula,
    pub drive: Formula,
    pub force: Formula,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BodyTable {
    pub name: String,
    pub dofs: Dofs,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ConstraintsTable {
    pub name: String,
    pub fixed: Dofs,
}

/// Names of degrees of freedom, and ranges of names.
#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "expected names of degrees of freedom, as [\"x\", \"1-40\"], or one of them in quotes")]
pub(super) enum Dofs {
    One(String),
    List(Vec<String>),
}
