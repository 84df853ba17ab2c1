//! Work that is cancelled ends with an error that says so, and what a study had goes on from its checkpoint.

#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64, Ordering};

use brakes::case::{LatticeCase, MatricesCase};
use brakes::{LatticeBrake, MatricesBrake};
use cea::{BatchSolver, QrSolver};
use montecarlo::Progress;
use squeal::cycles::{CycleOptions, Start, branches, cycles};
use squeal::influence::influence;
use squeal::screen::{ChangeKind, Confirmation, Criterion, ScreenOptions, confirm, rank};
use squeal::study::Study;
use squeal::sweep::{Over, stability_map, sweep};
use squeal::{RunOptions, RunProgress, run_study_with, workers};

/// Steps that were foreseen and that were made.
#[derive(Default)]
struct Counts([AtomicI64; 2]);

impl Progress for Counts {
    fn begin(&self, total: u64, done: u64) {
        self.0[0].store(total as i64, Ordering::Relaxed);
        self.0[1].store(done as i64, Ordering::Relaxed);
    }
    fn advance(&self, evaluations: u64) {
        self.0[1].fetch_add(evaluations as i64, Ordering::Relaxed);
    }
    fn end(&self) {}
}

#[test]
fn what_is_foreseen_is_what_is_done() {
    let brake = brake(8);
    let study = Study::new(&brake, &BatchSolver).unwrap();
    let (swept, ranked) = (Counts::default(), Counts::default());
    sweep(&study, 0, &Over { name: "mu".into(), from: 0.0, to: 1.3 }, &QrSolver, &swept).unwrap();
    let mut options = ScreenOptions::default();
    (options.kinds, options.draws) = (vec![ChangeKind::Constraint, ChangeKind::Contact], 2);
    rank(&brake, &options, &ranked).unwrap();
    for counts in [swept, ranked] {
        let [total, done] = counts.0.map(AtomicI64::into_inner);
        assert!(total > 1 && done == total, "{done} of {total}");
    }
}

/// Whoever has enough after so many evaluations.
struct Until(AtomicI64);

impl Progress for Until {
    fn begin(&self, _: u64, _: u64) {}
    fn advance(&self, evaluations: u64) {
        self.0.fetch_sub(evaluations as i64, Ordering::Relaxed);
    }
    fn end(&self) {}
    fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed) <= 0
    }
}

fn after(evaluations: i64) -> Until {
    Until(AtomicI64::new(evaluations))
}

fn brake(samples: u64) -> LatticeBrake {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/two-by-two.toml");
    let mut case = LatticeCase::read(&path).unwrap();
    case.header.samples = samples;
    LatticeBrake::new(case).unwrap()
}

/// On one thread a run that is cancelled has kept all samples but those of its last block; of two a slow one may have the first block still.
fn run(brake: &LatticeBrake, dir: &Path, progress: RunProgress<'_>) -> Result<(), squeal::Error> {
    let options = RunOptions::default().with_threads(Some(1)).with_progress(progress);
    run_study_with(brake, dir, options, &mut |_, _, _| Ok(())).map(drop)
}

#[test]
fn a_study_goes_on_where_it_was_cancelled() {
    let (brake, folder) = (brake(2000), tempfile::tempdir().unwrap());
    let [whole, parts] = ["whole", "parts"].map(|name| folder.path().join(name));
    run(&brake, &whole, RunProgress::default()).unwrap();

    let of_preparation = after(3);
    let progress = RunProgress { preparation: &of_preparation, ..RunProgress::default() };
    assert_eq!(run(&brake, &parts, progress).unwrap_err().to_string(), "cancelled");
    assert!(!parts.exists(), "nothing was sampled");

    let scenes = brake.plan.scenes.len() as i64;
    let mut known = 0;
    for samples in [300, 900] {
        let of_samples = after(samples * scenes);
        let progress = RunProgress { evaluation: &of_samples, ..RunProgress::default() };
        assert_eq!(run(&brake, &parts, progress).unwrap_err().to_string(), "cancelled");
        let kept = std::fs::read_to_string(parts.join("checkpoint.json")).unwrap();
        let state: serde_json::Value = serde_json::from_str(kept.lines().nth(2).unwrap()).unwrap();
        let now = state["samples"].as_u64().unwrap();
        assert!(now > known && now < 2000, "{known} {now}");
        known = now;
    }

    let of_reasons = after(0);
    let progress = RunProgress { reasons: &of_reasons, ..RunProgress::default() };
    assert_eq!(run(&brake, &parts, progress).unwrap_err().to_string(), "cancelled");
    assert!(!parts.join("occurrence.csv").exists());
    run(&brake, &parts, RunProgress::default()).unwrap();
    for name in ["checkpoint.json", "occurrence.csv", "summary.md", "sensitivities.csv"] {
        let [a, b] = [&whole, &parts].map(|dir| std::fs::read(dir.join(name)).unwrap());
        assert!(a == b, "{name}");
    }
}

