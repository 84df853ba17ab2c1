//! Sizes: what would not end, or take all memory, is refused beforehand with the limit named.

use std::path::Path;

use crate::common::{SMALL, refusal, replaced, squeal};

/// What `squeal check` says about a case that it refuses.
fn refused(text: &str, expected: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, text).unwrap();
    refusal(&squeal().args(["check", "--memory", "4G"]).arg(&case).output().unwrap(), expected);
}

/// Every command that reads a file, on this one.
fn refused_by_all(path: &Path, expected: &[&str]) {
    for command in ["check", "cea"] {
        refusal(&squeal().arg(command).arg(path).output().unwrap(), expected);
    }
    let out = path.with_extension("out");
    refusal(&squeal().arg("run").arg(path).arg("--out").arg(&out).output().unwrap(), expected);
    assert!(!out.exists());
    refusal(&squeal().arg("eig").arg("--mass").arg(path).arg("--stiffness").arg(path).output().unwrap(), expected);
}

/// Linux only: a file without an end. A pipe that nobody writes to would be waited for without an end.
#[cfg(target_os = "linux")]
#[test]
fn files_that_are_no_regular_ones() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let zeros = folder.path().join("zeros");
    std::os::unix::fs::symlink("/dev/zero", &zeros).unwrap();
    for path in [&pipe, &zeros] {
        let name = path.to_str().unwrap();
        refused_by_all(path, &[name, "it is no regular file", "allowed: a regular file of at most"]);
    }
}

#[test]
fn files_that_are_too_large() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large");
    std::fs::File::create(&path).unwrap().set_len(65_000_000).unwrap();
    refused_by_all(&path, &["large", "it has 65 MB", "allowed: a regular file of at most"]);
    let case = "[study]\nname = \"m\"\nsamples = 1\nseed = 1\n[brake]\nkind = \"matrices\"\n\
                [[terms]]\nname = \"springs\"\nmass = \"large\"\n";
    std::fs::write(folder.path().join("case.toml"), case).unwrap();
    let output = squeal().arg("check").arg(folder.path().join("case.toml")).output().unwrap();
    refusal(&output, &["terms \"springs\".mass", "large", "it has 65 MB", "at most 64 MB"]);
}

#[test]
fn studies_that_take_too_much_memory() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases");
    let two = std::fs::read_to_string(cases.join("two-by-two.toml")).unwrap();
    let lattice = |rows: &str, columns: &str, contacts: &str| {
        let text = replaced(&two, "rows = 2", &format!("rows = {rows}"));
        let text = replaced(&text, "columns = 2", &format!("columns = {columns}"));
        replaced(&text, "in_contact = [4, 3]", &format!("in_contact = [{contacts}]"))
    };
    let limit = "and 4.0 GB are there; what would fit: ";
    refused(&lattice("25", "40", "1000"), &["brake.toml", "the lattice is 25 x 40", "allowed: 1 to 200 oscillators"]);
    refused(&lattice("1", "200", "1"), &["brake.toml", "scenes of 603 degrees of freedom", limit]);
    refused(&lattice("3", "6", "9"), &["brake.toml", "scenes of 57 degrees of freedom", limit]);
}

#[test]
fn every_command_goes_by_the_memory_that_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, SMALL).unwrap();
    let out = folder.path().join("out");
    let with = |arguments: &[&str], memory: &str| {
        squeal().args(arguments).args(["--memory", memory]).arg(&case).output().unwrap()
    };
    let run = ["run", "--out", out.to_str().unwrap()];
    for arguments in
        [&["check"][..], &run, &["cea", "--why"], &["screen"], &["influence"], &["sweep", "--over", "mu=0.1:0.5"]]
    {
        let expected = ["brake.toml", "take roughly", "and 1.0 MB are there; what would fit: ", "--memory"];
        refusal(&with(arguments, "1M"), &expected);
        refusal(&with(arguments, "much"), &["--memory", "allowed: a number of bytes"]);
    }
    assert!(!out.exists() && with(&["check"], "1T").status.success());
}

#[test]
fn check_states_memory_and_time() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, SMALL).unwrap();
    let output = squeal().arg("check").arg(&case).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("  memory        roughly 30 MB\n") && text.contains("  time          roughly "), "{text}");
}

#[test]
fn stiff_scenes_are_given_up_by_name() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases");
    let two = std::fs::read_to_string(cases.join("two-by-two.toml")).unwrap();
    let sigma1 = r#"sigma1 = { distribution = "constant", value = 10.0 }"#;
    let stiff = replaced(&two, sigma1, r#"sigma1 = { distribution = "constant", value = 1e25 }"#);
    let stiff = replaced(&stiff, "in_contact = [4, 3]", "in_contact = [4]");
    refused(
        &stiff,
        &["brake.toml", "median parameters", "none, lugre, contact 1 2 3 4", "times as fast as the vibrations"],
    );
}

#[test]
fn eigenvalues_of_too_many_degrees_of_freedom() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("K.mtx");
    std::fs::write(&path, "%%MatrixMarket matrix coordinate real general\n1001 1001 1\n1 1 1.0\n").unwrap();
    let output = squeal().arg("eig").arg("--mass").arg(&path).arg("--stiffness").arg(&path).output().unwrap();
    refusal(&output, &["K.mtx", "1001 x 1001", "at most 1000 degrees of freedom"]);
}
