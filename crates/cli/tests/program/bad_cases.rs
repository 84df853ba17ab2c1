//! Case files that cannot be run: one line each, which names the file, the field, the value and what is allowed.

use std::path::Path;

use crate::common::{SMALL, refusal, replaced, squeal};

/// What `squeal run` says about a case; the folder for its results must not come into being.
fn said(text: impl AsRef<[u8]>, expected: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = (folder.path().join("brake.toml"), folder.path().join("out"));
    std::fs::write(&case, text).unwrap();
    let output = squeal().arg("run").arg(&case).arg("--out").arg(&out).output().unwrap();
    let line = refusal(&output, expected);
    assert!(line.contains("brake.toml"), "the file is not named: {line}");
    assert!(!out.exists(), "written in spite of: {line}");
    println!("{}", line.trim_end());
    line
}

fn paper() -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/paper.toml")).unwrap()
}

#[test]
fn values_out_of_range() {
    let text = paper();
    for (from, to, expected) in [
        ("oscillator_mass = 0.39 ", "oscillator_mass = -0.39 ", ["lattice.oscillator_mass", "-0.39", "> 0"]),
        ("oscillator_mass = 0.39 ", "oscillator_mass = 0.0 ", ["lattice.oscillator_mass", "= 0;", "> 0"]),
        ("oscillator_mass = 0.39 ", "oscillator_mass = nan ", ["lattice.oscillator_mass", "NaN", "finite"]),
        ("wall = 2.45e7", "wall = -2.45e7", ["lattice.x_stiffness", "-24500000", ">= 0"]),
        ("wall = 2.45e7", "wall = inf", ["lattice.x_stiffness", "inf", "finite"]),
        ("contact_stiffness = 3.47e7", "contact_stiffness = -1.0", ["lattice.contact_stiffness", "= -1", "> 0"]),
        ("theta = 60.0", "theta = nan", ["lattice.theta", "NaN", "finite"]),
        ("mass = 9.05", "mass = -9.05", ["lattice.plate.mass", "-9.05", "> 0"]),
        ("4.87e8, 4.25e8", "4.87e8, -4.25e8", ["lattice.plate.stiffness[3]", "-425000000", ">= 0"]),
        ("mean = 0.55", "mean = 0.40", ["friction.mu_s", "0.4;", "mu_k, 0.45"]),
        ("mean = 0.50, deviation = 0.10", "mean = inf, deviation = 0.10", ["friction.mu.mean", "inf", "finite"]),
        ("deviation = 0.10", "deviation = -0.10", ["friction.mu.deviation", "-0.1", "> 0"]),
        ("at_least = 0.02 }", "at_least = 0.6 }", ["friction.mu.at_least", "0.6", "at most the mean, 0.5"]),
        ("at_least = 0.02 }", "at_least = -0.02 }", ["friction.mu.at_least", "-0.02", ">= 0"]),
        (
            "at_least = 0.02 }",
            "at_most = 0.1 }",
            ["friction.mu.at_most", "0.1", "keep 1 % of the distribution or more"],
        ),
        ("median = 1.5", "median = -1.5", ["friction.alpha.median", "-1.5", "> 0"]),
        ("from = 0.1", "from = 0.0", ["speeds \"low\".from", "= 0;", "m/s, > 0"]),
        ("from = 0.1", "from = -0.1", ["speeds \"low\".from", "-0.1", "m/s, > 0"]),
        ("to = 1.0\n", "to = 0.05\n", ["speeds \"low\".to", "0.05", "at least from = 0.1"]),
        ("to = 1.0\n", "to = inf\n", ["speeds \"low\".to", "inf", "m/s"]),
        ("per_contact = 600.0", "per_contact = 0.0", ["readings.preload.per_contact", "= 0;", "in N, > 0"]),
        ("samples = 1000 ", "samples = 0 ", ["study.samples", "= 0;", "1 to"]),
        ("oscillator_mass = [0.04", "oscillator_mass = [-0.04", ["alternatives.oscillator_mass", "-0.04", "> 0"]),
    ] {
        said(replaced(&text, from, to), &expected);
    }
}

