//! What docs/case-files.md says is so: its example runs, and no field or column is missing from it.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

fn squeal(arguments: &[&str]) -> String {
    let Output { status, stdout, stderr } =
        Command::new(env!("CARGO_BIN_EXE_squeal")).args(arguments).output().unwrap();
    assert!(status.success(), "squeal {}: {}", arguments.join(" "), String::from_utf8_lossy(&stderr));
    String::from_utf8(stdout).unwrap()
}

/// Names in backticks: fields, columns and keys.
fn described() -> BTreeSet<String> {
    let text = std::fs::read_to_string(root("docs/case-files.md")).unwrap();
    text.split(['`', '"', '.', '[', ']', ',', ' ']).map(str::to_owned).collect()
}

fn keys(value: &toml::Value, found: &mut BTreeSet<String>) {
    match value {
        toml::Value::Table(table) => {
            for (key, value) in table {
                found.insert(key.clone());
                keys(value, found);
            }
        }
        toml::Value::Array(list) => list.iter().for_each(|value| keys(value, found)),
        _ => {}
    }
}

#[test]
fn every_field_of_the_cases_is_described() {
    let described = described();
    for case in ["cases/paper.toml", "cases/two-by-two.toml"] {
        let mut found = BTreeSet::new();
        keys(&toml::from_str(&std::fs::read_to_string(root(case)).unwrap()).unwrap(), &mut found);
        let missing: Vec<_> = found.difference(&described).collect();
        assert!(missing.is_empty(), "{case}: {missing:?}");
    }
}

fn keys_of(value: &serde_json::Value) -> BTreeSet<String> {
    value.as_object().unwrap().keys().cloned().collect()
}

#[test]
fn every_key_of_a_spectrum_is_described() {
    let matrix = |name: &str| root("tests/fixtures/hard/bicycle_v4").join(name).to_str().unwrap().to_owned();
    let (m, c, k) = (matrix("M.mtx"), matrix("C.mtx"), matrix("K.mtx"));
    let matrices = ["eig", "--mass", &m, "--damping", &c, "--stiffness", &k];
    let spectrum = squeal(&[&matrices[..], &["--vectors", "--json"]].concat());
    let spectrum: serde_json::Value = serde_json::from_str(&spectrum).unwrap();
    let names = &keys_of(&spectrum) | &keys_of(&spectrum["eigenvalues"][0]);
    let described = described();
    let missing: Vec<_> = names.difference(&described).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

/// Keys of all objects in a document, and in what it holds.
fn all_keys(value: &serde_json::Value, found: &mut BTreeSet<String>) {
    match value {
        serde_json::Value::Object(all) => {
            for (key, value) in all {
                // After a blank stands a name of the case.
                found.insert(key.split(' ').next().unwrap().to_owned());
                all_keys(value, found);
            }
        }
        serde_json::Value::Array(list) => list.iter().for_each(|value| all_keys(value, found)),
        _ => {}
    }
}

#[test]
fn every_key_of_the_other_commands_is_described() {
    let (hoffmann, small) = (root("cases/hoffmann.toml"), root("cases/two-by-two.toml"));
    let (hoffmann, small) = (hoffmann.to_str().unwrap(), small.to_str().unwrap());
    let page = std::fs::read_to_string(root("docs/json.md")).unwrap();
    let described: BTreeSet<&str> = page.split(['"', ' ', ',']).collect();
    for (command, own) in [
        (&["check", small, "--shards", "4"][..], None),
        (&["sweep", hoffmann, "--over", "mu=0:1.3"], None),
        (&["sweep", small, "--over", "mu=0:1.3", "--over", "x_damping=50:400"], None),
        (&["screen", small, "--kinds", "constraint", "--up-to", "1", "--samples", "20"], None),
        (&["cycle", hoffmann], None),
        (&["cycle", hoffmann, "--over", "mu=0.5:1.1"], Some("mu")),
    ] {
        let document = squeal(&[command, &["--json"]].concat());
        let mut found = BTreeSet::new();
        all_keys(&serde_json::from_str(&document).unwrap(), &mut found);
        let missing: Vec<_> =
            found.iter().filter(|key| !described.contains(key.as_str()) && Some(key.as_str()) != own).collect();
        assert!(missing.is_empty(), "{command:?}: {missing:?}");
    }
}

#[test]
fn every_key_of_studies_is_described() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("study");
    let case = |name: &str| root("cases").join(name).to_str().unwrap().to_owned();
    let (small, disc, paper) = (case("two-by-two.toml"), case("wobbling-disc.toml"), case("paper.toml"));
    let page = std::fs::read_to_string(root("docs/json.md")).unwrap();
    let described: BTreeSet<&str> = page.split(['"', ' ', ',']).collect();
    let run = ["run", &small, "--samples", "8", "--out", out.to_str().unwrap(), "--json"];
    let mut study: serde_json::Value = serde_json::from_str(&squeal(&run)).unwrap();
    let manifest = std::fs::read_to_string(out.join("manifest.json")).unwrap();
    assert_eq!(study["manifest"].take(), serde_json::from_str::<serde_json::Value>(&manifest).unwrap());
    let mut found = BTreeSet::new();
    all_keys(&study, &mut found);
    for arguments in [
        &["influence", &disc, "--samples", "200", "--json"][..],
        &["rare", &paper, "--law", "velocity-dependent", "--constraints", "corners-4-6", "--relative", "0.3", "--json"],
    ] {
        let document: serde_json::Value = serde_json::from_str(&squeal(arguments)).unwrap();
        found.extend(keys_of(&document));
        assert!(document["rows"].as_array().is_some_and(|rows| !rows.is_empty()), "{arguments:?}");
    }
    let missing: Vec<_> = found.iter().filter(|key| !described.contains(key.as_str())).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn the_small_case_runs_and_every_column_is_described() {
    let case = root("cases/two-by-two.toml");
    let case = case.to_str().unwrap();
    let text = squeal(&["check", case, "--samples", "8"]);
    assert!(text.contains("valid") && text.lines().any(|line| line.trim() == "CEAs          160"), "{text}");

    let modes: serde_json::Value = serde_json::from_str(&squeal(&["cea", case, "--modes", "--json"])).unwrap();
    assert_eq!(modes["modes"].as_array().unwrap().len(), 15);

    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("study");
    squeal(&["run", case, "--samples", "8", "--out", out.to_str().unwrap()]);
    let manifest = std::fs::read_to_string(out.join("manifest.json")).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&manifest).unwrap();

    let mut names: BTreeSet<String> = [&modes, &modes["modes"][0], &manifest].into_iter().flat_map(keys_of).collect();
    for entry in std::fs::read_dir(&out).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "csv") {
            let mut table = csv::Reader::from_path(&path).unwrap();
            names.extend(table.headers().unwrap().iter().map(str::to_owned));
        }
    }
    let described = described();
    let missing: Vec<_> = names.difference(&described).collect();
    assert!(missing.is_empty(), "{missing:?}");
}
