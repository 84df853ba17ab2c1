//! The root locus: eigenvalues over one real parameter, each as far as it is known to be one branch.

use crate::TrackingError;
use crate::branch::{BranchPoint, Branches, first_steps, link};
use crate::error::check_interval;

/// One branch of a root locus.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Branch {
    /// Its eigenvalue at each parameter, ascending: denser where branches turn or come near each other.
    pub points: Vec<(f64, BranchPoint)>,
}

/// A step over which it has no answer which branch continues which: a coalescence lies in it or too near to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Ambiguity {
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// The branches that end there, as indices.
    pub before: Vec<usize>,
    /// The branches that begin there, as many: each may continue any of those.
    pub after: Vec<usize>,
}

/// All branches on an interval.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RootLocus {
    /// First those at the lower end of the interval, ascending in frequency, then those that begin after an ambiguity.
    pub branches: Vec<Branch>,
    /// Where branches end and others begin, ascending.
    pub ambiguities: Vec<Ambiguity>,
}

/// A step, and the mode at its end that each at its beginning becomes, where that is clear.
struct LocusStep {
    to: f64,
    links: Vec<Option<usize>>,
}

/// The root locus from one parameter to another, in steps that are halved until all links are clear, or shorter than the
/// `smallest`.
///
/// # Errors
/// Those of the branches; [`TrackingError::Interval`].
pub fn root_locus<B>(branches: &mut B, from: f64, to: f64, smallest: f64) -> Result<RootLocus, B::Error>
where
    B: Branches + ?Sized,
    B::Error: From<TrackingError>,
{
    check_interval(from, to)?;
    let mut steps = Vec::new();
    for [a, b] in first_steps(from, to) {
        subdivide(branches, a, b, smallest, &mut steps)?;
    }
    let count = branches.lambdas(from)?.len();
    let mut locus = RootLocus { branches: vec![Branch::default(); count], ambiguities: Vec::new() };
    // The branch of each mode at the parameter reached.
    let (mut reached, mut here): (f64, Vec<usize>) = (from, (0..count).collect());
    locus.enter(branches, reached, &here)?;
    for LocusStep { to, links } in steps {
        here = locus.step([reached, to], &here, &links);
        locus.enter(branches, to, &here)?;
        reached = to;
    }
    Ok(locus)
}

/// Halves a step until all its links are clear.
fn subdivide<B: Branches + ?Sized>(
    branches: &mut B,
    a: f64,
    b: f64,
    smallest: f64,
    steps: &mut Vec<LocusStep>,
) -> Result<(), B::Error> {
    let count = branches.lambdas(a)?.len();
    let mut links = Vec::with_capacity(count);
    for index in 0..count {
        let link = link(branches, a, index, b)?;
        links.push(Some(link.to).filter(|_| link.is_clear));
    }
    if b - a <= smallest || links.iter().all(Option::is_some) {
        steps.push(LocusStep { to: b, links });
        return Ok(());
    }
    let middle = 0.5 * (a + b);
    subdivide(branches, a, middle, smallest, steps)?;
    subdivide(branches, middle, b, smallest, steps)
}

impl RootLocus {
    /// Enters the eigenvalues at a parameter, of modes whose branches are given.
    fn enter<B: Branches + ?Sized>(&mut self, branches: &mut B, at: f64, of: &[usize]) -> Result<(), B::Error> {
        for (index, &branch) in of.iter().enumerate() {
            self.branches[branch].points.push((at, branches.point(at, index)?));
        }
        Ok(())
    }

    /// The branches of the modes at the end of a step; those without a clear link begin anew.
    fn step(&mut self, [from, to]: [f64; 2], here: &[usize], links: &[Option<usize>]) -> Vec<usize> {
        let mut there: Vec<Option<usize>> = vec![None; here.len()];
        let mut before = Vec::new();
        for (&branch, link) in here.iter().zip(links) {
            match link {
                Some(to) => there[*to] = Some(branch),
                None => before.push(branch),
            }
        }
        let mut after = Vec::new();
        let there = there.into_iter().map(|branch| branch.unwrap_or_else(|| self.begin(&mut after))).collect();
        if !before.is_empty() {
            self.ambiguities.push(Ambiguity { from, to, before, after });
        }
        there
    }

    fn begin(&mut self, after: &mut Vec<usize>) -> usize {
        self.branches.push(Branch::default());
        after.push(self.branches.len() - 1);
        self.branches.len() - 1
    }
}
