//! A sweep over one parameter: branches with names, onsets, coalescences.

use cea::{EigenSolver, Threshold};
use montecarlo::Progress;
use num_complex::Complex;
use rayon::prelude::*;
use study::{Study, UncertainBrake};
use tracking::{Ambiguity, BranchPoint};

use super::changes::Marginal;
use super::coalescence::Coalescence;
use super::family::{Evaluations, Family, Part};
use super::names::{Names, in_words};
use super::onset::SweepOnset;
use super::opening::Opening;
use super::openings::openings;
use super::parameter::{Over, SweptParameter};
use super::part_sweep::{Entry, of_part};
use super::pieces::piecewise;
use super::remembered::Remembered;
use crate::Error;

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
    /// Branches, as `tracking::RootLocus` has them.
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
    /// Openings, ascending: places at which contact points open or close, between which branches are smooth.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub openings: Vec<Opening>,
    /// Number of equal steps at which contact points were asked for their state; `None` where the brake has none that open.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub opening_steps: Option<usize>,
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
/// A parameter or range that the scene does not have, a value that the brake refuses, and those of `tracking::root_locus`.
pub fn sweep<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    over: &Over,
    solver: &dyn EigenSolver,
    progress: &dyn Progress,
) -> Result<Sweep, Error> {
    let remembered = Remembered::new(solver);
    let family = Family::new(study, scene, std::slice::from_ref(over), solver, progress)?;
    let parameter = family.parameters[0].clone();
    let in_words = |source: Error| source.in_sweep(|| format!("sweep over {over}"));
    let median = parameter.part(parameter.median);
    let opened = match family.contact_points()[..] {
        [] => Vec::new(),
        _ => {
            let (closed, value) = (|at: f64| family.closed_points(&[parameter.at(at)]), |at: f64| parameter.at(at));
            openings(&closed, &value, [median.min(0.0), median.max(1.0)]).map_err(in_words)?
        }
    };
    let (mut sweep, parts) = if opened.is_empty() {
        let parts = family.parts()?;
        progress.begin(parts.len() as u64, 0);
        let of_part = |part: &Part<'_, B>| {
            let found = of_part(part, &parameter, &Entry::Medians);
            progress.advance(1);
            Ok(found?.sweep)
        };
        let found = parts.par_iter().map(of_part).collect::<Result<Vec<_>, Error>>();
        progress.end();
        let empty = Sweep::empty(parameter, study.plan().threshold);
        (found.map_err(in_words)?.into_iter().fold(empty, Sweep::joined), parts.len())
    } else {
        let family = family.with_solver(&remembered);
        let mut sweep = piecewise(&family, &opened).map_err(in_words)?;
        sweep.evaluations.spectra = remembered.solved();
        (sweep, 1)
    };
    sweep.opening_steps = (!family.contact_points().is_empty()).then_some(super::openings::OPENING_STEPS);
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
    sweep.fine_grid = ((1.0 / sweep.shortest_step).ceil() as u64 + 1) * parts as u64;
    Ok(sweep)
}

impl Sweep {
    pub(super) fn empty(parameter: SweptParameter, threshold: Threshold) -> Self {
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
            openings: Vec::new(),
            opening_steps: None,
            marginal: Vec::new(),
            steps: usize::MAX,
            evaluations: Evaluations::default(),
            fine_grid: 0,
        }
    }

    /// The sweep of some sectors with that of another one.
    pub(super) fn joined(mut self, other: Self) -> Self {
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

impl NamedBranch {
    /// The branch over fractions of the range of a parameter, in values of the parameter.
    pub(super) fn new(parameter: &SweptParameter, branch: tracking::Branch, names: &Names) -> Self {
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
