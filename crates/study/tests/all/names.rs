//! The names of a study, most of them by shape alone, against modes that are followed all the way to their reference.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

use crate::common::case;
use brakes::case::LatticeCase;
use brakes::{LatticeBrake, LatticeSample};
use cea::{BatchSolver, EigenSolver, Mode, Modes, QrSolver, Verdict, Workspace, verdict};
use montecarlo::{Experiment as _, stream};
use rayon::prelude::*;
use study::{ModeLabel, Reference, Study, UncertainBrake as _};
use tracking::{Path, PathEnd, PathStart, follow, mac};

/// What came of the unstable modes of some samples.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
struct Count {
    modes: u64,
    /// One name by the study.
    named: u64,
    /// Of these: the mode followed has the same name; has it among several; has another.
    same: u64,
    left_open: u64,
    contradicted: u64,
    /// Of those named: the MAC with the reference mode of this name is below 0.8, below 0.5.
    below: [u64; 2],
}

impl Count {
    fn and(self, other: Self) -> Self {
        Self {
            modes: self.modes + other.modes,
            named: self.named + other.named,
            same: self.same + other.same,
            left_open: self.left_open + other.left_open,
            contradicted: self.contradicted + other.contradicted,
            below: [0, 1].map(|i| self.below[i] + other.below[i]),
        }
    }
}

/// Names and largest MAC with a reference mode of such a name, of each unstable mode, ascending in frequency.
fn followed(
    brake: &LatticeBrake,
    study: &Study<'_, LatticeBrake>,
    scene: usize,
    sample: &LatticeSample,
) -> Vec<Followed> {
    let (of_scene, mut work) = (&brake.plan.scenes[scene], Workspace::default());
    let whole = brake.system(of_scene, sample).unwrap();
    let mut found = Vec::new();
    for (sector, reference) in brake.plan.brake(of_scene).sectors.iter().zip(&study.sector_references()[scene]) {
        let system = sector.reduced(&whole).unwrap();
        let spectrum = QrSolver.eigenvalues(&system, &mut work).unwrap();
        let mut unstable = Modes::classify(&system, &spectrum, &mut work).unwrap().oscillatory;
        unstable.retain(|&lambda| verdict(&system, lambda, &spectrum, &mut work).unwrap() == Verdict::Unstable);
        let modes = Mode::at(&system, &unstable, &mut work).unwrap();
        let Reference { system: end, modes: known, names, .. } = reference;
        let path =
            Path { start: PathStart::System(&system), start_modes: &modes, end: PathEnd { system: end, modes: known } };
        let shapes = mac(&modes, known, &system.m);
        let links = follow(&QrSolver, path, &mut work).unwrap();
        found.extend(modes.iter().zip(links).enumerate().map(|(i, (mode, link))| Followed {
            frequency: mode.lambda.im,
            names: link.into_iter().flat_map(|to| names[to].iter().copied()).collect(),
            macs: names.iter().cloned().zip(shapes.row(i).iter().copied()).collect(),
        }));
    }
    found.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
    found
}

/// An unstable mode that was followed to its reference.
struct Followed {
    frequency: f64,
    names: Vec<ModeLabel>,
    /// Each reference mode of its sector, by its names, with the MAC.
    macs: Vec<(Vec<ModeLabel>, f64)>,
}

fn count(case: LatticeCase, samples: u64) -> Count {
    let brake = LatticeBrake::new(case).unwrap();
    let study = Study::new(&brake, &BatchSolver).unwrap();
    let of_scene = |scene: usize| {
        let (mut count, mut scratch) = (Count::default(), Default::default());
        for index in 0..samples {
            let sample = LatticeSample::draw(&brake.case, &mut stream(brake.case.header.seed + 1, index)).unwrap();
            let outcome = study.evaluate(scene, &sample, &mut scratch).unwrap();
            let followed = followed(&brake, &study, scene, &sample);
            assert_eq!(outcome.unstable.len(), followed.len(), "scene {scene}, sample {index}");
            for (mode, other) in outcome.unstable.iter().zip(followed) {
                count.modes += 1;
                let &[name] = mode.names.as_slice() else { continue };
                count.named += 1;
                match other.names.as_slice() {
                    [same] if *same == name => count.same += 1,
                    names if names.contains(&name) => count.left_open += 1,
                    _ => count.contradicted += 1,
                }
                let of_name = other.macs.iter().filter(|(names, _)| names.contains(&name)).map(|(_, mac)| *mac);
                let largest = of_name.fold(0.0, f64::max);
                for (below, limit) in count.below.iter_mut().zip([0.8, 0.5]) {
                    *below += u64::from(largest < limit);
                }
            }
        }
        count
    };
    (0..brake.plan.scenes.len()).into_par_iter().map(of_scene).reduce(Count::default, Count::and)
}

#[test]
fn a_mode_named_by_its_shape_has_the_name_that_following_it_gives() {
    let found = count(case("paper.toml", &[("in_contact = [9, 8, 7, 6]", "arrangements = [[1,3,4,5,6,8]]")]), 12);
    println!("{found:?}");
    assert!(found.named > 100 && found.contradicted == 0, "{found:?}");
}

/// `cargo test --release -p brake-squeal-study --test all names:: -- --ignored --nocapture`
#[test]
#[ignore = "follows some ten thousand modes in 675 scenes"]
fn names_of_the_whole_case_are_those_of_modes_that_are_followed() {
    let found = count(case("paper.toml", &[]), 12);
    println!("{found:?}");
    assert_eq!(found.contradicted, 0, "{found:?}");
}
