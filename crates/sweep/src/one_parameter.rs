//! A sweep over one parameter: branches with names, onsets, coalescences.

use cea::{EigenSolver, Threshold};
use montecarlo::Progress;
use num_complex::Complex;
use rayon::prelude::*;
use study::{Reference, Study, UncertainBrake};
use tracking::{Ambiguity, BranchPoint, Branches, Onset, RootLocus, root_locus};

use super::change::{Along, Change, ChangeOf};
use super::changes::{Changes, Marginal};
use super::coalescence::{Candidate, Coalescence, add, candidates, settle};
use super::divergence::DIVERGENCE;
use super::family::{DIFFERENCE, Evaluations, Family, Line, Part, SHORTEST_LOCUS_STEP};
use super::names::{Names, carry, in_words, names_at};
use super::onset::{SweepOnset, WholeOnset, error_of_reduced};
use super::parameter::{Over, SweptParameter};
use crate::Error;

/// Largest distance of two branch points that are one, found twice: of the parameter as a fraction of the range, of omega as a fraction of
/// omega; chosen.
const SAME_BRANCH_POINT: f64 = 1e-6;

/// Pairs of a number of eigenvalues, 2 n + s, and the number of equal steps of the range at which the unstable modes of systems up to that
/// size are counted; chosen: the time that a sweep may take on a desk. Larger systems have [`FEWEST_STEPS`].
const STEPS: [(usize, usize); 2] = [(160, 1024), (480, 256)];
/// Number of equal steps for the largest brakes; chosen.
const FEWEST_STEPS: usize = 64;

/// A branch of the root locus.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct NamedBranch {
    /// Candidates for the name of the mode: "16", or "16|20" where a coalescence leaves it open, or "?".
    pub mode: String,
    /// Values of the parameter, ascending, each with the eigenvalue there and its derivative.
    pub points: Vec<(f64, BranchPoint)>,
}

/// Results of a sweep over one parameter.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Sweep {
    /// Parameter that is swept.
    pub parameter: SweptParameter,
    /// Instability threshold of a mode, which onsets cross.
    pub threshold: Threshold,
    /// Branches, as [`RootLocus`] has them.
    pub branches: Vec<NamedBranch>,
    /// Steps in which branches end and others begin.
    pub ambiguities: Vec<Ambiguity>,
    /// Onsets, ascending.
    pub onsets: Vec<SweepOnset>,
    /// Steps in which a mode comes so near the threshold that it is not known whether it crosses.
    pub unresolved: Vec<(f64, f64)>,
    /// Coalescences, ascending.
    pub coalescences: Vec<Coalescence>,
    /// Number of unstable modes at the lower end: pairs that flutter, and real eigenvalues that diverge.
    pub unstable_at_start: usize,
    /// Number of real eigenvalues that diverge at the lower end, among the unstable modes.
    pub diverging_at_start: usize,
    /// Divergence was looked for; of a reduced brake it is not.
    pub counts_divergence: bool,
    /// Ranges in which modes are on the axis, and so neither grow nor decay: without damping, conservative gyroscopic, rigid motions.
    pub marginal: Vec<Marginal>,
    /// Number of equal steps of the range at which unstable modes were counted: changes that are farther apart than one of them are all
    /// found.
    pub steps: usize,
    /// Numbers of spectra, vectors and eigenvalues computed.
    pub evaluations: Evaluations,
    /// Shortest step of a branch, as a fraction of the range.
    pub shortest_step: f64,
    /// Number of spectra that a grid of equal steps as short as the shortest would take, all sectors together, to compare with
    /// `evaluations`.
    pub fine_grid: u64,
}

/// Sweeps one parameter of a scene of a study. Only modes that oscillate have branches: one that becomes overdamped, or diverges, ends.
///
/// # Errors
/// A parameter or range that the scene does not have, a value that the brake refuses, and those of [`root_locus`].
pub fn sweep<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    over: &Over,
    solver: &dyn EigenSolver,
    progress: &dyn Progress,
) -> Result<Sweep, Error> {
    let family = Family::new(study, scene, std::slice::from_ref(over), solver, progress)?;
    let parameter = family.parameters[0].clone();
    let parts = family.parts()?;
    progress.begin(parts.len() as u64, 0);
    let of_part = |part: &Part<'_, B>| {
        let found = of_part(part, &parameter);
        progress.advance(1);
        found
    };
    let found = parts.par_iter().map(of_part).collect::<Result<Vec<_>, Error>>();
    progress.end();
    let in_words = |source: Error| source.in_sweep(|| format!("sweep over {over}"));
    let mut sweep =
        found.map_err(in_words)?.into_iter().fold(Sweep::empty(parameter, study.plan().threshold), Sweep::joined);
    sweep.onsets.sort_by(|a, b| a.at.total_cmp(&b.at));
    sweep.ambiguities.sort_by(|a, b| a.from.total_cmp(&b.from));
    sweep.coalescences.sort_by(|a, b| a.at.total_cmp(&b.at));
    sweep.unresolved.sort_by(|a, b| a.0.total_cmp(&b.0));
    sweep.marginal.sort_by(|a, b| a.from.total_cmp(&b.from));
    let mut unstable = sweep.unstable_at_start as i64;
    for onset in &mut sweep.onsets {
        unstable += if onset.starts { 1 } else { -1 };
        onset.unstable = unstable.max(0) as usize;
    }
    sweep.fine_grid = ((1.0 / sweep.shortest_step).ceil() as u64 + 1) * parts.len() as u64;
    Ok(sweep)
}

