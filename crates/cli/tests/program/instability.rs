//! What the program says of what is unstable without being a mode with a name, or grows below a threshold.

use std::path::Path;

use serde_json::Value;

use crate::common::{answer, asked, hoffmann, replaced, run};
use crate::prepared;
use crate::tables::columns;

/// A brake given by matrices with one parameter p, uniform between two numbers.
fn family(ends: [f64; 2], constant: &str, linear: &str) -> String {
    format!(
        "[study]\nname = \"family\"\nsamples = 200\nseed = 1\n[brake]\nkind = \"matrices\"\n[parameters.p]\ndistribution = \"uniform\"\n\
         from = {:?}\nto = {:?}\n[[terms]]\nname = \"constant\"\n{constant}\n[[terms]]\nname = \"linear\"\ncoefficient = \"-p\"\n{linear}\n",
        ends[0], ends[1]
    )
}

/// Two masses whose stiffness is indefinite for p > 1.5.
fn diverging() -> String {
    let constant =
        "mass = [[1.0, 0.0], [0.0, 1.0]]\nstiffness = [[2.0, 1.0], [1.0, 2.0]]\ndamping = [[0.05, 0.0], [0.0, 0.05]]";
    family([0.5, 2.5], constant, "stiffness = [[1.0, 0.0], [0.0, 0.0]]")
}

fn read(dir: &Path, name: &str) -> String {
    std::fs::read_to_string(dir.join(name)).unwrap()
}

#[test]
fn divergence_is_in_the_text_the_summary_the_page_and_the_tables() {
    let folder = tempfile::tempdir().unwrap();
    let (case, dir) = (folder.path().join("brake.toml"), folder.path().join("out"));
    std::fs::write(&case, diverging()).unwrap();
    let said = run(&case, &dir, &["--half-width", "0.02", "--keep-samples"]);
    assert!(
        said.contains("divergence (real eigenvalues, no oscillation): unstable in 0.")
            && !said.contains("ever unstable"),
        "{said}"
    );
    for file in ["summary.md", "report.html"] {
        assert!(read(&dir, file).contains("divergence"), "{file}");
    }
    assert!(!read(&dir, "summary.md").contains("no mode is unstable"));
    let rows = columns(&dir.join("occurrence.csv"), &["mode", "samples", "unstable", "lower", "upper"]);
    let row = rows.iter().find(|row| row[0] == "divergence").unwrap();
    let panel =
        &columns(&dir.join("panels.csv"), &["any_unstable", "divergent", "diverging", "mean_unstable_modes"])[0];
    assert_eq!([&panel[0], &panel[2]], [&row[2], &row[2]]);
    let share = row[2].parse::<f64>().unwrap() / 200.0;
    assert!((share - 0.5).abs() < 0.15 && panel[3].parse::<f64>().unwrap() >= share);
    // The estimators count it as well: half of the draws.
    let estimate = columns(&dir.join("estimates.csv"), &["mode", "lower", "upper", "half_width"]);
    let estimate = estimate.iter().find(|row| row[0] == "divergence").unwrap();
    let [lower, upper, half_width] = [1, 2, 3].map(|at| estimate[at].parse::<f64>().unwrap());
    assert!(lower - half_width <= 0.5 && 0.5 <= upper + half_width && half_width <= 0.02, "{estimate:?}");
    let kept = columns(&dir.join("samples.csv"), &["unstable"]);
    assert_eq!(kept.iter().filter(|row| row[0].starts_with("divergence:")).count().to_string(), row[2]);
    assert!(columns(&dir.join("influence.csv"), &["mode"]).iter().any(|row| row[0] == "divergence"));

    let asked = answer("influence", &case, &["--samples", "200"]);
    assert!(asked.contains("growth of divergence") && asked.contains("whether there is divergence"), "{asked}");
    let screened = answer("screen", &case, &["--samples", "60", "--kinds", "spring"]);
    assert!(
        screened.contains("divergence: ") && !screened.contains("0.000 (0.000 to 0.000) unstable modes"),
        "{screened}"
    );
}