#[test]
fn distributions_that_are_none() {
    let mu = r#"mu = { distribution = "normal", mean = 0.60, deviation = 0.2, at_least = 0.02 }"#;
    for (distribution, expected) in [
        (r#"distribution = "log-uniform", from = 0.0, to = 1.0"#, ["friction.mu.from", "= 0;", "a number > 0"]),
        (r#"distribution = "log-uniform", from = 2.0, to = 1.0"#, ["friction.mu.to", "= 1;", "at least from = 2"]),
        (
            r#"distribution = "log-normal", median = 0.5, sigma = 0.1, at_least = 0.9"#,
            ["friction.mu.at_least", "= 0.9;", "keep 1 % of the distribution or more"],
        ),
        (
            r#"distribution = "quantiles", probabilities = [0.0, 0.5], values = [0.1, 0.2]"#,
            ["friction.mu.probabilities", "0.5]", "1 as the last"],
        ),
        (
            r#"distribution = "quantiles", probabilities = [0.0, 1.0], values = [-0.1, 0.2]"#,
            ["friction.mu.values", "= -0.1;", "a number >= 0"],
        ),
        (
            r#"distribution = "quantiles", probabilities = [0.0, 1.0], value = [0.1, 0.2]"#,
            ["line 57", "value", "expected `probabilities` or `values`"],
        ),
    ] {
        said(replaced(SMALL, mu, &format!("mu = {{ {distribution} }}")), &expected);
    }
}

#[test]
fn lists_that_do_not_fit() {
    let text = paper();
    let arrangements = |list: &str| replaced(&text, "in_contact = [9, 8, 7, 6]", &format!("arrangements = {list}"));
    let fixed = |list: &str| replaced(&text, r#"["x1", "x3", "x7", "x9"]"#, list);
    for (text, expected) in [
        (arrangements("[[1, 10]]"), ["contact.arrangements", "10", "1 to 9"]),
        (arrangements("[[0, 1]]"), ["contact.arrangements", "0", "1 to 9"]),
        (arrangements("[[1, 2, 2]]"), ["contact.arrangements", "2", "each once"]),
        (arrangements("[[1, 2], [2, 1]]"), ["contact.arrangements", "1", "each once"]),
        (arrangements("[[]]"), ["contact.arrangements", "[]", "one oscillator or more"]),
        (arrangements("[]"), ["contact", "empty", "in_contact = [numbers]"]),
        (replaced(&text, "[9, 8, 7, 6]", "[9, 10]"), ["contact.in_contact", "10", "1 to 9"]),
        (replaced(&text, "[9, 8, 7, 6]", "[0]"), ["contact.in_contact", "0", "1 to 9"]),
        (replaced(&text, "[9, 8, 7, 6]", "[9, 9]"), ["contact.in_contact", "9", "each once"]),
        (fixed(r#"["x1", "x10"]"#), ["constraints \"corners\".fixed", "x10", "1 to 9"]),
        (fixed(r#"["x1", "q1"]"#), ["constraints \"corners\".fixed", "`q1`", "as in x1"]),
        (fixed(r#"["x1", "x1"]"#), ["constraints \"corners\".fixed", "x1", "each once"]),
        (replaced(&text, r#""corners-4-6""#, r#""corners""#), ["constraints.name", "corners", "each once"]),
        (replaced(&text, r#""corners""#, r#""a/b""#), ["constraints.name", "a/b", "letters, digits"]),
        (replaced(&text, r#"name = "high""#, r#"name = "low""#), ["speeds.name", "low", "each once"]),
        (
            replaced(&text, r#"["amontons-coulomb", "velocity-dependent", "lugre"]"#, r#"["lugre", "lugre"]"#),
            ["study.laws", "lugre", "each once"],
        ),
        (
            replaced(&text, r#"["amontons-coulomb", "velocity-dependent", "lugre"]"#, "[]"),
            ["study.laws", "[]", "one law or more"],
        ),
        (replaced(&text, "rows = 3", "rows = 0"), ["lattice", "0 x 3", "1 to 200"]),
        (
            replaced(&text, "z_damping = 181.0", "z_damping = [1.0]"),
            ["lattice.z_damping", "a list of 1;", "a list of 9"],
        ),
        (replaced(&text, "corners = [1, 3", "corners = [10, 3"), ["paper.corners", "10", "1 to 9"]),
    ] {
        said(text, &expected);
    }
}

#[test]
fn text_that_is_no_case() {
    for (text, expected) in [
        (replaced(SMALL, "rows = 1\n", "rwos = 1\n"), ["line 9", "rwos", "expected one of `rows`"]),
        (replaced(SMALL, "rows = 1\n", ""), ["line 8", "missing field `rows`", "lattice"]),
        (
            replaced(SMALL, "rows = 1\n", "rows = \"three\"\n"),
            ["line 9", "rows = \"three\"", "expected a whole number >= 0"],
        ),
        (replaced(SMALL, "rows = 1\n", "rows = -3\n"), ["line 9", "rows = -3", "expected a whole number >= 0"]),
        (replaced(SMALL, "samples = 40", "samples = 2.5"), ["line 5", "samples = 2.5", "expected a whole number >= 0"]),
        (replaced(SMALL, "theta = 60.0", "theta = sixty"), ["line 18", "theta = sixty", "quoted"]),
        (replaced(SMALL, "\"velocity-dependent\"", "\"coulomb\""), ["line 4", "coulomb", "`amontons-coulomb`"]),
        (replaced(SMALL, "lateral = \"coupled\"", "lateral = \"both\""), ["lateral", "both", "`vector`"]),
        (replaced(SMALL, "distribution = \"normal\"", "distribution = \"gauss\""), ["mu", "gauss", "`log-normal`"]),
        (replaced(SMALL, "rows = 1\n", "rows = 1\nrows = 4\n"), ["line 10", "rows", "duplicate"]),
        ("this is no TOML".into(), ["line 1", "this is no TOML", "="]),
        (String::new(), ["brake.kind = missing", "\"lattice\"", "\"matrices\""]),
    ] {
        said(text, &expected);
    }
    said([0xff, 0xfe, 0x00], &["cannot be read", "UTF-8"]);
}

#[test]
fn files_that_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    for (name, expected) in [("missing.toml", "No such file"), (".", "directory")] {
        for command in ["run", "check", "cea"] {
            let case = folder.path().join(name);
            let mut program = squeal();
            program.arg(command).arg(&case);
            if command == "run" {
                program.arg("--out").arg(folder.path().join("out"));
            }
            let line = refusal(&program.output().unwrap(), &["cannot be read", expected]);
            assert!(line.contains(folder.path().to_str().unwrap()), "{line}");
        }
    }
    assert!(!folder.path().join("out").exists());
}

#[test]
fn options_out_of_range() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = (folder.path().join("brake.toml"), folder.path().join("out"));
    std::fs::write(&case, SMALL).unwrap();
    let run = |options: &[&str]| squeal().arg("run").arg(&case).arg("--out").arg(&out).args(options).output().unwrap();
    refusal(&run(&["--samples", "0"]), &["'0'", "--samples", "1 to"]);
    refusal(&run(&["--samples", "18446744073709551615"]), &["'18446744073709551615'", "1 to"]);
    refusal(&run(&["--threads", "0"]), &["--threads = 0", "1 to"]);
    refusal(&run(&["--threads", "1000000"]), &["--threads = 1000000", "1 to"]);
    for options in [["--samples", "-1"], ["--samples", "ten"], ["--seed", "x"], ["--spam", "1"]] {
        let output = run(&options);
        assert_eq!(output.status.code(), Some(2));
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert!(stderr.starts_with("error: ") && stderr.contains(options[0]), "{stderr}");
    }
    assert!(!out.exists());
}

#[test]
fn a_case_beyond_memory_is_refused_at_once() {
    let text = replaced(&replaced(&paper(), "rows = 3 ", "rows = 6 "), "columns = 3", "columns = 6");
    said(replaced(&text, "[9, 8, 7, 6]", "[36, 18]"), &["contact.in_contact", "18", "arrangements"]);
}

#[test]
fn a_case_without_a_median_equilibrium_leaves_no_folder() {
    let text = replaced(SMALL, "per_contact = 600.0", "equilibrium = 600.0");
    let text = replaced(&text, "lean = \"against\"", "lean = \"along\"");
    let text = replaced(&text, "mean = 0.60", "mean = 1.5");
    let text = replaced(&text, "x_stiffness = { wall = 2.45e7, inner = 1.05e7 }", "x_stiffness = 1e6");
    said(text, &["median", "oscillator", "lifts off", "allowed: > 0"]);
}

#[test]
fn what_a_sweep_cannot_be_at_is_refused_with_the_file_first_and_once() {
    let case = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/two-by-two.toml");
    let output = squeal().arg("sweep").arg(&case).args(["--law", "lugre", "--over", "mu_k=0.1:0.6"]).output().unwrap();
    let line = refusal(&output, &["two-by-two.toml: swept to mu_k = 0.6: mu_s = 0.55; allowed: >= mu_k"]);
    assert_eq!(line.matches("two-by-two.toml").count(), 1, "{line}");
}
