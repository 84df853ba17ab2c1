//! Following modes by continuation from one system to another.
//!
//! MAC straight between two far states is too weak: from nine oscillators in contact to six its median is 0.53.
//! Between *near* states it is strong, so the way from one system to the other is walked in steps that are cut again
//! until every match is beyond doubt. A pair that stays in doubt at the smallest step passes so near a coalescence
//! that which of the two is which has no answer; such modes are reported with all their candidates, never guessed.

use std::borrow::Cow;

use cea::{CeaError, EigenSolver, Line, Mode, Workspace};
use linsys::{Internal, SecondOrder};
use nalgebra::DMatrix;

use crate::mac::{Match, match_modes};
use crate::trace::trace;
use crate::walk::Walk;

/// Places on the way at which a system that is not known to be near is looked at in any case.
const STATIONS: usize = 7;

/// The beginning of a way.
#[derive(Debug, Clone, Copy)]
pub enum Start<'a> {
    /// A system.
    System(&'a SecondOrder),
    /// A structure with a gain, where the end of the way is that structure with another one: cheaper to follow.
    Line(Line<'a>),
}

/// From some modes of one system to another system whose modes are known.
///
/// The way is the straight line `Q(lambda, t) = (1 - t) Q_from(lambda) + t Q_to(lambda)`, 0 <= t <= 1, between two systems with
/// as many degrees of freedom; internal states may differ, in number too. Where the systems differ in the stiffness of a
/// contact, this is the continuation in that stiffness.
#[derive(Debug, Clone, Copy)]
pub struct Way<'a> {
    /// The system at the beginning, and those of its modes that are asked for.
    pub from: (Start<'a>, &'a [Mode]),
    /// The system at the end, and its modes.
    pub to: (&'a SecondOrder, &'a [Mode]),
}

impl<'a> Way<'a> {
    /// A system with the mass at the beginning.
    pub(crate) fn inertia(&self) -> &'a SecondOrder {
        match self.from.0 {
            Start::System(system) => system,
            Start::Line(line) => line.secular.structure(),
        }
    }

    /// The systems at both ends, where the way is not known as a line.
    pub(crate) fn systems(&self) -> Option<[&'a SecondOrder; 2]> {
        match self.from.0 {
            Start::System(from) => Some([from, self.to.0]),
            Start::Line(_) => None,
        }
    }

    pub(crate) fn line(&self) -> Option<Line<'a>> {
        match self.from.0 {
            Start::System(_) => None,
            Start::Line(line) => Some(line),
        }
    }

    /// The system at t. It has the states of both ends, whose forces come and go.
    pub(crate) fn system(&self, t: f64) -> SecondOrder {
        let (from, to) = match self.from.0 {
            Start::System(system) => (Cow::Borrowed(system), self.to.0),
            Start::Line(line) => (Cow::Owned(line.secular.system(&line.from)), self.to.0),
        };
        let mix = |a: &DMatrix<f64>, b: &DMatrix<f64>| a.zip_map(b, |a, b| (1.0 - t) * a + t * b);
        let (n, first, all) = (from.order(), from.states(), from.states() + to.states());
        let mut internal = Internal::zeros(n, all);
        for (end, at, part) in [(&from.internal, 0, 1.0 - t), (&to.internal, first, t)] {
            let states = end.decay.len();
            internal.decay.rows_mut(at, states).copy_from(&end.decay);
            internal.drive.rows_mut(at, states).copy_from(&end.drive);
            internal.force.columns_mut(at, states).copy_from(&(&end.force * part));
        }
        SecondOrder { m: mix(&from.m, &to.m), c: mix(&from.c, &to.c), k: mix(&from.k, &to.k), internal }
    }
}

/// For each mode at the beginning of a way, the indices of those that it may have become: one where it is known,
/// none where it ceased to oscillate.
pub type Links = Vec<Vec<usize>>;

/// Follows the modes all the way.
///
/// # Errors
/// Those of the solver and of the eigenvectors on the way.
pub fn follow(solver: &dyn EigenSolver, way: Way<'_>, work: &mut Workspace) -> Result<Links, CeaError> {
    link_all(solver, &[way], false, work).remove(0)
}

/// Which of the known modes the modes at the beginning are: by MAC where that is beyond doubt, by following those
/// where it is not.
///
/// # Errors
/// As [`follow`].
pub fn identify(solver: &dyn EigenSolver, way: Way<'_>, work: &mut Workspace) -> Result<Links, CeaError> {
    identify_all(solver, &[way], work).remove(0)
}

