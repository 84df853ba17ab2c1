//! Adaptive subdivision: spectra at sample points on the path, in steps that are cut until every match by MAC is clear. Many
//! paths are subdivided together, each in steps of its own length, so that their systems are solved together. Where the owner of a
//! path knows the eigenvalues next to a number, it is asked for the candidates of a step instead.

use std::collections::{BTreeMap, BTreeSet};

use cea::{CeaError, EigenSolver, Mode, Modes, Workspace};
use num_complex::Complex;

use crate::mac::{Match, match_modes};
use crate::path::{Links, Path, PathStart};
use crate::sample_point::{Candidates, Known, SamplePoint, Solved};

/// Fraction of a step at which it is cut; chosen: no simple fraction, because symmetric paths have their crossings there.
const CUT_FRACTION: f64 = 0.382;
/// Sample points that are asked for when a step is cut; chosen: the solver takes four small systems at little more than the cost of one.
const CUTS_AT_ONCE: usize = 3;
/// Fewest degrees of freedom of a system with which a step is cut once, and not [`CUTS_AT_ONCE`] times. Chosen: of a reduced brake of 50 the shapes at a
/// sample point cost as much as its spectrum, and half of the sample points of a triple cut turn out to be needless.
const LARGE: usize = 40;
/// Longest step that is not cut any more, as a fraction of the path; chosen: a step that needs a cut there passes a coalescence.
const SHORTEST_SUBDIVISION: f64 = 1.0 / 4096.0;
/// Largest relative distance between eigenvalues that count as one multiple eigenvalue, whose vectors no step tells apart;
/// chosen.
const MULTIPLE_SEPARATION: f64 = 1e-4;

/// The modes being followed on one path, and what each mode at its beginning may have become.
pub(crate) struct Subdivision<'a> {
    path: Path<'a>,
    /// True if all modes at the end of the path are known, so that a mode may be found by elimination.
    has_all: bool,
    /// Position on the path, up to which the modes have been followed.
    at: f64,
    modes: Vec<Mode>,
    /// Index of each followed mode in the set it was last matched to.
    indices: Vec<usize>,
    /// Candidates of each mode at the beginning, as indices into `modes`.
    candidates: Vec<BTreeSet<usize>>,
    /// Positions on the path at which systems are to be solved next, 0 to 1.
    requested: Vec<f64>,
    /// Sample points ahead, the next one last. The end of the path is not among them.
    sample_points: Vec<SamplePoint>,
}

/// The modes at the end of a step, among which those that are followed are looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Among {
    /// The nearest few.
    Nearest,
    /// All, so that a mode may be found by elimination.
    All,
    /// The modes of a band, which a mode may have left.
    Band,
}

impl<'a> Subdivision<'a> {
    /// `start` are the modes to be followed; `sample_points` is the number of points solved in any case. More are added where a
    /// match is not clear. With `has_all` the modes at the end of the path are all that are left there.
    pub(crate) fn new(path: Path<'a>, start: Vec<Mode>, sample_points: usize, has_all: bool) -> Self {
        let place = |i: usize| (i as f64 + 1.0 - CUT_FRACTION) / (sample_points as f64 + 1.0);
        Self {
            path,
            has_all,
            at: 0.0,
            indices: (0..start.len()).collect(),
            candidates: (0..start.len()).map(|i| BTreeSet::from([i])).collect(),
            modes: start,
            requested: (0..sample_points).rev().map(place).collect(),
            sample_points: Vec::new(),
        }
    }

    /// Follows all modes to the ends of their paths.
    pub(crate) fn all(
        solver: &dyn EigenSolver,
        paths: Vec<Self>,
        work: &mut Workspace,
    ) -> Vec<Result<Links, CeaError>> {
        let mut paths: Vec<Result<Self, CeaError>> = paths.into_iter().map(Ok).collect();
        let mut is_under_way = !paths.is_empty();
        while is_under_way {
            paths.iter_mut().flatten().for_each(Self::ask_owner);
            solve_sample_points(solver, &mut paths, work);
            find_shapes(&mut paths, work);
            is_under_way = false;
            for of_path in paths.iter_mut().flatten() {
                is_under_way |= of_path.advance();
            }
        }
        paths.into_iter().map(|of_path| of_path.map(Self::links)).collect()
    }

    fn links(self) -> Links {
        self.candidates.iter().map(|set| set.iter().map(|&f| self.indices[f]).collect()).collect()
    }

    /// Goes to the next sample point if every match is clear, otherwise asks for one before it; `false` at the end.
    fn advance(&mut self) -> bool {
        if self.at == 1.0 {
            return false;
        }
        let next = self.sample_points.pop();
        let place = next.as_ref().map_or(1.0, |sample_point| sample_point.at);
        let last_try = place - self.at <= SHORTEST_SUBDIVISION;
        let is_taken = match &next {
            Some(sample_point) => self.step_to(&sample_point.known.modes_near(&self.modes), last_try, Among::Nearest),
            None => self.step_to(self.path.end.modes, last_try, if self.has_all { Among::All } else { Among::Band }),
        };
        if is_taken {
            self.at = place;
        } else {
            let mut part = place - self.at;
            let cuts = if self.path.mass().nrows() < LARGE { CUTS_AT_ONCE } else { 1 };
            for _ in 0..cuts {
                part *= CUT_FRACTION;
                self.requested.push(self.at + part);
            }
            self.sample_points.extend(next);
        }
        true
    }

