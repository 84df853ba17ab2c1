//! A sweep over one parameter of one part of a brake: a sector, or all of it, over the range or a piece of it on which its systems are smooth.

use num_complex::Complex;
use study::{ModeLabel, UncertainBrake};
use tracking::{Ambiguity, BranchPoint, Branches, KeptSpectra, Onset, RootLocus, root_locus_in_steps};

use super::change::{Along, Change, ChangeOf};
use super::changes::Changes;
use super::coalescence::{Candidate, Coalescence, FARTHEST, add, candidates, settle};
use super::divergence::DIVERGENCE;
use super::family::{DIFFERENCE, Evaluations, Line, MakeSystem, Part, SHORTEST_LOCUS_STEP};
use super::names::{Names, carry, names_at};
use super::parameter::SweptParameter;
use super::results::{NamedBranch, Sweep};
use super::sweep_onset::{SweepOnset, WholeOnset};
use crate::Error;

/// Largest distance of two branch points that are one, found twice: of the parameter as a fraction of the range, of omega as a fraction of
/// omega; chosen.
const SAME_BRANCH_POINT: f64 = 1e-6;

/// Pairs of a number of eigenvalues, 2 n + s, and the number of equal steps of the range at which the unstable modes of systems up to that
/// size are counted; chosen: the time that a sweep may take on a desk. Larger systems have [`FEWEST_STEPS`].
const STEPS: [(usize, usize); 2] = [(160, 1024), (480, 256)];
/// Number of equal steps for the largest brakes; chosen.
const FEWEST_STEPS: usize = 64;

/// Number of steps that the whole range is divided into before branches are linked; chosen.
const FIRST_STEPS: usize = 16;
/// Least number of steps of a piece at which unstable modes are counted; chosen: three places show a dip.
const FEWEST_OF_PIECE: usize = 2;
/// Largest distance from the real axis of a branch point that is listed, as a fraction of a piece; chosen.
const FARTHEST_OF_PIECE: f64 = 0.25;

/// Where the modes of a part have the names that its branches get.
pub(super) enum Entry<'n> {
    /// At the medians.
    Medians,
    /// At an end of a piece, 0 or 1: the names of the eigenvalues that are followed there, by their indices.
    End(f64, &'n [Names]),
}

/// Sweep of a part, with what a neighbouring piece needs.
pub(super) struct PartSweep<'a> {
    pub sweep: Sweep,
    /// Candidates for the name of each branch.
    pub names: Vec<Names>,
    /// Spectra along the part, over fractions of its range.
    pub spectra: KeptSpectra<'a, MakeSystem<'a>>,
}

/// Steps of progress of the sweep of a part: branches, coalescences, changes, and these changes to full accuracy.
pub(super) const STEPS_OF_PART: u64 = 4;

