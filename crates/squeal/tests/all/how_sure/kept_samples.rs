//! Samples that a study keeps.

use std::path::Path;

use brakes::LatticeBrake;
use cea::BatchSolver;
use squeal::influence::{Influence, influence, influence_of_kept, write_kept_samples};
use squeal::study::{Study, UncertainBrake as _};
use squeal::{Error, RunOptions, run_study_with};

use crate::common;

/// Not one of the systems is evaluated again; and a run that is extended has the samples of a run at once.
#[test]
fn influence_of_samples_that_a_study_has_kept_is_that_of_evaluating_them_again() {
    let case = |samples: u64| {
        let mut case = common::case("two-by-two.toml", &[]);
        case.header.samples = samples;
        LatticeBrake::new(case).unwrap()
    };
    let keeping = RunOptions::default().keeping_samples(true);
    let run = |dir: &Path, samples: u64, options: RunOptions| {
        let brake = case(samples);
        let mut kept = None;
        let manifest = run_study_with(&brake, dir, options, &mut |_, results, dir| {
            write_kept_samples(&brake, &results.summary, dir)?;
            kept.clone_from(&results.summary.tally.kept);
            Ok(())
        });
        manifest.map(|_| kept)
    };
    let folder = tempfile::tempdir().unwrap();
    let [once, extended, without] = ["once", "extended", "without"].map(|name| folder.path().join(name));
    let kept = run(&once, 240, keeping).unwrap().unwrap();
    run(&extended, 100, keeping).unwrap();
    run(&extended, 240, keeping).unwrap();
    for table in ["samples.csv", "influence.csv", "occurrence.csv"] {
        let [a, b] = [&once, &extended].map(|dir| std::fs::read_to_string(dir.join(table)).unwrap());
        assert!(a == b && a.lines().count() > 10, "{table}");
    }
    // A folder that began without samples has none of the first, and is refused.
    assert_eq!(run(&without, 100, RunOptions::default()).unwrap(), None);
    assert!(!without.join("samples.csv").exists());
    assert!(matches!(run(&without, 240, keeping), Err(Error::OtherStudy { .. })));

    let brake = case(240);
    let study = Study::new(&brake, &BatchSolver).unwrap();
    let found = influence_of_kept(&brake, 240, &kept);
    assert_eq!(found.len(), brake.plan().scenes.len());
    let mut explained = 0;
    for (scene, found) in found.into_iter().enumerate() {
        let again = influence(&study, scene, 240, None, &()).unwrap();
        explained += again.outputs.iter().filter(|output| !output.inputs.is_empty()).count();
        assert_eq!(found, Some(Influence { evaluations: 0, ..again }));
    }
    assert!(explained > 0);
}
