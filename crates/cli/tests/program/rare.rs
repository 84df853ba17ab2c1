//! `squeal rare` as a user sees it: its files, the likeliest squealing brake as a case, the same bytes on any number of threads, and what it refuses.

use std::path::Path;
use std::time::Duration;

use crate::common::{assert_same, refusal, replaced, results, squeal};
use crate::tables::columns;

/// Hoffmann's oscillator, one in 100,000 of which flutters.
pub const RARE: &str = r#"
[study]
name = "Hoffmann"
samples = 100
seed = 3

[brake]
kind = "matrices"
dofs = ["x", "y"]

[parameters.mu]
unit = "1"
distribution = "normal"
mean = 0.5
deviation = 0.076

[parameters.c]
unit = "Ns/m"
distribution = "log-normal"
median = 0.3
sigma = 0.4

[[terms]]
name = "springs"
mass = [[1.0, 0.0], [0.0, 1.0]]
stiffness = [[2.0, 1.0], [1.0, 2.0]]

[[terms]]
name = "dashpots"
coefficient = "c"
damping = [[1.0, 0.0], [0.0, 1.0]]

[[contacts]]
name = "belt"
force = { x = -1.0 }
reading = { y = 1.3333333333333333 }
mu = "mu"
"#;

#[test]
fn rare_squeal_has_its_tables_and_its_likeliest_brake_as_a_case_on_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, RARE).unwrap();
    let ask = |threads: &str| {
        let dir = folder.path().join(threads);
        let output =
            squeal().arg("rare").arg(&case).args(["--threads", threads]).arg("--out").arg(&dir).output().unwrap();
        assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
        (String::from_utf8(output.stdout).unwrap(), results(&dir))
    };
    let ((said, one), (_, two)) = (ask("1"), ask("2"));
    assert_same(&one, &two);
    let files: Vec<&str> = one.keys().map(String::as_str).collect();
    let expected = [
        "design_points.csv",
        "design_points.pdf",
        "design_points.png",
        "design_points.svg",
        "likeliest.toml",
        "rare.csv",
        "study.txt",
        "summary.md",
    ];
    assert_eq!(files, expected);
    assert!(said.contains("probability of squeal: 1.") && said.contains("e-5 ("), "{said}");
    let rows = columns(&folder.path().join("1/rare.csv"), &["mode", "probability", "lower", "upper", "spectra"]);
    assert_eq!(rows[0][0], "any");
    for row in &rows {
        let [value, lower, upper] = [1, 2, 3].map(|at| row[at].parse::<f64>().unwrap());
        assert!((0.0..1.0).contains(&lower) && lower <= value && value <= upper && upper < 1e-4, "{row:?}");
    }
    // The case runs, and just squeals.
    let likeliest = folder.path().join("1/likeliest.toml");
    let output = squeal().arg("cea").arg(&likeliest).arg("--json").output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let point: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let growths = point["modes"].as_array().unwrap().iter().map(|mode| mode["re"].as_f64().unwrap());
    let largest = growths.fold(f64::NEG_INFINITY, f64::max);
    assert!(largest > 0.0 && largest < 0.05, "{point}");
    // Another question in the same folder is refused, the same one is answered again.
    let again = |relative: &str| {
        let dir = folder.path().join("1");
        squeal().arg("rare").arg(&case).args(["--relative", relative]).arg("--out").arg(dir).output().unwrap()
    };
    assert!(again("0.1").status.success());
    refusal(&again("0.2"), &["rare"]);
}

