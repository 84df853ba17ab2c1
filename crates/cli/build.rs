//! Tells the program which commit it is built from, for the manifest of a study.

use std::path::{Path, PathBuf};
use std::process::Command;

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}

/// True if the repository of this folder is the project's own, which has the crate in `crates/cli`. One into which the crate was copied,
/// or that of a folder far above it, has other commits.
fn is_own_repository() -> bool {
    let real = |path: PathBuf| path.canonicalize().ok();
    let own = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from).and_then(real);
    let root = git(&["rev-parse", "--show-toplevel"]).map(PathBuf::from);
    let expected = root.and_then(|root| real(root.join("crates").join("cli")));
    // A file that is there and not in the commit was vendored into a checkout that happens to have the same folders.
    let is_known = git(&["ls-files", "--error-unmatch", "Cargo.toml"]).is_some();
    own.is_some() && own == expected && is_known
}

/// The commit from which `cargo package` made this folder, as it wrote it down; of files that were in no commit there is none.
fn packaged() -> Option<String> {
    let said = std::fs::read_to_string(".cargo_vcs_info.json").ok().filter(|said| !said.contains("\"dirty\": true"))?;
    let (_, rest) = said.split_once("\"sha1\": \"")?;
    Some(rest.split_once('"')?.0.to_owned())
}

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if let Some(commit) = packaged() {
        println!("cargo::rustc-env=SQUEAL_COMMIT={commit}");
    }
    // Without git, or outside its own checkout, the commit stays unknown.
    if !is_own_repository() {
        return;
    }
    // Its log changes with every commit and checkout.
    let log = git(&["rev-parse", "--git-path", "logs/HEAD"]);
    if let Some(log) = log.filter(|log| Path::new(log).exists()) {
        println!("cargo::rerun-if-changed={log}");
    }
    if let Some(commit) = git(&["rev-parse", "HEAD"]) {
        println!("cargo::rustc-env=SQUEAL_COMMIT={commit}");
    }
}
