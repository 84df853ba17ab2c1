//! Following modes by continuation from one system to another.
//!
//! MAC straight between two far states is too weak: from nine oscillators in contact to six its median is 0.53.
//! Between *near* states it is strong, so the way from one system to the other is walked in steps that are cut again
//! until every match is beyond doubt. A pair that stays in doubt at the smallest step passes so near a coalescence
//! that which of the two is which has no answer; such modes are reported with all their candidates, never guessed.

use std::collections::BTreeSet;

use linsys::SecondOrder;
use nalgebra::DMatrix;
use num_complex::Complex;

use crate::mac::match_modes;
use crate::{CeaError, EigenSolver, Mode, Modes, Spectrum, Workspace};

/// Steps into which the way, and then each step that leaves a doubt, is cut. They are solved together, one per lane.
const CUTS: usize = 8;
/// Cuts stand aside of round fractions, where symmetric ways have their crossings.
const ASIDE: f64 = 0.382;
/// How often a step is cut again: the smallest is 1 / 4096 of the way.
const DEPTH: u32 = 3;
/// Eigenvalues this close, relatively, are a multiple eigenvalue: no step tells its vectors apart.
const MULTIPLE: f64 = 1e-4;
/// How many eigenvalues around a followed one are looked at in a step.
const NEIGHBOURS: usize = 3;

/// Follows `start`, modes of `from`, to `to`, whose modes `end` are known.
///
/// The way is the straight line between the two systems, which must have the same shape (see
/// [`with_idle_states`]); where the systems differ in the stiffness of a contact, this is the continuation in that
/// stiffness. For each mode of `start`: the indices into `end` that it may have become, one where it is known, none
/// where it ceased to oscillate.
///
/// # Errors
/// Those of the solver and of the eigenvectors on the way.
pub fn follow(
    solver: &dyn EigenSolver,
    (from, start): (&SecondOrder, &[Mode]),
    (to, end): (&SecondOrder, &[Mode]),
    work: &mut Workspace,
) -> Result<Vec<Vec<usize>>, CeaError> {
    let mut walk = Walk::new(solver, (from, to), start);
    walk.cross((0.0, 1.0), end, 0, work)?;
    Ok(walk.candidates.iter().map(|set| set.iter().map(|&f| walk.indices[f]).collect()).collect())
}

/// Which of the known modes `end` of `to` the modes `start` of `from` are: by MAC where that is beyond doubt, by
/// following those where it is not. The result is as that of [`follow`].
///
/// # Errors
/// As [`follow`].
pub fn identify(
    solver: &dyn EigenSolver,
    (from, start): (&SecondOrder, &[Mode]),
    (to, end): (&SecondOrder, &[Mode]),
    work: &mut Workspace,
) -> Result<Vec<Vec<usize>>, CeaError> {
    let matches = match_modes(start, end, &from.m);
    let far: Vec<usize> = (0..start.len()).filter(|&i| !matches[i].is_clear()).collect();
    let mut found: Vec<Vec<usize>> = matches.iter().map(|m| m.to.into_iter().collect()).collect();
    if !far.is_empty() {
        work.counters.continuations += far.len() as u64;
        let modes: Vec<Mode> = far.iter().map(|&i| start[i].clone()).collect();
        for (&i, candidates) in far.iter().zip(follow(solver, (from, &modes), (to, end), work)?) {
            found[i] = candidates;
        }
    }
    Ok(found)
}

/// `system` with the internal states of `like`, which do not act back on it: the same modes, a common shape.
///
/// `like` must have as many degrees of freedom, and `system` no states of its own.
pub fn with_idle_states(system: &SecondOrder, like: &SecondOrder) -> SecondOrder {
    let mut internal = like.internal.clone();
    internal.force.fill(0.0);
    SecondOrder { m: system.m.clone(), c: system.c.clone(), k: system.k.clone(), internal }
}

/// The modes being followed and what each start mode may have become.
struct Walk<'a> {
    solver: &'a dyn EigenSolver,
    from: &'a SecondOrder,
    to: &'a SecondOrder,
    modes: Vec<Mode>,
    /// Index of each followed mode in the set it was last matched to.
    indices: Vec<usize>,
    /// For each start mode, positions in `modes`.
    candidates: Vec<BTreeSet<usize>>,
}

impl<'a> Walk<'a> {
    fn new(solver: &'a dyn EigenSolver, (from, to): (&'a SecondOrder, &'a SecondOrder), start: &[Mode]) -> Self {
        let candidates = (0..start.len()).map(|i| BTreeSet::from([i])).collect();
        Self { solver, from, to, modes: start.to_vec(), indices: (0..start.len()).collect(), candidates }
    }

