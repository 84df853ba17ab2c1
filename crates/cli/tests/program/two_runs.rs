//! Two runs, one folder.

use std::path::Path;
use std::process::Child;
use std::time::Duration;

use crate::common::{SMALL, assert_same, refusal, replaced, results, run, squeal};

/// A case of one scene.
fn one_scene(folder: &Path) -> std::path::PathBuf {
    let case = folder.join("brake.toml");
    let text = replaced(SMALL, r#"["amontons-coulomb", "velocity-dependent", "lugre"]"#, r#"["amontons-coulomb"]"#);
    std::fs::write(&case, replaced(&text, "in_contact = [2, 1]", "in_contact = [2]")).unwrap();
    case
}

/// A run that has begun and is not near its end.
fn begun(case: &Path, out: &Path, options: &[&str]) -> Child {
    let mut child = squeal()
        .arg("run")
        .arg(case)
        .arg("--out")
        .arg(out)
        .args(["--samples", "100000000"])
        .args(options)
        .spawn()
        .unwrap();
    while !out.join("checkpoint.json").exists() {
        assert!(child.try_wait().unwrap().is_none(), "ended at once");
        std::thread::sleep(Duration::from_millis(2));
    }
    child
}

#[test]
fn the_second_of_two_is_told_who_is_first() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = (one_scene(folder.path()), folder.path().join("out"));
    let mut first = begun(&case, &out, &[]);
    for seed in ["7", "8"] {
        let second = squeal().arg("run").arg(&case).arg("--out").arg(&out).args(["--seed", seed]).output().unwrap();
        // That of another study is told so before.
        let expected = if seed == "7" {
            format!("another run (process {}, started a second ago) is writing there", first.id())
        } else {
            "seed 7, not seed 8".into()
        };
        let line = refusal(&second, &["out"]);
        assert!(line.contains(&expected) || line.contains(" s ago) is writing there"), "{line}");
    }
    // However the first ends, its lock ends with it.
    first.kill().unwrap();
    first.wait().unwrap();
    std::fs::remove_dir_all(&out).unwrap();
    run(&case, &out, &[]);
}

#[test]
fn a_folder_made_anew_belongs_to_the_new_run_alone() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out, clean) = (one_scene(folder.path()), folder.path().join("out"), folder.path().join("clean"));
    run(&case, &clean, &["--seed", "8"]);
    let old = begun(&case, &out, &[]);
    std::fs::remove_dir_all(&out).unwrap();
    run(&case, &out, &["--seed", "8"]);
    // The old one finds the checkpoint of the other at its next own, after five seconds.
    refusal(&old.wait_with_output().unwrap(), &["checkpoint", "belongs to another run", "seed=8"]);
    assert_same(&results(&clean), &results(&out));
}

/// CRC-32 as checkpoints have it.
fn checksum(bytes: &[u8]) -> u32 {
    let of_bit = |crc: u32| if crc & 1 == 1 { 0xEDB8_8320 ^ (crc >> 1) } else { crc >> 1 };
    !bytes.iter().fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| of_bit(crc)))
}

#[test]
fn a_forged_checkpoint_with_a_right_checksum_is_not_continued() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = (one_scene(folder.path()), folder.path().join("out"));
    run(&case, &out, &[]);
    let path = out.join("checkpoint.json");
    let whole = std::fs::read_to_string(&path).unwrap();
    let [header, identity, state] = whole.lines().collect::<Vec<_>>()[..] else { panic!("{whole}") };
    assert!(header.ends_with(&format!("{:08x}", checksum(format!("{identity}\n{state}\n").as_bytes()))), "{header}");
    for (from, to, part) in [
        ("\"seed\":7", "\"seed\":8", "its seed"),
        ("\"first\":0", "\"first\":8", "its first sample"),
        ("\"samples\":40", "\"samples\":32", "its tally"),
        ("\"solved\":40", "\"solved\":39", "its tally"),
        ("\"draws\":0", "\"draws\":41", "its failures"),
    ] {
        let body = format!("{identity}\n{}\n", replaced(state, from, to));
        let forged = format!("montecarlo-checkpoint 2 {} {:08x}\n{body}", body.len(), checksum(body.as_bytes()));
        std::fs::write(&path, forged).unwrap();
        let output = squeal().arg("run").arg(&case).arg("--out").arg(&out).args(["--samples", "48"]).output().unwrap();
        refusal(&output, &["checkpoint.json is damaged", part, "cannot be that of the run that it names"]);
    }
}