#[test]
fn whatever_takes_long_can_be_cancelled() {
    let brake = brake(8);
    let study = Study::new(&brake, &BatchSolver).unwrap();
    let over = |name: &str, from: f64, to: f64| Over { name: name.into(), from, to };
    let both = [over("mu", 0.0, 1.3), over("x_damping", 50.0, 400.0)];
    let mut options = ScreenOptions::default();
    (options.kinds, options.draws) = (vec![ChangeKind::Constraint], 4);
    for evaluations in [0, 1] {
        let answers = [
            ("a study", Study::with_progress(&brake, &BatchSolver, &after(evaluations)).map(drop).map_err(Into::into)),
            ("a sweep", sweep(&study, 0, &both[0], &QrSolver, &after(evaluations)).map(drop).map_err(Into::into)),
            ("a map", stability_map(&study, 0, &both, &QrSolver, &after(evaluations)).map(drop).map_err(Into::into)),
            ("an influence", influence(&study, 0, 5000, None, &after(evaluations)).map(drop)),
            (
                "a motion",
                cycles(&brake, &brake.plan.scenes[0], &CycleOptions::default(), None, &after(evaluations)).map(drop),
            ),
            ("a ranking", rank(&brake, &options, &after(evaluations)).map(drop)),
        ];
        for (what, answer) in answers {
            let answer: Result<(), squeal::questions::Error> = answer;
            assert!(
                answer.as_ref().is_err_and(squeal::questions::Error::is_cancelled),
                "{what} after {evaluations}: {answer:?}"
            );
        }
    }
}

/// Number of times that somebody was told of progress.
#[derive(Default)]
struct Told(AtomicU64);

impl Progress for Told {
    fn begin(&self, _: u64, _: u64) {}
    fn advance(&self, _: u64) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }
    fn end(&self) {}
}

#[test]
fn motions_go_on_where_they_were_cancelled() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/hoffmann.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let brake = MatricesBrake::new(MatricesCase::parse(&path, text).unwrap()).unwrap();
    let (folder, one) = (tempfile::tempdir().unwrap(), workers(Some(1)).unwrap());
    let options = CycleOptions { from: Start::Noise, ..CycleOptions::default() };
    let kept = folder.path().join("motions.json");
    let ask = |options: &CycleOptions, kept: Option<&Path>, progress: &dyn Progress| {
        one.install(|| cycles(&brake, &brake.plan.scenes[0], options, kept, progress))
    };
    let whole = Told::default();
    let expected = ask(&options, None, &whole).unwrap();
    // A motion has 1,000 periods, whether it needs them or not.
    assert!(ask(&options, Some(&kept), &after(1500)).unwrap_err().is_cancelled());
    let resumed = Told::default();
    assert_eq!(format!("{:?}", ask(&options, Some(&kept), &resumed).unwrap()), format!("{expected:?}"));
    let [whole, resumed] = [whole, resumed].map(|told| told.0.into_inner());
    assert!(resumed > 30 && resumed < whole - 30, "{resumed} of {whole}");
    // Another question is none of those that are known.
    let other = CycleOptions { stick: 0.02, ..options };
    ask(&other, Some(&kept), &()).unwrap();
    let first = |path: &Path| std::fs::read_to_string(path).unwrap().lines().nth(1).unwrap().to_owned();
    assert!(first(&kept).contains("stick: 0.02"));

    let (study, over) = (Study::new(&brake, &QrSolver).unwrap(), Over { name: "mu".into(), from: 0.5, to: 1.1 });
    let ask = |progress: &dyn Progress| {
        one.install(|| branches(&study, 0, &over, &CycleOptions::default(), Some(&kept), [&(), progress]))
    };
    let expected = branches(&study, 0, &over, &CycleOptions::default(), None, [&(), &()]).unwrap();
    assert!(ask(&after(1)).unwrap_err().is_cancelled());
    let length = std::fs::metadata(&kept).unwrap().len();
    assert_eq!(format!("{:?}", ask(&()).unwrap()), format!("{expected:?}"));
    let all = std::fs::read_to_string(&kept).unwrap();
    assert!(first(&kept).contains("over mu=0.5:1.1") && length > 1000 && all.len() as u64 > length);
    assert_eq!(all.matches("\"Balances\"").count(), 1);
}

/// Whoever has enough as soon as they hear of work, and counts what is done of it.
#[derive(Default)]
struct Impatient {
    has_begun: AtomicBool,
    done: AtomicU64,
}

impl Progress for Impatient {
    fn begin(&self, _: u64, _: u64) {
        self.has_begun.store(true, Ordering::Relaxed);
    }
    fn advance(&self, evaluations: u64) {
        self.done.fetch_add(evaluations, Ordering::Relaxed);
    }
    fn end(&self) {}
    fn is_cancelled(&self) -> bool {
        self.has_begun.load(Ordering::Relaxed)
    }
}

/// The motions of the brake without changes end, and nothing is made of them; nor is a sample of a confirmation that is cancelled.
#[test]
fn a_screen_by_loudness_ends_within_a_motion() {
    let brake = brake(8);
    let mut options = ScreenOptions::default();
    (options.kinds, options.draws) = (vec![ChangeKind::Contact], 2);
    let ranking = rank(&brake, &options, &()).unwrap();
    options.criterion = Criterion::Loudness;
    let impatient = Impatient::default();
    let cancelled = rank(&brake, &options, &impatient).map(drop);
    assert!(cancelled.is_err_and(|error| error.is_cancelled()));
    assert_eq!(impatient.done.into_inner(), 0);
    let folder = tempfile::tempdir().unwrap();
    let kept = folder.path().join("checkpoint.json");
    let impatient = Impatient::default();
    let how = Confirmation::new(8).with_progress(&(), &impatient).with_checkpoint(Some(kept.clone()));
    let cancelled = confirm(&brake, ranking, &options, &how).map(drop);
    assert!(cancelled.is_err_and(|error| error.is_cancelled()));
    let kept = std::fs::read_to_string(kept).unwrap();
    let state: serde_json::Value = serde_json::from_str(kept.lines().nth(2).unwrap()).unwrap();
    assert_eq!(state["samples"], 0);
}
