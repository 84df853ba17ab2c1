//! Coefficients that follow a table over a parameter.

use std::path::{Path, PathBuf};

use crate::common::{answer, asked, hoffmann, refusal, replaced, run};

/// Hoffmann's oscillator whose friction falls with a temperature T, which is uniform up to an end: it squeals from the onset, mu = 0.75375, down to 20 degrees, on the
/// chord from 0.9 at 100 to 0.7 at 300: up to T = 246.25.
fn case(folder: &Path, to: &str) -> PathBuf {
    let text = std::fs::read_to_string(hoffmann()).unwrap();
    let text = replaced(&text, "[parameters.mu]", "[parameters.T]");
    let text = replaced(&text, "from = 0.5\nto = 1.1", &format!("from = 20.0\nto = {to}"));
    let text = replaced(&text, "mu = \"mu\"", "mu = \"friction(T)\"");
    let table = "\n[tables.friction]\nat = [20.0, 100.0, 300.0, 400.0]\nvalue = [1.0, 0.9, 0.7, 0.65]\n";
    let path = folder.join("hot.toml");
    std::fs::write(&path, text + table).unwrap();
    path
}

#[test]
fn the_onset_over_the_temperature_and_the_occurrence_are_those_of_the_chord() {
    let folder = tempfile::tempdir().unwrap();
    let case = case(folder.path(), "400.0");
    let onset = |set: &str| {
        let said = answer("sweep", &case, &["--over", "T=20:400", "--json", "--set", set]);
        let found: serde_json::Value = serde_json::from_str(&said).unwrap();
        let onsets = found["onsets"].as_array().unwrap();
        assert_eq!(onsets.len(), 1, "{said}");
        ["at", "error"].map(|key| onsets[0][key].as_f64().unwrap())
    };
    let [at, error] = onset("study.seed=2");
    assert!((at - 246.25).abs() <= error && error < 1e-9, "{at} {error}");
    // 0.75375 on the chord from 0.9 at 300 to 0.7 at 400.
    let [at, error] = onset("tables.friction.value=[1.2, 1.1, 0.9, 0.7]");
    assert!((at - 373.125).abs() <= error && error < 1e-9, "{at} {error}");
    // (246.25 - 20) / 380: in the estimate to its half width, and of 4,000 draws with four deviations.
    let (out, expected) = (folder.path().join("out"), 226.25 / 380.0);
    run(&case, &out, &["--samples", "4000", "--half-width", "0.01", "--keep-samples"]);
    let column = |table: &str, name: &str| -> Vec<String> {
        let mut table = csv::Reader::from_path(out.join(table)).unwrap();
        let at = table.headers().unwrap().iter().position(|head| head == name).unwrap();
        table.records().map(|row| row.unwrap()[at].to_owned()).collect()
    };
    let squeals = column("samples.csv", "unstable").iter().filter(|cell| !cell.is_empty()).count() as f64 / 4000.0;
    assert!((squeals - expected).abs() < 0.031, "{squeals}");
    let [lower, upper, half] =
        ["lower", "upper", "half_width"].map(|name| column("estimates.csv", name)[0].parse::<f64>().unwrap());
    assert!(
        lower - half <= expected && expected <= upper + half && upper + half - lower < 0.03,
        "{lower} {upper} {half}"
    );
    assert!(answer("check", &case, &[]).contains("friction (4 points from 20 to 400)"));
    // The folder is that of these points.
    let other = [
        "--samples",
        "4000",
        "--keep-samples",
        "--out",
        out.to_str().unwrap(),
        "--set",
        "tables.friction.value=[1.0, 0.9, 0.7, 0.6]",
    ];
    refusal(&asked("run", &case, &other), &["other tables"]);
    refusal(&asked("sweep", &case, &["--over", "T=20:401"]), &["friction(401)", "from 20 to 400"]);
}

#[test]
fn samples_beyond_the_ends_fail_and_medians_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let beyond = case(folder.path(), "500.0");
    run(&beyond, &out, &["--samples", "2000", "--keep-samples"]);
    let mut failures = csv::Reader::from_path(out.join("failures.csv")).unwrap();
    let failures: Vec<csv::StringRecord> = failures.records().map(Result::unwrap).collect();
    // 100 of 480 degrees: 417 of 2,000, with four deviations.
    assert!((344..490).contains(&failures.len()), "{}", failures.len());
    let is_said = |row: &csv::StringRecord| row.iter().any(|cell| cell.contains("allowed: an argument from 20 to 400"));
    assert!(failures.iter().all(is_said), "{failures:?}");
    let case = case(folder.path(), "900.0");
    refusal(&asked("check", &case, &[]), &["contacts \"belt\".mu = \"friction(T)\": friction(460) at T = 460"]);
}

/// Friction with a spike that is narrower than the places at which a certificate asks whether a formula is straight: nothing is certified over it.
#[test]
fn nothing_is_certified_across_the_points_of_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let case = case(folder.path(), "380.0");
    let text = std::fs::read_to_string(&case).unwrap();
    let text = replaced(&text, "[[0.05, 0.0], [0.0, 0.05]]", "[[0.3, 0.0], [0.0, 0.3]]");
    let (points, _) = text.split_once("[tables.friction]").unwrap();
    let spike = "at = [20.0, 35.05, 35.08, 35.11, 400.0]\nvalue = [0.4, 0.407525, 1.2, 0.407555, 0.59]\n";
    std::fs::write(&case, format!("{points}[tables.friction]\n{spike}")).unwrap();
    assert!(answer("cea", &case, &["--set", "T=35.08"]).contains("unstable"));
    let said = answer("rare", &case, &[]);
    assert!(!said.contains("certified: nothing grows"), "{said}");
}
