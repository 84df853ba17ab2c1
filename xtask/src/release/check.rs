//! `cargo xtask release-check`: is all there that a release needs, as far as that can be said without a network?

use std::path::Path;
use std::process::Command;

use serde_json::Value;

use super::made::Made;
use super::packages::{Packages, text_of};
use super::{licences, refusals};
use crate::error::TaskError;

/// Largest published package, bytes of its archive; chosen, twice the largest there is: fixtures belong to tests, which stay here.
const LARGEST_PACKAGE: u64 = 250_000;
/// Texts that every published package says of itself.
const SAID: [&str; 4] = ["description", "license", "readme", "rust_version"];
/// Most keywords and categories of a registry.
const MOST_WORDS: usize = 5;

/// Check that all is there that a release needs: versions, metadata, licences, the change log, pages that are made, sizes of packages.
#[derive(Debug, clap::Args)]
pub struct ReleaseCheckArgs {
    /// Also what only whoever publishes knows: where the repository is
    #[arg(long)]
    to_publish: bool,
}

/// Checks everything and lists all faults.
///
/// # Errors
/// The faults.
pub fn run(args: &ReleaseCheckArgs, root: &Path) -> Result<(), TaskError> {
    let packages = Packages::read(root)?;
    let mut faults: Vec<String> = Vec::new();
    faults.extend(refusals::pages(root)?.iter().filter_map(Made::fault));
    faults.extend(licences::page(root)?.fault());
    let published: Vec<&Value> = packages.own().filter(|package| package["publish"].is_null()).collect();
    let Some(version) = published.first().map(|package| text_of(package, "version")) else {
        return Err(TaskError::Release("no package is published".into()));
    };
    for package in &published {
        faults.extend(of_package(package, version));
        if args.to_publish && text_of(package, "repository").is_empty() {
            faults.push(format!("{}: no repository; workspace.package.repository says it", text_of(package, "name")));
        }
    }
    let citation = std::fs::read_to_string(root.join("CITATION.cff")).unwrap_or_default();
    if args.to_publish && !citation.contains("\nrepository-code: ") {
        faults.push("CITATION.cff: no repository-code".into());
    }
    faults.extend(of_archives(root, &packages, &published)?);
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
            let said = format!("{} packages of version {version} can be published\n", published.len());
            Ok(squeal_cli::terminal::say(&said)?)
        }
        false => Err(TaskError::Release(faults.join("; "))),
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
    let licence = Path::new(text_of(package, "manifest_path")).with_file_name("LICENSE");
    check(licence.is_file(), "no LICENSE; allowed: a link to that of the repository".into());
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
    faults
}

/// Faults of the archives that a registry would get: all are made, without being built.
fn of_archives(root: &Path, packages: &Packages, published: &[&Value]) -> Result<Vec<String>, TaskError> {
    let made = root.join("target/release-check");
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(["package", "--workspace", "--no-verify", "--allow-dirty", "--quiet"]);
    for own in packages.own().filter(|package| !package["publish"].is_null()) {
        command.args(["--exclude", text_of(own, "name")]);
    }
    let output = command.env("CARGO_TARGET_DIR", &made).current_dir(root).output().map_err(TaskError::Start)?;
    if !output.status.success() {
        return Ok(vec![format!("cargo package: {}", String::from_utf8_lossy(&output.stderr).replace('\n', " "))]);
    }
    let fault = |package: &&Value| {
        let name = format!("{}-{}.crate", text_of(package, "name"), text_of(package, "version"));
        match std::fs::metadata(made.join("package").join(&name)) {
            Ok(archive) if archive.len() <= LARGEST_PACKAGE => None,
            Ok(archive) => Some(format!("{name}: {} bytes; allowed: {LARGEST_PACKAGE}", archive.len())),
            Err(error) => Some(format!("{name}: {error}")),
        }
    };
    Ok(published.iter().filter_map(fault).collect())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::of_package;

    #[test]
    fn what_a_package_lacks_is_said() {
        let package = json!({
            "name": "cea",
            "version": "0.2.0",
            "description": "Eigenvalues",
            "license": null,
            "readme": "README.md",
            "rust_version": "1.89",
            "keywords": [],
            "categories": ["science"],
            "dependencies": [
                { "name": "brake-squeal-linsys", "path": "/linsys", "req": "*", "kind": null },
                { "name": "brake-squeal-brakes", "path": "/brakes", "req": "=0.1.0", "kind": "dev" },
                { "name": "brake-squeal-work", "path": "/work", "req": "=0.1.0", "kind": null },
                { "name": "csv", "req": "^1", "kind": "dev" },
            ],
        });
        let faults = of_package(&package, "0.1.0");
        let said = [
            "cea: its name does not begin with brake-squeal",
            "cea: version 0.2.0, not 0.1.0",
            "cea: no license",
            "cea: no LICENSE; allowed: a link to that of the repository",
            "cea: 0 keywords; allowed: 1 to 5",
            "cea: brake-squeal-linsys is needed as \"*\"",
            "cea: brake-squeal-brakes is needed as \"=0.1.0\", by tests",
        ];
        assert_eq!(faults, said);
    }
}
