//! Folders for results that are not this study's, not whole, full or closed.

use std::path::{Path, PathBuf};
use std::process::Output;

use tempfile::TempDir;

use crate::common::{SMALL, assert_same, refusal, replaced, results, run, squeal};

struct Place {
    folder: TempDir,
}

impl Place {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("brake.toml"), SMALL).unwrap();
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn attempt(&self, out: &Path, options: &[&str]) -> Output {
        squeal().arg("run").arg(self.path("brake.toml")).arg("--out").arg(out).args(options).output().unwrap()
    }
}

#[test]
fn a_folder_of_another_study_stays_as_it_is() {
    let place = Place::new();
    let out = place.path("out");
    run(&place.path("brake.toml"), &out, &[]);
    let before = results(&out);
    refusal(&place.attempt(&out, &["--seed", "8"]), &["out", "seed 7", "not", "seed 8", "allowed"]);
    refusal(&place.attempt(&out, &["--samples", "39"]), &["out", "40 samples", "samples = 39", "allowed: 40 or more"]);
    std::fs::write(place.path("brake.toml"), replaced(SMALL, "mean = 0.60", "mean = 0.61")).unwrap();
    refusal(&place.attempt(&out, &[]), &["out", "two oscillators", "allowed"]);
    assert_same(&before, &results(&out));
}

#[test]
fn a_folder_in_use_is_left_to_its_run() {
    let place = Place::new();
    let out = place.path("out");
    run(&place.path("brake.toml"), &out, &[]);
    let before = results(&out);
    let other = std::fs::File::open(out.join("run.lock")).unwrap();
    other.try_lock().unwrap();
    refusal(&place.attempt(&out, &["--samples", "48"]), &["out", "another run (process ", "allowed: another folder"]);
    assert_same(&before, &results(&out));
    // The lock ends with the one who holds it, whatever is left in the folder.
    drop(other);
    run(&place.path("brake.toml"), &out, &["--samples", "48"]);
}

#[test]
fn a_folder_with_other_files_stays_as_it_is() {
    let place = Place::new();
    let out = place.path("out");
    std::fs::create_dir(&out).unwrap();
    std::fs::write(out.join("thesis.tex"), "years of work").unwrap();
    refusal(&place.attempt(&out, &[]), &["out", "other files", "allowed: a new or empty folder"]);
    assert_eq!(results(&out).into_keys().collect::<Vec<_>>(), ["thesis.tex"]);
}

#[test]
fn a_file_in_place_of_the_folder() {
    let place = Place::new();
    let file = place.path("brake.toml");
    refusal(&place.attempt(&file, &[]), &["brake.toml", "directory"]);
    refusal(&place.attempt(&file.join("deeper"), &[]), &["brake.toml/deeper", "directory"]);
    assert_eq!(std::fs::read_to_string(&file).unwrap(), SMALL);
}

#[test]
fn a_checkpoint_cut_or_altered_anywhere_is_not_continued() {
    let place = Place::new();
    let out = place.path("out");
    run(&place.path("brake.toml"), &out, &[]);
    let checkpoint = out.join("checkpoint.json");
    let whole = std::fs::read(&checkpoint).unwrap();
    let tables = results(&out);
    let damaged = |bytes: &[u8]| {
        std::fs::write(&checkpoint, bytes).unwrap();
        refusal(&place.attempt(&out, &[]), &["checkpoint", "checkpoint.json", "damaged", "delete it to start"]);
        assert_eq!(std::fs::read(&checkpoint).unwrap(), bytes, "what is left may still be of use");
    };
    for length in [0, 1, 10, 40, 100, whole.len() / 2, whole.len() - 1] {
        damaged(&whole[..length]);
    }
    for place in [0, 30, whole.len() / 3, whole.len() - 2] {
        let mut bytes = whole.clone();
        bytes[place] ^= 1;
        damaged(&bytes);
    }
    damaged(&[whole.as_slice(), b"more"].concat());

    std::fs::remove_file(&checkpoint).unwrap();
    run(&place.path("brake.toml"), &out, &[]);
    assert_same(&tables, &results(&out));
}

