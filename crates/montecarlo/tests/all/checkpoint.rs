//! Checkpoints that are continued, and checkpoints that are refused.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::Duration;

use crate::common::{Counts, WALK, Walk, bytes, checkpoint, sampling, walk};
use montecarlo::{Checkpoint, Damage, Merge, MonteCarloError, Progress, Runs, Sampling, Tally, run_with};
use serde::{Deserialize, Serialize};

#[test]
fn a_broken_off_run_resumes_to_the_same_bytes() {
    let uninterrupted = bytes(&walk(&sampling(150, 1), None).unwrap());
    for (panics_at, threads) in [(0, 1), (7, 2), (70, 1), (71, 2), (149, 2)] {
        let folder = tempfile::tempdir().unwrap();
        let checkpoint = checkpoint(folder.path());
        let experiment = Walk { panics_at: Some(panics_at), ..WALK };
        let broken = || run_with(&experiment, &sampling(150, threads), Counts::default, Some(&checkpoint), &());
        assert!(catch_unwind(AssertUnwindSafe(broken)).is_err());
        let resumed = walk(&sampling(150, 3 - threads), Some(&checkpoint)).unwrap();
        assert_eq!(bytes(&resumed), uninterrupted, "broken off at {panics_at}");
    }
}

#[test]
fn a_complete_checkpoint_gives_its_result_without_evaluating() {
    let folder = tempfile::tempdir().unwrap();
    let checkpoint = Checkpoint { every: Duration::from_secs(3600), ..checkpoint(folder.path()) };
    let first = walk(&sampling(50, 1), Some(&checkpoint)).unwrap();
    let experiment = Walk { panics_at: Some(0), ..WALK };
    let second = run_with(&experiment, &sampling(50, 1), Counts::default, Some(&checkpoint), &()).unwrap();
    assert_eq!(bytes(&first), bytes(&second));
    let left: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, ["run.checkpoint"]);
}

#[test]
fn an_extended_run_has_the_bytes_of_a_run_at_once() {
    for sizes in [[1, 2, 150], [7, 8, 9], [8, 64, 100], [41, 97, 333]] {
        let folder = tempfile::tempdir().unwrap();
        let checkpoint = checkpoint(folder.path());
        for (samples, block) in sizes.into_iter().zip([8, 3, 32]) {
            let extended = walk(&Sampling { block, ..sampling(samples, 2) }, Some(&checkpoint)).unwrap();
            assert_eq!(bytes(&extended), bytes(&walk(&sampling(samples, 1), None).unwrap()), "{samples} of {sizes:?}");
        }
        let at_once = tempfile::tempdir().unwrap();
        walk(&sampling(sizes[2], 1), Some(&crate::common::checkpoint(at_once.path()))).unwrap();
        let file = |folder: &std::path::Path| fs::read(folder.join("run.checkpoint")).unwrap();
        assert_eq!(file(folder.path()), file(at_once.path()));
    }
}

#[test]
fn an_extension_that_breaks_off_is_continued_to_any_size_not_below_it() {
    let folder = tempfile::tempdir().unwrap();
    let checkpoint = checkpoint(folder.path());
    walk(&sampling(40, 1), Some(&checkpoint)).unwrap();
    let experiment = Walk { panics_at: Some(90), ..WALK };
    let broken = || run_with(&experiment, &sampling(200, 1), Counts::default, Some(&checkpoint), &());
    assert!(catch_unwind(AssertUnwindSafe(broken)).is_err());
    let before = fs::read(&checkpoint.path).unwrap();
    let error = walk(&sampling(40, 1), Some(&checkpoint)).unwrap_err();
    let MonteCarloError::CheckpointLonger { found: 41..=90, wanted: 40, .. } = error else { panic!("{error}") };
    assert_eq!(fs::read(&checkpoint.path).unwrap(), before);
    let resumed = walk(&sampling(120, 2), Some(&checkpoint)).unwrap();
    assert_eq!(bytes(&resumed), bytes(&walk(&sampling(120, 1), None).unwrap()));
}

#[test]
fn a_file_truncated_anywhere_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let checkpoint = checkpoint(folder.path());
    walk(&sampling(10, 1), Some(&checkpoint)).unwrap();
    let whole = fs::read(&checkpoint.path).unwrap();
    for length in 0..whole.len() {
        fs::write(&checkpoint.path, &whole[..length]).unwrap();
        let refused = walk(&sampling(10, 1), Some(&checkpoint));
        assert!(matches!(refused, Err(MonteCarloError::CheckpointDamaged { .. })), "{length} bytes: {refused:?}");
    }
    fs::write(&checkpoint.path, &whole).unwrap();
    assert!(walk(&sampling(10, 1), Some(&checkpoint)).is_ok());
}

