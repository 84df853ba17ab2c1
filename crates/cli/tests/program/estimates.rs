//! `--half-width`: every occurrence by the cheapest estimator, against a closed form, and what is refused.

use crate::common::{assert_same, hoffmann, refusal, results, run, squeal};
use crate::tables::columns;

/// (1.1 - 0.75375) / (1.1 - 0.5), as the case derives it.
const EXACT: f64 = 0.346_25 / 0.6;
const HALF_WIDTH: f64 = 1e-3;

#[test]
fn the_closed_form_in_the_mode_that_the_study_names() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("estimates");
    run(&hoffmann(), &dir, &["--samples", "200", "--half-width", "1e-3"]);
    let mut unstable = columns(&dir.join("occurrence.csv"), &["mode", "unstable"]);
    assert_eq!(unstable.len(), 2, "a mode that is never unstable has a row too");
    unstable.retain(|row| row[1] != "0");
    unstable.iter_mut().for_each(|row| row.truncate(1));
    let mut ever = 0;
    for row in columns(&dir.join("estimates.csv"), &["mode", "estimator", "lower", "upper", "half_width"]) {
        let [lower, upper, half_width] = [2, 3, 4].map(|column| row[column].parse::<f64>().unwrap());
        assert!(row[1] == "exact integral" && half_width <= HALF_WIDTH, "{row:?}");
        let expected = if unstable.contains(&row[..1].to_vec()) { EXACT } else { 0.0 };
        assert!(
            lower <= expected + HALF_WIDTH && expected - HALF_WIDTH <= upper && upper - lower <= HALF_WIDTH,
            "{row:?}"
        );
        ever += usize::from(expected > 0.0);
    }
    assert_eq!(ever, 1);

    // Estimates are kept: again, they are the same bytes, and so they are on another number of threads.
    let first = results(&dir);
    run(&hoffmann(), &dir, &["--samples", "200", "--half-width", "1e-3"]);
    assert_same(&first, &results(&dir));
    let one = folder.path().join("one");
    run(&hoffmann(), &one, &["--samples", "200", "--half-width", "1e-3", "--threads", "1"]);
    assert_same(&first, &results(&one));
}

#[test]
fn half_widths_out_of_range() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    for (value, shown) in [("0", "= 0;"), ("0.3", "0.3"), ("nan", "NaN"), ("1e-6", "0.000001")] {
        let output = squeal().arg("run").arg(hoffmann()).arg("--out").arg(&out).args(["--half-width", value]).output();
        refusal(&output.unwrap(), &["--half-width", shown, "0.00001 to 0.25"]);
        assert!(!out.exists(), "{value}");
    }
    let case = folder.path().join("brake.toml");
    let text = std::fs::read_to_string(hoffmann()).unwrap();
    std::fs::write(&case, text + "\n[accuracy]\nhalf_width = 0.5\n").unwrap();
    let output = squeal().arg("run").arg(&case).arg("--out").arg(&out).output().unwrap();
    refusal(&output, &["brake.toml", "accuracy.half_width", "0.5", "0.00001 to 0.25"]);
}