/// The sweep of a part; `parameter` has the range of the part.
///
/// # Errors
/// Those of the brake, of the solver and of [`root_locus_in_steps`].
pub(super) fn of_part<'a, B: UncertainBrake>(
    part: &'a Part<'_, B>,
    parameter: &SweptParameter,
    entry: &Entry<'_>,
) -> Result<PartSweep<'a>, Error> {
    let (median, threshold, share) = (part.medians()[0], part.threshold(), part.family.share);
    let bounds = match entry {
        Entry::Medians => [median.min(0.0), median.max(1.0)],
        Entry::End(..) => [0.0, 1.0],
    };
    let mut branches = part.along(Line { start: vec![0.0], direction: vec![1.0], bounds, difference: DIFFERENCE });
    let system = |at: f64| part.system(&[at]);
    let along = Along::new(&system, &part.family.solver, threshold, part.band());
    let steps = steps(part)?;
    let first = (FIRST_STEPS as f64 * share).ceil() as usize;
    let locus = part.studied(root_locus_in_steps(&mut branches, [0.0, 1.0], first, SHORTEST_LOCUS_STEP)?);
    let done = || part.family.progress.advance(1);
    done();
    let places = places(&locus);
    let nearest = |a: &&f64, b: &&f64| (**a - median).abs().total_cmp(&(**b - median).abs());
    let (of_modes, named_at) = match entry {
        Entry::Medians => {
            let named_at = *places.iter().min_by(nearest).unwrap_or(&0.0);
            (names_at(&mut branches, part.reference, median, named_at)?, named_at)
        }
        Entry::End(end, names) => (names.to_vec(), *end),
    };
    let names = branch_names(&mut branches, &locus, &of_modes, named_at)?;
    let farthest = if share < 1.0 { (FARTHEST / share).min(FARTHEST_OF_PIECE) } else { FARTHEST };
    let coalescences = coalescences(&mut branches, &locus, &names, farthest)?;
    done();
    let Changes { found: changes, unresolved, marginal, beside, ends, spectra } =
        along.changes(steps_of_piece(steps, share), &between_meetings(&coalescences))?;
    done();
    let mut evaluations = Evaluations::default();
    let mut found = Vec::new();
    for change in changes.into_iter().filter(|change| part.counts(change)) {
        let Change { at, error, lambda, of, starts, .. } = change;
        let omega = if of.oscillates() { lambda.im } else { 0.0 };
        let reduced = Onset { at, error, omega, destabilises: starts };
        let whole = match along.crossed(&change) {
            Some(crossed) => WholeOnset::near(part, &reduced, crossed, &mut branches)?,
            None => WholeOnset::NotReduced,
        };
        let (onset, moved, is_reduced) = match whole {
            WholeOnset::NotReduced => (reduced, None, false),
            WholeOnset::Found(onset, solved) => {
                evaluations.whole += solved;
                (onset, Some(parameter.at(onset.at) - parameter.at(reduced.at)), false)
            }
            WholeOnset::NotFound { error } => (Onset { error, ..reduced }, None, true),
        };
        let mode = match of {
            ChangeOf::Divergence => DIVERGENCE.to_owned(),
            ChangeOf::Flutter | ChangeOf::Band | ChangeOf::Exchange => {
                ModeLabel::candidates(&names_of_change(&locus, &names, &change))
            }
        };
        found.push(SweepOnset {
            at: parameter.at(onset.at),
            error: onset.error * parameter.slope(onset.at),
            omega: onset.omega,
            growth: lambda.re,
            starts,
            of,
            mode,
            unstable: 0,
            moved,
            is_reduced,
            jump: None,
        });
    }
    evaluations += Evaluations::of(branches.counters());
    evaluations.spectra += spectra;
    let [[flutter, diverging_at_start], at_end] = ends.map(|end| part.counted(&end));
    let named = |(branch, names): (tracking::Branch, &Names)| NamedBranch::new(parameter, branch, names);
    let in_values = |ambiguity: Ambiguity| Ambiguity {
        from: parameter.at(ambiguity.from),
        to: parameter.at(ambiguity.to),
        ..ambiguity
    };
    let sweep = Sweep {
        onsets: found,
        branches: locus.branches.into_iter().zip(&names).map(named).collect(),
        ambiguities: locus.ambiguities.into_iter().map(in_values).collect(),
        unresolved: unresolved.into_iter().map(|(from, to)| (parameter.at(from), parameter.at(to))).collect(),
        coalescences: coalescences.into_iter().map(|coalescence| coalescence.in_values(parameter)).collect(),
        unstable_at_start: flutter + diverging_at_start,
        diverging_at_start,
        unstable_at_end: at_end.into_iter().sum(),
        growing_beside: beside.map(|range| range.map(|range| range.in_values(parameter))),
        counts_divergence: part.counts_divergence(),
        marginal: marginal.into_iter().map(|range| range.in_values(parameter)).collect(),
        steps,
        evaluations,
        shortest_step: places.windows(2).map(|step| step[1] - step[0]).fold(1.0, f64::min),
        ..Sweep::empty(parameter.clone(), threshold)
    };
    done();
    Ok(PartSweep { sweep, names, spectra: branches })
}

/// Places in the middle between two neighbouring coalescences on the real axis: where modes leave the axis as they meet, and come back to it as they
/// meet again, they grow between.
fn between_meetings(coalescences: &[Coalescence]) -> Vec<f64> {
    let on_axis = coalescences.iter().filter(|found| found.distance <= found.error.max(f64::EPSILON));
    let places: Vec<f64> = on_axis.map(|found| found.at).filter(|at| (0.0..=1.0).contains(at)).collect();
    places.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect()
}

