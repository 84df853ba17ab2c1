//! What the tables of a study say together.

use std::collections::{BTreeMap, BTreeSet};

use crate::common::{SMALL, results, run};

/// The rows of a table, each by its columns.
fn rows(bytes: &[u8]) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_reader(bytes);
    let header = reader.headers().unwrap().clone();
    let row = |record: csv::StringRecord| header.iter().zip(&record).map(|(k, v)| (k.into(), v.into())).collect();
    reader.records().map(|record| row(record.unwrap())).collect()
}

#[test]
fn modes_have_rows_frequencies_links_and_differences_in_every_set() {
    let folder = tempfile::tempdir().unwrap();
    let (case, dir) = (folder.path().join("brake.toml"), folder.path().join("out"));
    std::fs::write(&case, SMALL).unwrap();
    run(&case, &dir, &[]);
    let files = results(&dir);

    // Nine degrees of freedom, eight with x1 held; none is overdamped.
    let modes = rows(&files["modes.csv"]);
    let labels: Vec<&str> = modes.iter().map(|row| row["label"].as_str()).collect();
    let expected: Vec<String> = (1..=9).map(|i| format!("A{i}")).chain((1..=8).map(|i| format!("B{i}"))).collect();
    assert_eq!(labels, expected);
    for row in &modes {
        let [hertz, growth, damping]: [f64; 3] =
            ["frequency_hz", "growth_rate", "damping_ratio"].map(|column| row[column].parse().unwrap());
        let modulus = growth.hypot(std::f64::consts::TAU * hertz);
        assert!(hertz > 0.0 && (damping + growth / modulus).abs() < 1e-12, "{row:?}");
        let shape = rows(&files[&row["shape_file"]]);
        assert!(shape.iter().filter(|part| part["mode"] == row["mode"]).count() >= 8, "{row:?}");
    }
    assert!(rows(&files["shapes-first.csv"]).iter().all(|part| part["dof"] != "x1"));

    // Each mode of the second set continues one of the first.
    let links = rows(&files["links.csv"]);
    let reached: BTreeSet<&str> =
        links.iter().filter(|row| row["continuation"] != "no").map(|row| row["to_mode"].as_str()).collect();
    assert_eq!(reached.into_iter().collect::<Vec<_>>(), labels[9..]);

    // Modes that are never unstable have rows: 0 of 40, at most z^2 / (40 + z^2) with z = 1.96 (Wilson).
    let occurrence = rows(&files["occurrence.csv"]);
    for set in ["none", "first"] {
        let of_set: BTreeSet<&str> =
            occurrence.iter().filter(|row| row["constraints"] == set).map(|row| row["mode"].as_str()).collect();
        assert_eq!(of_set.len(), if set == "none" { 9 } else { 8 });
    }
    let quiet = occurrence.iter().find(|row| row["unstable"] == "0" && row["open"] == "0").unwrap();
    assert!((quiet["upper"].parse::<f64>().unwrap() - 0.0876).abs() < 1e-4, "{quiet:?}");

    let differences = rows(&files["differences.csv"]);
    let kinds: BTreeSet<&str> = differences.iter().map(|row| row["comparison"].as_str()).collect();
    assert_eq!(kinds.into_iter().collect::<Vec<_>>(), ["constraints", "contact", "law", "speed"]);
    for row in &differences {
        let [value, lower, upper]: [f64; 3] =
            ["difference", "lower", "upper"].map(|column| row[column].parse().unwrap());
        assert!(lower <= value && value <= upper, "{row:?}");
    }
    let summary = String::from_utf8(files["summary.md"].clone()).unwrap();
    for part in
        ["- **Set A, \u{201c}none\u{201d}**: ", "## What helps", "- **Set B, \u{201c}first\u{201d}**: fewer in "]
    {
        assert!(summary.contains(part), "{part} is missing from\n{summary}");
    }
}

#[test]
fn figures_have_tables_of_numbers_and_names_without_an_empty_cell() {
    let folder = tempfile::tempdir().unwrap();
    let (case, dir) = (folder.path().join("brake.toml"), folder.path().join("out"));
    std::fs::write(&case, SMALL).unwrap();
    run(&case, &dir, &["--samples", "8"]);
    let files = results(&dir);
    let figures: Vec<_> =
        files.iter().filter(|(name, _)| name.starts_with("occurrence-") && name.ends_with(".csv")).collect();
    assert_eq!(figures.len(), 6, "two sets, three laws");
    for (name, bytes) in figures {
        let table = rows(bytes);
        assert!(!table.is_empty());
        for row in &table {
            assert!(row.values().all(|cell| !cell.is_empty()), "{name}: {row:?}");
            // 12.5 and not 12.500000000000002.
            assert!(row["occurrence_percent"].len() <= 5, "{name}: {row:?}");
        }
    }
}
