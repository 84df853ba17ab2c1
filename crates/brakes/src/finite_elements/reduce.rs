//! The reduction of a finite element brake: one basis for each set of constraints, and a smaller one within it for each part of the study.

use std::sync::atomic::AtomicU64;
use std::sync::{Arc, Mutex};

use linsys::OperatingPoint;
use montecarlo::Progress;
use num_complex::Complex;
use rayon::prelude::*;
use reduction::{CoarseBasis, Within, compared, error_within, within};
use sparse::SparseAffineSystem;

use super::points::{all_patches, naming_point, of_brake};
use super::reduced_set::{Part, ReducedSet};
use super::set_basis;
use super::together::Together;
use super::training::{Closed, arrangements, rectangle, training};
use super::whole_modes::{held_out, modes_at_medians};
use crate::Error;
use crate::bits::{Bits as _, bits, put_list};
use crate::case::FiniteElementCase;
use crate::prepared::Pieces;

/// Largest estimated error of eigenvalues on the basis of a part, relative to |lambda|, at the draws that it is made of; chosen: a third of the error for which
/// the basis of a set is made.
const WITHIN: f64 = 3e-7;
/// Number of further draws, at which the basis of a part is checked; chosen: with fewer, a basis that does not hold other draws is found out less often; with
/// more, the check takes longer.
const FURTHER: u64 = 4;
/// Largest estimated error of eigenvalues there, relative to |lambda|. If it is larger, the basis is made anew of twice as many draws. Chosen: the same is
/// wanted of the basis of a set, at draws of which it was not made.
const WANTED_FURTHER: f64 = 1e-6;
/// Most times that the number of draws is doubled; chosen: the error that is left after the last time is assumed of samples.
const MOST_DOUBLINGS: u32 = 3;
/// Number of points of a part at which its coarse modes are made, unless more had to be solved whole on the basis of the set ([`Within::solved`]); chosen:
/// with fewer, more samples need a whole spectrum; with more, the coarse basis has more columns.
const COARSE_POINTS: usize = 24;

/// Choice of the arrangements that have a basis of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bases {
    /// A basis for each arrangement: the smallest, for a study.
    OfEach,
    /// A basis for each set of constraints, so that what is compared has the same coordinates.
    OfEachSet,
}

/// Bases of a brake, all of them.
pub(super) struct AllBases {
    pub sets: Vec<ReducedSet>,
    pub parts: Vec<Part>,
    /// The part of each set of constraints with all patches closed, where its modes are named.
    pub of_origins: Vec<usize>,
    /// The part of each configuration.
    pub of_configurations: Vec<usize>,
}

/// Set of constraints and arrangements that a part is to hold.
struct Asked {
    set: usize,
    arrangements: Vec<Closed>,
}

/// A point of the whole brake that a reduction is trained on beside its own draws.
#[derive(Debug, Clone)]
pub(super) struct Trained {
    /// The set of constraints.
    pub set: usize,
    /// The closed patches, from 0.
    pub closed: Closed,
    pub at: OperatingPoint,
}

bits!(Trained { set, closed, at });

/// Kept piece of a part: [`Part`] follows from it and its set.
struct PartPiece {
    within: Within,
    coarse: Option<CoarseBasis>,
    distance_of_losses: f64,
    first: Vec<Complex<f64>>,
}

bits!(PartPiece { within, coarse, distance_of_losses, first });

