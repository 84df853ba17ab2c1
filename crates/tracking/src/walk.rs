//! The walk behind [`follow`](crate::follow): many ways at once, each in steps of its own length.

use std::collections::{BTreeMap, BTreeSet};

use cea::{CeaError, EigenSolver, Mode, Modes, Workspace};
use linsys::SecondOrder;
use num_complex::Complex;

use crate::mac::match_modes;
use crate::track::{Links, Way};

/// Where a step is cut, as a part of it: aside of round fractions, where symmetric ways have their crossings.
const CUT: f64 = 0.382;
/// How often a step is cut at once: places that fill the solver's lanes cost little more than one.
const AT_ONCE: usize = 3;
/// Steps are not cut below this part of the way.
const SMALLEST: f64 = 1.0 / 4096.0;
/// Eigenvalues this close, relatively, are a multiple eigenvalue: no step tells its vectors apart.
const MULTIPLE: f64 = 1e-4;
/// How many eigenvalues around a followed one are looked at in a step.
const NEIGHBOURS: usize = 3;

/// The modes being followed on one way, and what each mode at its beginning may have become.
pub(crate) struct Walk<'a> {
    way: Way<'a>,
    /// Part of the way gone.
    at: f64,
    modes: Vec<Mode>,
    /// Index of each followed mode in the set it was last matched to.
    indices: Vec<usize>,
    /// For each mode at the beginning, positions in `modes`.
    candidates: Vec<BTreeSet<usize>>,
    /// Places on the way whose systems are to be solved next.
    asked: Vec<f64>,
    /// Places ahead, the next one last. The end of the way is not among them.
    stations: Vec<Station>,
}

/// A solved place on the way.
struct Station {
    at: f64,
    system: SecondOrder,
    lambdas: Vec<Complex<f64>>,
    /// Those modes that were asked for, by index in `lambdas`.
    modes: BTreeMap<usize, Mode>,
}

impl<'a> Walk<'a> {
    /// With `start`, modes at the beginning of a way, to be walked over `stations` places in any case and more where
    /// there is a doubt.
    pub(crate) fn new(way: Way<'a>, start: Vec<Mode>, stations: usize) -> Self {
        let place = |i: usize| (i as f64 + 1.0 - CUT) / (stations as f64 + 1.0);
        Self {
            way,
            at: 0.0,
            indices: (0..start.len()).collect(),
            candidates: (0..start.len()).map(|i| BTreeSet::from([i])).collect(),
            modes: start,
            asked: (0..stations).rev().map(place).collect(),
            stations: Vec::new(),
        }
    }

    /// Walks all ways to their ends.
    pub(crate) fn all(
        solver: &dyn EigenSolver,
        walks: Vec<Self>,
        work: &mut Workspace,
    ) -> Vec<Result<Links, CeaError>> {
        let mut walks: Vec<Result<Self, CeaError>> = walks.into_iter().map(Ok).collect();
        let mut is_under_way = !walks.is_empty();
        while is_under_way {
            solve_asked(solver, &mut walks, work);
            shape_next(&mut walks, work);
            is_under_way = false;
            for walk in walks.iter_mut().flatten() {
                is_under_way |= walk.step();
            }
        }
        walks.into_iter().map(|walk| walk.map(Self::links)).collect()
    }

    fn links(self) -> Links {
        self.candidates.iter().map(|set| set.iter().map(|&f| self.indices[f]).collect()).collect()
    }

    /// Goes to the next place if every match is clear, otherwise asks for one before it; `false` at the end.
    fn step(&mut self) -> bool {
        if self.at == 1.0 {
            return false;
        }
        let next = self.stations.pop();
        let place = next.as_ref().map_or(1.0, |station| station.at);
        let last_try = place - self.at <= SMALLEST;
        let is_there = match &next {
            Some(station) => self.advance(&station.modes_near(&self.modes), last_try),
            None => self.advance(self.way.to.1, last_try),
        };
        if is_there {
            self.at = place;
        } else {
            let mut part = place - self.at;
            for _ in 0..AT_ONCE {
                part *= CUT;
                self.asked.push(self.at + part);
            }
            self.stations.extend(next);
        }
        true
    }

