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

/// The words of each line, but of those with a time, a size of memory or an error by rounding, which differ from machine to machine.
fn comparable(text: &str) -> Vec<Vec<&str>> {
    let is_of_machine =
        |line: &&str| ["roughly", "solutions", "reduction", "..."].iter().any(|word| line.contains(word));
    text.lines()
        .filter(|line| !line.trim().is_empty() && !is_of_machine(line))
        .map(|line| line.split_whitespace().collect())
        .collect()
}

/// Whether two words are the same, or numbers that differ by less than a thousandth. Numbers below 1e-6 are residuals, of which the
/// power of ten counts.
fn is_alike(found: &str, expected: &str) -> bool {
    match (found.parse::<f64>(), expected.parse::<f64>()) {
        _ if found == expected => true,
        (Ok(a), Ok(b)) if b.abs() < 1e-6 => a.abs() < 10.0 * b.abs(),
        (Ok(a), Ok(b)) => (a - b).abs() <= 1e-3 * b.abs(),
        _ => false,
    }
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
                    let is_it = |line: &&Vec<&str>| {
                        line.len() == expected.len() && line.iter().zip(&expected).all(|(a, b)| is_alike(a, b))
                    };
                    assert!(found.iter().any(|line| is_it(&line)), "{expected:?}\n-- is not in --\n{printed}");
                    compared += 1;
                }
            }
        }
    }
    assert!(commands < 10 && compared > 15, "{commands} {compared}");
}