impl Sweep {
    fn empty(parameter: SweptParameter, threshold: Threshold) -> Self {
        Self {
            threshold,
            shortest_step: 1.0,
            parameter,
            branches: Vec::new(),
            ambiguities: Vec::new(),
            onsets: Vec::new(),
            unresolved: Vec::new(),
            coalescences: Vec::new(),
            unstable_at_start: 0,
            diverging_at_start: 0,
            counts_divergence: true,
            marginal: Vec::new(),
            steps: usize::MAX,
            evaluations: Evaluations::default(),
            fine_grid: 0,
        }
    }

    /// The sweep of some sectors with that of another one.
    fn joined(mut self, other: Self) -> Self {
        let first = self.branches.len();
        let shifted = |branches: Vec<usize>| branches.into_iter().map(|branch| first + branch).collect();
        self.ambiguities.extend(other.ambiguities.into_iter().map(|ambiguity| Ambiguity {
            before: shifted(ambiguity.before),
            after: shifted(ambiguity.after),
            ..ambiguity
        }));
        self.branches.extend(other.branches);
        self.onsets.extend(other.onsets);
        self.unresolved.extend(other.unresolved);
        self.coalescences.extend(other.coalescences);
        self.unstable_at_start += other.unstable_at_start;
        self.diverging_at_start += other.diverging_at_start;
        self.counts_divergence &= other.counts_divergence;
        self.marginal.extend(other.marginal);
        self.steps = self.steps.min(other.steps);
        self.evaluations += other.evaluations;
        self.shortest_step = self.shortest_step.min(other.shortest_step);
        self
    }
}

/// The sweep of one sector.
fn of_part<B: UncertainBrake>(part: &Part<'_, B>, parameter: &SweptParameter) -> Result<Sweep, Error> {
    let (median, threshold) = (part.medians()[0], part.threshold());
    let mut branches = part.along(Line {
        start: vec![0.0],
        direction: vec![1.0],
        bounds: [median.min(0.0), median.max(1.0)],
        difference: DIFFERENCE,
    });
    let system = |at: f64| part.system(&[at]);
    let along = Along::new(&system, &part.family.solver, threshold);
    let steps = steps(part)?;
    let Changes { found: changes, unresolved, marginal, start, spectra } = along.changes(steps)?;
    let locus = part.studied(root_locus(&mut branches, 0.0, 1.0, SHORTEST_LOCUS_STEP)?);
    let places = places(&locus);
    let nearest = |a: &&f64, b: &&f64| (**a - median).abs().total_cmp(&(**b - median).abs());
    let named_at = *places.iter().min_by(nearest).unwrap_or(&0.0);
    let names = branch_names(&mut branches, &locus, part.reference, [median, named_at])?;
    let coalescences = coalescences(&mut branches, &locus, &names)?;
    let mut evaluations = Evaluations::default();
    let mut found = Vec::new();
    for change in changes.into_iter().filter(|change| part.counts(change)) {
        let Change { at, error, lambda, of, starts, .. } = change;
        let omega = if of == ChangeOf::Flutter { lambda.im } else { 0.0 };
        let reduced = Onset { at, error, omega, destabilises: starts };
        let whole = match of {
            ChangeOf::Flutter => WholeOnset::near(part, &reduced, &mut branches)?,
            ChangeOf::Divergence | ChangeOf::Exchange => WholeOnset::NotReduced,
        };
        let (onset, moved, is_reduced) = match whole {
            WholeOnset::NotReduced => (reduced, None, false),
            WholeOnset::Found(onset, solved) => {
                evaluations.whole += solved;
                (onset, Some(parameter.at(onset.at) - parameter.at(reduced.at)), false)
            }
            WholeOnset::NotFound => {
                let error = error_of_reduced(part, &reduced, &mut branches)?;
                (Onset { error, ..reduced }, None, true)
            }
        };
        let mode = match of {
            ChangeOf::Divergence => DIVERGENCE.to_owned(),
            ChangeOf::Flutter | ChangeOf::Exchange => in_words(&names_of_change(&locus, &names, &change)),
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
        });
    }
    evaluations += Evaluations::of(branches.counters());
    evaluations.spectra += spectra;
    let [flutter, diverging_at_start] = part.counted(&start);
    let named = |(branch, names): (tracking::Branch, &Names)| NamedBranch::new(parameter, branch, names);
    let in_values = |ambiguity: Ambiguity| Ambiguity {
        from: parameter.at(ambiguity.from),
        to: parameter.at(ambiguity.to),
        ..ambiguity
    };
    Ok(Sweep {
        onsets: found,
        branches: locus.branches.into_iter().zip(&names).map(named).collect(),
        ambiguities: locus.ambiguities.into_iter().map(in_values).collect(),
        unresolved: unresolved.into_iter().map(|(from, to)| (parameter.at(from), parameter.at(to))).collect(),
        coalescences: coalescences.into_iter().map(|coalescence| coalescence.in_values(parameter)).collect(),
        unstable_at_start: flutter + diverging_at_start,
        diverging_at_start,
        counts_divergence: part.counts_divergence(),
        marginal: marginal.into_iter().map(|range| range.in_values(parameter)).collect(),
        steps,
        evaluations,
        shortest_step: places.windows(2).map(|step| step[1] - step[0]).fold(1.0, f64::min),
        ..Sweep::empty(parameter.clone(), threshold)
    })
}

