//! What the pages say is so: the tutorial's case file is taken from the page, its commands are run, as are those of other pages that begin with
//! `$`, and what they print is compared.

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
    let words: Vec<&str> = command.split_whitespace().take_while(|word| *word != "#").collect();
    let Output { status, stdout, stderr } =
        Command::new(env!("CARGO_BIN_EXE_squeal")).args(&words[1..]).current_dir(folder).output().unwrap();
    assert!(status.success(), "{command}: {}", String::from_utf8_lossy(&stderr));
    String::from_utf8(stdout).unwrap()
}

/// The words of each line, but of those with a time, a size of memory or an error by rounding, which differ from machine to machine.
fn comparable(text: &str) -> Vec<Vec<&str>> {
    let is_of_machine =
        |line: &&str| ["roughly", "solutions", "reduction", "results in", "..."].iter().any(|word| line.contains(word));
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

/// Looks for each line of a page in what was printed; says how many there were.
fn compare(page: &str, printed: &str) -> usize {
    let (found, expected) = (comparable(printed), comparable(page));
    for line in &expected {
        let is_it =
            |other: &&Vec<&str>| other.len() == line.len() && other.iter().zip(line).all(|(a, b)| is_alike(a, b));
        assert!(found.iter().any(|other| is_it(&other)), "{line:?}\n-- is not in --\n{printed}");
    }
    expected.len()
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
            _ => compared += compare(&text, &printed),
        }
    }
    assert!(commands < 10 && compared > 15, "{commands} {compared}");
}

/// Pages with commands that begin with `$`, but for the tutorial.
const PAGES: [&str; 6] =
    ["README.md", "docs/cycles.md", "docs/screen.md", "docs/sweeps.md", "docs/uncertainty.md", "docs/why.md"];
/// Parts of commands that take more than some seconds, or a case that the reader has.
const LEFT_OUT: [&str; 7] =
    ["brake.toml", "disc-pad", "two-pads", "disk-brake100", "--up-to 6", "--from noise", "--half-width 0.001"];

#[test]
fn the_commands_of_the_pages_print_what_they_say() {
    let folder = tempfile::tempdir().unwrap();
    let mut commands = 0;
    for page in PAGES {
        for (_, text) in blocks(&std::fs::read_to_string(root(page)).unwrap()) {
            let mut from = root("");
            for said in text.split("$ ").skip(1) {
                let (command, printed) = said.split_once('\n').unwrap_or((said, ""));
                match command.split_whitespace().next() {
                    Some("cd") => from = root(command.split_whitespace().nth(1).unwrap()),
                    Some("squeal") if !LEFT_OUT.iter().any(|part| command.contains(part)) => {
                        commands += 1;
                        let out = folder.path().join(commands.to_string());
                        let command = match command.split_once(" --out ") {
                            Some((command, _)) => format!("{command} --out {}", out.display()),
                            None => command.to_owned(),
                        };
                        let found = run(&command, &from).replace(out.to_str().unwrap(), "OUT");
                        compare(printed, &found);
                    }
                    _ => {}
                }
            }
        }
    }
    assert!(commands > 12, "{commands}");
}
