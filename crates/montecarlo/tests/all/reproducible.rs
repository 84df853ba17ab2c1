//! Results depend on the seed and the indices alone.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::common::{Counts, SCENES, WALK, bytes, sampling, walk};
use montecarlo::{Experiment, Merge, MonteCarloError, Progress, Runs, Sampling, StreamRng, Tally, run, run_with};
use proptest::prelude::*;
use serde::{Deserialize, Serialize};

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let one = walk(&sampling(333, 1), None).unwrap();
    for threads in [2, 8] {
        assert_eq!(bytes(&one), bytes(&walk(&sampling(333, threads), None).unwrap()), "{threads} threads");
    }
    let all_cores = walk(&Sampling { threads: None, ..sampling(333, 1) }, None).unwrap();
    assert_eq!(bytes(&one), bytes(&all_cores));
}

#[test]
fn a_sample_does_not_depend_on_how_many_follow_it() {
    let few = walk(&sampling(20, 2), None).unwrap().tally.samples;
    let many = walk(&sampling(200, 2), None).unwrap().tally.samples;
    assert_eq!(few[..], many[..few.len()]);
    assert!(many.iter().map(|(index, _)| *index).is_sorted());
}

#[test]
fn the_seed_matters() {
    let of_seed = |seed| walk(&Sampling { seed, ..sampling(20, 1) }, None).unwrap().tally.samples;
    assert_ne!(of_seed(1), of_seed(2));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20))]
    #[test]
    fn parts_run_apart_and_merged_give_the_same_bytes(cut in 1u64..149, block in 1u64..20) {
        let whole = walk(&sampling(150, 1), None).unwrap();
        let early = walk(&Sampling { samples: cut, block, ..sampling(150, 2) }, None).unwrap();
        let late = walk(&Sampling { first: cut, samples: 150 - cut, ..sampling(150, 2) }, None).unwrap();
        prop_assert_eq!(bytes(&whole), bytes(&early.merge(late).unwrap()));
    }
}

#[test]
fn parts_that_do_not_fit_are_not_merged() {
    let part = |seed, first, samples| walk(&Sampling { seed, first, ..sampling(samples, 1) }, None).unwrap();
    for (late, message) in [
        (part(1, 11, 5), "the first sample of the later one is 11; 10 is needed"),
        (part(1, 9, 5), "the first sample of the later one is 9; 10 is needed"),
        (part(2, 10, 5), "the seed of the later one is 2; 1 is needed"),
    ] {
        let error = part(1, 0, 10).merge(late).unwrap_err();
        assert_eq!(error.to_string(), format!("the summaries cannot be merged: {message}"));
    }
}

#[test]
fn every_sample_is_evaluated_once_in_every_scene_or_counted_as_failed() {
    let summary = walk(&sampling(500, 2), None).unwrap();
    let failures = &summary.failures;
    let drawn = summary.tally.samples.len() as u64;
    assert_eq!(drawn + failures.draws(), 500);
    for scene in 0..SCENES {
        assert_eq!(summary.tally.positive[scene].trials() + failures.by_scene()[scene], drawn);
        assert!(failures.by_scene()[scene] > 0);
    }
    assert!(failures.draws() > 0);
    assert_eq!(failures.listed().len() as u64, failures.total());
    let order: Vec<_> = failures.listed().iter().map(|f| (f.index, f.scene)).collect();
    assert!(order.is_sorted());
    for failure in failures.listed() {
        let expected = match failure.scene {
            None => "is a multiple of 37".to_string(),
            Some(scene) => format!("fails in scene {scene}"),
        };
        assert!(failure.message.ends_with(&expected), "{failure:?}");
    }
}

#[test]
fn progress_counts_every_evaluation() {
    #[derive(Default)]
    struct Observed {
        announced: Mutex<Vec<(u64, u64)>>,
        advanced: AtomicU64,
        ended: AtomicU64,
    }
    impl Progress for Observed {
        fn begin(&self, total: u64, done: u64) {
            self.announced.lock().unwrap().push((total, done));
        }
        fn advance(&self, evaluations: u64) {
            self.advanced.fetch_add(evaluations, Ordering::Relaxed);
        }
        fn end(&self) {
            self.ended.fetch_add(1, Ordering::Relaxed);
        }
    }
    let observed = Observed::default();
    run_with(&WALK, &sampling(101, 2), Counts::default, None, &observed).unwrap();
    assert_eq!(*observed.announced.lock().unwrap(), [(101 * SCENES as u64, 0)]);
    assert_eq!(observed.advanced.into_inner(), 101 * SCENES as u64);
    assert_eq!(observed.ended.into_inner(), 1);
}

/// An experiment whose `evaluate_block` leaves out one sample in scene 1.
struct Forgetful {
    scenes: usize,
}

impl Experiment for Forgetful {
    type Sample = ();
    type Outcome = ();
    type Error = String;
    type Scratch = ();
    fn scenes(&self) -> usize {
        self.scenes
    }
    fn draw(&self, _: &mut StreamRng) -> Result<(), String> {
        Ok(())
    }
    fn evaluate(&self, _: usize, (): &(), (): &mut ()) -> Result<(), String> {
        Ok(())
    }
    fn evaluate_block(&self, scene: usize, samples: &[&()], (): &mut (), out: &mut Vec<Result<(), String>>) {
        out.extend(samples.iter().skip(usize::from(scene == 1)).map(|_| Ok(())));
    }
}

#[derive(Serialize, Deserialize)]
struct Nothing;
impl Merge for Nothing {
    fn merge(&mut self, _: Self) {}
}
impl Tally<Forgetful> for Nothing {
    fn record(&mut self, _: &Runs<'_, Forgetful>) {}
}

#[test]
fn a_study_that_loses_a_result_is_stopped() {
    let error = run(&Forgetful { scenes: 2 }, &sampling(100, 2), || Nothing).err().unwrap();
    assert!(matches!(error, MonteCarloError::BlockLength { scene: 1, .. }), "{error}");
    let error = run(&Forgetful { scenes: 0 }, &sampling(100, 2), || Nothing).err().unwrap();
    assert_eq!(error.to_string(), "the number of scenes is 0; at least 1 is needed");
    assert!(run(&Forgetful { scenes: 1 }, &sampling(100, 2), || Nothing).is_ok());
}

#[test]
#[should_panic(expected = "sample 60 reached")]
fn a_panic_of_the_study_reaches_the_caller() {
    let experiment = crate::common::Walk { panics_at: Some(60), ..WALK };
    let _ = run(&experiment, &sampling(200, 2), Counts::default);
}

#[test]
fn zero_samples_are_refused() {
    assert!(matches!(walk(&sampling(0, 1), None), Err(MonteCarloError::Zero { what: "samples" })));
}
