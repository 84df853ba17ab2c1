//! Samples of a reduced brake against the whole one.

use montecarlo::{rand::RngExt, stream};
use num_complex::Complex;

use rayon::prelude::*;
use sparse::{Rectangle, eigenpairs_in};

use super::FiniteElementBrake;
use super::reduce::rectangle;
use crate::Error;
use crate::study::{FullChecks, UncertainBrake};

/// Distance, relative to |lambda|, up to which two eigenvalues are of the same mode; also of one from the border of the rectangle, at which
/// it may be inside in one system and outside in the other.
const SAME_MODE: f64 = 1e-3;
/// The first stream from which samples are chosen, far from those of samples and from those of training points.
const FIRST_STREAM: u64 = u64::MAX / 2;

/// Solves the whole brake for `count` of its samples, chosen at random among all scenes and the first `samples` draws.
pub(super) fn full_checks(brake: &FiniteElementBrake, count: u64, samples: u64) -> Result<FullChecks, Error> {
    let one = |at: u64| full_check(brake, FIRST_STREAM + at, samples);
    let found = (0..count).into_par_iter().map(one).collect::<Result<Vec<_>, Error>>()?;
    let sum = |of: fn(&FullChecks) -> u64| found.iter().map(of).sum();
    Ok(FullChecks {
        samples: sum(|one| one.samples),
        modes: sum(|one| one.modes),
        missing: sum(|one| one.missing),
        invented: sum(|one| one.invented),
        other_verdicts: sum(|one| one.other_verdicts),
        largest_distance: found.iter().map(|one| one.largest_distance).fold(0.0, f64::max),
    })
}

fn full_check(brake: &FiniteElementBrake, number: u64, samples: u64) -> Result<FullChecks, Error> {
    let (mut rng, scenes) = (stream(brake.case.seed, number), &brake.plan.scenes);
    let (scene, index) = (&scenes[rng.random_range(0..scenes.len())], rng.random_range(0..samples.max(1)));
    let sample = brake.draw(&mut stream(brake.case.seed, index))?;
    let at = brake.full_point(scene, &brake.operating_point(scene, &sample)?);
    let (part, rectangle) = (brake.part(scene), rectangle(&brake.case));
    let whole = brake.sets[part.set].system.assemble(&at)?;
    let whole = eigenpairs_in(&whole, &rectangle, &sparse::Options::default(), &mut |_| {})?;
    let mut reduced = part.reduced.modes(&at)?.lambdas;
    let grows = |lambda: Complex<f64>| brake.plan.threshold.margin(lambda) > 0.0;
    let mut found = FullChecks { samples: 1, modes: whole.pairs.len() as u64, ..FullChecks::default() };
    for lambda in whole.pairs.iter().map(|pair| pair.lambda) {
        let distance = |other: &Complex<f64>| (other - lambda).norm() / lambda.norm();
        let nearest = (0..reduced.len()).min_by(|&a, &b| distance(&reduced[a]).total_cmp(&distance(&reduced[b])));
        match nearest.filter(|&at| distance(&reduced[at]) <= SAME_MODE) {
            Some(at) => {
                let other = reduced.swap_remove(at);
                found.largest_distance = found.largest_distance.max(distance(&other));
                found.other_verdicts += u64::from(grows(other) != grows(lambda));
            }
            None => found.missing += u64::from(is_well_inside(&rectangle, lambda)),
        }
    }
    found.invented = reduced.into_iter().filter(|&lambda| is_well_inside(&rectangle, lambda)).count() as u64;
    Ok(found)
}

fn is_well_inside(rectangle: &Rectangle, lambda: Complex<f64>) -> bool {
    rectangle.contains(lambda, -SAME_MODE * lambda.norm())
}
