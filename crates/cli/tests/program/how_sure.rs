//! `squeal influence`, `run --until-half-width` and a threshold on squeal, as a user sees them.

use std::path::Path;

use serde_json::Value;

use crate::common::{SMALL, answer, assert_same, hoffmann, refusal, results, run, squeal};
use crate::tables::columns;

fn manifest(dir: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(dir.join("manifest.json")).unwrap()).unwrap()
}

#[test]
fn a_run_until_a_half_width_has_the_bytes_of_one_with_as_many_samples() {
    let folder = tempfile::tempdir().unwrap();
    let (until, plain) = (folder.path().join("until"), folder.path().join("plain"));
    let said = run(&hoffmann(), &until, &["--until-half-width", "0.03", "--threads", "1"]);
    assert!(said.contains("every occurrence is within 0.03 of the truth"), "{said}");
    let found = manifest(&until);
    let samples = found["samples"].as_u64().unwrap();
    assert!(found["stopped"]["reached"].as_f64().unwrap() <= 0.03, "{found}");
    assert!((40..2_000).contains(&samples), "{samples}");
    // An occurrence near one half takes all looks; one is enough where a part of the first samples is stable for sure.
    assert_eq!(found["stopped"]["look"], found["stopped"]["looks"]);
    run(&hoffmann(), &plain, &["--samples", &samples.to_string()]);
    let first = results(&until);
    assert_same(&first, &results(&plain));
    // Asked again, and from a run that had stopped on the way, it is the same.
    run(&hoffmann(), &until, &["--until-half-width", "0.03", "--threads", "2"]);
    assert_same(&first, &results(&until));
    let resumed = folder.path().join("resumed");
    run(&hoffmann(), &resumed, &["--samples", "333"]);
    run(&hoffmann(), &resumed, &["--until-half-width", "0.03"]);
    assert_same(&first, &results(&resumed));
    assert!(manifest(&plain)["stopped"].is_null());
}

#[test]
fn half_widths_of_a_stop_are_checked() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let options = |value: &str| ["--until-half-width".to_owned(), value.to_owned()];
    let output = squeal().arg("run").arg(hoffmann()).arg("--out").arg(&out).args(options("0.3")).output();
    refusal(&output.unwrap(), &["--until-half-width", "0.3", "0.00001 to 0.25"]);
    assert!(!out.exists());
}

#[test]
fn influence_has_the_same_bytes_with_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, SMALL).unwrap();
    let ask = |threads: &str| {
        let dir = folder.path().join(threads);
        let options =
            ["--law", "lugre", "--contact", "1,2", "--samples", "300", "--total", "200", "--threads", threads];
        let output = squeal().arg("influence").arg(&case).args(options).arg("--out").arg(&dir).output().unwrap();
        assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
        (String::from_utf8(output.stdout).unwrap(), results(&dir))
    };
    let ((said, one), (_, two)) = (ask("1"), ask("2"));
    assert_same(&one, &two);
    let files: Vec<&str> = one.keys().map(String::as_str).collect();
    assert_eq!(files, ["influence.csv", "influence.pdf", "influence.png", "influence.svg", "study.txt", "summary.md"]);
    assert!(said.contains("growth of any mode") && said.contains("explains"), "{said}");
    let rows = columns(
        &folder.path().join("1/influence.csv"),
        &["mode", "output", "input", "index", "value", "lower", "upper"],
    );
    assert!(rows.iter().any(|row| row[0] == "any" && row[2] == "mu_k" && row[3] == "first-order"), "{rows:?}");
    assert!(rows.iter().any(|row| row[3] == "total"));
    for row in &rows {
        let [lower, upper] = [5, 6].map(|at| row[at].parse::<f64>().unwrap());
        assert!((0.0..=1.0).contains(&lower) && lower <= upper && upper <= 1.0, "{row:?}");
    }
}

#[test]
fn what_influence_refuses() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, SMALL).unwrap();
    let correlated = folder.path().join("correlated.toml");
    let matrix = "[correlation]\nparameters = [\"mu_k\", \"mu_s\"]\nmatrix = [[1.0, 0.5], [0.5, 1.0]]\n";
    std::fs::write(&correlated, format!("{SMALL}\n{matrix}")).unwrap();
    for (case, options, words) in [
        (&case, &["--samples", "10"][..], ["--samples = 10", "100 to 1000000"]),
        (&case, &["--total", "10"], ["--total = 10", "100 to 1000000"]),
        (&case, &["--range", "none"], ["--range = none", "\"low\", \"high\""]),
        (&hoffmann(), &["--range", "low"], ["--range = low", "ranges of speed"]),
        (&correlated, &["--law", "lugre", "--total", "100"], ["--total = 100", "independent"]),
    ] {
        let output = squeal().arg("influence").arg(case).args(options).output().unwrap();
        refusal(&output, &words);
    }
}