#[test]
fn a_file_with_any_byte_altered_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let checkpoint = checkpoint(folder.path());
    walk(&sampling(10, 1), Some(&checkpoint)).unwrap();
    let whole = fs::read(&checkpoint.path).unwrap();
    for at in 0..whole.len() {
        let mut altered = whole.clone();
        altered[at] ^= 1;
        fs::write(&checkpoint.path, &altered).unwrap();
        let refused = walk(&sampling(10, 1), Some(&checkpoint));
        assert!(matches!(refused, Err(MonteCarloError::CheckpointDamaged { .. })), "byte {at}: {refused:?}");
    }
}

#[test]
fn a_damaged_file_is_named_with_the_damage_and_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let checkpoint = checkpoint(folder.path());
    walk(&sampling(10, 1), Some(&checkpoint)).unwrap();
    let whole = fs::read_to_string(&checkpoint.path).unwrap();
    let body = whole.split_once('\n').unwrap().1.len();

    let damage = |content: &str| {
        fs::write(&checkpoint.path, content).unwrap();
        walk(&sampling(10, 1), Some(&checkpoint)).unwrap_err()
    };
    assert_eq!(
        damage(&whole[..whole.len() - 5]).to_string(),
        format!(
            "checkpoint {} is damaged: {} bytes follow its header, which announces {body}; \
             put back an intact copy, or delete it to start from the first sample",
            checkpoint.path.display(),
            body - 5
        )
    );
    let kind = |content: &str| match damage(content) {
        MonteCarloError::CheckpointDamaged { damage, .. } => damage,
        other => panic!("{other}"),
    };
    assert!(matches!(kind("something else\n"), Damage::Header));
    assert!(matches!(kind(&(whole.clone() + "\n")), Damage::Length { .. }));
    assert!(matches!(kind(&whole.replace("seed\":2026", "seed\":2027")), Damage::Checksum { .. }));
    let newer = whole.replacen("checkpoint 2 ", "checkpoint 3 ", 1);
    assert!(matches!(kind(&newer), Damage::Version { found: 3, expected: 2 }));
}

#[test]
fn a_checkpoint_of_another_run_is_refused_by_field() {
    let folder = tempfile::tempdir().unwrap();
    let written = checkpoint(folder.path());
    walk(&sampling(10, 1), Some(&written)).unwrap();
    let before = fs::read(&written.path).unwrap();

    let this = sampling(10, 1);
    let other_experiment = Checkpoint { fingerprint: "walk 2".to_string(), ..written.clone() };
    for (sampling, checkpoint, difference) in [
        (this.clone(), &other_experiment, "experiment is walk 1, here it is walk 2"),
        (Sampling { seed: 1, ..this.clone() }, &written, "seed is 2026, here it is 1"),
        (Sampling { first: 3, ..this.clone() }, &written, "first sample is 0, here it is 3"),
    ] {
        let error = walk(&sampling, Some(checkpoint)).unwrap_err();
        assert!(matches!(error, MonteCarloError::CheckpointMismatch { .. }));
        let expected = format!("checkpoint {} belongs to another run: its {difference}; ", written.path.display());
        assert!(error.to_string().starts_with(&expected), "{error}");
    }
    assert_eq!(fs::read(&written.path).unwrap(), before);
}

#[test]
fn a_folder_that_cannot_be_written_is_found_before_the_first_draw() {
    let folder = tempfile::tempdir().unwrap();
    let missing = checkpoint(&folder.path().join("missing"));
    let experiment = Walk { panics_at: Some(0), ..WALK };
    let error = run_with(&experiment, &sampling(10, 1), Counts::default, Some(&missing), &()).unwrap_err();
    let MonteCarloError::CheckpointIo { action: "write", path, source } = error else { panic!("{error}") };
    assert!(path.starts_with(folder.path().join("missing")));
    assert_eq!(source.kind(), std::io::ErrorKind::NotFound);
}

#[test]
fn a_checkpoint_that_cannot_be_written_is_an_error_and_leaves_the_previous_one() {
    let folder = tempfile::tempdir().unwrap();
    let checkpoint = checkpoint(folder.path());
    let experiment = Walk { panics_at: Some(40), ..WALK };
    let broken = || run_with(&experiment, &sampling(80, 1), Counts::default, Some(&checkpoint), &());
    assert!(catch_unwind(AssertUnwindSafe(broken)).is_err());
    let before = fs::read(&checkpoint.path).unwrap();

    let partial = folder.path().join("run.checkpoint.partial");
    fs::create_dir(&partial).unwrap();
    let error = walk(&sampling(80, 1), Some(&checkpoint)).unwrap_err();
    let MonteCarloError::CheckpointIo { action: "write", path, .. } = error else { panic!("{error}") };
    assert_eq!(path, partial);
    assert_eq!(fs::read(&checkpoint.path).unwrap(), before);

    fs::remove_dir(&partial).unwrap();
    let resumed = walk(&sampling(80, 1), Some(&checkpoint)).unwrap();
    assert_eq!(bytes(&resumed), bytes(&walk(&sampling(80, 1), None).unwrap()));
}

