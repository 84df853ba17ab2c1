//! Variants of a case: what is changed of it in practice, as data.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::check::{Check, syntax};
use super::{CaseError, CaseFile};
use crate::input::{LARGEST_CASE, read_text};

/// Variant of a case: the brake with a shim, with another lining, with other matrices, with a chamfer.
#[derive(Debug, Clone)]
pub struct Variant {
    /// Name of the variant.
    pub name: String,
    /// The case of the variant.
    pub case: CaseFile,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct VariantsFile {
    variants: Vec<VariantTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct VariantTable {
    name: String,
    case: Option<PathBuf>,
    #[serde(default)]
    set: Vec<String>,
}

impl Variant {
    /// Reads the variants of a case: each is the case, or another one that it names, with fields set as by [`CaseFile::read_with`], first the
    /// fields of the case (`set`). Paths are relative to the folder of the file.
    ///
    /// # Errors
    /// The first fault, in one line that names the file and the variant.
    pub fn read_all(path: &Path, case: &Path, set: &[String]) -> Result<Vec<Self>, CaseError> {
        let text = read_text(path, LARGEST_CASE).map_err(|source| CaseError::Read { path: path.to_owned(), source })?;
        let VariantsFile { variants } = toml::from_str(&text).map_err(|error| syntax(path, &text, &error))?;
        let check = Check::new(path);
        if variants.is_empty() {
            return Err(check.value("variants", "[]", "one table or more"));
        }
        let mut names = BTreeSet::new();
        let mut read = Vec::new();
        for VariantTable { name, case: other, set: own } in variants {
            check.plain_name("variants.name", &name)?;
            if !names.insert(name.clone()) {
                return Err(check.value("variants.name", name, "each once"));
            }
            if other.is_none() && own.is_empty() {
                return Err(check.value("variants", name, "with a field case, set, or both"));
            }
            let of = match &other {
                Some(other) => path.parent().unwrap_or(Path::new("")).join(other),
                None => case.to_owned(),
            };
            let of_variant = CaseFile::read_with(&of, &[set, own.as_slice()].concat());
            let refused =
                |source| CaseError::Variant { path: path.to_owned(), name: name.clone(), source: Box::new(source) };
            read.push(Self { case: of_variant.map_err(refused)?, name });
        }
        Ok(read)
    }
}
