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
                let is_there = |test: &&str| {
                    tests.as_ref().is_some_and(|tests| {
                        tests.join(format!("{test}.rs")).is_file() || tests.join(test).join("main.rs").is_file()
                    })
                };
                named += 1;
                let lost = values("--test").into_iter().find(|test| !is_there(test));
                if tests.is_none() || lost.is_some() {
                    missing.push(format!("{}: cargo test {command}", file.display()));
                }
            }
        }
    }
    assert!(named > 20, "{named}");
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

/// True for what a name is made of; a placeholder, as NAME, is none.
fn is_of_a_name(letter: char) -> bool {
    letter.is_ascii_lowercase() || letter.is_ascii_digit() || "-_".contains(letter)
}
