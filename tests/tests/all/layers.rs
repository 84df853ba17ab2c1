//! Which crate knows which: the layers of docs/architecture.md, from the dependency lists of all crates.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// The packages, each with its folder; none knows one that stands after it.
const LAYERS: [(&str, &str); 29] = [
    ("formats", "crates/formats"),
    ("elements", "crates/elements"),
    ("linsys", "crates/linsys"),
    ("friction", "crates/friction"),
    ("osc-model", "crates/osc-model"),
    ("certified", "crates/certified"),
    ("cea", "crates/cea"),
    ("tracking", "crates/tracking"),
    ("work", "crates/work"),
    ("cycle", "crates/cycle"),
    ("sparse", "crates/sparse"),
    ("contact", "crates/contact"),
    ("reduction", "crates/reduction"),
    ("montecarlo", "crates/montecarlo"),
    ("rare", "crates/rare"),
    ("output", "crates/output"),
    ("figures", "crates/figures"),
    ("study", "crates/study"),
    ("sweep", "crates/sweep"),
    ("questions", "crates/questions"),
    ("squeal", "crates/squeal"),
    ("case", "crates/case"),
    ("brakes", "crates/brakes"),
    ("report", "crates/report"),
    ("squeal-cli", "crates/cli"),
    ("brake-squeal-python", "crates/python"),
    ("reproduction", "crates/reproduction"),
    ("validation", "crates/validation"),
    ("xtask", "xtask"),
];

/// What the library must not bring along: a command line, fonts, pictures, parsers of case files.
const NOT_IN_THE_LIBRARY: [&str; 9] =
    ["clap", "indicatif", "skrifa", "svg", "tiny-skia", "png", "toml", "exmex", "formats"];

/// The names in the table of dependencies of a package.
fn dependencies(folder: &str) -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder).join("Cargo.toml");
    let text = fs::read_to_string(path).unwrap();
    let lines = text.lines().skip_while(|line| *line != "[dependencies]").skip(1);
    let names = lines.take_while(|line| !line.starts_with('[')).filter_map(|line| line.split(['.', ' ', '=']).next());
    names.filter(|name| !name.is_empty() && !name.starts_with('#')).map(str::to_owned).collect()
}

#[test]
fn no_crate_knows_one_that_stands_after_it() {
    let order: BTreeMap<&str, usize> = LAYERS.iter().enumerate().map(|(at, (name, _))| (*name, at)).collect();
    let mut known = 0;
    for (name, folder) in LAYERS {
        for dependency in dependencies(folder) {
            let Some(&at) = order.get(dependency.as_str()) else { continue };
            assert!(at < order[name], "{name} knows {dependency}");
            known += 1;
        }
    }
    assert!(known > 60, "{known} dependencies were read");
}

#[test]
fn every_crate_has_its_place() {
    let crates = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates")).unwrap();
    for entry in crates {
        let folder = format!("crates/{}", entry.unwrap().file_name().to_str().unwrap());
        assert!(LAYERS.iter().any(|(_, known)| *known == folder), "{folder}");
    }
}

#[test]
fn the_library_brings_no_command_line_no_fonts_and_no_case_files() {
    let (mut open, mut all) = (vec!["squeal".to_owned()], Vec::new());
    while let Some(name) = open.pop() {
        if all.contains(&name) {
            continue;
        }
        if let Some((_, folder)) = LAYERS.iter().find(|(known, _)| *known == name) {
            open.extend(dependencies(folder));
        }
        all.push(name);
    }
    let found: Vec<_> = all.iter().filter(|name| NOT_IN_THE_LIBRARY.contains(&name.as_str())).collect();
    assert!(all.len() > 20 && found.is_empty(), "{found:?}");
}
