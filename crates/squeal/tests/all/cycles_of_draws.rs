//! The motions of the draws of a study: those of closed forms and of `cycles`, and the same bytes however they are computed.

#![allow(clippy::unwrap_used, clippy::panic)] // Test code, which the lints do not recognise outside test functions.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use brakes::case::{LatticeCase, MatricesCase};
use brakes::{LatticeBrake, MatricesBrake};
use squeal::cycles::{CycleOptions, CyclesOfDraws, DrawnFate, cycles};
use squeal::montecarlo::stream;
use squeal::parts::{Shard, merge_parts, run_part};
use squeal::results::Results;
use squeal::study::{Study, UncertainBrake};
use squeal::{Error, RunOptions, run_study_with};

const STICK: f64 = 0.01;

/// Both sides of the onset.
const UNIFORM: &str = "\"uniform\"\nfrom = 0.5\nto = 1.1";

fn case(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases").join(name)
}

/// Hoffmann's oscillator with a distribution of mu.
fn hoffmann(mu: &str, samples: u64) -> MatricesBrake {
    let path = case("hoffmann.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let given = "distribution = \"uniform\"\nfrom = 0.5\nto = 1.1\n";
    assert!(text.contains(given));
    let mut case = MatricesCase::parse(&path, text.replace(given, &format!("distribution = {mu}\n"))).unwrap();
    case.header.samples = samples;
    MatricesBrake::new(case).unwrap()
}

/// Motions of the first draws of a study in memory, with the folder of their tables.
fn followed<B: UncertainBrake>(brake: &B, draws: u64) -> (CyclesOfDraws, tempfile::TempDir) {
    let study = Study::new(brake, &squeal::cea::QrSolver).unwrap();
    let results = Results::sampled(&study).unwrap();
    let dir = tempfile::tempdir().unwrap();
    let found = CyclesOfDraws::run(&study, &results.summary, (draws, STICK), dir.path(), dir.path(), &()).unwrap();
    (found, dir)
}

/// Two linear phases matched by exponentials: period, time open and largest y at mu.
#[test]
fn a_draw_of_hoffmanns_oscillator_has_the_cycle_of_the_closed_form() {
    for (mu, period, open, largest) in [
        (0.8, 4.485144715, 0.968634, 0.911365),
        (0.9, 4.560150545, 1.435545, 1.096984),
        (1.1, 4.670813590, 1.895878, 1.357805),
    ] {
        let brake = hoffmann(&format!("\"constant\"\nvalue = {mu}"), 8);
        let (found, _dir) = followed(&brake, 3);
        let [of_scene] = &found.scenes[..] else { panic!("{found:?}") };
        assert_eq!(of_scene.draws.iter().map(|draw| draw.sample).collect::<Vec<_>>(), [0, 1, 2]);
        for motion in of_scene.draws.iter().flat_map(|draw| &draw.motions) {
            let Some(DrawnFate::Cycle { hz, measured, .. }) = &motion.fate else { panic!("{motion:?}") };
            assert!((hz.recip() - period).abs() < 1e-8, "{mu}: {}", hz.recip());
            assert!((measured.contacts[0].0 * period - open).abs() < 2e-6, "{mu}: {measured:?}");
            // The mass is the only body, of x and y: its peak is at least that of y.
            assert!(measured.bodies[0].1 > largest - 2e-6 && measured.loudness == measured.bodies[0].0, "{measured:?}");
        }
    }
}

#[test]
fn a_draw_has_the_motion_that_its_values_have_as_medians() {
    let brake = hoffmann(UNIFORM, 20);
    let (found, _dir) = followed(&brake, 4);
    assert_eq!(found.scenes[0].draws.len(), 4);
    for draw in &found.scenes[0].draws {
        let mu = brake.draw(&mut stream(brake.plan.seed, draw.sample)).unwrap()[0];
        let frozen = hoffmann(&format!("\"constant\"\nvalue = {mu:?}"), 20);
        let at_medians = cycles(&frozen, &frozen.plan.scenes[0], &CycleOptions::default(), None, &()).unwrap();
        let (expected, measures) = match &at_medians.motions[0] {
            motion @ squeal::cycles::MotionOfMode { motion: squeal::cycle::Motion::Cycle(cycle), .. } => {
                (cycle.frequency_hz(), motion.measures.as_ref().unwrap())
            }
            other => panic!("{other:?}"),
        };
        let Some(DrawnFate::Cycle { hz, measured, .. }) = &draw.motions[0].fate else { panic!("{draw:?}") };
        assert!((hz - expected).abs() < 1e-9 * expected, "{mu}: {hz} {expected}");
        assert!((measured.loudness - measures.rms_of(&[0, 1])).abs() < 1e-7, "{mu}: {measured:?}");
        assert!((draw.motions[0].omega / TAU - at_medians.motions[0].lambda.im / TAU).abs() < 1e-12);
    }
}

/// All files of a folder with their bytes but those of a run's own.
fn bytes(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let files = std::fs::read_dir(dir).unwrap().map(|entry| entry.unwrap().path());
    let tables = files.filter(|path| path.extension().is_some_and(|end| end == "csv" || end == "md"));
    tables.map(|path| (path.file_name().unwrap().to_string_lossy().into(), std::fs::read(&path).unwrap())).collect()
}

#[test]
fn tables_are_the_same_bytes_with_any_threads_after_a_stop_and_from_parts() {
    let brake = hoffmann(UNIFORM, 24);
    let folder = tempfile::tempdir().unwrap();
    let draw_in = |dir: PathBuf| {
        move |study: &Study<'_, MatricesBrake>, results: &Results, stage: &Path| -> Result<(), Error> {
            let found = CyclesOfDraws::run(study, &results.summary, (6, STICK), &dir, stage, &())?;
            Ok(found.add_to_summary(study.plan(), stage)?)
        }
    };
    let run = |name: &str, threads: usize| {
        let dir = folder.path().join(name);
        let options = RunOptions::default().with_threads(Some(threads));
        run_study_with(&brake, &dir, options, &mut draw_in(dir.clone())).unwrap();
        bytes(&dir)
    };
    let one = run("one", 1);
    assert!(one.contains_key("cycles_of_draws.csv") && one.contains_key("cycles_by_mode.csv"), "{:?}", one.keys());
    assert!(String::from_utf8_lossy(&one["summary.md"]).contains("a cycle in 6 of 6"));
    assert!(one == run("three", 3));
    // Again in the same folder: what is kept is not followed again. Of a kept file that is cut nothing is taken.
    assert!(one == run("one", 2));
    let kept = folder.path().join("one/cycles_of_draws.json");
    let whole = std::fs::read(&kept).unwrap();
    std::fs::write(&kept, &whole[..whole.len() / 2]).unwrap();
    assert!(one == run("one", 2));
    assert!(whole == std::fs::read(&kept).unwrap());

    let parts: Vec<PathBuf> = [1, 2].map(|number| folder.path().join(format!("part{number}"))).into();
    for (number, part) in (1..).zip(&parts) {
        run_part(&brake, Shard { number, of: 2, from: 0 }, part, RunOptions::default()).unwrap();
    }
    let merged = folder.path().join("merged");
    merge_parts(&brake, &parts, false, &merged, RunOptions::default(), &mut draw_in(merged.clone())).unwrap();
    assert!(one == bytes(&merged));
}