/// [`identify`] on many ways, one result each: what has to be followed shares the solver's lanes.
pub fn identify_all(solver: &dyn EigenSolver, ways: &[Way<'_>], work: &mut Workspace) -> Vec<Result<Links, CeaError>> {
    link_all(solver, ways, true, work)
}

/// Links all modes: by MAC where it is beyond doubt and the systems are `near`; those left traced each by its derivative;
/// and those that are then left walked with all their rivals.
fn link_all(
    solver: &dyn EigenSolver,
    ways: &[Way<'_>],
    near: bool,
    work: &mut Workspace,
) -> Vec<Result<Links, CeaError>> {
    let by_mac = |way: &Way<'_>| -> Vec<Option<usize>> {
        let clear = |found: Match| found.to.filter(|_| found.is_clear());
        match near {
            true => match_modes(way.from.1, way.to.1, &way.inertia().m).into_iter().map(clear).collect(),
            false => vec![None; way.from.1.len()],
        }
    };
    let mut ends: Vec<Vec<Option<usize>>> = ways.iter().map(by_mac).collect();
    let places = ends.iter().enumerate().flat_map(|(at, ends)| (0..ends.len()).map(move |i| (at, i)));
    let in_doubt: Vec<(usize, usize)> = places.filter(|&(at, i)| ends[at][i].is_none()).collect();
    work.counters.continuations += in_doubt.len() as u64;

    let to_trace: Vec<(Way<'_>, &Mode)> = in_doubt.iter().map(|&(at, i)| (ways[at], &ways[at].from.1[i])).collect();
    for (&(at, i), end) in in_doubt.iter().zip(trace(&to_trace, near, work)) {
        ends[at][i] = end;
    }
    // Two modes do not become one.
    let is_sure = |&(at, i): &(usize, usize)| {
        ends[at][i].is_some_and(|to| ends[at].iter().filter(|end| **end == Some(to)).count() == 1)
    };
    let lost: Vec<(usize, usize)> = in_doubt.into_iter().filter(|doubt| !is_sure(doubt)).collect();
    lost.iter().for_each(|&(at, i)| ends[at][i] = None);
    let lost: Vec<Lost> = lost.chunk_by(|a, b| a.0 == b.0).map(|of_way| Lost::new(of_way, ways, &ends)).collect();
    let stations = if near { 0 } else { STATIONS };
    let walks = lost.iter().map(|lost| Walk::new(lost.way(ways), lost.start(ways), stations)).collect();
    let found = Walk::all(solver, walks, work);

    let sure = |ends: Vec<Option<usize>>| Ok(ends.into_iter().map(|end| end.into_iter().collect()).collect());
    let mut links: Vec<Result<Links, CeaError>> = ends.into_iter().map(sure).collect();
    for (lost, found) in lost.iter().zip(found) {
        match (&mut links[lost.at], found) {
            (Ok(links), Ok(found)) => lost.modes.iter().zip(found).for_each(|(&i, to)| links[i] = lost.original(&to)),
            (links, Err(error)) => *links = Err(error),
            (Err(_), Ok(_)) => {}
        }
    }
    links
}

/// Modes of one way that have to be walked, and the known modes that no other one became.
struct Lost {
    /// Index of the way.
    at: usize,
    /// Indices of the modes at its beginning.
    modes: Vec<usize>,
    left: Vec<Mode>,
    /// Index of each of `left` among all known modes.
    originals: Vec<usize>,
}

impl Lost {
    fn new(of_way: &[(usize, usize)], ways: &[Way<'_>], ends: &[Vec<Option<usize>>]) -> Self {
        let (at, modes) = (of_way[0].0, of_way.iter().map(|&(_, i)| i).collect());
        let is_left = |to: usize| !ends[at].contains(&Some(to));
        let (left, originals) = ways[at].to.1.iter().cloned().zip(0..).filter(|&(_, to)| is_left(to)).unzip();
        Self { at, modes, left, originals }
    }

    fn way<'a>(&'a self, ways: &[Way<'a>]) -> Way<'a> {
        let Way { to: (end, _), .. } = ways[self.at];
        Way { to: (end, &self.left), ..ways[self.at] }
    }

    fn start(&self, ways: &[Way<'_>]) -> Vec<Mode> {
        self.modes.iter().map(|&i| ways[self.at].from.1[i].clone()).collect()
    }

    fn original(&self, to: &[usize]) -> Vec<usize> {
        to.iter().map(|&to| self.originals[to]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cea::{Modes, QrSolver};
    use nalgebra::{DVector, dmatrix};
    use num_complex::Complex;

    fn modes(system: &SecondOrder) -> Vec<Mode> {
        let mut work = Workspace::default();
        let spectrum = QrSolver.eigenvalues(system, &mut work).unwrap();
        Mode::at(system, &Modes::classify(system, &spectrum, &mut work).unwrap().oscillatory, &mut work).unwrap()
    }

    fn diagonal(k: &[f64]) -> SecondOrder {
        let n = k.len();
        let stiffness = DMatrix::from_diagonal(&DVector::from_column_slice(k));
        SecondOrder::new(DMatrix::identity(n, n), DMatrix::identity(n, n) * 0.01, stiffness).unwrap()
    }

    fn linked(from: &SecondOrder, to: &SecondOrder) -> Vec<Vec<usize>> {
        let way = Way { from: (Start::System(from), &modes(from)), to: (to, &modes(to)) };
        follow(&QrSolver, way, &mut Workspace::default()).unwrap()
    }

    #[test]
    fn uncoupled_modes_cross_and_keep_their_names() {
        assert_eq!(linked(&diagonal(&[1.0, 4.0, 9.0]), &diagonal(&[6.0, 3.0, 9.0])), [vec![1], vec![0], vec![2]]);
    }

    #[test]
    fn weakly_coupled_modes_veer_and_exchange_shapes() {
        let coupled = |a: f64, b: f64| {
            let k = dmatrix![a, 0.4; 0.4, b];
            SecondOrder::new(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), k).unwrap()
        };
        // MAC alone, straight from end to end, would say [1], [0].
        assert_eq!(linked(&coupled(1.0, 4.0), &coupled(4.0, 1.0)), [vec![0], vec![1]]);
    }

    #[test]
    fn through_a_coalescence_nothing_is_guessed() {
        // k12 k21 < 0: as the diagonal crosses, the pair meets at an exceptional point twice.
        let flutter = |a: f64, b: f64| {
            let k = dmatrix![a, 0.5, 0.0; -0.5, b, 0.0; 0.0, 0.0, 50.0];
            SecondOrder::new(DMatrix::identity(3, 3), DMatrix::zeros(3, 3), k).unwrap()
        };
        assert_eq!(linked(&flutter(5.0, 10.0), &flutter(10.0, 5.0)), [vec![0, 1], vec![0, 1], vec![2]]);
    }

    #[test]
    fn a_double_eigenvalue_is_one_group_and_costs_no_small_steps() {
        let (from, to) = (diagonal(&[4.0, 4.0, 9.0]), diagonal(&[4.1, 4.1, 9.0]));
        let mut work = Workspace::default();
        let way = Way { from: (Start::System(&from), &modes(&from)), to: (&to, &modes(&to)) };
        let links = follow(&QrSolver, way, &mut work).unwrap();
        assert_eq!(links[2], [2]);
        assert_eq!(work.counters.eigenvalue_solves, STATIONS as u64);
    }

    #[test]
    fn internal_states_of_the_ends_come_and_go() {
        let plain = diagonal(&[1.0, 4.0]);
        let mut other = SecondOrder::zeros(2, 1);
        (other.m, other.c, other.k) = (plain.m.clone(), plain.c.clone(), diagonal(&[2.0, 3.0]).k);
        other.internal.decay[0] = 3.0;
        other.internal.drive[(0, 1)] = 1.0;
        other.internal.force[(1, 0)] = 0.5;
        let way = Way { from: (Start::System(&other), &[]), to: (&plain, &[]) };
        let lambda = Complex::new(-0.1, 1.7);
        for t in [0.0, 0.3, 1.0] {
            let line = other.dynamic_stiffness(lambda) * Complex::from(1.0 - t)
                + plain.dynamic_stiffness(lambda) * Complex::from(t);
            assert!((way.system(t).dynamic_stiffness(lambda) - line).norm() < 1e-14);
        }
        assert_eq!(linked(&plain, &other), [vec![0], vec![1]]);
        assert_eq!(linked(&other, &plain), [vec![0], vec![1]]);
    }
}
