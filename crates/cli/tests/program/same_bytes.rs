//! One thread or two, killed or not, run again or not: the same bytes.

use std::path::Path;
use std::time::Duration;

use crate::common::{SMALL, assert_same, replaced, results, run, squeal};

#[test]
fn threads_and_a_second_run_change_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, SMALL).unwrap();
    let (one, two) = (folder.path().join("one"), folder.path().join("two"));
    run(&case, &one, &["--threads", "1"]);
    run(&case, &two, &["--threads", "2"]);
    let first = results(&one);
    for name in
        ["occurrence.csv", "panels.csv", "net_work.csv", "failures.csv", "occurrence-none-lugre.svg", "report.html"]
    {
        assert!(first.contains_key(name), "{name} is missing from {:?}", first.keys());
    }
    assert_same(&first, &results(&two));
    run(&case, &one, &["--threads", "2"]);
    assert_same(&first, &results(&one));
}

#[test]
fn a_finished_study_is_extended_to_the_bytes_of_one_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let small = folder.path().join("brake.toml");
    // One of each distribution that the cases of the repository do not have.
    let text = replaced(
        SMALL,
        r#"mu = { distribution = "normal", mean = 0.60, deviation = 0.2, at_least = 0.02 }"#,
        r#"mu = { distribution = "log-uniform", from = 0.3, to = 0.9 }"#,
    );
    let text = replaced(
        &text,
        r#""normal", mean = 0.65, deviation = 0.06, at_least = 0.02 }"#,
        r#""quantiles", probabilities = [0.0, 0.5, 1.0], values = [0.5, 0.65, 0.7] }"#,
    );
    let text =
        replaced(&text, "median = 1.5, sigma = 0.25", "median = 1.5, sigma = 0.25, at_least = 1.0, at_most = 2.0");
    std::fs::write(&small, text).unwrap();
    let two_by_two = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/two-by-two.toml");
    for (case, sizes) in [(two_by_two.as_path(), ["40", "100"]), (small.as_path(), ["13", "50"])] {
        let of = |name: &str| folder.path().join(format!("{name}-{}", sizes[1]));
        let (extended, at_once) = (of("extended"), of("at-once"));
        run(case, &extended, &["--samples", sizes[0]]);
        run(case, &extended, &["--samples", sizes[1]]);
        run(case, &at_once, &["--samples", sizes[1]]);
        let (extended, at_once) = (results(&extended), results(&at_once));
        for name in ["occurrence.csv", "panels.csv", "net_work.csv", "checkpoint.json"] {
            assert!(at_once.contains_key(name), "{name}");
        }
        assert_same(&at_once, &extended);
    }
}

/// How many samples the checkpoint in a folder holds.
fn samples_done(dir: &Path) -> u64 {
    let text = std::fs::read_to_string(dir.join("checkpoint.json")).unwrap_or_default();
    let state: serde_json::Value = serde_json::from_str(text.lines().nth(2).unwrap_or("{}")).unwrap();
    state["samples"].as_u64().unwrap_or(0)
}

/// Kills the run of `samples` samples once `ready` says so; `false` if it ended before that.
fn killed(case: &Path, dir: &Path, samples: &str, ready: impl Fn() -> bool) -> bool {
    let mut child = squeal().arg("run").arg(case).arg("--out").arg(dir).args(["--samples", samples]).spawn().unwrap();
    while !ready() {
        if child.try_wait().unwrap().is_some() {
            return false;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    true
}

#[test]
fn a_killed_study_ends_in_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    // One law, one arrangement: many samples, and so many places to be killed at.
    let text = replaced(SMALL, r#"["amontons-coulomb", "velocity-dependent", "lugre"]"#, r#"["amontons-coulomb"]"#);
    std::fs::write(&case, replaced(&text, "in_contact = [2, 1]", "in_contact = [2]")).unwrap();
    // A machine that is done before its first checkpoint in the middle (after seconds) gets more to do.
    let mut samples = 4_000_u64;
    let (dir, samples) = loop {
        let (dir, count) = (folder.path().join(samples.to_string()), samples.to_string());
        let early = killed(&case, &dir, &count, || dir.join("study.txt").exists())
            && killed(&case, &dir, &count, || dir.join("checkpoint.json").exists());
        let late = early && killed(&case, &dir, &count, || samples_done(&dir) > 0);
        // It may have written its last checkpoint, or all, before it was killed.
        if late && (1..samples).contains(&samples_done(&dir)) && !dir.join("manifest.json").exists() {
            break (dir, samples);
        }
        samples *= 4;
    };
    run(&case, &dir, &["--samples", &samples.to_string()]);
    let whole = folder.path().join("whole");
    run(&case, &whole, &["--samples", &samples.to_string()]);
    assert_same(&results(&whole), &results(&dir));
}