    /// Steps to the modes `new` if every match is clear, or cannot become clear: at the last try, or in a multiple eigenvalue.
    fn step_to(&mut self, new: &[Mode], last_try: bool, among: Among) -> bool {
        let matches = match_modes(&self.modes, new, self.path.mass());
        // Two modes with equal eigenvalues before and after the step; modes that only cross are told apart by a longer step.
        let is_inseparable = |f: usize, r: usize| {
            let other = (0..matches.len()).find(|&g| matches[g].to == Some(r));
            let before = other.is_some_and(|g| is_multiple(&self.modes[f], &self.modes[g]));
            before && matches[f].to.is_some_and(|to| is_multiple(&new[to], &new[r]))
        };
        let is_decided = |f: usize| {
            let Match { to, rivals, .. } = &matches[f];
            let is_found = among == Among::All || matches[f].is_same() || rivals.iter().any(|&r| *to != Some(r));
            is_found && to.is_some() && rivals.iter().all(|&r| is_inseparable(f, r))
        };
        if !last_try && !(0..matches.len()).all(is_decided) {
            return false;
        }
        // The new modes that are followed on: modes that are assigned to an old mode, then rivals that are not.
        let mut indices: Vec<usize> = Vec::new();
        let mut position = |j: usize| {
            indices.iter().position(|&x| x == j).unwrap_or_else(|| {
                indices.push(j);
                indices.len() - 1
            })
        };
        // Of the modes in a band, one with another shape is no match: the mode has left the band.
        let is_match = |found: &Match| among != Among::Band || !found.is_other();
        let mut reach = |found: &Match| -> BTreeSet<usize> {
            let candidates = found.to.iter().chain(&found.rivals).filter(|_| is_match(found));
            candidates.map(|&j| position(j)).collect()
        };
        let reach: Vec<BTreeSet<usize>> = matches.iter().map(&mut reach).collect();
        // Two modes that share a rival are in doubt together: either may be where the other is, so their candidates are joined.
        for set in &mut self.candidates {
            let mut grown: BTreeSet<usize> = set.iter().flat_map(|&f| reach[f].iter().copied()).collect();
            loop {
                let touching = reach.iter().filter(|r| r.len() > 1 && !r.is_disjoint(&grown));
                let more: BTreeSet<usize> = touching.flatten().copied().collect();
                if more.is_subset(&grown) {
                    break;
                }
                grown.extend(more);
            }
            *set = grown;
        }
        self.modes = indices.iter().map(|&j| new[j].clone()).collect();
        self.indices = indices;
        true
    }

    fn next(&self) -> Option<&Known> {
        self.sample_points.last().map(|next| &next.known)
    }

    /// Asks the owner of the path for the modes at the next sample point. Where it cannot tell, a spectrum is requested there.
    fn ask_owner(&mut self) {
        if !matches!(self.path.start, PathStart::Owned(..)) {
            return;
        }
        let unknown = |at| SamplePoint { at, known: Known::ByOwner(None) };
        self.sample_points.extend(self.requested.drain(..).map(unknown));
        let Some(SamplePoint { at, known: Known::ByOwner(known) }) = self.sample_points.last() else { return };
        if known.as_ref().is_some_and(|known| known.are_of(&self.modes)) {
            return;
        }
        let at = *at;
        self.sample_points.pop();
        match Candidates::at(at, &self.path, &self.modes) {
            Some(found) => self.sample_points.push(SamplePoint { at, known: Known::ByOwner(Some(found)) }),
            None => self.requested.push(at),
        }
    }

    /// The modes of the next sample point that may be asked for and have no shapes yet.
    fn missing_shapes(&self) -> Vec<usize> {
        let Some(Known::Spectrum(next)) = self.next() else { return Vec::new() };
        next.candidates(&self.modes).into_iter().filter(|i| !next.modes.contains_key(i)).collect()
    }
}

