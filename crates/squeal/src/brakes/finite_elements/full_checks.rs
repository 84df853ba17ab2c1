//! Samples of a reduced brake against the whole one.

use montecarlo::{rand::RngExt, stream};
use num_complex::Complex;
use rayon::prelude::*;
use sparse::Rectangle;
use sparse::reduction::{Compared, compared};

use super::FiniteElementBrake;
use super::reduce::{rectangle, whole_modes};
use crate::Error;
use crate::study::{FullChecks, UncertainBrake};

/// Distance, relative to |lambda|, of a mode from the border of the rectangle up to which it may be inside in one system and outside in
/// the other.
const AT_BORDER: f64 = 1e-3;
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
    let reduced = part.reduced.modes(&at)?.lambdas;
    let lambdas = whole_modes(&brake.case, &whole, &reduced)?;
    let Compared { distance, missed, left, pairs } = compared(&lambdas, reduced);
    let grows = |lambda: Complex<f64>| brake.plan.threshold.margin(lambda) > 0.0;
    let count =
        |of: Vec<Complex<f64>>| of.into_iter().filter(|&lambda| is_well_inside(&rectangle, lambda)).count() as u64;
    Ok(FullChecks {
        samples: 1,
        modes: lambdas.len() as u64,
        missing: count(missed),
        invented: count(left),
        other_verdicts: pairs.iter().filter(|[whole, reduced]| grows(*whole) != grows(*reduced)).count() as u64,
        largest_distance: distance,
    })
}

fn is_well_inside(rectangle: &Rectangle, lambda: Complex<f64>) -> bool {
    let open = Rectangle { re: [rectangle.re[0], f64::INFINITY], ..*rectangle };
    open.contains(lambda, -AT_BORDER * lambda.norm())
}
