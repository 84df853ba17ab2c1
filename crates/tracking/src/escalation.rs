//! The escalation: each mode is followed by the cheapest method that identifies it.
//!
//! MAC between the modes of two distant systems is too weak: from nine oscillators in contact to six its median is 0.53. Between
//! *near* systems MAC identifies most modes. A mode that MAC leaves in doubt is continued along the path by its derivative; a
//! mode that continuation loses is followed by subdivision, in steps that are cut until every match is clear. Two modes that
//! are in doubt at the shortest step pass so near a coalescence that they cannot be told apart; each is reported with all its
//! candidates.

use cea::{CeaError, EigenSolver, Mode, Workspace};

use crate::continuation::{Ending, continue_modes};
use crate::mac::{clear_matches, weighted};
use crate::path::{Links, Path, PathEnd};
use crate::subdivision::Subdivision;

/// Least number of sample points of a subdivision between systems that are not known to be near; chosen.
const SAMPLE_POINTS_OF_FAR_PATHS: usize = 7;

/// Follows the modes over the whole path; MAC between the modes at its two ends is not used.
///
/// # Errors
/// Those of the solver and of the eigenvectors on the path.
pub fn follow(solver: &dyn EigenSolver, path: Path<'_>, work: &mut Workspace) -> Result<Links, CeaError> {
    link_all(solver, &[path], false, work).remove(0)
}

/// Links the modes at the two ends of a path between near systems: by MAC where the match is clear, otherwise by following
/// the mode along the path.
///
/// # Errors
/// As [`follow`].
pub fn identify(solver: &dyn EigenSolver, path: Path<'_>, work: &mut Workspace) -> Result<Links, CeaError> {
    identify_all(solver, &[path], work).remove(0)
}

