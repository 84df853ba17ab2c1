//! What docs/tutorial.md says is so: its case file is taken from the page, its commands are run, and what they print is compared.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

/// The fenced blocks of a page with their languages, in order.
fn blocks(page: &str) -> Vec<(String, String)> {
    let mut blocks = Vec::new();
    let mut parts = page.split("```");
    parts.next();
    while let (Some(block), Some(_)) = (parts.next(), parts.next()) {
        let (language, text) = block.split_once('\n').unwrap();
        blocks.push((language.to_owned(), text.to_owned()));
    }
    blocks
}

fn run(command: &str, folder: &Path) -> String {
    let words: Vec<&str> = command.split_whitespace().collect();
    let Output { status, stdout, stderr } =
        Command::new(env!("CARGO_BIN_EXE_squeal")).args(&words[1..]).current_dir(folder).output().unwrap();
    assert!(status.success(), "{command}: {}", String::from_utf8_lossy(&stderr));
    String::from_utf8(stdout).unwrap()
}

/// Lines with single spaces; those with a time, a size of memory or a rounding error differ from machine to machine.
fn comparable(text: &str) -> Vec<String> {
    let line = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
    let is_of_machine = |line: &String| ["roughly", "solutions"].iter().any(|word| line.contains(word));
    text.lines().map(line).filter(|line| !line.is_empty() && line != "..." && !is_of_machine(line)).collect()
}

#[test]
fn the_commands_of_the_tutorial_print_what_it_says() {
    let folder = tempfile::tempdir().unwrap();
    let page = std::fs::read_to_string(root("docs/tutorial.md")).unwrap();
    let (mut printed, mut commands, mut compared) = (String::new(), 0, 0);
    for (language, text) in blocks(&page) {
        match language.as_str() {
            "toml" => std::fs::write(folder.path().join("brake.toml"), text).unwrap(),
            "sh" => {
                for command in text.lines() {
                    commands += 1;
                    let words: Vec<&str> = command.split_whitespace().collect();
                    match words[0] {
                        "mkdir" | "cd" => {}
                        "cp" => words[1..words.len() - 1].iter().for_each(|file| {
                            std::fs::copy(root(file), folder.path().join(Path::new(file).file_name().unwrap()))
                                .unwrap();
                        }),
                        "cat" => printed = std::fs::read_to_string(folder.path().join(words[1])).unwrap(),
                        "squeal" => printed = run(command, folder.path()),
                        other => panic!("{other}"),
                    }
                }
            }
            _ => {
                let found = comparable(&printed);
                for expected in comparable(&text) {
                    assert!(found.contains(&expected), "{expected}\n-- is not in --\n{printed}");
                    compared += 1;
                }
            }
        }
    }
    assert!(commands < 10 && compared > 20, "{commands} {compared}");
}
