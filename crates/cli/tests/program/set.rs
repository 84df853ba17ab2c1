//! `--set`: as if the case file said so.

use std::path::Path;

use crate::common::{SMALL, answer, asked, assert_same, hoffmann, refusal, replaced, results, run, squeal};

/// Asserts that commands, each with its options, find the same with a setting as of a file that says so.
fn same_as_edited(text: &str, edited: &str, set: &[&str], commands: &[(&str, &[&str])]) {
    let dir = tempfile::tempdir().unwrap();
    let case = dir.path().join("brake.toml");
    let asked = |with: &str, set: &[&str]| {
        let set: Vec<&str> = set.iter().flat_map(|&setting| ["--set", setting]).collect();
        for (command, options) in commands {
            let out = dir.path().join(format!("{command}-{with}"));
            let mut program = squeal();
            program.arg(command).arg(&case).args(*options).args(&set).arg("--out").arg(out);
            let output = program.output().unwrap();
            assert!(output.status.success(), "{command}: {output:?}");
        }
        answer("cea", &case, &set)
    };
    std::fs::write(&case, text).unwrap();
    let (plain, with) = (answer("cea", &case, &[]), asked("set", set));
    assert_ne!(plain, with);
    std::fs::write(&case, edited).unwrap();
    assert_eq!(asked("edited", &[]), with);
    for (command, _) in commands {
        let of = |with: &str| results(&dir.path().join(format!("{command}-{with}")));
        assert_same(&of("edited"), &of("set"));
    }
    let manifest = |with: &str| -> serde_json::Value {
        let (command, _) = commands[0];
        serde_json::from_slice(&std::fs::read(dir.path().join(format!("{command}-{with}/manifest.json"))).unwrap())
            .unwrap()
    };
    assert_eq!(manifest("set")["set"], serde_json::json!(set));
    assert_eq!(manifest("edited").get("set"), None);
    assert_eq!(manifest("set")["case_sha256"], manifest("edited")["case_sha256"]);
}

#[test]
fn every_command_finds_what_it_finds_of_the_edited_file() {
    let text = std::fs::read_to_string(hoffmann()).unwrap();
    let edited = replaced(&text, "to = 1.1", "to = 1.2");
    let edited = replaced(&edited, "samples = 10000", "samples = 100");
    let edited = replaced(&edited, "mu = \"mu\"", "mu = \"mu * 1.05\"");
    let edited = edited + "\n[squeal]\ngrowth_above = 0.001\n";
    let set = ["parameters.mu.to=1.2", "study.samples=100", "contacts.belt.mu=mu * 1.05", "squeal.growth_above=0.001"];
    same_as_edited(
        &text,
        &edited,
        &set,
        &[
            ("run", &["--keep-samples"]),
            ("influence", &[]),
            ("sweep", &["--over", "mu=0.1:1.3"]),
            ("screen", &["--kinds", "dashpot", "--up-to", "1"]),
            ("cycle", &["--over", "mu=0.5:1.1"]),
        ],
    );
    let edited =
        replaced(SMALL, r#""normal", mean = 0.60, deviation = 0.2, at_least = 0.02 }"#, r#""constant", value = 0.9 }"#);
    same_as_edited(SMALL, &edited, &["mu=0.9"], &[("run", &[])]);
}

/// What is set to a constant leaves the correlation, in every command: the study is that of the file without its row and column.
#[test]
fn what_is_set_to_a_constant_is_correlated_with_nothing() {
    let text = std::fs::read_to_string(hoffmann()).unwrap();
    let drawn = "distribution = \"uniform\"\nfrom = 0.9\nto = 1.1\n";
    let correlation = |names: &str, rows: &str| format!("[correlation]\nparameters = {names}\nmatrix = {rows}\n");
    let three = correlation("[\"s\", \"mu\", \"t\"]", "[[1.0, -0.6, 0.3], [-0.6, 1.0, 0.2], [0.3, 0.2, 1.0]]");
    let case = |t: &str, correlation: &str| {
        let text = replaced(&text, "mu = \"mu\"", "mu = \"mu*s*t\"");
        format!("{text}\n[parameters.s]\n{drawn}[parameters.t]\n{t}{correlation}")
    };
    let two = correlation("[\"s\", \"mu\"]", "[[1.0, -0.6], [-0.6, 1.0]]");
    same_as_edited(
        &case(drawn, &three),
        &case("distribution = \"constant\"\nvalue = 0.8\n", &two),
        &["t=0.8"],
        &[("run", &["--samples", "200"]), ("sweep", &["--over", "mu=0.5:1.1"])],
    );
}

#[test]
fn a_study_is_continued_only_with_what_was_set() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("study");
    run(&hoffmann(), &out, &["--samples", "20", "--set", "parameters.mu.to=1.2"]);
    let options = ["--samples", "40", "--out", out.to_str().unwrap()];
    refusal(&asked("run", &hoffmann(), &options), &["study", "parameters"]);
    let same = ["--set", "parameters.mu.to=1.2"];
    assert!(asked("run", &hoffmann(), &[&options[..], &same].concat()).status.success());
}

#[test]
fn what_cannot_be_set_is_refused_in_a_line() {
    let said = |set: &str| asked("check", &hoffmann(), &["--set", set]);
    refusal(&said("mo=0.3"), &["hoffmann.toml: set = mo=0.3; allowed: mu, or a field as table.key"]);
    refusal(&said("mu"), &["NAME=VALUE"]);
    refusal(&said("terms.spring.coefficient=2"), &["springs, dashpots"]);
    // What has a place is for the case to refuse, as if the file said so.
    refusal(&said("parameters.mu.to=0.1"), &["hoffmann.toml", "from"]);
    refusal(&said("study.sample=3"), &["hoffmann.toml: --set stu", "unknown field `sample`"]);
    refusal(&said("stuudy.samples=3"), &["hoffmann.toml: --set stu", "unknown field `stuudy`"]);
    refusal(&said("terms.springs.coefficient=2 * nu"), &["nu"]);
    refusal(&asked("check", Path::new("none.toml"), &["--set", "mu=1"]), &["none.toml: cannot be read"]);
}