#[test]
fn estimates_cut_or_altered_anywhere_are_not_continued() {
    let place = Place::new();
    let (out, options) = (place.path("out"), ["--half-width", "0.1"]);
    run(&place.path("brake.toml"), &out, &options);
    let estimates = out.join("estimates.json");
    let whole = std::fs::read(&estimates).unwrap();
    let tables = results(&out);
    let line = whole.iter().position(|&byte| byte == b'\n').unwrap();
    let digits: Vec<usize> = (line..whole.len()).filter(|&at| whole[at].is_ascii_digit()).collect();
    let altered = |at: usize, byte: u8| {
        let mut bytes = whole.clone();
        bytes[at] = byte;
        bytes
    };
    // One of each kind, as each is a run: the seal is that of the checkpoint, which is cut and altered in more places above.
    let mut damaged: Vec<Vec<u8>> = [0, whole.len() / 2].map(|length| whole[..length].to_vec()).to_vec();
    damaged.extend([line / 2, line + 1].map(|at| altered(at, whole[at] ^ 1)));
    damaged.extend([digits[digits.len() / 2]].map(|at| altered(at, b'0' + (whole[at] - b'0' + 1) % 10)));
    damaged.push([&whole[..], b" "].concat());
    // What an older program wrote: the same without a first line.
    damaged.push(whole[line + 1..].to_vec());
    for bytes in damaged {
        std::fs::write(&estimates, &bytes).unwrap();
        refusal(&place.attempt(&out, &options), &["estimates.json", "damaged", "delete them to estimate anew"]);
        assert_eq!(std::fs::read(&estimates).unwrap(), bytes, "what is left may still be of use");
    }
    std::fs::remove_file(&estimates).unwrap();
    run(&place.path("brake.toml"), &out, &options);
    assert_same(&tables, &results(&out));
}

/// The soft limit on the size of a file, in the shell's 512-byte or 1024-byte units, stands for a full disk; the signal
/// that goes with it is ignored, so that writing fails as it does there.
#[cfg(unix)]
#[test]
fn a_limit_on_file_size_leaves_no_half_written_file() {
    let place = Place::new();
    let whole = place.path("whole");
    run(&place.path("brake.toml"), &whole, &[]);
    let whole = results(&whole);
    let mut refused = 0;
    for blocks in [0, 2, 16] {
        let out = place.path(&format!("out-{blocks}"));
        let script = r#"trap "" XFSZ; ulimit -f "$1"; exec "$2" run "$3" --out "$4""#;
        let output = std::process::Command::new("sh")
            .args(["-c", script, "sh", &blocks.to_string(), env!("CARGO_BIN_EXE_squeal")])
            .args([&place.path("brake.toml"), &out])
            .output()
            .unwrap();
        if output.status.success() {
            continue;
        }
        refused += 1;
        let line = refusal(&output, &["writ", "too large"]);
        assert!(line.contains(out.to_str().unwrap()), "the file is not named: {line}");
        // Whatever was written is whole.
        for (name, bytes) in results(&out) {
            assert!(bytes == whole[&name] || name == "checkpoint.json", "{name} is half-written");
        }
        run(&place.path("brake.toml"), &out, &[]);
        assert_same(&whole, &results(&out));
    }
    assert!(refused >= 2, "the limit was never felt");
}

/// Names under which the program writes for a moment, as links to a file of somebody else.
#[cfg(unix)]
#[test]
fn links_in_place_of_its_own_files_are_not_written_through() {
    let place = Place::new();
    let (out, thesis) = (place.path("out"), place.path("thesis.tex"));
    run(&place.path("brake.toml"), &out, &[]);
    let (before, years_of_work) = (results(&out), "years of work");
    std::fs::write(&thesis, years_of_work).unwrap();
    for name in ["checkpoint.json.partial", "results.partial", "run.lock"] {
        let _ = std::fs::remove_file(out.join(name));
        std::os::unix::fs::symlink(&thesis, out.join(name)).unwrap();
        let output = place.attempt(&out, &[]);
        if !output.status.success() {
            refusal(&output, &[name, "cannot be written"]);
        }
        assert_eq!(std::fs::read_to_string(&thesis).unwrap(), years_of_work, "{name}");
        let _ = std::fs::remove_file(out.join(name));
    }
    run(&place.path("brake.toml"), &out, &[]);
    assert_same(&before, &results(&out));
}

/// Root may write anywhere but here.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_cannot_be_made() {
    let place = Place::new();
    refusal(&place.attempt(Path::new("/proc/squeal/out"), &[]), &["/proc/squeal/out", "cannot be written"]);
}
