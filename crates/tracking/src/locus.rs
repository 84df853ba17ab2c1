//! The root locus: eigenvalues over one real parameter, joined to branches as far as the links between them are clear.

use num_complex::Complex;

use crate::TrackingError;
use crate::branch::{BranchPoint, Branches, FIRST_STEPS, first_steps, is_equal, link};
use crate::error::check_interval;

/// Number of steps within one first step after which the rest of it, towards its upper end, is not halved any more; chosen: where the links of
/// modes that are equal, or keep no distance, stay in doubt over a whole interval, no step tells these modes apart.
const MOST_STEPS: usize = 512;

/// A branch of a root locus.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize)]
pub struct Branch {
    /// Parameter, and the eigenvalue there with its derivative by the parameter; ascending in the parameter, denser where branches turn or come
    /// near each other.
    pub points: Vec<(f64, BranchPoint)>,
}

/// A step of the parameter over which branches cannot be continued, because a coalescence lies in the step or near it, or because a mode becomes
/// overdamped in it or oscillates again.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Ambiguity {
    /// Parameter at the lower end of the step.
    pub from: f64,
    /// Parameter at the upper end of the step.
    pub to: f64,
    /// Indices of the branches that end at `from`.
    pub before: Vec<usize>,
    /// Indices of the branches that begin at `to`: each may continue any branch of `before`. They are as many as those of `before`, unless a mode
    /// becomes overdamped in the step or oscillates again.
    pub after: Vec<usize>,
}

/// Root locus: all branches on an interval.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize)]
pub struct RootLocus {
    /// Branches: first those that begin at the lower end of the interval, ascending in frequency; then those that begin
    /// after an ambiguity.
    pub branches: Vec<Branch>,
    /// The steps in which branches end and others begin, ascending.
    pub ambiguities: Vec<Ambiguity>,
}

/// A step of the parameter with the links between the modes at its ends.
struct LocusStep {
    /// Parameter at the upper end.
    to: f64,
    /// Number of modes at the upper end.
    count: usize,
    /// For each mode at the lower end, the index of the mode at the upper end that continues it; `None` where no link is clear.
    links: Vec<Option<usize>>,
}

/// The root locus between two values of the parameter. A step is halved until all its links are clear; it is not halved where it is no longer than
/// `smallest`, in the unit of the parameter, or where its first step has been divided into `MOST_STEPS` steps. What is in doubt then is an
/// [`Ambiguity`].
///
/// # Errors
/// Errors of the branches; [`TrackingError::Interval`].
pub fn root_locus<B>(branches: &mut B, from: f64, to: f64, smallest: f64) -> Result<RootLocus, B::Error>
where
    B: Branches + ?Sized,
    B::Error: From<TrackingError>,
{
    root_locus_in_steps(branches, [from, to], FIRST_STEPS, smallest)
}

/// The root locus as by [`root_locus`], with the interval divided into `first` equal steps before any of them is halved: fewer serve where the
/// interval is a small part of what is of interest.
///
/// # Errors
/// As [`root_locus`].
pub fn root_locus_in_steps<B>(
    branches: &mut B,
    [from, to]: [f64; 2],
    first: usize,
    smallest: f64,
) -> Result<RootLocus, B::Error>
where
    B: Branches + ?Sized,
    B::Error: From<TrackingError>,
{
    check_interval(from, to)?;
    let mut steps = Vec::new();
    for [a, b] in first_steps(from, to, first) {
        let mut in_step = Vec::new();
        subdivide(branches, a, b, smallest, &mut in_step)?;
        steps.append(&mut in_step);
    }
    let count = branches.lambdas(from)?.len();
    let mut locus = RootLocus { branches: vec![Branch::default(); count], ambiguities: Vec::new() };
    // `here[i]` is the branch that mode i at the parameter `reached` belongs to.
    let (mut reached, mut here): (f64, Vec<usize>) = (from, (0..count).collect());
    locus.enter(branches, reached, &here)?;
    for LocusStep { to, count, links } in steps {
        here = locus.step([reached, to], &here, (&links, count));
        locus.enter(branches, to, &here)?;
        reached = to;
    }
    Ok(locus)
}

/// Enters the step from `a` to `b` into `steps`, or its halves where a link is not clear.
fn subdivide<B: Branches + ?Sized>(
    branches: &mut B,
    a: f64,
    b: f64,
    smallest: f64,
    steps: &mut Vec<LocusStep>,
) -> Result<(), B::Error> {
    let [from, count] = [branches.lambdas(a)?.len(), branches.lambdas(b)?.len()];
    let mut links = Vec::with_capacity(from);
    let (is_last, mut is_clear) = (b - a <= smallest || steps.len() >= MOST_STEPS, from == count);
    for index in 0..from {
        if !(is_clear || is_last) {
            break;
        }
        let found = link(branches, a, index, b)?;
        is_clear &= found.is_clear;
        links.push(Some(found.to).filter(|_| found.is_clear));
    }
    share_out_equal(branches.lambdas(b)?, &mut links);
    if is_last || is_clear {
        steps.push(LocusStep { to: b, count, links });
        return Ok(());
    }
    let middle = 0.5 * (a + b);
    subdivide(branches, a, middle, smallest, steps)?;
    subdivide(branches, middle, b, smallest, steps)
}

/// Links that lead to one eigenvalue together are shared out among the eigenvalues that are equal to it, one each; a link becomes `None` where no
/// equal eigenvalue is left.
fn share_out_equal(lambdas: &[Complex<f64>], links: &mut [Option<usize>]) {
    for index in 0..links.len() {
        let Some(mode) = links[index] else { continue };
        if links[..index].contains(&Some(mode)) {
            let is_free = |other: &usize| !links.contains(&Some(*other)) && is_equal(lambdas[*other], lambdas[mode]);
            links[index] = (0..lambdas.len()).find(is_free);
        }
    }
}

impl RootLocus {
    /// Enters the eigenvalues at a parameter; mode i there belongs to the branch `branch_of[i]`.
    fn enter<B: Branches + ?Sized>(&mut self, branches: &mut B, at: f64, branch_of: &[usize]) -> Result<(), B::Error> {
        for (index, &branch) in branch_of.iter().enumerate() {
            self.branches[branch].points.push((at, branches.point(at, index)?));
        }
        Ok(())
    }

    /// Carries the branches over the step between the parameters `from` and `to`: the branch of each mode at `to`, from the branches `here` at `from`,
    /// the links and the number of modes at `to`. A mode that no link leads to begins a new branch; the step is an [`Ambiguity`] where a branch ends
    /// or begins.
    fn step(&mut self, [from, to]: [f64; 2], here: &[usize], (links, count): (&[Option<usize>], usize)) -> Vec<usize> {
        let mut there: Vec<Option<usize>> = vec![None; count];
        let mut before = Vec::new();
        for (&branch, link) in here.iter().zip(links) {
            match link {
                Some(mode) => there[*mode] = Some(branch),
                None => before.push(branch),
            }
        }
        let mut after = Vec::new();
        let there = there.into_iter().map(|branch| branch.unwrap_or_else(|| self.begin(&mut after))).collect();
        if !(before.is_empty() && after.is_empty()) {
            self.ambiguities.push(Ambiguity { from, to, before, after });
        }
        there
    }

    /// Begins a branch without points: its index, which is also appended to `after`.
    fn begin(&mut self, after: &mut Vec<usize>) -> usize {
        self.branches.push(Branch::default());
        after.push(self.branches.len() - 1);
        self.branches.len() - 1
    }
}