#[test]
fn a_real_eigenvalue_that_grows_diverges_and_growth_below_a_threshold_is_not_stability() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, replaced(&diverging(), "from = 0.5", "from = 1.6")).unwrap();
    let said = answer("cea", &case, &[]);
    assert!(
        said.contains("UNSTABLE without oscillation: 1 real eigenvalue diverges, by ") && said.contains(" diverges"),
        "{said}"
    );
    let json: serde_json::Value = serde_json::from_str(&answer("cea", &case, &["--json"])).unwrap();
    assert_eq!(json["real_verdicts"], serde_json::json!(["stable", "diverges"]));

    let text = std::fs::read_to_string(hoffmann()).unwrap();
    let growing = "[squeal]\ngrowth_above = 5.0\n";
    std::fs::write(&case, format!("{text}\n{growing}")).unwrap();
    let said = answer("cea", &case, &[]);
    let verdicts: Vec<&str> = said.lines().filter_map(|line| line.rsplit("  ").next()).collect();
    assert!(verdicts.contains(&"below threshold") && !verdicts.iter().any(|word| word.trim() == "unstable"), "{said}");
    // Any divergence has the damping ratio -1.
    let (dir, ratio) = (folder.path().join("out"), "\n[squeal]\ndamping_ratio_below = -0.5\n");
    std::fs::write(&case, diverging() + ratio).unwrap();
    let by_ratio = run(&case, &dir, &[]);
    assert!(by_ratio.contains("divergence (real eigenvalues"), "{by_ratio}");
}

#[test]
fn an_estimate_that_the_samples_contradict_is_not_printed() {
    let folder = tempfile::tempdir().unwrap();
    let (case, dir) = (folder.path().join("brake.toml"), folder.path().join("out"));
    // Unstable in 1 % of the draws, in an interval of the parameter in which its formula has a bump.
    let text = std::fs::read_to_string(hoffmann()).unwrap();
    let text = replaced(&text, "from = 0.5", "from = 0.0");
    let text = replaced(&text, "to = 1.1", "to = 1.0");
    let text = replaced(&text, "mu = \"mu\"", "mu = \"0.7 + 0.06*exp(-((mu - 0.8585)/0.0150755)^2)\"");
    std::fs::write(&case, text).unwrap();
    let said = run(&case, &dir, &["--samples", "4000", "--half-width", "0.004"]);
    assert!(!said.contains("exact integral: 1 scenes"), "{said}");
    let estimates = columns(&dir.join("estimates.csv"), &["mode", "lower", "upper", "half_width"]);
    assert!(!estimates.is_empty());
    for row in estimates {
        let [lower, upper, half_width] = [1, 2, 3].map(|at| row[at].parse::<f64>().unwrap());
        assert!(lower - half_width <= 0.01 && 0.01 <= upper + half_width, "{row:?}");
    }
}

/// Without damping `-conj(lambda)` is an eigenvalue with lambda: what is alone is on the axis, whatever the error of the reduction.
#[test]
fn modes_of_finite_elements_without_damping_are_on_the_axis_or_flutter_in_pairs() {
    let folder = tempfile::tempdir().unwrap();
    let damped = std::fs::read_to_string(prepared::case(folder.path())).unwrap();
    let lines = damped.lines().filter(|line| !line.starts_with("rayleigh"));
    let undamped = replaced(
        &(lines.collect::<Vec<_>>().join("\n") + "\n"),
        "tolerance = 1e-6",
        "lateral = \"none\"\ntolerance = 1e-6",
    );
    let case = folder.path().join("undamped.toml");
    std::fs::write(&case, undamped).unwrap();
    let verdicts = |mu: &str| {
        let asked = asked("cea", &case, &["--no-cache", "--json", "--set", mu]);
        let found: Value = serde_json::from_slice(&asked.stdout).unwrap();
        let of = |mode: &Value| (mode["verdict"].as_str().unwrap().to_owned(), mode["re"].as_f64().unwrap());
        found["modes"].as_array().unwrap().iter().map(of).collect::<Vec<_>>()
    };
    // At a friction too small for any two to meet, and with none.
    let [_, on_the_axis] = ["mu=0", "mu=0.02"].map(|mu| {
        let found = verdicts(mu);
        assert!(found.len() >= 2 && found.iter().all(|(verdict, _)| verdict == "marginal"), "{found:?}");
        found.len()
    });
    // Where two flutter one grows; the other decays as fast, faster than the case follows modes.
    let found = verdicts("mu=1.0");
    let count = |wanted: &str| found.iter().filter(|(verdict, _)| verdict == wanted).count();
    assert!(count("unstable") == 1 && count("marginal") >= 2, "{found:?}");
    assert_eq!(count("unstable") + count("marginal"), found.len(), "{found:?}");
    let dir = folder.path().join("out");
    run(&case, &dir, &["--no-cache", "--set", "mu=0.02"]);
    let panel = &columns(&dir.join("panels.csv"), &["any_unstable", "undecided", "marginal"])[0];
    assert_eq!([&*panel[0], &*panel[1]], ["0", "0"]);
    assert_eq!(panel[2], (6 * on_the_axis).to_string());
}