#[test]
fn a_threshold_is_said_wherever_results_are() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, format!("{SMALL}\n[squeal]\ndamping_ratio_below = -0.02\n")).unwrap();
    let (sign, threshold) = (folder.path().join("sign"), folder.path().join("threshold"));
    run(&case, &threshold, &[]);
    std::fs::write(&case, SMALL).unwrap();
    run(&case, &sign, &[]);
    let words = "a damping ratio below -0.02";
    for file in ["summary.md", "report.html", "manifest.json"] {
        let [with, without] = [&threshold, &sign].map(|dir| std::fs::read_to_string(dir.join(file)).unwrap());
        assert!(with.contains(words) && !without.contains("damping ratio below"), "{file}");
    }
    let unstable = |dir: &Path| -> u64 {
        let rows = columns(&dir.join("occurrence.csv"), &["unstable"]);
        rows.iter().map(|row| row[0].parse::<u64>().unwrap()).sum()
    };
    assert!(0 < unstable(&threshold) && unstable(&threshold) < unstable(&sign));
    for (text, parts) in [
        ("damping_ratio_below = 0.01", ["squeal.damping_ratio_below", "0.01", "<= 0"]),
        ("growth_above = -1.0", ["squeal.growth_above", "-1", ">= 0"]),
        ("growth = 1.0", ["growth", "unknown field", "growth_above"]),
    ] {
        std::fs::write(&case, format!("{SMALL}\n[squeal]\n{text}\n")).unwrap();
        let out = folder.path().join("out");
        refusal(&squeal().arg("run").arg(&case).arg("--out").arg(&out).output().unwrap(), &parts);
    }
}

#[test]
fn a_sweep_and_one_analysis_say_which_threshold_they_apply() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("case.toml");
    let text = std::fs::read_to_string(hoffmann()).unwrap();
    std::fs::write(&case, format!("{text}\n[squeal]\ndamping_ratio_below = -0.001\n")).unwrap();
    let note = "; unstable: with a damping ratio below -0.001";
    for (command, options) in [("cea", &[][..]), ("sweep", &["--over", "mu=0:1"])] {
        let said = answer(command, &case, options);
        assert!(said.lines().next().unwrap().ends_with(note), "{said}");
        assert!(!answer(command, &hoffmann(), options).contains("unstable: with"));
    }
}

/// Hoffmann's oscillator with mu from 0.2 to a number, and dashpots by a table of mu that ends at another: draws beyond it fail.
fn with_a_table([to, end]: [f64; 2]) -> String {
    let text = std::fs::read_to_string(hoffmann()).unwrap();
    let changes = [
        ("samples = 10000", "samples = 1000".to_owned()),
        ("from = 0.5", "from = 0.2".to_owned()),
        ("to = 1.1", format!("to = {to}")),
        ("name = \"dashpots\"", "name = \"dashpots\"\ncoefficient = \"f(mu)\"".to_owned()),
    ];
    let changed = changes.into_iter().fold(text, |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, &to, 1)
    });
    format!("{changed}\n[tables.f]\nat = [0.0, {end}]\nvalue = [1.0, 1.0]\n")
}

/// Samples that fail count in the half width as what may be unstable in any mode: a modulus that is measured up to mu = 0.9 alone, beyond which every draw fails.
#[test]
fn a_half_width_that_failures_leave_open_is_not_reached() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("case.toml");
    for (to, is_reached) in [(0.9, true), (0.905, false), (1.0, false)] {
        std::fs::write(&case, with_a_table([to, 0.9])).unwrap();
        let said = run(&case, &folder.path().join(format!("to-{to}")), &["--until-half-width", "0.1"]);
        assert_eq!(said.contains("every occurrence is within 0.1"), is_reached, "{to} {said}");
        assert_eq!(said.contains("every occurrence is NOT within 0.1"), !is_reached, "{to} {said}");
    }
}

/// A table that draws leave, at one end: a screen passes over such draws in its prediction and counts them in what it confirms; an integral to a half width has to
/// have all, and says what counts them.
#[test]
fn draws_that_fail_are_counted_by_a_screen_and_refused_by_an_integral() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, with_a_table([1.1, 1.0])).unwrap();
    let options = |command: &str, out: &str| {
        let mut program = squeal();
        program.arg(command).arg(&case).arg("--out").arg(folder.path().join(out)).args(["--samples", "200"]);
        program
    };
    let screened = options("screen", "screened").output().unwrap();
    let said = String::from_utf8(screened.stdout).unwrap();
    assert!(screened.status.success() && said.contains("FAILED"), "{said}");
    let integral = options("run", "integral").args(["--half-width", "0.05"]).output().unwrap();
    refusal(&integral, &["f(1.0", "no occurrence to a half width", "plain sampling"]);
}
