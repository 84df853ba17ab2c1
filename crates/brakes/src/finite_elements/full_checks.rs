//! Draws of a reduced brake against the whole one, before it is sampled; and the reduction trained on where they do not agree.
//!
//! Two results leave this file. The counts, [`study::FullChecks`], go to whoever answers from samples: where a mode is missing, invented or has another
//! verdict, `study::reduced_doubts` has the sentence that stands before every answer, and the program ends with exit code 1. The distances widen the error that
//! is assumed of samples (`error_of_modes` in `mode_source.rs`).

use std::collections::BTreeMap;

use cea::{BatchSolver, EigenSolver as _, Workspace, frequency_hz};
use montecarlo::{Progress, rand::RngExt, stream};
use num_complex::Complex;
use reduction::{Compared, compared};
use study::{BandMode, DivergenceCounts, FullChecks, ModeSource, UncertainBrake, wider};

use super::reduce::Trained;
use super::training::{AT_BORDER, MOST_ROUNDS, rectangle};
use super::whole_modes::{is_next_to_axis, modes_beside};
use super::{Bases, FiniteElementBrake};
use crate::bits::{Bits as _, bits, put_list};
use crate::case::FiniteElementCase;
use crate::prepared::Pieces;
use crate::{Error, Prepared, Purpose};

/// Number of the first stream of the draws that are checked: far from the streams of samples, which begin at 0, and of training points, so that the
/// number of samples changes nothing.
const FIRST_STREAM: u64 = u64::MAX / 2;
/// Largest distance of a mode next to the imaginary axis from the same mode of the whole brake, relative to |lambda|, with which a draw agrees; a reduction is
/// trained on draws with a larger distance. Chosen: an error of this size leaves so few verdicts open that settling them with the whole brake costs less than
/// making the bases anew.
const TRAINED_ABOVE: f64 = 1e-4;

/// Result of one draw: where the reduced brake and the whole one differ, and the operating point to add to the training if they differ too much.
struct OneCheck {
    found: FullChecks,
    at: Option<Trained>,
    /// Largest distance, relative to |lambda|, of a mode next to the axis from its counterpart in the reduced brake, or from the nearest mode of that where it has none.
    error_next_to_axis: f64,
}

bits!(OneCheck { found, at, error_next_to_axis });

impl FiniteElementBrake {
    /// Reduces the brake as [`FiniteElementBrake::new`] does, and compares it with the whole one at draws in scenes chosen at random. Where they do not agree the
    /// brake is trained on these draws too and compared at new ones, at most twice; what eigenvalues are off by at the last draws is assumed of samples at
    /// least. No draw is compared that the brake was trained on. All of it follows from the case alone, whatever the number of samples is.
    ///
    /// # Errors
    /// As [`FiniteElementBrake::new`].
    pub fn checked(case: FiniteElementCase, progress: &dyn Progress) -> Result<Self, Error> {
        Self::prepared(case, Purpose::Study, &Prepared::default(), progress)
    }