#[test]
fn motions_that_cannot_be_followed_are_counted_and_stable_draws_are_not_among_those_that_are() {
    let brake = hoffmann("\"uniform\"\nfrom = 0.5\nto = 0.74", 10);
    let (found, dir) = followed(&brake, 5);
    assert!(found.scenes[0].draws.is_empty(), "{found:?}");
    assert!(found.text(&brake.plan).contains("no sample has an unstable mode"));
    let table = std::fs::read_to_string(dir.path().join("cycles_of_draws.csv")).unwrap();
    assert_eq!(table.lines().count(), 1, "{table}");

    // A contact whose spring takes more than K holds.
    let path = case("hoffmann.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let given = "stiffness = 1.3333333333333333";
    assert!(text.contains(given));
    let mut case = MatricesCase::parse(&path, text.replace(given, "stiffness = 0.1")).unwrap();
    case.header.samples = 10;
    let (found, dir) = followed(&MatricesBrake::new(case).unwrap(), 2);
    let fates: Vec<_> =
        found.scenes[0].draws.iter().flat_map(|draw| &draw.motions).map(|motion| &motion.fate).collect();
    assert!(
        fates.iter().all(|fate| matches!(fate, Some(DrawnFate::NotFollowed(why)) if why.contains("stiffness"))),
        "{fates:?}"
    );
    let by_mode = std::fs::read_to_string(dir.path().join("cycles_by_mode.csv")).unwrap();
    assert!(by_mode.contains(",2,0,0,0,0,0,2,"), "{by_mode}");
}

#[test]
fn friction_across_the_sliding_is_refused_before_anything_is_followed() {
    let path = case("two-by-two.toml");
    let text = std::fs::read_to_string(&path).unwrap().replace("lateral = \"none\"", "lateral = \"vector\"");
    let brake = LatticeBrake::new(LatticeCase::parse(&path, text).unwrap()).unwrap();
    let error = squeal::cycles::check_contacts_of_draws(&brake, STICK).unwrap_err().to_string();
    assert!(error.contains("friction across the sliding"), "{error}");
    let brake = LatticeBrake::new(LatticeCase::read(&path).unwrap()).unwrap();
    let (names, _) = squeal::cycles::check_contacts_of_draws(&brake, STICK).unwrap();
    assert_eq!(names.len(), brake.plan.scenes.len());
}