    /// Goes from part `a` of the way to part `b`, where the modes are `end`.
    fn cross(&mut self, (a, b): (f64, f64), end: &[Mode], depth: u32, work: &mut Workspace) -> Result<(), CeaError> {
        let place = |cut: usize| if cut == 0 { a } else { a + (b - a) * (cut as f64 - ASIDE) / CUTS as f64 };
        let mut between = vec![self.from.clone(); CUTS - 1];
        for (cut, system) in (1..CUTS).zip(&mut between) {
            interpolate(self.from, self.to, place(cut), system);
        }
        let mut spectra = Vec::with_capacity(between.len());
        self.solver.eigenvalues_of_all(&between, work, &mut spectra);
        for (cut, (system, spectrum)) in (1..CUTS).zip(between.iter().zip(spectra)) {
            let modes = modes_near(system, &spectrum?, &self.modes, work)?;
            self.step((place(cut - 1), place(cut)), &modes, depth, work)?;
        }
        self.step((place(CUTS - 1), b), end, depth, work)
    }

    /// One step to `modes`, cut again where it leaves a doubt.
    fn step(&mut self, way: (f64, f64), modes: &[Mode], depth: u32, work: &mut Workspace) -> Result<(), CeaError> {
        if self.advance(modes, depth == DEPTH) {
            return Ok(());
        }
        self.cross(way, modes, depth + 1, work)
    }

    /// Goes over to `new` if every match is clear, or cannot become so: at the last try, or in a multiple eigenvalue.
    fn advance(&mut self, new: &[Mode], last_try: bool) -> bool {
        let matches = match_modes(&self.modes, new, &self.from.m);
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

fn is_multiple(a: &Mode, b: &Mode) -> bool {
    (a.lambda - b.lambda).norm() <= MULTIPLE * a.lambda.norm()
}

/// `(1 - t) from + t to`, all matrices.
fn interpolate(from: &SecondOrder, to: &SecondOrder, t: f64, out: &mut SecondOrder) {
    let mix = |a: &DMatrix<f64>, b: &DMatrix<f64>, out: &mut DMatrix<f64>| {
        out.zip_zip_apply(a, b, |x, a, b| *x = (1.0 - t) * a + t * b);
    };
    mix(&from.m, &to.m, &mut out.m);
    mix(&from.c, &to.c, &mut out.c);
    mix(&from.k, &to.k, &mut out.k);
    mix(&from.internal.drive, &to.internal.drive, &mut out.internal.drive);
    mix(&from.internal.force, &to.internal.force, &mut out.internal.force);
    out.internal.decay = &from.internal.decay * (1.0 - t) + &to.internal.decay * t;
}

fn modes_near(
    system: &SecondOrder,
    spectrum: &Spectrum,
    followed: &[Mode],
    work: &mut Workspace,
) -> Result<Vec<Mode>, CeaError> {
    let all = Modes::classify(system, spectrum, work)?.oscillatory;
    let mut wanted = BTreeSet::new();
    for mode in followed {
        let mut order: Vec<usize> = (0..all.len()).collect();
        order.sort_by(|&a, &b| (all[a] - mode.lambda).norm().total_cmp(&(all[b] - mode.lambda).norm()));
        // Where most are followed each is somebody's successor.
        let few = if 2 * followed.len() < all.len() { NEIGHBOURS } else { all.len() };
        wanted.extend(order.into_iter().take(few));
    }
    let lambdas: Vec<Complex<f64>> = wanted.into_iter().map(|i| all[i]).collect();
    Mode::at(system, &lambdas, work)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::QrSolver;
    use nalgebra::{DVector, dmatrix};

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
        follow(&QrSolver, (from, &modes(from)), (to, &modes(to)), &mut Workspace::default()).unwrap()
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
        let links = follow(&QrSolver, (&from, &modes(&from)), (&to, &modes(&to)), &mut work).unwrap();
        assert_eq!(links[2], [2]);
        assert_eq!(work.counters.eigenvalue_solves, CUTS as u64 - 1);
    }

    #[test]
    fn idle_states_change_no_mode() {
        let plain = diagonal(&[1.0, 4.0]);
        let mut like = SecondOrder::zeros(2, 1);
        like.internal.decay[0] = 3.0;
        like.internal.drive[(0, 1)] = 1.0;
        like.internal.force[(1, 0)] = 5.0;
        let padded = with_idle_states(&plain, &like);
        assert_eq!(padded.states(), 1);
        for (a, b) in modes(&plain).iter().zip(&modes(&padded)) {
            assert!((a.lambda - b.lambda).norm() < 1e-14 * a.lambda.norm());
        }
    }
}
