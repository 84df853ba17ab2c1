//! `cargo xtask release-check`: is all there that a release needs, as far as that can be said without a network?

use std::path::Path;
use std::process::Command;

use serde_json::Value;

use super::packages::{Packages, text_of};
use super::{licences, refusals};
use crate::error::TaskError;

/// Largest file of a published package, bytes; chosen: fixtures of more belong to tests that stay here.
const LARGEST_FILE: u64 = 1_000_000;
/// Texts that every published package says of itself.
const SAID: [&str; 6] = ["description", "license", "repository", "readme", "rust_version", "documentation"];
/// Most keywords and categories of a registry.
const MOST_WORDS: usize = 5;

/// Checks everything and lists all faults.
///
/// # Errors
/// The faults, a line each.
pub fn run(root: &Path) -> Result<(), TaskError> {
    let packages = Packages::read(root)?;
    let mut faults: Vec<String> = Vec::new();
    faults.extend(refusals::page(root)?.fault());
    faults.extend(licences::page(root)?.fault());
    let published: Vec<&Value> = packages.own().filter(|package| package["publish"].is_null()).collect();
    let Some(version) = published.first().map(|package| text_of(package, "version")) else {
        return Err(TaskError::Release("no package is published".into()));
    };
    for package in &published {
        faults.extend(of_package(package, version));
    }
    for (file, needed) in [
        ("CHANGELOG.md", format!("## {version}")),
        ("CITATION.cff", format!("version: {version}")),
        ("crates/python/pyproject.toml", "dynamic = [\"version\"]".to_owned()),
        ("LICENSE", "MIT".to_owned()),
        ("crates/figures/src/fonts/OFL.txt", "SIL OPEN FONT LICENSE".to_owned()),
    ] {
        let text = std::fs::read_to_string(root.join(file)).unwrap_or_default();
        if !text.contains(&needed) {
            faults.push(format!("{file}: has no {needed:?}"));
        }
    }
    match faults.is_empty() {
        true => {
            squeal_cli::terminal::say(&format!("{} packages of version {version} can be published", published.len()));
            Ok(())
        }
        false => Err(TaskError::Release(faults.join("\nerror: "))),
    }
}

/// Faults of a package that is published.
fn of_package(package: &Value, version: &str) -> Vec<String> {
    let name = text_of(package, "name");
    let mut faults: Vec<String> = Vec::new();
    let mut check = |is_right: bool, what: String| {
        if !is_right {
            faults.push(format!("{name}: {what}"));
        }
    };
    check(name.starts_with("brake-squeal"), "its name does not begin with brake-squeal".into());
    check(text_of(package, "version") == version, format!("version {}, not {version}", text_of(package, "version")));
    for key in SAID {
        check(!text_of(package, key).is_empty(), format!("no {key}"));
    }
    for key in ["keywords", "categories"] {
        let words = package[key].as_array().map_or(0, Vec::len);
        check((1..=MOST_WORDS).contains(&words), format!("{words} {key}; allowed: 1 to {MOST_WORDS}"));
    }
    for needed in package["dependencies"].as_array().into_iter().flatten().filter(|needed| !needed["path"].is_null()) {
        // A dependency of tests alone may have no version: a registry then leaves it out.
        let of_tests = needed["kind"].as_str() == Some("dev");
        let (requirement, other) = (text_of(needed, "req"), text_of(needed, "name"));
        check(
            of_tests == (requirement == "*"),
            format!("{other} is needed as {requirement:?}{}", if of_tests { ", by tests" } else { "" }),
        );
    }
    let folder = Path::new(text_of(package, "manifest_path")).parent().unwrap_or(Path::new(""));
    match listed(folder) {
        Err(error) => faults.push(format!("{name}: cargo package --list: {error}")),
        Ok(files) => {
            for file in files {
                let size = std::fs::metadata(folder.join(&file)).map_or(0, |found| found.len());
                if size > LARGEST_FILE {
                    faults.push(format!("{name}: {file} has {size} bytes; allowed: {LARGEST_FILE}"));
                }
            }
        }
    }
    faults
}

/// The files of a package.
fn listed(folder: &Path) -> Result<Vec<String>, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["package", "--list", "--allow-dirty", "--offline"])
        .current_dir(folder)
        .output()
        .map_err(|error| error.to_string())?;
    match output.status.success() {
        true => Ok(String::from_utf8_lossy(&output.stdout).lines().map(str::to_owned).collect()),
        false => Err(String::from_utf8_lossy(&output.stderr).replace('\n', " ")),
    }
}
