//! A run killed with SIGKILL, and the run that continues it.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::common::{Counts, WALK, Walk, bytes, checkpoint, sampling, walk};
use montecarlo::run_with;

const FOLDER: &str = "MONTECARLO_KILL_TEST_FOLDER";
const SAMPLES: u64 = 2_000;

/// Not a test: the run of the process that is killed. At a millisecond per evaluation it would take three seconds.
#[test]
#[ignore = "run by the test below"]
fn victim() {
    let folder = std::env::var(FOLDER).unwrap();
    let experiment = Walk { pause: Duration::from_millis(1), ..WALK };
    run_with(&experiment, &sampling(SAMPLES, 2), Counts::default, Some(&checkpoint(Path::new(&folder))), &()).unwrap();
}

/// Number of samples in the checkpoint.
fn samples_done(path: &Path) -> u64 {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let state = text.lines().nth(2).unwrap_or("{}");
    let state: serde_json::Value = serde_json::from_str(state).unwrap();
    state["samples"].as_u64().unwrap_or(0)
}

#[test]
fn a_killed_run_resumes_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let checkpoint = checkpoint(folder.path());
    let mut done = 0;
    for _ in 0..3 {
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "kill::victim", "--ignored"])
            .env(FOLDER, folder.path())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        while samples_done(&checkpoint.path) < done + 50 {
            assert!(child.try_wait().unwrap().is_none(), "it ended before it could be killed");
            std::thread::sleep(Duration::from_millis(1));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let reached = samples_done(&checkpoint.path);
        assert!(reached >= done + 50);
        done = reached;
    }
    assert!(done < SAMPLES);
    let resumed = walk(&sampling(SAMPLES, 2), Some(&checkpoint)).unwrap();
    assert_eq!(bytes(&resumed), bytes(&walk(&sampling(SAMPLES, 1), None).unwrap()));
}