/// Places at which branches have points, ascending, as fractions of the range.
fn places(locus: &RootLocus) -> Vec<f64> {
    let mut all: Vec<f64> = locus.branches.iter().flat_map(|branch| &branch.points).map(|point| point.0).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// The names of all branches, from the names that eigenvalues have at a place.
fn branch_names<B: Branches<Error = Error>>(
    branches: &mut B,
    locus: &RootLocus,
    of_modes: &[Names],
    named_at: f64,
) -> Result<Vec<Names>, Error> {
    let mut names = vec![Names::new(); locus.branches.len()];
    let lambdas = branches.lambdas(named_at)?;
    for (branch, names) in locus.branches.iter().zip(&mut names) {
        let here = branch.points.iter().find(|point| point.0 == named_at);
        let index = here.and_then(|(_, point)| lambdas.iter().position(|lambda| *lambda == point.lambda));
        if let Some(index) = index {
            names.clone_from(&of_modes[index]);
        }
    }
    carry(&mut names, &locus.ambiguities, named_at);
    Ok(names)
}

/// Number of equal steps of the whole range at which the unstable modes of a part are counted.
fn steps<B: UncertainBrake>(part: &Part<'_, B>) -> Result<usize, Error> {
    let system = part.system(&[0.0])?;
    let eigenvalues = 2 * system.order() + system.states();
    Ok(STEPS.iter().find(|(most, _)| eigenvalues <= *most).map_or(FEWEST_STEPS, |(_, steps)| *steps))
}

/// Number of equal steps at which unstable modes are counted on a piece, which is a `share` of a range with `steps` of them.
pub(super) fn steps_of_piece(steps: usize, share: f64) -> usize {
    ((steps as f64 * share).ceil() as usize).max(FEWEST_OF_PIECE)
}

/// Candidates for the mode of a change. Where a mode becomes real, or real eigenvalues a mode: the names of all branches that end, or begin, in
/// its step. Else the names of all branches that end in an open step around it; without such a step, of the branch whose tangent passes nearest
/// to lambda.
fn names_of_change(locus: &RootLocus, names: &[Names], &Change { at, lambda, of, starts, .. }: &Change) -> Names {
    if of == ChangeOf::Exchange {
        let near = locus.ambiguities.iter().filter(|step| (step.from..=step.to).contains(&at));
        let open = near.flat_map(|step| if starts { &step.before } else { &step.after });
        let mut all: Names = open.flat_map(|&branch| names[branch].clone()).collect();
        all.sort_unstable();
        all.dedup();
        return all;
    }
    let distance = |branch: &tracking::Branch| {
        let step = branch.points.windows(2).find(|step| step[0].0 <= at && at <= step[1].0)?;
        let [(from, a), (to, b)] = [step[0], step[1]];
        let forward = a.lambda + a.rate * (at - from);
        let backward = b.lambda + b.rate * (at - to);
        Some((forward - lambda).norm().min((backward - lambda).norm()))
    };
    let alive = locus.branches.iter().enumerate().filter_map(|(at, branch)| Some((at, distance(branch)?)));
    let nearest = alive.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(at, _)| names[at].clone());
    let ambiguity = locus.ambiguities.iter().find(|step| (step.from..=step.to).contains(&at));
    let open = ambiguity.map(|step| step.before.iter().flat_map(|&branch| names[branch].clone()).collect::<Names>());
    let mut all = open.into_iter().chain(nearest).min_by_key(|names| names.is_empty()).unwrap_or_default();
    all.sort_unstable();
    all.dedup();
    all
}

/// The coalescences on the root locus, ascending, in fractions of the range.
fn coalescences<B: Branches<Error = Error>>(
    branches: &mut B,
    locus: &RootLocus,
    names: &[Names],
    farthest: f64,
) -> Result<Vec<Coalescence>, Error> {
    let places = places(locus);
    let mut open: Vec<Candidate> = Vec::new();
    for (place, &at) in places.iter().enumerate() {
        let points: Vec<(usize, BranchPoint)> = locus
            .branches
            .iter()
            .enumerate()
            .filter_map(|(index, branch)| {
                let point = branch.points.binary_search_by(|point| point.0.total_cmp(&at)).ok()?;
                Some((index, branch.points[point].1))
            })
            .collect();
        let before = if place == 0 { 0.0 } else { places[place - 1] };
        let after = places.get(place + 1).copied().unwrap_or(1.0);
        for candidate in candidates(at, &points, [before, after], farthest) {
            add(candidate, &mut open);
        }
    }
    let mut found: Vec<(Coalescence, Complex<f64>)> = Vec::new();
    for candidate in open {
        let Some(branch_point) = settle(branches, &candidate, farthest)? else { continue };
        let (at, lambda) = (branch_point.at, branch_point.lambda);
        let same = |other: &(Coalescence, Complex<f64>)| {
            (other.1 - at).norm() <= SAME_BRANCH_POINT
                && (other.0.omega - lambda.im).abs() <= SAME_BRANCH_POINT * lambda.im.abs()
        };
        if found.iter().any(same) {
            continue;
        }
        let modes = candidate.branches.map(|branch| ModeLabel::candidates(&names[branch]));
        let coalescence = Coalescence {
            at: at.re,
            distance: at.im.abs(),
            error: branch_point.error,
            omega: lambda.im,
            growth: lambda.re,
            modes,
        };
        found.push((coalescence, at));
    }
    found.sort_by(|a, b| a.0.at.total_cmp(&b.0.at).then(a.0.omega.total_cmp(&b.0.omega)));
    Ok(found.into_iter().map(|(coalescence, _)| coalescence).collect())
}