impl NamedBranch {
    /// The branch over fractions of the range of a parameter, in values of the parameter.
    fn new(parameter: &SweptParameter, branch: tracking::Branch, names: &Names) -> Self {
        let point = |(part, point): (f64, BranchPoint)| {
            (parameter.at(part), BranchPoint { rate: point.rate / parameter.slope(part), ..point })
        };
        Self { mode: in_words(names), points: branch.points.into_iter().map(point).collect() }
    }

    /// The branch between two of its points, `step` and the next: the cubic with their derivatives, at the fraction `part` of
    /// the step.
    pub fn between(&self, step: usize, part: f64) -> (f64, Complex<f64>) {
        let [(from, a), (to, b)] = [self.points[step], self.points[step + 1]];
        let (u, v, h) = (part, 1.0 - part, to - from);
        let first = a.lambda * (1.0 + 2.0 * u) + a.rate * (h * u);
        let last = b.lambda * (1.0 + 2.0 * v) - b.rate * (h * v);
        (from + h * u, first * (v * v) + last * (u * u))
    }
}

/// Places at which branches have points, ascending, as fractions of the range.
fn places(locus: &RootLocus) -> Vec<f64> {
    let mut all: Vec<f64> = locus.branches.iter().flat_map(|branch| &branch.points).map(|point| point.0).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// The names of all branches, from those that they have next to the median.
fn branch_names<B: Branches<Error = Error>>(
    branches: &mut B,
    locus: &RootLocus,
    reference: &Reference,
    [median, named_at]: [f64; 2],
) -> Result<Vec<Names>, Error> {
    let of_modes = names_at(branches, reference, median, named_at)?;
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

/// Number of steps at which the unstable modes of a part are counted.
fn steps<B: UncertainBrake>(part: &Part<'_, B>) -> Result<usize, Error> {
    let system = part.system(&[0.0])?;
    let eigenvalues = 2 * system.order() + system.states();
    Ok(STEPS.iter().find(|(most, _)| eigenvalues <= *most).map_or(FEWEST_STEPS, |(_, steps)| *steps))
}

/// Candidates for the mode of a change. Where a mode becomes real, or real eigenvalues a mode: those of all branches that end, or begin, in
/// its step. Else those of all branches that end in an open step around it; without such a step, of the branch whose tangent passes nearest
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
        for candidate in candidates(at, &points, [before, after]) {
            add(candidate, &mut open);
        }
    }
    let mut found: Vec<(Coalescence, Complex<f64>)> = Vec::new();
    for candidate in open {
        let Some(branch_point) = settle(branches, &candidate)? else { continue };
        let (at, lambda) = (branch_point.at, branch_point.lambda);
        let same = |other: &(Coalescence, Complex<f64>)| {
            (other.1 - at).norm() <= SAME_BRANCH_POINT
                && (other.0.omega - lambda.im).abs() <= SAME_BRANCH_POINT * lambda.im.abs()
        };
        if found.iter().any(same) {
            continue;
        }
        let modes = candidate.branches.map(|branch| in_words(&names[branch]));
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
