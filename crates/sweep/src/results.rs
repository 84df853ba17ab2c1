//! Results of a sweep over one parameter.

use cea::Threshold;
use num_complex::Complex;
use tracking::{Ambiguity, BranchPoint};

use super::changes::{GrowingBeside, Marginal};
use super::coalescence::Coalescence;
use super::family::Evaluations;
use study::ModeLabel;

use super::names::Names;
use super::opening::Opening;
use super::parameter::SweptParameter;
use super::sweep_onset::SweepOnset;

/// A branch of the root locus.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct NamedBranch {
    /// Candidates for the name of the mode: "16", or "16|20" where a coalescence leaves it open, or "?".
    pub mode: String,
    /// Values of the parameter, ascending, each with the eigenvalue there and its derivative.
    pub points: Vec<(f64, BranchPoint)>,
}

/// A place where spectra count other unstable modes than the onsets up to there: a change before it is not among them, or one too many is.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Miscount {
    /// Value of the parameter.
    pub at: f64,
    /// Number of unstable modes by the spectrum.
    pub by_spectrum: usize,
    /// Number of unstable modes by the onsets.
    pub by_onsets: i64,
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
    /// Number of unstable modes at the upper end, by its spectrum.
    pub unstable_at_end: usize,
    /// Places where spectra count other unstable modes than the onsets up to there.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub miscounts: Vec<Miscount>,
    /// Modes that grow below the band that is studied, and above it, where they do not count; `None` where none grows, and of a brake all of whose modes
    /// are studied.
    pub growing_beside: [Option<GrowingBeside>; 2],
    /// True if divergence was looked for; of a reduced brake it is not.
    pub counts_divergence: bool,
    /// Openings, ascending: places at which contact points open or close, between which branches are smooth.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub openings: Vec<Opening>,
    /// Number of equal steps at which contact points were asked for their state; `None` where the brake has none that open.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub opening_steps: Option<usize>,
    /// Number of equal steps at whose ends unstable modes were counted with loss factors, in the place of which branches are followed with dashpots; `None` of a
    /// brake without.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loss_steps: Option<usize>,
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

impl Sweep {
    /// Enters a miscount where a spectrum counts another number of unstable modes at a place than the onsets found so far, corrected by the miscounts so
    /// far. All of them must be below the place.
    pub(super) fn compare(&mut self, at: f64, by_spectrum: usize) {
        let known: i64 = self.miscounts.iter().map(|miscount| miscount.by_spectrum as i64 - miscount.by_onsets).sum();
        let changes: i64 = self.onsets.iter().map(SweepOnset::by).sum();
        let by_onsets = self.unstable_at_start as i64 + changes + known;
        if by_onsets != by_spectrum as i64 {
            self.miscounts.push(Miscount { at, by_spectrum, by_onsets });
        }
    }

    /// Takes the counts of a brake with loss factors, where branches and onsets are of a system with dashpots in their place: at values of the parameter,
    /// ascending over the range, the number of modes that are unstable for certain and of those that may be. Places where the onsets up to there say
    /// another number are miscounts.
    pub(super) fn compare_with_losses(&mut self, counts: &[(f64, [usize; 2])]) {
        let (Some((_, first)), Some((_, last))) = (counts.first(), counts.last()) else {
            return;
        };
        self.loss_steps = Some(counts.len() - 1);
        self.unstable_at_start = self.unstable_at_start.clamp(first[0], first[1]);
        self.unstable_at_end = self.unstable_at_end.clamp(last[0], last[1]);
        for &(at, [least, most]) in counts {
            let known = self.miscounts.iter().filter(|miscount| miscount.at <= at);
            let known: i64 = known.map(|miscount| miscount.by_spectrum as i64 - miscount.by_onsets).sum();
            let changes: i64 = self.onsets.iter().filter(|onset| onset.at <= at).map(SweepOnset::by).sum();
            let by_onsets = self.unstable_at_start as i64 + changes + known;
            let by_spectrum = by_onsets.clamp(least as i64, most as i64);
            if by_onsets != by_spectrum {
                self.miscounts.push(Miscount { at, by_spectrum: by_spectrum as usize, by_onsets });
            }
        }
    }

    /// Sweep without results, to which [`Self::joined`] adds those of sectors or of pieces.
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
            unstable_at_end: 0,
            miscounts: Vec::new(),
            growing_beside: [None; 2],
            counts_divergence: true,
            openings: Vec::new(),
            opening_steps: None,
            loss_steps: None,
            marginal: Vec::new(),
            steps: usize::MAX,
            evaluations: Evaluations::default(),
            fine_grid: 0,
        }
    }

    /// The sweep of the sectors, or of the pieces, so far together with that of another one. Openings, the numbers of steps for openings and for loss
    /// factors, and the fine grid are not taken from the other one.
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
        self.unstable_at_end += other.unstable_at_end;
        self.miscounts.extend(other.miscounts);
        let both = |end: usize| {
            [self.growing_beside[end], other.growing_beside[end]].into_iter().flatten().reduce(GrowingBeside::with)
        };
        self.growing_beside = [0, 1].map(both);
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
        Self { mode: ModeLabel::candidates(names), points: branch.points.into_iter().map(point).collect() }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::change::ChangeOf;

    /// One mode more from 0.3 on, by the branches; with loss factors another one between 0.5 and 0.7, and at the end one that may be.
    #[test]
    fn counts_with_loss_factors_correct_those_of_the_onsets() {
        let parameter = SweptParameter {
            name: "mu".into(),
            unit: "1".into(),
            from: 0.0,
            to: 1.0,
            is_logarithmic: false,
            median: 0.5,
            place: 0,
        };
        let mut sweep = Sweep::empty(parameter, Threshold::default());
        sweep.onsets.push(SweepOnset {
            at: 0.3,
            error: 0.0,
            omega: 1.0,
            growth: 0.0,
            starts: true,
            of: ChangeOf::Flutter,
            mode: "1".into(),
            unstable: 1,
            moved: None,
            is_reduced: false,
            jump: None,
        });
        let counts = [(0.0, [1, 1]), (0.25, [1, 1]), (0.5, [3, 3]), (0.75, [2, 2]), (1.0, [2, 3])];
        sweep.compare_with_losses(&counts);
        assert_eq!((sweep.loss_steps, sweep.unstable_at_start), (Some(4), 1));
        let miscount = |at, by_spectrum, by_onsets| Miscount { at, by_spectrum, by_onsets };
        assert_eq!(sweep.miscounts, [miscount(0.5, 3, 2), miscount(0.75, 2, 3)]);
    }
}