/// Reduces the brake with each set of constraints. A basis holds the modes of the first configuration at the points `swept`, if any, and the modes of every
/// configuration at its further points `trained`.
pub(super) fn all_bases(
    (case, pieces): (&FiniteElementCase, &Pieces<'_>),
    bases: Bases,
    (swept, trained): (&[OperatingPoint], &[Trained]),
    progress: &dyn Progress,
) -> Result<AllBases, Error> {
    let arrangements = arrangements(case);
    let all = all_patches(case);
    let mut asked = Vec::new();
    let (mut of_origins, mut of_configurations) = (Vec::new(), Vec::new());
    for set in 0..case.constraints.len() {
        let first = asked.len();
        of_origins.push(first);
        match bases {
            Bases::OfEachSet => {
                asked.push(Asked { set, arrangements: arrangements.clone() });
                of_configurations.extend(arrangements.iter().map(|_| first));
            }
            Bases::OfEach => {
                asked.push(Asked { set, arrangements: vec![all.clone()] });
                for arrangement in &arrangements {
                    let known = (first..asked.len()).find(|&at| asked[at].arrangements[0] == *arrangement);
                    of_configurations.push(known.unwrap_or(asked.len()));
                    if known.is_none() {
                        asked.push(Asked { set, arrangements: vec![arrangement.clone()] });
                    }
                }
            }
        }
    }
    // What the basis of a set depends on beside the case.
    let inputs = |set: usize| {
        let of_set: Vec<Trained> = trained.iter().filter(|point| point.set == set).cloned().collect();
        (case.constraints[set].fixed.clone(), (swept.to_vec(), of_set)).bytes()
    };
    let together = Arc::new(Together::new(pieces.solutions_together(case.dofs.len())));
    progress.begin((case.constraints.len() * set_basis::ADVANCES + asked.len()) as u64, 0);
    let mut sets = Vec::with_capacity(case.constraints.len());
    for (at, set) in case.constraints.iter().enumerate() {
        progress.go_on()?;
        let own: Vec<OperatingPoint> =
            trained.iter().filter(|point| point.set == at).map(|point| point.at.clone()).collect();
        let mut is_kept = true;
        let basis = |system: &SparseAffineSystem| {
            let make = || {
                is_kept = false;
                let kept = set_basis::KeptSolutions { pieces, fixed: &set.fixed };
                set_basis::basis(case, (system, together.count()), (swept, &own), &kept, progress)
            };
            pieces.item("set", |to| to.extend(inputs(at)), make)
        };
        sets.push(ReducedSet::new(case, &set.fixed, Arc::clone(&together), basis)?);
        if is_kept {
            progress.advance(set_basis::ADVANCES as u64);
        }
    }
    let first = of_configurations[0];
    let part = |(at, asked): (usize, &Asked)| {
        progress.go_on()?;
        let swept = if at == first { swept } else { &[] };
        let is_own = |point: &&Trained| point.set == asked.set && asked.arrangements.contains(&point.closed);
        let own: Vec<OperatingPoint> = trained.iter().filter(is_own).map(|point| point.at.clone()).collect();
        let all = |to: &mut Vec<u8>| {
            to.extend(inputs(asked.set));
            put_list(&asked.arrangements, to);
            (at == first).put(to);
        };
        let set = &sets[asked.set];
        let piece = pieces.item("part", all, || part_piece(case, set, asked, (swept, &own)))?;
        let found = part(case, set, asked, piece);
        progress.advance(1);
        found
    };
    let parts = asked.par_iter().enumerate().map(part).collect::<Result<Vec<_>, Error>>()?;
    let modes_of_whole = |(set, &origin): (&ReducedSet, &usize)| {
        let (asked, first) = (&asked[origin], &parts[origin].first);
        let inputs = |to: &mut Vec<u8>| {
            case.constraints[asked.set].fixed.put(to);
            asked.arrangements[0].put(to);
            first.put(to);
        };
        pieces.item("whole", inputs, || modes_at_medians(case, set, &asked.arrangements[0], first))
    };
    let by_set: Vec<(&ReducedSet, &usize)> = sets.iter().zip(&of_origins).collect();
    let whole = together.map(by_set, modes_of_whole)?;
    for (at, ((set, whole), &origin)) in sets.iter_mut().zip(whole).zip(&of_origins).enumerate() {
        set.compared = compared(&whole, &parts[origin].first);
        set.modes = whole;
        let of_set = &of_configurations[at * arrangements.len()..];
        let part = |closed: &Closed| arrangements.iter().position(|own| own == closed).map(|own| &parts[of_set[own]]);
        let all = |to: &mut Vec<u8>| {
            to.extend(inputs(at));
            (bases == Bases::OfEachSet).put(to);
        };
        (set.held_out, set.held_out_residual) = pieces.item("held out", all, || held_out(case, &set.drawn, part))?;
        if set.has_others(case) {
            set.held_out = 1.0;
        }
    }
    progress.end();
    Ok(AllBases { sets, parts, of_origins, of_configurations })
}

/// A part, from what is kept of it.
fn part(case: &FiniteElementCase, set: &ReducedSet, asked: &Asked, piece: PartPiece) -> Result<Part, Error> {
    let PartPiece { within, coarse, distance_of_losses, first } = piece;
    let reduced =
        set.reduced_within(&within.basis, case)?.with_distance_of_losses(distance_of_losses).on_coarse(coarse)?;
    let (routes, settled) = (Mutex::default(), AtomicU64::default());
    Ok(Part { set: asked.set, within, distance_of_losses, first, reduced, routes, settled })
}

/// The kept piece of a part: the fewest directions that hold it, coarse ones among them.
fn part_piece(
    case: &FiniteElementCase,
    set: &ReducedSet,
    asked: &Asked,
    (swept, trained): (&[OperatingPoint], &[OperatingPoint]),
) -> Result<PartPiece, Error> {
    let first = &asked.arrangements[0];
    let at_median = of_brake(case, first, &naming_point(case, first)?);
    let rectangle = rectangle(case);
    let drawn = |count: u64| training(case, &asked.arrangements, count, swept);
    let (mut count, mut doublings) = (drawn(case.reduction.training as u64)?.len() as u64, 0);
    let within = loop {
        let mut training = drawn(count)?;
        let further = drawn(count + FURTHER)?.split_off(training.len());
        training.extend_from_slice(trained);
        let mut within = within((&set.reduced, set.leading), (rectangle, &training), WITHIN)?;
        // Points that a sweep goes through are all that there is.
        let error = match further.is_empty() {
            true => 0.0,
            false => error_within((&set.reduced, &within.basis), (rectangle, &further))?,
        };
        within.distance = within.distance.max(error);
        if error <= WANTED_FURTHER || doublings == MOST_DOUBLINGS {
            break within;
        }
        (count, doublings) = (2 * count, doublings + 1);
    };
    // First the draws that had to be solved whole and the trained points, then other draws, thinned evenly.
    let mut known: Vec<OperatingPoint> = within.solved.iter().chain(trained).cloned().collect();
    let others = drawn(count.max(COARSE_POINTS as u64))?;
    let step = others.len().div_ceil(COARSE_POINTS.saturating_sub(known.len()).max(1)).max(1);
    known.extend(others.iter().step_by(step).cloned());
    let reduced = set.reduced_within(&within.basis, case)?.with_coarse(&known)?;
    let distance_of_losses = reduced.distance_of_losses(&known)?;
    let reduced = reduced.with_distance_of_losses(distance_of_losses);
    let (first, coarse) = (reduced.modes(&at_median)?.lambdas, reduced.coarse_basis().cloned());
    Ok(PartPiece { within, coarse, distance_of_losses, first })
}