/// [`identify`] on many paths, one result each; the modes to be followed are computed together, which is cheaper.
pub fn identify_all(
    solver: &dyn EigenSolver,
    paths: &[Path<'_>],
    work: &mut Workspace,
) -> Vec<Result<Links, CeaError>> {
    link_all(solver, paths, true, work)
}

/// A mode at the beginning of a path: the index of the path and the index of the mode.
type StartMode = (usize, usize);

/// Links all modes of all paths: by clear matches of MAC if the systems are `near`, then by continuation, then by subdivision.
fn link_all(
    solver: &dyn EigenSolver,
    paths: &[Path<'_>],
    near: bool,
    work: &mut Workspace,
) -> Vec<Result<Links, CeaError>> {
    let by_shape = |path: &Path<'_>| {
        let clear = clear_matches(path.start_modes, &weighted(path.start_modes, path.mass()), path.end.modes);
        clear.into_iter().map(|to| to.map_or(Ending::Lost, Ending::Known)).collect()
    };
    let mut ends: Vec<Vec<Ending>> = paths
        .iter()
        .map(|path| if near { by_shape(path) } else { vec![Ending::Lost; path.start_modes.len()] })
        .collect();
    let lost = link_by_continuation(paths, near, &mut ends, work);
    let lost: Vec<Lost> = lost.chunk_by(|a, b| a.0 == b.0).map(|of_path| Lost::new(of_path, paths, &ends)).collect();
    let sample_points = if near { 0 } else { SAMPLE_POINTS_OF_FAR_PATHS };
    let begun = lost.iter().map(|lost| lost.begin(paths, sample_points)).collect();
    let found = Subdivision::all(solver, begun, work);

    let link = |end| if let Ending::Known(to) = end { vec![to] } else { Vec::new() };
    let sure = |ends: Vec<Ending>| Ok(ends.into_iter().map(link).collect());
    let mut links: Vec<Result<Links, CeaError>> = ends.into_iter().map(sure).collect();
    for (lost, found) in lost.iter().zip(found) {
        match (&mut links[lost.path], found) {
            (Ok(links), Ok(found)) => lost.modes.iter().zip(found).for_each(|(&i, to)| links[i] = lost.original(&to)),
            (links, Err(error)) => *links = Err(error),
            (Err(_), Ok(_)) => {}
        }
    }
    links
}

/// Continues the modes whose entry in `ends` is in doubt and fills the entries found; returns the modes that are lost, ascending.
fn link_by_continuation(
    paths: &[Path<'_>],
    near: bool,
    ends: &mut [Vec<Ending>],
    work: &mut Workspace,
) -> Vec<StartMode> {
    let all = ends.iter().enumerate().flat_map(|(at, ends)| (0..ends.len()).map(move |i| (at, i)));
    let in_doubt: Vec<StartMode> = all.filter(|&(at, i)| ends[at][i] == Ending::Lost).collect();
    work.counters.continuations += in_doubt.len() as u64;
    let asked: Vec<(Path<'_>, &Mode)> =
        in_doubt.iter().map(|&(at, i)| (paths[at], &paths[at].start_modes[i])).collect();
    for (&(at, i), end) in in_doubt.iter().zip(continue_modes(&asked, near, work)) {
        ends[at][i] = end;
    }
    // Two continuations that end at one mode are both lost.
    let is_sure = |&(at, i): &StartMode| {
        ends[at][i] != Ending::Lost && ends[at].iter().filter(|end| end.is_same(ends[at][i])).count() == 1
    };
    let lost: Vec<StartMode> = in_doubt.into_iter().filter(|doubt| !is_sure(doubt)).collect();
    lost.iter().for_each(|&(at, i)| ends[at][i] = Ending::Lost);
    lost
}

/// The modes of one path that are left to subdivision, and the known modes at its end that no other mode is linked to.
struct Lost {
    /// Index of the path.
    path: usize,
    /// Indices of the modes at the beginning of the path.
    modes: Vec<usize>,
    left: Vec<Mode>,
    /// Index of each mode of `left` among all known modes.
    originals: Vec<usize>,
}

impl Lost {
    fn new(of_path: &[StartMode], paths: &[Path<'_>], ends: &[Vec<Ending>]) -> Self {
        let (path, modes) = (of_path[0].0, of_path.iter().map(|&(_, i)| i).collect());
        let is_left = |to: usize| !ends[path].contains(&Ending::Known(to));
        let known = paths[path].end.modes.iter().cloned().zip(0..);
        let (left, originals) = known.filter(|&(_, to)| is_left(to)).unzip();
        Self { path, modes, left, originals }
    }

    /// The subdivision that is left to follow these modes.
    fn begin<'a>(&'a self, paths: &[Path<'a>], sample_points: usize) -> Subdivision<'a> {
        let path = paths[self.path];
        let start = self.modes.iter().map(|&i| path.start_modes[i].clone()).collect();
        let has_all = path.end.modes.len() == path.mass().nrows();
        let left = Path { end: PathEnd { modes: &self.left, ..path.end }, ..path };
        Subdivision::new(left, start, sample_points, has_all)
    }

    fn original(&self, to: &[usize]) -> Vec<usize> {
        to.iter().map(|&to| self.originals[to]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PathStart;
    use crate::test_modes::modes;
    use cea::QrSolver;
    use linsys::SecondOrder;
    use nalgebra::{DMatrix, DVector, dmatrix};
    use num_complex::Complex;

    fn diagonal(k: &[f64]) -> SecondOrder {
        let n = k.len();
        let stiffness = DMatrix::from_diagonal(&DVector::from_column_slice(k));
        SecondOrder::new(DMatrix::identity(n, n), DMatrix::identity(n, n) * 0.01, stiffness).unwrap()
    }

    fn linked(from: &SecondOrder, to: &SecondOrder) -> Vec<Vec<usize>> {
        let path = Path {
            start: PathStart::System(from),
            start_modes: &modes(from),
            end: PathEnd { system: to, modes: &modes(to) },
        };
        follow(&QrSolver, path, &mut Workspace::default()).unwrap()
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
    fn through_a_coalescence_both_candidates_are_kept() {
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
        let path = Path {
            start: PathStart::System(&from),
            start_modes: &modes(&from),
            end: PathEnd { system: &to, modes: &modes(&to) },
        };
        let links = follow(&QrSolver, path, &mut work).unwrap();
        assert_eq!(links[2], [2]);
        assert_eq!(work.counters.eigenvalue_solves, SAMPLE_POINTS_OF_FAR_PATHS as u64);
    }

    #[test]
    fn internal_states_of_the_ends_come_and_go() {
        let plain = diagonal(&[1.0, 4.0]);
        let mut other = SecondOrder::zeros(2, 1);
        (other.m, other.c, other.k) = (plain.m.clone(), plain.c.clone(), diagonal(&[2.0, 3.0]).k);
        other.internal.decay[0] = 3.0;
        other.internal.drive[(0, 1)] = 1.0;
        other.internal.force[(1, 0)] = 0.5;
        let path =
            Path { start: PathStart::System(&other), start_modes: &[], end: PathEnd { system: &plain, modes: &[] } };
        let lambda = Complex::new(-0.1, 1.7);
        for t in [0.0, 0.3, 1.0] {
            let on_path = other.dynamic_stiffness(lambda) * Complex::from(1.0 - t)
                + plain.dynamic_stiffness(lambda) * Complex::from(t);
            assert!((path.system_at(t).unwrap().dynamic_stiffness(lambda) - on_path).norm() < 1e-14);
        }
        assert_eq!(linked(&plain, &other), [vec![0], vec![1]]);
        assert_eq!(linked(&other, &plain), [vec![0], vec![1]]);
    }
}