    /// [`FiniteElementBrake::checked`], of pieces that are read where they are kept.
    pub(super) fn checked_of(
        (case, pieces): (FiniteElementCase, &Pieces<'_>),
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let mut brake = Self::with_points((case, pieces), Bases::OfEach, (&[], &[]), progress)?;
        let mut trained: Vec<Trained> = Vec::new();
        let count = brake.case.reduction.full_checks;
        for round in 0..=MOST_ROUNDS {
            if count == 0 {
                break;
            }
            progress.begin(count, 0);
            let one = |at: u64| {
                progress.go_on()?;
                let number = round * count + at;
                let inputs = |to: &mut Vec<u8>| {
                    number.put(to);
                    put_list(&trained, to);
                };
                let found = pieces.item("check", inputs, || full_check(&brake, FIRST_STREAM + number));
                progress.advance(1);
                found
            };
            let all = brake.sets[0].together.map((0..count).collect(), one);
            progress.end();
            let all = all?;
            let none = FullChecks { trained_on: round, ..FullChecks::default() };
            let sum = all.iter().fold(none, |sum, one| sum.with(one.found.clone()));
            brake.full_checks = Some(sum);
            if round == MOST_ROUNDS || !all.iter().any(calls_for_training) {
                for OneCheck { at, error_next_to_axis, .. } in &all {
                    if let Some(at) = at {
                        let known = &mut brake.sets[at.set].checked;
                        *known = known.max(*error_next_to_axis);
                    }
                }
                break;
            }
            let open = all.into_iter().filter(calls_for_training);
            trained.extend(open.filter_map(|one| one.at));
            let Self { case, full_checks, .. } = brake;
            let trained_on = Self::with_points((case, pieces), Bases::OfEach, (&[], &trained), progress)?;
            brake = Self { full_checks, ..trained_on };
        }
        Ok(brake)
    }
}

/// True if a draw calls for more training: one with other modes, or an error that would leave many verdicts open.
fn calls_for_training(OneCheck { found, error_next_to_axis, .. }: &OneCheck) -> bool {
    found.has_other_modes() || *error_next_to_axis > TRAINED_ABOVE
}

/// Comparison of one draw, in one scene, with the whole brake. One without an operating point for whatever reason, as where contacts have no equilibrium, is
/// counted as failed, and whether it diverges as open: as a sample is. No other is drawn in its place, as training does, since these draws stand for samples,
/// of which as many fail.
fn full_check(brake: &FiniteElementBrake, stream_number: u64) -> Result<OneCheck, Error> {
    let (mut rng, scenes) = (stream(brake.case.header.seed, stream_number), &brake.plan.scenes);
    let scene_number = rng.random_range(0..scenes.len());
    let scene = &scenes[scene_number];
    let sample = brake.draw(&mut rng)?;
    let Ok(point) = brake.operating_point(scene, &sample) else {
        let divergence =
            BTreeMap::from([(scene_number, DivergenceCounts { draws: 1, open: 1, ..DivergenceCounts::default() })]);
        return Ok(OneCheck {
            found: FullChecks { samples: 1, failed: 1, divergence, ..FullChecks::default() },
            at: None,
            error_next_to_axis: 0.0,
        });
    };
    let (at, part, threshold) = (brake.full_point(scene, &point), brake.part(scene), brake.plan.threshold);
    let reduced = part.reduced.modes(&at)?.lambdas;
    let system = brake.sets[part.set].system.assemble(&at)?;
    let together = brake.sets[part.set].together.count();
    let all = modes_beside(&brake.case, &system, &reduced, together)?;
    let spectrum = BatchSolver.eigenvalues(&part.reduced.system().assemble(&at)?, &mut Workspace::default())?;
    // A reduced brake that diverges casts doubt on a whole one of which no divergence is found.
    let diverging = brake.diverging(scene, &at, &spectrum, together)?;
    let wanted = rectangle(&brake.case);
    let (whole, beside): (Vec<Complex<f64>>, Vec<_>) =
        all.into_iter().partition(|&lambda| wanted.contains_to_the_right(lambda, 0.0));
    let surely_wanted = |lambda: &&Complex<f64>| wanted.contains_to_the_right(**lambda, -AT_BORDER * lambda.norm());
    let count = |of: &[Complex<f64>]| of.iter().filter(surely_wanted).count() as u64;
    let of_reduced = compared(&whole, &reduced);
    let error_next_to_axis = distance_next_to_axis(&of_reduced, &reduced);
    let Compared { distance, missed, left, .. } = of_reduced;
    // The modes that a sample counts: of coarse modes that are corrected, where `reduced` has those of the whole reduced spectrum.
    let sampled = brake.band_modes(scene, std::slice::from_ref(&point)).remove(0)?;
    let counts = |mode: &&BandMode| brake.plan.is_studied(mode.lambda) && threshold.margin(mode.lambda) > mode.bound;
    let counted: Vec<Complex<f64>> = sampled.iter().filter(counts).map(|mode| mode.lambda).collect();
    let beyond = |error: f64| whole.iter().copied().filter(move |l| threshold.margin(*l) > error * l.norm());
    // Twice the error assumed of samples: a mode nearer to the threshold may be open in the sample and is not compared.
    let error = 2.0 * brake.error_of_modes(scene);
    let surely_growing: Vec<Complex<f64>> = beyond(error).collect();
    let growing: Vec<Complex<f64>> = beyond(0.0).collect();
    let verdicts = compared(&surely_growing, &counted);
    let not_counted = verdicts.missed.into_iter().filter(|&lambda| !has(&missed, lambda));
    let wrongly_counted = verdicts.left.into_iter().filter(|&lambda| !has(&growing, lambda) && !has(&left, lambda));
    let other: Vec<Complex<f64>> = not_counted.chain(wrongly_counted).collect();
    let surely_grows = |lambda: &&Complex<f64>| threshold.margin(**lambda) > error * lambda.norm();
    let growing_beside: Vec<f64> = beside.iter().filter(surely_grows).map(|&lambda| frequency_hz(lambda)).collect();
    let divergence = DivergenceCounts {
        draws: 1,
        diverging: u64::from(diverging.any() == Some(true)),
        beyond: u64::from(diverging.beyond),
        open: u64::from(diverging.any().is_none()),
        fastest: diverging.whole.iter().flatten().map(|lambda| lambda.re).fold(0.0, f64::max),
    };
    let found = FullChecks {
        samples: 1,
        modes: whole.len() as u64,
        missing: count(&missed),
        invented: count(&left),
        other_verdicts: count(&other),
        residuals_above: sampled.iter().filter(|mode| mode.residual.is_some_and(|residual| residual.is_above)).count()
            as u64,
        growing_beside: u64::from(!growing_beside.is_empty()),
        divergence: BTreeMap::from([(scene_number, divergence)]),
        beside_hz: growing_beside.iter().map(|&hz| [hz, hz]).reduce(wider),
        largest_distance: distance,
        failed: 0,
        trained_on: 0,
    };
    let at = Some(Trained { set: part.set, closed: brake.closed(scene).to_vec(), at });
    Ok(OneCheck { found, at, error_next_to_axis })
}

/// Largest distance, relative to |lambda|, of modes of the whole brake next to the axis from the same modes of the reduced one; of a mode that it has not from
/// the nearest that it has, 1 at most.
fn distance_next_to_axis(Compared { missed, pairs, .. }: &Compared, reduced: &[Complex<f64>]) -> f64 {
    let off = |of_whole: Complex<f64>, of_reduced: Complex<f64>| (of_whole - of_reduced).norm() / of_whole.norm();
    let nearest = |of_whole| reduced.iter().map(|&of_reduced| off(of_whole, of_reduced)).fold(1.0, f64::min);
    let all = pairs.iter().map(|&[of_whole, of_reduced]| (of_whole, off(of_whole, of_reduced)));
    let all = all.chain(missed.iter().map(|&of_whole| (of_whole, nearest(of_whole))));
    all.filter(|(of_whole, _)| is_next_to_axis(*of_whole)).map(|(_, distance)| distance).fold(0.0, f64::max)
}

/// True if an eigenvalue is one of `modes`, to within [`AT_BORDER`] of its size.
fn has(modes: &[Complex<f64>], lambda: Complex<f64>) -> bool {
    modes.iter().any(|other| (other - lambda).norm() <= AT_BORDER * lambda.norm())
}
