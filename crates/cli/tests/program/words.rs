//! What the program calls things: brakes without contacts, and one mode by one number in all commands.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::common::{run, squeal};
use crate::tables::columns;

fn case(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases").join(name)
}

#[test]
fn a_brake_whose_friction_is_a_term_has_no_word_about_contacts() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("disc");
    let text = run(&case("wobbling-disc.toml"), &dir, &["--samples", "50"]);
    assert!(text.starts_with("mode 2 at ") && !text.contains("contact"), "{text}");
    for file in ["summary.md", "report.html"] {
        let words = std::fs::read_to_string(dir.join(file)).unwrap();
        assert!(words.contains("with 50 random draws of N0, Omega and mu."), "{words}");
    }
    let figure = std::fs::read_to_string(dir.join("occurrence-none.svg")).unwrap();
    assert!(figure.contains("all draws") && !figure.contains("contact"), "{figure}");
}

#[test]
fn panels_are_named_where_there_are_several() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("lattice");
    let text = run(&case("two-by-two.toml"), &dir, &["--samples", "8"]);
    assert!(text.contains("none, lugre, ") || text.contains("anything is unstable in"), "{text}");
    let figure = std::fs::read_to_string(dir.join("occurrence-none-amontons-coulomb.svg")).unwrap();
    assert!(figure.contains("(a) four in contact"), "{figure}");
    let page = |dir: &Path| std::fs::read_to_string(dir.join("report.html")).unwrap();
    assert!(page(&dir).contains("A mark is the median over the arrangements of contacts"));
    // Of one panel nothing is said of panels or arrangements.
    let dir = folder.path().join("belt");
    let text = run(&case("hoffmann.toml"), &dir, &["--samples", "50"]);
    assert!(text.starts_with("mode 2 at ") && !text.contains("contact"), "{text}");
    let page = page(&dir);
    let (_, words) = page.split_once("</style>").unwrap();
    let (words, _) = words.split_once("<script").unwrap();
    assert!(!words.contains("panel") && !words.contains("rrangement"), "{words}");
}

/// Hoffmann's oscillator flutters at one frequency, and so does its damped mode.
#[test]
fn modes_of_equal_frequency_have_the_same_rank_everywhere() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("belt");
    run(&case("hoffmann.toml"), &dir, &["--samples", "50"]);
    let mut named = columns(&dir.join("occurrence.csv"), &["mode", "unstable"]);
    named.retain(|row| row[1] != "0");
    let output = squeal().arg("cea").arg(case("hoffmann.toml")).arg("--json").output().unwrap();
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let modes = found["modes"].as_array().unwrap();
    let number = |mode: &Value, key: &str| mode[key].as_f64().unwrap();
    assert!((number(&modes[0], "im") - number(&modes[1], "im")).abs() < 1e-12 * number(&modes[0], "im"));
    assert!(number(&modes[0], "re") < 0.0 && number(&modes[1], "re") > 0.0);
    assert_eq!((number(&modes[0], "rank"), number(&modes[1], "rank")), (1.0, 2.0));
    assert_eq!(named.len(), 1);
    assert_eq!(named[0][0], "2");
}
