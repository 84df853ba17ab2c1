//! Shards of a study, sampled anywhere and in any order, killed and repeated, are the study.

use std::path::{Path, PathBuf};
use std::process::Output;
use std::time::Duration;

use crate::common::{SMALL, assert_same, replaced, results, run, squeal};

fn shard(case: &Path, of: &str, out: &Path, more: &[&str]) -> Output {
    squeal().arg("run").arg(case).args(["--shard", of]).args(more).arg("--out").arg(out).output().unwrap()
}

fn merge(case: &Path, parts: &[PathBuf], out: &Path) -> Output {
    squeal().arg("merge").arg(case).args(parts).arg("--out").arg(out).output().unwrap()
}

fn said(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stdout));
    String::from_utf8(output.stderr.clone()).unwrap().lines().last().unwrap_or_default().to_owned()
}

#[test]
fn shards_in_any_order_are_the_study_byte_for_byte() {
    let folder = tempfile::tempdir().unwrap();
    let hoffmann = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/hoffmann.toml");
    let lattice = folder.path().join("brake.toml");
    std::fs::write(&lattice, SMALL).unwrap();
    for (name, case, more) in [
        ("lattice", &lattice, &["--samples", "21"][..]),
        ("hoffmann", &hoffmann, &["--samples", "500", "--seed", "9", "--keep-samples"]),
    ] {
        let whole = folder.path().join(format!("{name}-whole"));
        run(case, &whole, more);
        let whole = results(&whole);
        for shards in [1_u64, 3, 7] {
            let place = |number: u64| folder.path().join(format!("{name}-{shards}-{number}"));
            // From the last to the first, each twice: the second time it is complete already.
            let parts: Vec<PathBuf> = (1..=shards).rev().map(place).collect();
            for (part, number) in parts.iter().zip((1..=shards).rev()) {
                for _ in 0..2 {
                    let output = shard(case, &format!("{number}/{shards}"), part, more);
                    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
                }
            }
            let merged = folder.path().join(format!("{name}-{shards}"));
            let twice = [&parts[..], &parts[..1]].concat();
            let output = merge(case, &twice, &merged);
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            assert_same(&whole, &results(&merged));
        }
    }
}

#[test]
fn a_killed_shard_goes_on_and_a_study_is_extended_by_shards() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, replaced(SMALL, "samples = 40", "samples = 4000")).unwrap();
    let [whole, first, second, merged] = ["whole", "first", "second", "merged"].map(|name| folder.path().join(name));
    let mut killed = squeal().arg("run").arg(&case).args(["--shard", "1/2"]).arg("--out").arg(&first).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(1500));
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert!(shard(&case, "2/2", &second, &[]).status.success());
    if !first.join("shard.json").exists() {
        let refused = said(&merge(&case, &[first.clone(), second.clone()], &merged));
        assert!(refused.contains("first: ") && refused.contains("complete parts"), "{refused}");
    }
    assert!(shard(&case, "1/2", &first, &[]).status.success());
    assert!(merge(&case, &[second, first.clone()], &merged).status.success());
    run(&case, &whole, &[]);
    assert_same(&results(&whole), &results(&merged));

    let [short, third, fourth, longer, at_once] =
        ["short", "third", "fourth", "longer", "at once"].map(|name| folder.path().join(name));
    assert!(shard(&case, "1/1", &short, &["--samples", "21"]).status.success());
    for (of, part) in [("1/2", &third), ("2/2", &fourth)] {
        assert!(shard(&case, of, part, &["--samples", "60", "--from", "21"]).status.success());
    }
    assert!(merge(&case, &[short.clone(), third, fourth], &longer).status.success());
    let refused = said(&merge(&case, &[short], &longer));
    assert!(refused.contains("holds 60 samples already"), "{refused}");
    run(&case, &at_once, &["--samples", "60"]);
    assert_same(&results(&at_once), &results(&longer));
}

