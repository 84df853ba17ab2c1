//! Measured squeal beside the modes of a study: hits, misses, and what nobody measured.

use super::common::{hoffmann, refusal, squeal};

/// Hoffmann's oscillator, whose mode at 0.2255 Hz is unstable in 58 % of the draws, with what was measured on it.
fn case(dir: &std::path::Path, measured: &str) -> std::path::PathBuf {
    let path = dir.join("brake.toml");
    let text = std::fs::read_to_string(hoffmann()).unwrap();
    std::fs::write(&path, format!("{text}\n[measured]\n{measured}\n")).unwrap();
    path
}

#[test]
fn a_measured_frequency_is_hit_by_a_mode_within_its_tolerance_that_surely_squeals_often_enough() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("results");
    // Of the same draws, in the same folder: nothing is sampled anew, and the last words on what was measured count.
    for (measured, said, found) in [
        ("frequencies = [0.5, 0.225]\ntolerance = 0.01", "1 of 2 frequencies hit", &["hit", "missed"][..]),
        ("frequencies = [0.5]\ntolerance = 0.01", "0 of 1 frequencies hit", &["missed", "not measured"]),
        ("frequencies = [0.225]\ntolerance = [0.01]\nshare = 0.58", "0 of 1 frequencies hit", &["open"]),
        ("frequencies = [0.22, 0.23]\ntolerance = 0.02", "1 of 2 frequencies hit", &["open", "hit"]),
        ("frequencies = [0.22, 0.24]\ntolerance = [0.01, 0.03]", "1 of 2 frequencies hit", &["open", "hit"]),
        ("frequencies = [0.225]\ntolerance = 0.01\nshare = 0.9", "0 of 1 frequencies hit", &["missed"]),
    ] {
        let case = case(dir.path(), measured);
        let output = squeal().arg("run").arg(&case).args(["--samples", "400", "--out"]).arg(&out).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains(&format!("measured, none: {said}")), "{text}");
        let table = std::fs::read_to_string(out.join("measured.csv")).unwrap();
        let column: Vec<&str> = table.lines().skip(1).map(|row| row.split(',').nth(3).unwrap()).collect();
        assert_eq!(column, found, "{table}");
        for page in ["summary.md", "report.html"] {
            let page = std::fs::read_to_string(out.join(page)).unwrap();
            assert!(page.contains("Beside what was measured") && page.contains(said), "{measured}");
        }
    }
}

/// With ten draws in which nothing is unstable a mode may still be in a tenth of all: whether it is what was measured stays open.
#[test]
fn what_few_samples_cannot_tell_is_open() {
    let dir = tempfile::tempdir().unwrap();
    let path = case(dir.path(), "frequencies = [0.17, 0.5]\ntolerance = 0.01");
    let text = std::fs::read_to_string(&path).unwrap();
    let quiet = text.replace("from = 0.5", "from = 0.1").replace("to = 1.1", "to = 0.3");
    assert_ne!(text, quiet);
    std::fs::write(&path, quiet).unwrap();
    let out = dir.path().join("results");
    let output = squeal().arg("run").arg(&path).args(["--samples", "10", "--out"]).arg(&out).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let table = std::fs::read_to_string(out.join("measured.csv")).unwrap();
    let of_frequency =
        |hz: &str| table.lines().filter(|row| row.starts_with(&format!("none,{hz},"))).collect::<Vec<_>>();
    assert!(of_frequency("0.17").iter().all(|row| row.contains(",open,")), "{table}");
    assert!(of_frequency("0.5").iter().all(|row| row.contains(",missed,")), "{table}");
}

#[test]
fn what_cannot_be_a_measured_frequency_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    for (measured, said) in [
        ("frequencies = []\ntolerance = 1.0", "measured.frequencies = []; allowed: one frequency or more"),
        ("frequencies = [-1.0]\ntolerance = 1.0", "measured.frequencies = -1; allowed: a number of Hz, > 0"),
        ("frequencies = [1.0, 1.0]\ntolerance = 0.5", "measured.frequencies = 1; allowed: each once"),
        ("frequencies = [1.0]\ntolerance = [1.0, 2.0]", "a list of 1, one for each frequency"),
        ("frequencies = [1.0, 5.0]\ntolerance = 2.0", "measured.tolerance = 2; allowed: below its frequency, 1 Hz"),
        ("frequencies = [1.0]\ntolerance = nan", "measured.tolerance = NaN; allowed: a number of Hz, > 0"),
        ("frequencies = [1.0]\ntolerance = 0.5\nshare = 1.0", "measured.share = 1; allowed: 0 or more, below 1"),
        ("frequencies = [1.0]", "missing field `tolerance`"),
    ] {
        let output = squeal().arg("cea").arg(case(dir.path(), measured)).output().unwrap();
        refusal(&output, &[said]);
    }
}