/// Friction that is high in a range of a deviation's fraction alone: what squeals is there, and not a fixed step behind its onset.
#[test]
fn the_likeliest_brake_of_a_narrow_range_squeals() {
    let folder = tempfile::tempdir().unwrap();
    for width in ["0.5", "0.05", "0.02"] {
        let friction = format!("mu = \"0.3 + 0.6 * exp(-((x - 3) / {width})^2)\"");
        let case = RARE
            .replace("[parameters.mu]", "[parameters.x]")
            .replace("mean = 0.5\ndeviation = 0.076", "mean = 0.0\ndeviation = 1.0\nat_least = -inf")
            .replace(
                "distribution = \"log-normal\"\nmedian = 0.3\nsigma = 0.4",
                "distribution = \"constant\"\nvalue = 0.05",
            )
            .replace("mu = \"mu\"", &friction);
        assert!(case.contains(&friction));
        let path = folder.path().join(format!("{width}.toml"));
        std::fs::write(&path, case).unwrap();
        let out = folder.path().join(width);
        assert!(squeal().arg("rare").arg(&path).arg("--out").arg(&out).status().unwrap().success());
        let output = squeal().arg("cea").arg(out.join("likeliest.toml")).arg("--json").output().unwrap();
        let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let is_unstable = |mode: &serde_json::Value| mode["verdict"] == "unstable";
        assert!(document["modes"].as_array().unwrap().iter().any(is_unstable), "{width}: {document:#}");
    }
}

#[test]
fn a_killed_answer_ends_in_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, RARE).unwrap();
    let ask = |dir: &Path| {
        let mut command = squeal();
        command.arg("rare").arg(&case).args(["--relative", "0.02", "--budget", "100000"]).arg("--out").arg(dir);
        command
    };
    let [killed, whole] = ["killed", "whole"].map(|name| folder.path().join(name));
    let length = || std::fs::metadata(killed.join("rare_points.json")).map_or(0, |file| file.len());
    for least in [1, 100_000, 400_000] {
        let mut child = ask(&killed).spawn().unwrap();
        while length() < least {
            assert!(child.try_wait().unwrap().is_none(), "the answer is there before {least} bytes are kept");
            std::thread::sleep(Duration::from_millis(1));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(!killed.join("rare.csv").exists());
    }
    for dir in [&killed, &whole] {
        let output = ask(dir).output().unwrap();
        assert!(output.status.success(), "{output:?}");
    }
    assert_same(&results(&killed), &results(&whole));
    assert!(!killed.join("rare_points.json").exists());
}

#[test]
fn what_rare_squeal_cannot_be_asked_of_is_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    let ask = |text: &str, options: &[&str], said: &[&str]| {
        std::fs::write(&case, text).unwrap();
        refusal(&squeal().arg("rare").arg(&case).args(options).output().unwrap(), said);
    };
    ask(RARE, &["--relative", "0"], &["--relative = 0", "above 0 and below 1"]);
    ask(RARE, &["--relative", "-0.1"], &["--relative = -0.1"]);
    ask(RARE, &["--relative", "nan"], &["--relative = NaN"]);
    ask(RARE, &["--budget", "0"], &["--budget = 0", "100 to 10000000"]);
    ask(RARE, &["--budget", "18446744073709551615"], &["--budget", "100 to 10000000"]);
    ask(RARE, &["--directions", "1000000000"], &["--directions"]);
    // The folder is free for another question.
    let dir = folder.path().join("out");
    let out = ["--out", dir.to_str().unwrap()];
    ask(&RARE.replace("mean = 0.5", "mean = 0.9"), &out, &["is unstable with all inputs at their medians"]);
    assert!(!dir.exists());
    let discrete = "distribution = \"discrete\"\nvalues = [0.4, 0.5, 0.6]";
    let normal = "distribution = \"normal\"\nmean = 0.5\ndeviation = 0.076";
    ask(&RARE.replace(normal, discrete), &[], &["\"mu\"", "discrete", "continuous"]);
}

/// A unit is text in every document, also the unit 1 of what has no dimension.
#[test]
fn units_of_documents_are_text() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    // What squeals in few samples has no influences.
    for (command, rows, mean) in [("rare", "design_points", "mean = 0.5"), ("influence", "rows", "mean = 0.75")] {
        let text = replaced(&replaced(RARE, "mean = 0.5", mean), "samples = 100", "samples = 400");
        std::fs::write(&case, text).unwrap();
        let output = squeal().arg(command).arg(&case).arg("--json").output().unwrap();
        assert!(output.status.success(), "{output:?}");
        let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let units: Vec<_> = document[rows].as_array().unwrap().iter().map(|row| row["unit"].clone()).collect();
        assert!(units.contains(&"1".into()) && units.contains(&"Ns/m".into()), "{command}: {units:?}");
        assert!(units.iter().all(|unit| unit.is_string() || unit.is_null()), "{command}: {units:?}");
    }
}
