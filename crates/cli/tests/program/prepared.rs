//! A brake of finite elements is prepared once: whatever comes after reads it, with the same bytes as without.

use std::path::{Path, PathBuf};
use std::process::Output;

use super::common::{asked, assert_same, hoffmann, refusal, replaced, results, run, squeal};

/// The disc and pad in little, with one set of constraints, in a folder of its own.
pub fn case(folder: &Path) -> PathBuf {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/disc-pad");
    for name in ["disc-pad.inp", "disc-pad.mas.gz", "disc-pad.sti.gz", "disc-pad.dof.gz"] {
        std::fs::copy(own.join(name), folder.join(name)).unwrap();
    }
    let mut text = std::fs::read_to_string(own.join("disc-pad.toml")).unwrap();
    for (from, to) in [
        ("in_contact = [9, 8]", "in_contact = [9]"),
        ("laws = [\"amontons-coulomb\", \"velocity-dependent\", \"lugre\"]", "laws = [\"amontons-coulomb\"]"),
        ("[500.0, 8000.0]", "[2600.0, 3200.0]"),
        ("full_checks = 100", "training = 3\nfull_checks = 2"),
        ("samples = 100", "samples = 6"),
    ] {
        text = replaced(&text, from, to);
    }
    let [other, next] = ["[[constraints]]\nname = \"ends", "[[speeds]]"].map(|part| text.find(part).unwrap());
    text.replace_range(other..next, "");
    let path = folder.join("brake.toml");
    std::fs::write(&path, text).unwrap();
    path
}

/// The output of a command, and its line on where its brake is from.
fn said(output: &Output) -> (String, String) {
    let [out, err] = [&output.stdout, &output.stderr].map(|text| String::from_utf8(text.clone()).unwrap());
    assert!(output.status.success(), "{err}");
    let lines: Vec<&str> = err.lines().filter(|line| line.starts_with("Prepared brake: ")).collect();
    assert!(lines.len() <= 1, "{err}");
    (out, lines.concat())
}

#[test]
fn what_is_prepared_is_read_by_every_command_with_the_same_bytes() {
    let (folder, other) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let (case, file) = (case(folder.path()), folder.path().join("brake.prepared"));
    let out = |name: &str| folder.path().join(name);
    run(&case, &out("without"), &["--no-cache"]);
    assert!(!out(".squeal").exists());

    let (cea, words) = said(&asked("cea", &case, &[]));
    assert!(words.contains(" made and kept in ") && words.ends_with(".squeal"), "{words}");
    let prepare = |options: &[&str]| said(&asked("prepare", &case, options)).0;
    let words = prepare(&["--out", file.to_str().unwrap()]);
    assert!(words.contains(" pieces read from ") && words.contains("brake.prepared: written, "), "{words}");

    // All commands find all of it: none says that it made a piece.
    let (again, words) = said(&asked("cea", &case, &[]));
    assert_eq!(again, cea);
    assert!(words.contains(" pieces read from ") && !words.contains("made"), "{words}");
    for command in ["influence", "check", "cea"] {
        let (_, words) = said(&asked(command, &case, &["--no-cache", "--prepared", file.to_str().unwrap()]));
        assert!(words.contains("brake.prepared") && !words.contains("made"), "{command}: {words}");
    }
    // Modes of the whole brake, and of the reduced one where their shapes are asked for.
    let [whole, reduced] = [&["--json"][..], &["--json", "--modes"]].map(|options| {
        let found: serde_json::Value = serde_json::from_slice(&asked("cea", &case, options).stdout).unwrap();
        let number = |mode: &serde_json::Value, key: &str| mode[key].as_f64().unwrap();
        let of = |mode: &serde_json::Value| ["re", "im", "residual"].map(|key| number(mode, key));
        found["modes"].as_array().unwrap().iter().map(of).collect::<Vec<_>>()
    });
    assert!(whole.len() == reduced.len() && whole.len() > 1, "{whole:?} {reduced:?}");
    for ([re, im, residual], [of_reduced, frequency, larger]) in whole.into_iter().zip(reduced) {
        assert!((re - of_reduced).hypot(im - frequency) < 1e-6 * im, "{re} {im} {of_reduced} {frequency}");
        assert!(residual < 1e-14 && residual < larger, "{residual:e} {larger:e}");
    }
    run(&case, &out("cached"), &[]);
    run(&case, &out("given"), &["--no-cache", "--prepared", file.to_str().unwrap()]);
    let without = results(&out("without"));
    assert_same(&without, &results(&out("cached")));
    assert_same(&without, &results(&out("given")));

    // A file of another brake, and one for what needs none, in one line.
    let changed = ["--prepared", file.to_str().unwrap(), "--set", "mu=0.3"];
    let refused = asked("cea", &case, &changed);
    refusal(&refused, &["brake.prepared: holds the study \"Disc and pad\" with other contact; allowed: "]);
    refusal(&asked("cea", &hoffmann(), &changed[..2]), &["--prepared = ", "allowed: with cases of finite elements"]);
    refusal(&asked("prepare", &hoffmann(), &[]), &["CASE = ", "allowed: with cases of finite elements"]);
    let bytes = std::fs::read(&file).unwrap();
    std::fs::write(&file, &bytes[..bytes.len() - 1]).unwrap();
    refusal(
        &asked("run", &case, &["--prepared", file.to_str().unwrap(), "--out", "none"]),
        &["damaged", "bytes follow"],
    );

    // Where nothing can be written the command goes on, and says so once.
    let place = other.path().join("brake.toml");
    std::fs::copy(&case, &place).unwrap();
    for name in ["disc-pad.inp", "disc-pad.mas.gz", "disc-pad.sti.gz", "disc-pad.dof.gz"] {
        std::fs::copy(folder.path().join(name), other.path().join(name)).unwrap();
    }
    std::fs::write(other.path().join(".squeal"), "a file").unwrap();
    let (again, words) = said(&squeal().args(["cea", place.to_str().unwrap()]).output().unwrap());
    assert_eq!(again, cea);
    assert!(words.contains(" made, which cannot be kept in "), "{words}");
}