/// Solves the systems at the sample points that the paths asked for, in one call of the solver.
fn solve_sample_points(
    solver: &dyn EigenSolver,
    paths: &mut [Result<Subdivision<'_>, CeaError>],
    work: &mut Workspace,
) {
    let (mut places, mut systems) = (Vec::new(), Vec::new());
    for (i, slot) in paths.iter_mut().enumerate() {
        let Ok(of_path) = slot else { continue };
        let made: Result<Vec<_>, CeaError> =
            of_path.requested.drain(..).map(|at| Ok((at, of_path.path.system_at(at)?))).collect();
        match made {
            Ok(made) => made.into_iter().for_each(|(at, system)| {
                places.push((i, at));
                systems.push(system);
            }),
            Err(error) => *slot = Err(error),
        }
    }
    let mut spectra = Vec::with_capacity(systems.len());
    solver.eigenvalues_of_all(&systems, work, &mut spectra);
    for (((i, at), system), spectrum) in places.into_iter().zip(systems).zip(spectra) {
        let modes = spectrum.and_then(|spectrum| Modes::classify(&system, &spectrum, work));
        match (&mut paths[i], modes) {
            (Ok(of_path), Ok(modes)) => {
                let solved = Solved { system, lambdas: modes.oscillatory, modes: BTreeMap::new() };
                of_path.sample_points.push(SamplePoint { at, known: Known::Spectrum(Box::new(solved)) });
            }
            (of_path, Err(error)) => *of_path = Err(error),
            (Err(_), Ok(_)) => {}
        }
    }
}

/// Finds the shapes that the next step of each path needs, in one call.
fn find_shapes(paths: &mut [Result<Subdivision<'_>, CeaError>], work: &mut Workspace) {
    let missing: Vec<Vec<usize>> =
        paths.iter().map(|of_path| of_path.as_ref().map(Subdivision::missing_shapes).unwrap_or_default()).collect();
    let mut sample_points = Vec::new();
    for (of_path, missing) in paths.iter().zip(&missing) {
        if let Some(Known::Spectrum(solved)) = of_path.as_ref().ok().and_then(Subdivision::next) {
            let lambdas: Vec<Complex<f64>> = missing.iter().map(|&i| solved.lambdas[i]).collect();
            sample_points.push((&solved.system, lambdas));
        }
    }
    let of: Vec<_> = sample_points.iter().map(|(system, lambdas)| (*system, lambdas.as_slice())).collect();
    let mut shaped = Mode::of_all(&of, work).into_iter();
    for (slot, missing) in paths.iter_mut().zip(missing) {
        let next = slot.as_mut().ok().and_then(|of_path| of_path.sample_points.last_mut());
        let Some(SamplePoint { known: Known::Spectrum(solved), .. }) = next else { continue };
        match shaped.next() {
            Some(Ok(modes)) => solved.modes.extend(missing.into_iter().zip(modes)),
            Some(Err(error)) => *slot = Err(error),
            None => {}
        }
    }
}

fn is_multiple(a: &Mode, b: &Mode) -> bool {
    (a.lambda - b.lambda).norm() <= MULTIPLE_SEPARATION * a.lambda.norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::{Eigenpair, OwnedPath, PathEnd};
    use crate::test_modes::modes;
    use cea::{NewtonStep, QrSolver};
    use linsys::SecondOrder;
    use nalgebra::{DMatrix, DVector, dmatrix};

    /// An owner that knows the eigenvalues next to a number up to some position on the path.
    #[derive(Debug)]
    struct UpTo<'a>(Path<'a>, f64);

    impl OwnedPath for UpTo<'_> {
        fn correct(&self, _: f64, _: Complex<f64>) -> Option<(NewtonStep, DVector<Complex<f64>>)> {
            None
        }

        fn characteristic(&self, at: &[(f64, Complex<f64>)]) -> Vec<Complex<f64>> {
            vec![Complex::from(f64::NAN); at.len()]
        }

        fn nearest(&self, t: f64, _: &[Complex<f64>], _: usize) -> Option<Vec<Eigenpair>> {
            let all = || modes(&self.0.system_at(t).unwrap()).into_iter().map(|mode| (mode.lambda, mode.shape));
            (t <= self.1).then(|| all().collect())
        }

        fn system(&self) -> Result<SecondOrder, CeaError> {
            self.0.system_at(0.0)
        }
    }

    #[test]
    fn spectra_are_taken_only_where_an_owner_cannot_tell() {
        let system = |a: f64, b: f64| {
            let k = dmatrix![a, 0.4, 0.0; 0.4, b, 0.1; 0.0, 0.1, 50.0];
            SecondOrder::new(DMatrix::identity(3, 3), DMatrix::identity(3, 3) * 0.01, k).unwrap()
        };
        let (from, to) = (system(1.0, 4.0), system(4.0, 1.0));
        let (start, end) = (modes(&from), modes(&to));
        let by_systems =
            Path { start: PathStart::System(&from), start_modes: &start, end: PathEnd { system: &to, modes: &end } };
        let solved = [0.0, 0.5, 1.0].map(|up_to| {
            let owner = UpTo(by_systems, up_to);
            let path = Path { start: PathStart::Owned(&from.m, &owner), ..by_systems };
            let mut work = Workspace::default();
            let links = Subdivision::all(&QrSolver, vec![Subdivision::new(path, start.clone(), 7, true)], &mut work);
            assert_eq!(links[0].as_ref().unwrap(), &[vec![0], vec![1], vec![2]]);
            work.counters.eigenvalue_solves
        });
        assert!(solved[0] > solved[1] && solved[1] > 0 && solved[2] == 0, "{solved:?}");
    }
}
