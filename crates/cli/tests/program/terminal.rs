//! The program and its terminal: closed and full ends, characters that a terminal obeys, help.

use std::path::PathBuf;
use std::process::{Command, Output};

use tempfile::TempDir;

use crate::common::{SMALL, refusal, replaced, squeal};

fn case(text: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("brake.toml");
    std::fs::write(&path, text).unwrap();
    (folder, path)
}

fn check(text: &str) -> Output {
    let (_folder, path) = case(text);
    squeal().arg("check").arg(path).output().unwrap()
}

#[test]
fn a_reader_that_has_seen_enough_is_no_error() {
    let (folder, path) = case(SMALL);
    let out = folder.path().join("out");
    for arguments in [vec!["cea"], vec!["check"], vec!["run", "--out", out.to_str().unwrap()]] {
        let mut child = squeal().arg(arguments[0]).arg(&path).args(&arguments[1..]).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success() && output.stderr.is_empty(), "{arguments:?}: {output:?}");
    }
}

/// Linux only: a device that is always full.
#[cfg(target_os = "linux")]
#[test]
fn ends_that_are_closed_or_full_are_no_panic() {
    let (_folder, path) = case("no case");
    let program = env!("CARGO_BIN_EXE_squeal");
    for script in
        ["\"$1\" cea \"$2\" 2>/dev/full", "\"$1\" cea \"$2\" 2>&-", "\"$1\" sing 2>/dev/full", "\"$1\" sing 2>&-"]
    {
        let status = Command::new("sh").args(["-c", script, "sh", program]).arg(&path).status().unwrap();
        assert_eq!(status.code(), Some(2), "{script}");
    }
    std::fs::write(&path, SMALL).unwrap();
    let full = Command::new("sh").args(["-c", "\"$1\" cea \"$2\" >/dev/full", "sh", program]).arg(&path).output();
    refusal(&full.unwrap(), &["standard output", "No space left on device"]);
}

#[test]
fn control_characters_do_not_reach_the_terminal() {
    for (from, to, field) in [
        ("name = \"two oscillators\"", "name = \"two\\u001b[2Joscillators\"", "study.name"),
        ("name = \"low\"", "name = \"lo\\u0007w\"", "speeds.name"),
        ("name = \"first\"", "name = \"fi\\u001brst\"", "constraints.name"),
        ("lean = \"against\"", "lean = \"\u{9b}31m\"", "lean"),
    ] {
        let line = refusal(&check(&replaced(SMALL, from, to)), &[field]);
        assert!(!line.trim_end().chars().any(char::is_control), "{line:?}");
    }
    let missing = squeal().args(["check", "no\u{1b}[31mcase.toml"]).output().unwrap();
    let line = refusal(&missing, &["no\\u{1b}[31mcase.toml"]);
    assert!(!line.trim_end().chars().any(char::is_control), "{line:?}");
}

#[test]
fn names_and_numbers_that_are_too_long() {
    let name = "a".repeat(300);
    let line = refusal(&check(&replaced(SMALL, "\"first\"", &format!("\"{name}\""))), &["constraints.name", "1 to 60"]);
    assert!(line.len() < 250, "{line}");
    let line =
        refusal(&check(&replaced(SMALL, "= 0.39", &format!("= -{}.0", "7".repeat(300)))), &["300 digits", "> 0"]);
    assert!(line.len() < 250, "{line}");
    let expected = ["brake.toml", "lattice.y_stiffness[1]", "at most 1e100"];
    refusal(&check(&replaced(SMALL, "y_stiffness = 3.05e7", "y_stiffness = 1e308")), &expected);
}

#[test]
fn options_say_what_is_allowed() {
    let (folder, path) = case(SMALL);
    let out = folder.path().join("out");
    for (option, value, allowed) in [
        ("--threads", "-1", "allowed: 1 to 1024"),
        ("--samples", "2.5", "allowed: 1 to"),
        ("--seed", "x", "allowed: a whole number"),
        ("--half-width", "small", "allowed: a number"),
    ] {
        let output = squeal().arg("run").arg(&path).arg("--out").arg(&out).args([option, value]).output().unwrap();
        refusal(&output, &[option, value, allowed]);
    }
}

#[test]
fn a_study_of_which_most_failed_is_not_done() {
    // Where the inclined springs lean with the sliding, very much friction lifts an oscillator off in static equilibrium.
    let text = replaced(SMALL, "per_contact = 600.0", "equilibrium = 600.0");
    let text = replaced(&text, "lean = \"against\"", "lean = \"along\"");
    let mu = r#"mu = { distribution = "normal", mean = 0.60, deviation = 0.2, at_least = 0.02 }"#;
    let text = replaced(
        &text,
        mu,
        r#"mu = { distribution = "quantiles", probabilities = [0, 0.51, 1], values = [0.1, 0.2, 99.0] }"#,
    );
    // Of two oscillators with a draw each one or both fail in 1 - 0.51^2 of the samples, and at the medians none.
    let text = replaced(&text, "draws = \"shared\"", "draws = \"each\"");
    let (folder, path) = case(&replaced(&text, "in_contact = [2, 1]", "in_contact = [2]"));
    let out = folder.path().join("out");
    let output = squeal().arg("run").arg(&path).arg("--out").arg(&out).output().unwrap();
    let line = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), line.lines().count()), (Some(2), 1), "{line}");
    assert!(line.contains("evaluations failed") && line.contains("allowed: at most half"), "{line}");
    assert!(line.contains("lifts off") && out.join("occurrence.csv").exists(), "{line}");
}

#[test]
fn completions_manual_and_exit_codes() {
    let text = |arguments: &[&str]| {
        let output = squeal().args(arguments).output().unwrap();
        assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = text(&["completions", shell]);
        assert!(script.contains("half-width") && script.contains("stiffness"), "{shell}");
    }
    let manual = text(&["man"]);
    for part in [".TH squeal 1", "squeal\\-run", "half\\-width", "Exit codes"] {
        assert!(manual.contains(part), "{part:?} is missing from {manual}");
    }
    assert!(text(&["--help"]).contains("Exit codes: 0 done; 1 done, but of a reduced brake"));
}
