//! Whether the memory that `squeal check` predicts is what `squeal run` takes, by processes and GNU time: a measurement, ignored by default.

use std::path::Path;
use std::process::{Command, Output};

use super::common::replaced;

/// GNU time, which says the largest resident memory of a process.
const GNU_TIME: &str = "/usr/bin/time";
/// Largest lattice with sets of constraints, whose modes are linked: some minutes.
const MOST_WITH_SETS: usize = 10;
/// Bytes of a megabyte.
const MEGA: f64 = 1e6;

fn squeal_measured(arguments: &[&str]) -> (Output, f64) {
    let output = Command::new(GNU_TIME).args(["-f", "%M"]).arg(env!("CARGO_BIN_EXE_squeal")).args(arguments).output();
    let output = output.unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{said}");
    let kilobytes: f64 = said.lines().last().unwrap().parse().unwrap();
    (output, 1024.0 * kilobytes / MEGA)
}

/// The megabytes that a check predicts.
fn predicted(output: &Output) -> f64 {
    let text = String::from_utf8_lossy(&output.stdout);
    let words = text.lines().find_map(|line| line.trim().strip_prefix("memory")).unwrap().trim();
    match words.trim_start_matches("roughly ").split_once(' ').unwrap() {
        (number, "MB") => number.parse().unwrap(),
        (number, _) => 1000.0 * number.parse::<f64>().unwrap(),
    }
}

/// A lattice of so many rows and columns, with all in contact, and the two sets of constraints of the case or none.
fn lattice(size: usize, is_symmetric: bool, has_sets: bool) -> String {
    let base = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/two-by-two.toml");
    let text = std::fs::read_to_string(base).unwrap();
    let without_sets = || {
        let (first, others) = text.split_once("[[constraints]]").unwrap();
        format!("{first}[[speeds]]{}", others.split_once("[[speeds]]").unwrap().1)
    };
    let text = if has_sets { text.clone() } else { without_sets() };
    let text = replaced(&text, "rows = 2", &format!("rows = {size}"));
    let text = replaced(&text, "columns = 2", &format!("columns = {size}"));
    let text = replaced(&text, "in_contact = [4, 3]", &format!("in_contact = [{}]", size * size));
    let text = replaced(&text, "samples = 200", "samples = 8");
    if is_symmetric {
        return text;
    }
    let masses: Vec<String> = (0..size * size).map(|i| format!("{:.3}", 0.5 + 0.001 * i as f64)).collect();
    replaced(&text, "oscillator_mass = 0.5 ", &format!("oscillator_mass = [{}] ", masses.join(", ")))
}

#[test]
#[ignore = "a measurement of some minutes"]
fn the_memory_of_lattices_is_predicted_within_a_factor_of_two() {
    if !Path::new(GNU_TIME).exists() {
        println!("skipped: there is no {GNU_TIME} here");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for size in [2, 4, 6, 8, 10, 12] {
        for (is_symmetric, has_sets) in [(true, false), (false, false), (true, true)] {
            if has_sets && size > MOST_WITH_SETS {
                continue;
            }
            let name = format!("{size}-{is_symmetric}-{has_sets}");
            let case = folder.path().join(format!("{name}.toml"));
            std::fs::write(&case, lattice(size, is_symmetric, has_sets)).unwrap();
            let (case, out) = (case.to_str().unwrap(), folder.path().join(name));
            let (checked, of_check) = squeal_measured(&["check", case]);
            let (_, of_run) = squeal_measured(&["run", case, "--out", out.to_str().unwrap()]);
            let predicted = predicted(&checked);
            println!(
                "{size} x {size}, symmetric {is_symmetric}, sets {has_sets}: {predicted} MB predicted, check {of_check:.0}, run {of_run:.0}"
            );
            assert!((0.5..=2.0).contains(&(of_run / predicted)), "{size}, {is_symmetric}, {has_sets}");
        }
    }
}
