//! Tests that documentation and sources name, as in `cargo test -p brake-squeal-sweep --test sweep`: each is there.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// All files below a folder of the repository that end in `.md` or `.rs`.
fn texts(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let is_ours = path.file_name().is_some_and(|name| name != "target" && !name.to_string_lossy().starts_with('.'));
        match path.extension().and_then(|extension| extension.to_str()) {
            _ if path.is_dir() && is_ours => texts(&path, found),
            Some("md" | "rs") if is_ours => found.push(path),
            _ => {}
        }
    }
}

/// The folder of each package.
fn packages(root: &Path) -> BTreeMap<String, PathBuf> {
    let crates = fs::read_dir(root.join("crates")).unwrap().map(|entry| entry.unwrap().path());
    let folders =
        crates.chain([root.join("tests"), root.join("xtask")]).filter(|path| path.join("Cargo.toml").is_file());
    let name = |folder: PathBuf| {
        let text = fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        let name = text.lines().find_map(|line| line.strip_prefix("name = ")).unwrap().trim_matches('"').to_owned();
        (name, folder)
    };
    folders.map(name).collect()
}

#[test]
fn every_test_that_a_page_or_a_comment_names_is_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let packages = packages(root);
    let mut files = Vec::new();
    texts(root, &mut files);
    let (mut named, mut missing) = (0, Vec::new());
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        for command in text.split("cargo test ").skip(1).map(|rest| rest.split(['`', '\n']).next().unwrap_or_default())
        {
            let words: Vec<&str> = command.split_whitespace().collect();
            let values = |flag: &str| -> Vec<&str> {
                words
                    .windows(2)
                    .filter(|pair| pair[0] == flag)
                    .map(|pair| pair[1])
                    .filter(|value| value.chars().all(is_of_a_name))
                    .collect()
            };
            for package in values("-p") {
                let tests = packages.get(package).map(|folder| folder.join("tests"));
                let has = |path: String| tests.as_ref().is_some_and(|tests| tests.join(path).is_file());
                let is_there = |test: &&str| has(format!("{test}.rs")) || has(format!("{test}/main.rs"));
                // A filter such as `names::` is a module of the program before it.
                let is_module = |pair: &&[&str]| {
                    let module = pair[1].strip_suffix("::");
                    module.is_none_or(|module| {
                        [format!("{module}.rs"), format!("{module}/mod.rs")]
                            .into_iter()
                            .any(|file| has(format!("{}/{file}", pair[0])))
                    })
                };
                named += 1;
                let lost = values("--test").into_iter().find(|test| !is_there(test));
                let lost_module = words.windows(2).find(|pair| !is_module(pair));
                if tests.is_none() || lost.is_some() || lost_module.is_some() {
                    missing.push(format!("{}: cargo test {command}", file.display()));
                }
            }
        }
    }
    assert!(named > 20, "{named}");
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

/// A file beside `main.rs` that this does not name would be a test that nobody runs.
#[test]
fn every_file_beside_a_main_file_of_tests_is_named_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let (mut found, mut unnamed) = (0, Vec::new());
    for tests in packages(root).into_values().map(|folder| folder.join("tests")).filter(|tests| tests.is_dir()) {
        for folder in fs::read_dir(tests).unwrap().map(|entry| entry.unwrap().path()) {
            let Ok(main) = fs::read_to_string(folder.join("main.rs")) else { continue };
            for file in fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
                let name = file.file_stem().and_then(|name| name.to_str()).unwrap();
                let is_of_tests = file.join("mod.rs").is_file() || file.extension().is_some_and(|end| end == "rs");
                if is_of_tests && name != "main" {
                    found += 1;
                    if !main.lines().any(|line| line == format!("mod {name};")) {
                        unnamed.push(file);
                    }
                }
            }
        }
    }
    assert!(found > 60, "{found}");
    assert!(unnamed.is_empty(), "{unnamed:?}");
}

/// True for what a name is made of; a placeholder, as NAME, is none.
fn is_of_a_name(letter: char) -> bool {
    letter.is_ascii_lowercase() || letter.is_ascii_digit() || "-_".contains(letter)
}
