//! `THIRD-PARTY.md`: the packages that the program is made of besides its own, with their licences.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;

use super::made::Made;
use super::packages::{Packages, text_of};
use crate::error::TaskError;

/// Licences with which the project may be given on: each package offers one of them.
const ALLOWED: [&str; 11] = [
    "MIT",
    "MIT-0",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "ISC",
    "Unicode-3.0",
    "Zlib",
    "CC0-1.0",
];

/// What stands before the list.
const HEAD: &str = "# What others wrote

`squeal` and its Python package contain these packages, each under the licence beside it; where several are offered, any of them. The letters in
figures are Arimo, under the SIL Open Font License 1.1, whose text is `crates/figures/src/fonts/OFL.txt`. Below the list are the notices of packages
whose licences ask for them in copies of the program.

*Made by `cargo xtask licences` from `cargo metadata`; `cargo xtask release-check` compares it, and refuses licences that it does not know.*
";

/// The page.
///
/// # Errors
/// `cargo metadata` that fails, a licence that is not allowed.
pub(super) fn page(root: &Path) -> Result<Made, TaskError> {
    let packages = Packages::read(root)?;
    let (mut text, mut notices) = (HEAD.to_owned(), BTreeMap::<String, BTreeSet<String>>::new());
    text += "\n| package | version | licence | from |\n| --- | --- | --- | --- |\n";
    for package in packages.in_the_program(&["brake-squeal-cli", "brake-squeal-python"]) {
        let (name, version, licence) =
            (text_of(package, "name"), text_of(package, "version"), text_of(package, "license"));
        if !is_allowed(licence) {
            return Err(TaskError::Release(format!(
                "{name} {version}: licence {licence:?}; allowed: {}",
                ALLOWED.join(", ")
            )));
        }
        let _ = writeln!(text, "| {name} | {version} | {licence} | {} |", text_of(package, "repository"));
        for notice in notices_of(package) {
            notices.entry(notice).or_default().insert(name.to_owned());
        }
    }
    for (notice, names) in notices {
        let names: Vec<String> = names.into_iter().collect();
        let _ = write!(text, "\n## {}\n\n```text\n{notice}\n```\n", names.join(", "));
    }
    Ok(Made { path: root.join("THIRD-PARTY.md"), text, task: "licences" })
}

/// True if one of the licences that a package offers is allowed, or all of those that hold together are.
fn is_allowed(licence: &str) -> bool {
    let plain = licence.replace(['(', ')'], " ").replace('/', " OR ");
    plain.split(" AND ").all(|part| part.split(" OR ").any(|one| ALLOWED.contains(&one.trim())))
}

/// Texts of the licence and notice files of a package that offers neither MIT nor Apache 2.0 alone: these two are quoted once for all packages.
fn notices_of(package: &Value) -> Vec<String> {
    let licence = text_of(package, "license");
    let needs_none = ["MIT", "Apache-2.0"]
        .iter()
        .any(|common| licence.replace('/', " OR ").split(" OR ").any(|one| one.trim() == *common));
    let Some(folder) = Path::new(text_of(package, "manifest_path")).parent().filter(|_| !needs_none) else {
        return Vec::new();
    };
    let mut names: Vec<_> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| {
            let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().to_uppercase());
            path.is_file() && ["LICENSE", "LICENCE", "COPYING", "NOTICE"].iter().any(|start| name.starts_with(start))
        })
        .collect();
    names.sort();
    names.iter().filter_map(|path| Some(std::fs::read_to_string(path).ok()?.trim().replace("\r\n", "\n"))).collect()
}

#[cfg(test)]
mod tests {
    use super::is_allowed;

    #[test]
    fn one_licence_of_those_that_are_offered_suffices_and_all_of_those_that_hold_together_are_needed() {
        for licence in ["MIT", "MIT/Apache-2.0", "GPL-3.0 OR MIT", "(MIT OR Apache-2.0) AND Unicode-3.0", "Zlib"] {
            assert!(is_allowed(licence), "{licence}");
        }
        for licence in ["GPL-3.0", "MIT AND GPL-3.0", "", "(MIT OR Apache-2.0) AND MPL-2.0"] {
            assert!(!is_allowed(licence), "{licence}");
        }
    }
}
