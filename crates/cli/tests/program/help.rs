//! `--help` of every command has an example, and every example runs.

use std::path::Path;

use super::common::{hoffmann, squeal};
use super::prepared;
use super::rare::RARE;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// A folder with the files that examples name: a case, the matrices of a bicycle, a mesh with its matrices.
fn folder(command: &str) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    let copy = |from: &Path, to: &str| std::fs::copy(from, dir.path().join(to)).unwrap();
    let root = Path::new(ROOT);
    for name in ["M.mtx", "C.mtx", "K.mtx"] {
        copy(&root.join("tests/fixtures/hard/bicycle_v4").join(name), name);
    }
    match command {
        "new" => ["inp", "mas.gz", "sti.gz", "dof.gz"].iter().for_each(|end| {
            copy(&root.join(format!("cases/two-pads/two-pads.{end}")), &format!("model.{end}"));
        }),
        "prepare" => drop(prepared::case(dir.path())),
        "rare" => std::fs::write(dir.path().join("brake.toml"), RARE).unwrap(),
        _ => {
            copy(&hoffmann(), "brake.toml");
        }
    }
    dir
}

#[test]
fn the_example_of_every_command_runs() {
    for command in squeal_cli::command().get_subcommands() {
        let name = command.get_name();
        let help = squeal().args([name, "--help"]).output().unwrap();
        let help = String::from_utf8(help.stdout).unwrap();
        let (_, example) = help.split_once("Example: ").unwrap_or_else(|| panic!("{name}: no example in\n{help}"));
        let example = example.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(
            example.contains(&format!("squeal {name} ")) || example.contains(&format!("squeal {name}")),
            "{example}"
        );
        let dir = folder(name);
        for line in example.split("; ") {
            // What follows `>` is for a shell.
            let words: Vec<&str> = line.split(" > ").next().unwrap().split(' ').collect();
            assert_eq!(words[0], "squeal", "{line}");
            let output = squeal().args(&words[1..]).current_dir(dir.path()).output().unwrap();
            assert!(output.status.success() && !output.stdout.is_empty(), "{line}: {output:?}");
        }
    }
}
