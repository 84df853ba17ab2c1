//! A case file of any kind.

use std::path::Path;

use serde::Deserialize;

use super::check::{Check, syntax};
use super::set::{edited, placed};
use super::{CaseError, CaseHeader, FiniteElementCase, LatticeCase, MatricesCase};
use crate::input::{LARGEST_CASE, read_text};

/// A case file, by the kind of its brake.
#[derive(Debug, Clone)]
pub enum CaseFile {
    /// A lattice of oscillators, `[brake] kind = "lattice"` or a table `[lattice]` without `brake.kind`.
    Lattice(Box<LatticeCase>),
    /// A brake given by its matrices, `[brake] kind = "matrices"`.
    Matrices(Box<MatricesCase>),
    /// The export of a finite element program, `[brake] kind = "finite-elements"`.
    FiniteElements(Box<FiniteElementCase>),
}

/// The part of a case file that tells the kind of its brake.
#[derive(Deserialize)]
struct KindOfFile {
    brake: Option<KindOfBrake>,
    lattice: Option<toml::Table>,
}

/// The table `[brake]` as far as it tells the kind.
#[derive(Deserialize)]
struct KindOfBrake {
    kind: Option<BrakeKind>,
}

/// The word `brake.kind`.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum BrakeKind {
    Lattice,
    Matrices,
    FiniteElements,
}

impl CaseFile {
    /// Reads and checks a case file.
    ///
    /// # Errors
    /// The first fault, in one line that names the file, the field, the value and what is allowed.
    pub fn read(path: &Path) -> Result<Self, CaseError> {
        Self::read_with(path, &[])
    }

    /// Reads and checks a case file with fields set, each as `NAME=VALUE`: as if they stood in the file.
    ///
    /// NAME is a parameter of `[parameters]` or `[friction]`, or any field as a dotted key of TOML, in which a table of a list goes by its
    /// `name`: `contacts.pad.mu` is the field `mu` of the table of `[[contacts]]` with `name = "pad"`. VALUE is a value of TOML, or text without
    /// quotes. A number in place of a distribution is the constant; a distribution without a unit keeps the unit of the distribution that it replaces.
    ///
    /// # Errors
    /// As [`CaseFile::read`].
    pub fn read_with(path: &Path, set: &[String]) -> Result<Self, CaseError> {
        let text = read_text(path, LARGEST_CASE).map_err(|source| CaseError::Read { path: path.to_owned(), source })?;
        let mut case = match set {
            [] => Self::parse(path, text)?,
            set => Self::parse(path, edited(path, &text, set)?).map_err(|error| placed(error, &text, set))?,
        };
        case.header_mut().set = set.to_vec();
        Ok(case)
    }

    /// The header of the case.
    pub fn header(&self) -> &CaseHeader {
        match self {
            Self::Lattice(case) => &case.header,
            Self::Matrices(case) => &case.header,
            Self::FiniteElements(case) => &case.header,
        }
    }

    /// The header of the case, to be changed: samples and seed, for instance. What is changed is not checked again.
    pub fn header_mut(&mut self) -> &mut CaseHeader {
        match self {
            Self::Lattice(case) => &mut case.header,
            Self::Matrices(case) => &mut case.header,
            Self::FiniteElements(case) => &mut case.header,
        }
    }

    /// Parses and checks the text of a case file, and reads the files that it names, by their paths from the folder of `path`; messages name `path`,
    /// which itself is not read.
    ///
    /// # Errors
    /// As [`CaseFile::read`].
    pub fn parse(path: &Path, text: String) -> Result<Self, CaseError> {
        let kinds: KindOfFile = toml::from_str(&text).map_err(|error| syntax(path, &text, &error))?;
        match (kinds.brake.and_then(|brake| brake.kind), kinds.lattice) {
            (Some(BrakeKind::Lattice), _) | (None, Some(_)) => {
                LatticeCase::parse(path, text).map(Box::new).map(Self::Lattice)
            }
            (Some(BrakeKind::Matrices), _) => MatricesCase::parse(path, text).map(Box::new).map(Self::Matrices),
            (Some(BrakeKind::FiniteElements), _) => {
                FiniteElementCase::parse(path, text).map(Box::new).map(Self::FiniteElements)
            }
            (None, None) => {
                Err(Check::new(path).value("brake.kind", "missing", "\"lattice\", \"matrices\" or \"finite-elements\""))
            }
        }
    }
}