    /// Goes over to `new` if every match is clear, or cannot become so: at the last try, or in a multiple eigenvalue.
    fn advance(&mut self, new: &[Mode], last_try: bool) -> bool {
        let matches = match_modes(&self.modes, new, &self.way.inertia().m);
        // A pair that is multiple before and after the step; one that only crosses is told apart by a longer step.
        let is_inseparable = |f: usize, r: usize| {
            let other = (0..matches.len()).find(|&g| matches[g].to == Some(r));
            let before = other.is_some_and(|g| is_multiple(&self.modes[f], &self.modes[g]));
            before && matches[f].to.is_some_and(|to| is_multiple(&new[to], &new[r]))
        };
        let is_settled = |f: usize| {
            matches[f].is_clear() || matches[f].to.is_some() && matches[f].rivals.iter().all(|&r| is_inseparable(f, r))
        };
        if !last_try && !(0..matches.len()).all(is_settled) {
            return false;
        }
        // Who ends where: first the assigned ones, then rivals that nobody else became.
        let mut indices: Vec<usize> = Vec::new();
        let mut position = |j: usize| {
            indices.iter().position(|&x| x == j).unwrap_or_else(|| {
                indices.push(j);
                indices.len() - 1
            })
        };
        let reach: Vec<BTreeSet<usize>> =
            matches.iter().map(|m| m.to.iter().chain(&m.rivals).map(|&j| position(j)).collect()).collect();
        // A doubt binds both: what may be confused with a rival may be where the rival is.
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
}

impl Station {
    /// The modes that a followed one may have become, ascending in frequency.
    fn wanted(&self, followed: &[Mode]) -> BTreeSet<usize> {
        let mut wanted = BTreeSet::new();
        for mode in followed {
            let distance = |&i: &usize| (self.lambdas[i] - mode.lambda).norm_sqr();
            let mut order: Vec<usize> = (0..self.lambdas.len()).collect();
            order.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
            // Where most are followed each is somebody's successor.
            let few = if 2 * followed.len() < order.len() { NEIGHBOURS } else { order.len() };
            wanted.extend(order.into_iter().take(few));
        }
        wanted
    }

    fn modes_near(&self, followed: &[Mode]) -> Vec<Mode> {
        self.wanted(followed).iter().filter_map(|i| self.modes.get(i).cloned()).collect()
    }
}

/// Solves the systems that the walks asked for, all together.
fn solve_asked(solver: &dyn EigenSolver, walks: &mut [Result<Walk<'_>, CeaError>], work: &mut Workspace) {
    let (mut places, mut systems) = (Vec::new(), Vec::new());
    for (i, walk) in walks.iter_mut().enumerate() {
        let Ok(walk) = walk else { continue };
        for at in walk.asked.drain(..) {
            places.push((i, at));
            systems.push(walk.way.system(at));
        }
    }
    let mut spectra = Vec::with_capacity(systems.len());
    solver.eigenvalues_of_all(&systems, work, &mut spectra);
    for (((i, at), system), spectrum) in places.into_iter().zip(systems).zip(spectra) {
        let modes = spectrum.and_then(|spectrum| Modes::classify(&system, &spectrum, work));
        match (&mut walks[i], modes) {
            (Ok(walk), Ok(modes)) => {
                walk.stations.push(Station { at, system, lambdas: modes.oscillatory, modes: BTreeMap::new() })
            }
            (walk, Err(error)) => *walk = Err(error),
            (Err(_), Ok(_)) => {}
        }
    }
}

/// Finds the shapes that the next steps need, all together.
fn shape_next(walks: &mut [Result<Walk<'_>, CeaError>], work: &mut Workspace) {
    let missing = |walk: &Walk<'_>| -> Vec<usize> {
        let of = |station: &Station| {
            let wanted = station.wanted(&walk.modes).into_iter();
            wanted.filter(|i| !station.modes.contains_key(i)).collect()
        };
        walk.stations.last().map(of).unwrap_or_default()
    };
    let missing: Vec<Vec<usize>> = walks.iter().map(|walk| walk.as_ref().map(missing).unwrap_or_default()).collect();
    let mut stations = Vec::new();
    for (walk, missing) in walks.iter().zip(&missing) {
        if let Some(station) = walk.as_ref().ok().and_then(|walk| walk.stations.last()) {
            let lambdas: Vec<Complex<f64>> = missing.iter().map(|&i| station.lambdas[i]).collect();
            stations.push((&station.system, lambdas));
        }
    }
    let of: Vec<_> = stations.iter().map(|(system, lambdas)| (*system, lambdas.as_slice())).collect();
    let mut shaped = Mode::of_all(&of, work).into_iter();
    for (slot, missing) in walks.iter_mut().zip(missing) {
        let Some(station) = slot.as_mut().ok().and_then(|walk| walk.stations.last_mut()) else { continue };
        match shaped.next() {
            Some(Ok(modes)) => station.modes.extend(missing.into_iter().zip(modes)),
            Some(Err(error)) => *slot = Err(error),
            None => {}
        }
    }
}

fn is_multiple(a: &Mode, b: &Mode) -> bool {
    (a.lambda - b.lambda).norm() <= MULTIPLE * a.lambda.norm()
}