#[cfg(unix)]
#[test]
fn a_link_in_place_of_the_partial_file_is_not_followed() {
    let folder = tempfile::tempdir().unwrap();
    let (checkpoint, elsewhere) = (checkpoint(folder.path()), folder.path().join("thesis.tex"));
    fs::write(&elsewhere, "years of work").unwrap();
    std::os::unix::fs::symlink(&elsewhere, folder.path().join("run.checkpoint.partial")).unwrap();
    walk(&sampling(10, 1), Some(&checkpoint)).unwrap();
    assert_eq!(fs::read_to_string(&elsewhere).unwrap(), "years of work");
    assert!(fs::symlink_metadata(&checkpoint.path).unwrap().is_file());
}

/// Puts one file in place of another when the run has begun, after its first checkpoint.
struct Replaces<'a> {
    from: &'a Path,
    to: &'a Path,
}
impl Progress for Replaces<'_> {
    fn begin(&self, _: u64, _: u64) {
        fs::copy(self.from, self.to).unwrap();
    }
    fn advance(&self, _: u64) {}
    fn end(&self) {}
}

#[test]
fn the_checkpoint_of_another_run_that_came_meanwhile_is_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let this = checkpoint(folder.path());
    let other = Checkpoint { path: folder.path().join("other"), ..this.clone() };
    walk(&Sampling { seed: 7, ..sampling(10, 1) }, Some(&other)).unwrap();
    let replaces = Replaces { from: &other.path, to: &this.path };
    let error = run_with(&WALK, &sampling(80, 1), Counts::default, Some(&this), &replaces).unwrap_err();
    assert!(matches!(error, MonteCarloError::CheckpointMismatch { field: "seed", .. }), "{error}");
    assert_eq!(fs::read(&this.path).unwrap(), fs::read(&other.path).unwrap());
}

#[test]
fn a_state_that_is_not_of_its_identity_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let checkpoint = checkpoint(folder.path());
    walk(&sampling(40, 1), Some(&checkpoint)).unwrap();
    let whole = fs::read_to_string(&checkpoint.path).unwrap();
    let [_, identity, state] = whole.lines().collect::<Vec<_>>()[..] else { panic!("{whole}") };
    for (from, to, field) in [
        ("\"seed\":2026", "\"seed\":2027", "seed"),
        ("\"first\":0", "\"first\":8", "first sample"),
        ("\"draws\":", "\"draws\":9", "failures"),
    ] {
        let forged = state.replacen(from, to, 1);
        assert_ne!(forged, state);
        let body = format!("{identity}\n{forged}\n");
        let header = format!("montecarlo-checkpoint 2 {} {:08x}\n", body.len(), crc32fast::hash(body.as_bytes()));
        fs::write(&checkpoint.path, header + &body).unwrap();
        let error = walk(&sampling(40, 1), Some(&checkpoint)).unwrap_err();
        let MonteCarloError::CheckpointDamaged { damage: Damage::State { field: found }, .. } = error else {
            panic!("{error}")
        };
        assert_eq!(found, field);
    }
}

/// JSON has no infinity: it would be written as null, which is no float.
#[derive(Debug, Serialize, Deserialize)]
struct Largest(f64);
impl Merge for Largest {
    fn merge(&mut self, later: Self) {
        self.0 = self.0.max(later.0);
    }
}
impl Tally<Walk> for Largest {
    fn record(&mut self, runs: &Runs<'_, Walk>) {
        self.0 = self.0.max(runs.sample.size);
    }
}

#[test]
fn a_tally_that_cannot_be_read_back_is_refused_when_it_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let checkpoint = checkpoint(folder.path());
    let error = run_with(&WALK, &sampling(10, 1), || Largest(f64::NEG_INFINITY), Some(&checkpoint), &()).unwrap_err();
    assert!(matches!(error, MonteCarloError::NotStorable { .. }), "{error}");
    assert!(!checkpoint.path.exists());
    assert!(run_with(&WALK, &sampling(10, 1), || Largest(-1.0), Some(&checkpoint), &()).is_ok());
}

#[test]
fn a_checkpoint_of_another_tally_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let checkpoint = checkpoint(folder.path());
    run_with(&WALK, &sampling(10, 1), || Largest(-1.0), Some(&checkpoint), &()).unwrap();
    let error = walk(&sampling(10, 1), Some(&checkpoint)).unwrap_err();
    assert!(matches!(error, MonteCarloError::CheckpointDamaged { damage: Damage::Content(_), .. }), "{error}");
}