#[test]
fn what_does_not_belong_together_is_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, SMALL).unwrap();
    let place = |name: &str| folder.path().join(name);
    for (of, name, more) in [
        ("1/3", "one", &[][..]),
        ("2/3", "two", &[]),
        ("3/3", "three", &[]),
        ("2/3", "other seed", &["--seed", "77"]),
        ("1/2", "half", &[]),
    ] {
        assert!(shard(&case, of, &place(name), more).status.success());
    }
    let merged = place("merged");
    let refused =
        |parts: &[&str]| said(&merge(&case, &parts.iter().map(|name| place(name)).collect::<Vec<_>>(), &merged));
    let missing = refused(&["one", "three"]);
    assert!(missing.contains("no part has the samples 13..26 (shard 2/3); allowed"), "{missing}");
    let missing = refused(&["two"]);
    assert!(missing.contains("0..13 (shard 1/3), 26..40 (shard 3/3)"), "{missing}");
    // The same without merging, with a line for each part.
    let say = |parts: &[&str]| {
        let output = squeal()
            .arg("merge")
            .arg(&case)
            .args(parts.iter().map(|name| place(name)))
            .arg("--check")
            .output()
            .unwrap();
        (output.status.code(), String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    let (code, listed, missing) = say(&["one", "three", "nothing"]);
    assert!(code == Some(2) && listed.contains("samples 0..13 of 40, shard 1/3, complete"), "{listed}");
    assert!(listed.contains("nothing: is no part of a study") && missing.contains("(shard 2/3)"), "{listed}{missing}");
    let (code, listed, refused_part) = say(&["one", "two", "three", "nothing"]);
    assert!(
        code == Some(2) && refused_part.contains("is no part of a study") && !listed.contains("all samples"),
        "{listed}"
    );
    let (code, listed, _) = say(&["one", "two", "three"]);
    assert!(code == Some(0) && listed.ends_with("all samples are there\n"), "{listed}");
    let (code, _, other) = say(&["one", "other seed", "three"]);
    assert!(code == Some(2) && other.contains("other seed") && other.contains("seed 77"), "{other}");
    let (code, _, twice) = say(&["one", "half", "two", "three"]);
    assert!(code == Some(2) && twice.contains("both have the samples 0.."), "{twice}");
    let twice = refused(&["one", "half", "two", "three"]);
    assert!(twice.contains("both have the samples 0.."), "{twice}");
    let other = refused(&["one", "other seed", "three"]);
    assert!(other.contains("other seed") && other.contains("seed 77"), "{other}");
    let none = refused(&["nothing"]);
    assert!(none.contains("nothing: is no part of a study; allowed: complete parts"), "{none}");
    // A processor that rounds otherwise.
    let file = place("two").join("shard.json");
    let text = std::fs::read_to_string(&file).unwrap();
    let at = text.find("\"rounding\": \"").unwrap() + 13;
    std::fs::write(&file, format!("{}of a toaster, {}", &text[..at], &text[at..])).unwrap();
    let rounded = refused(&["one", "two", "three"]);
    assert!(rounded.contains("was sampled on of a toaster"), "{rounded}");
    let (code, _, rounded) = say(&["one", "two", "three"]);
    assert!(code == Some(2) && rounded.contains("was sampled on of a toaster"), "{rounded}");
    // Nothing was begun: there is no folder, and none that a run has locked.
    assert!(!merged.exists());
    let mut mixed = squeal();
    mixed.arg("merge").arg(&case).args(["one", "two", "three"].map(place)).arg("--mixed").arg("--out").arg(&merged);
    assert!(mixed.output().unwrap().status.success());
    // A part that another program began, or another processor, is not gone on with; where it is complete there is nothing to do.
    let marker = place("half").join("study.txt");
    let text = std::fs::read_to_string(&marker).unwrap();
    std::fs::write(&marker, text.replace("made=", "made=0.0.1/")).unwrap();
    assert!(shard(&case, "1/2", &place("half"), &[]).status.success());
    std::fs::remove_file(place("half").join("shard.json")).unwrap();
    let incomplete = refused(&["half"]);
    assert!(
        incomplete.contains("squeal run CASE --shard 1/2 --out ") && incomplete.contains("goes on"),
        "{incomplete}"
    );
    let begun = said(&shard(&case, "1/2", &place("half"), &[]));
    assert!(begun.contains("half") && begun.contains("made"), "{begun}");
    // The folder of a part is not that of the study, nor of another part.
    for more in [&[][..], &["--shard", "1/3"]] {
        let output = squeal().arg("run").arg(&case).args(more).arg("--out").arg(place("two")).output().unwrap();
        assert!(said(&output).contains("allowed: a new or empty folder"), "{more:?}");
    }
    let check = squeal().arg("check").arg(&case).args(["--shards", "0"]).output().unwrap();
    assert_eq!(check.status.code(), Some(2));
    let refused = String::from_utf8(check.stderr).unwrap();
    assert!(refused.contains("--shards") && refused.contains("1 to "), "{refused}");
    let refused = said(&shard(&case, "41/41", &place("none"), &[]));
    assert!(refused.contains("--shard = 41/41; allowed: 1/N to N/N, N at most 40"), "{refused}");
}

/// A complete part that lost its samples, or whose manifest was cut, is none: the same command makes it again.
#[test]
fn a_damaged_part_is_made_again() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, SMALL).unwrap();
    let part = folder.path().join("part");
    assert!(shard(&case, "2/3", &part, &[]).status.success());
    let kept = |name: &str| std::fs::read(part.join(name)).unwrap();
    let whole = kept("checkpoint.json");
    let cut = |name: &str, length: usize| std::fs::write(part.join(name), &kept(name)[..length]).unwrap();
    std::fs::remove_file(part.join("checkpoint.json")).unwrap();
    assert!(shard(&case, "2/3", &part, &[]).status.success());
    assert_eq!(kept("checkpoint.json"), whole);
    cut("shard.json", 20);
    assert!(shard(&case, "2/3", &part, &[]).status.success());
    assert!(serde_json::from_slice::<serde_json::Value>(&kept("shard.json")).is_ok());
    cut("checkpoint.json", 100);
    let refused = said(&shard(&case, "2/3", &part, &[]));
    assert!(refused.contains("checkpoint.json") && refused.contains("delete it"), "{refused}");
    std::fs::remove_file(part.join("checkpoint.json")).unwrap();
    assert!(shard(&case, "2/3", &part, &[]).status.success());
    assert_eq!(kept("checkpoint.json"), whole);
}
