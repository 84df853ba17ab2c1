//! Square roots of functions that turn about 0, and pairs that pass coalescences at small distances.

use super::*;
use crate::continuation::continue_modes;
use crate::test_modes::modes;
use crate::{OwnedPath, PathEnd, PathStart};
use cea::{CeaError, Feedback, Gain, GainPath, Mode, NewtonStep, Secular};
use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector, dmatrix};
use proptest::prelude::*;

/// The square root of `(u - 1/2) + i aside` at u = 1, continued from the root near `i sqrt(1/2)` at u = 0.
fn turned(aside: f64, miss: f64) -> Option<Complex<f64>> {
    turn(&|u| Complex::new(u - 0.5, aside), [0.0, 1.0], Complex::new(0.0, 0.5_f64.sqrt()), miss, MOST_HALVINGS)
}

#[test]
fn the_side_on_which_0_is_passed_decides() {
    for aside in [0.3, 1e-2, 1e-6] {
        assert!(turned(aside, 0.0).unwrap().re > 0.7);
        assert!(turned(-aside, 0.0).unwrap().re < -0.7);
        assert_eq!(turned(aside, aside), None);
    }
    assert_eq!(turned(0.0, 0.0), None);
    // A full turn of the function about 0 is half a turn of its root.
    let circle = |u: f64| Complex::from_polar(2.0, std::f64::consts::TAU * u);
    let end = turn(&circle, [0.0, 1.0], Complex::from(2.0_f64.sqrt()), 0.0, MOST_HALVINGS).unwrap();
    assert!((end + 2.0_f64.sqrt()).norm() < 1e-12);
}

/// Two masses that flutter for mu above 2.27, and a third mass. The damping of the second exceeds the damping of the first by `more`.
fn brake(more: f64) -> Secular {
    let c = DMatrix::from_diagonal(&nalgebra::dvector![0.02, 0.02 + more, 0.05]);
    let k = dmatrix![10.0, 0.6, 0.1; 0.6, 12.0, 0.2; 0.1, 0.2, 40.0];
    let structure = SecondOrder::new(DMatrix::identity(3, 3), c, k).unwrap();
    let feedback = Feedback { force: dmatrix![1.0; 0.0; 0.0], reading: dmatrix![0.0, -1.0, 0.0] };
    Secular::new(&structure, &feedback, &mut Workspace::default()).unwrap().unwrap()
}

/// Eigenvalue at the end of a path to which small steps lead from each mode at its beginning.
fn by_small_steps(path: Path<'_>) -> Vec<Complex<f64>> {
    let mut at: Vec<Complex<f64>> = path.start_modes.iter().map(|mode| mode.lambda).collect();
    let (mut before, mut t) = (at.clone(), 0.0);
    while t < 1.0 {
        // The steps are short next to the coalescence, where the two eigenvalues are near and move fast.
        let nearest = (at[1] - at[0]).norm() / at[0].norm();
        let step = (0.02 * nearest).clamp(1e-6, 2e-3).min(1.0 - t);
        let next: Vec<_> = modes(&path.system_at(t + step).unwrap()).into_iter().map(|mode| mode.lambda).collect();
        let expected: Vec<_> = at.iter().zip(&before).map(|(at, before)| at + 0.5 * (at - before)).collect();
        let distance = |l: &&Complex<f64>, to: &Complex<f64>| (*l - to).norm();
        before = at;
        at = expected
            .iter()
            .map(|to| *next.iter().min_by(|a, b| distance(a, to).total_cmp(&distance(b, to))).unwrap())
            .collect();
        t += step;
    }
    at
}

#[test]
fn modes_are_continued_past_a_coalescence_on_either_side() {
    let mut ends = Vec::new();
    for more in [3e-3, -3e-3, 3e-4, -3e-4] {
        let secular = brake(more);
        let [from, to] = [1.5, 3.0].map(|mu| Gain { mu, ..Gain::default() });
        let [start, end] = [from, to].map(|gain| modes(&secular.system(&gain)));
        let system = secular.system(&to);
        let path = Path {
            start: PathStart::Gain(GainPath { secular: &secular, from, to }),
            start_modes: &start,
            end: PathEnd { system: &system, modes: &end },
        };
        let mut work = Workspace::default();
        let found = continue_modes(&start.iter().map(|mode| (path, mode)).collect::<Vec<_>>(), false, &mut work);
        let lambdas: Vec<Complex<f64>> = found.iter().map(|to| end[to.known().unwrap()].lambda).collect();
        assert_eq!((work.counters.eigenvalue_solves, work.counters.factorisations), (0, 0));
        for (lambda, expected) in lambdas.iter().zip(by_small_steps(path)) {
            assert!((lambda - expected).norm() < 1e-9, "{more}: {lambda} {expected}");
        }
        ends.push(lambdas[0].re > 0.0);
    }
    // Which of the two modes becomes the growing one depends on which is damped more.
    assert_eq!(ends, [ends[0], !ends[0], ends[0], !ends[0]]);
}

/// A path that is evaluated by all modes of its systems and by determinants.
#[derive(Debug)]
struct BySpectra<'a>(Path<'a>);

impl BySpectra<'_> {
    fn nearest(&self, t: f64, lambda: Complex<f64>) -> Option<Mode> {
        let distance = |mode: &Mode| (mode.lambda - lambda).norm();
        modes(&self.0.system_at(t).unwrap()).into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }
}

impl OwnedPath for BySpectra<'_> {
    fn correct(&self, t: f64, lambda: Complex<f64>) -> Option<(NewtonStep, DVector<Complex<f64>>)> {
        let Mode { lambda, shape } = self.nearest(t, lambda)?;
        let [behind, ahead] = [self.nearest(t - 1e-7, lambda)?, self.nearest(t + 1e-7, lambda)?];
        Some((NewtonStep { lambda, rate: (ahead.lambda - behind.lambda) / 2e-7 }, shape))
    }

    fn characteristic(&self, at: &[(f64, Complex<f64>)]) -> Vec<Complex<f64>> {
        at.iter().map(|&(t, lambda)| self.0.system_at(t).unwrap().dynamic_stiffness(lambda).determinant()).collect()
    }

    fn system(&self) -> Result<SecondOrder, CeaError> {
        self.0.system_at(0.0)
    }
}

#[test]
fn modes_on_a_path_of_its_owner_are_continued_past_a_coalescence_too() {
    for more in [3e-3, -3e-3] {
        let secular = brake(more);
        let [from, to] = [1.5, 3.0].map(|mu| secular.system(&Gain { mu, ..Gain::default() }));
        let (start, end) = (modes(&from), modes(&to));
        let end = PathEnd { system: &to, modes: &end };
        let by_systems = Path { start: PathStart::System(&from), start_modes: &start, end };
        let owner = BySpectra(by_systems);
        let path = Path { start: PathStart::Owned(&from.m, &owner), ..by_systems };
        let mut work = Workspace::default();
        let found = continue_modes(&start.iter().map(|mode| (path, mode)).collect::<Vec<_>>(), false, &mut work);
        for (to, expected) in found.iter().zip(by_small_steps(by_systems)) {
            let lambda = end.modes[to.known().unwrap()].lambda;
            assert!((lambda - expected).norm() < 1e-9, "{more}: {lambda} {expected}");
        }
    }
}

proptest! {
    #[test]
    fn a_pair_is_what_its_eigenvalues_say(more in -0.05..0.05, mu in 1.0..3.5, aside in 0.0..0.4, angle in 0.0..6.3) {
        let secular = brake(more);
        let [from, to] = [0.0, 4.0].map(|mu| Gain { mu, ..Gain::default() });
        let path = GainPath { secular: &secular, from, to };
        let of = |mu: f64| {
            let both = modes(&secular.system(&Gain { mu, ..Gain::default() }));
            let [a, b] = [both[0].lambda, both[1].lambda];
            EigenvaluePair { mean: 0.5 * (a + b), half_gap_squared: 0.25 * (a - b) * (a - b) }
        };
        let expected = of(mu);
        let guess = EigenvaluePair {
            mean: expected.mean + Complex::from_polar(aside * 1e-3, angle),
            half_gap_squared: expected.half_gap_squared * Complex::from_polar(1.0 - 0.5 * aside, angle),
        };
        let [here, rate] = GainPath::pairs(&[(path, 0.25 * mu, guess)], &mut Workspace::default())[0].unwrap();
        let size = expected.mean.norm();
        prop_assert!((here.mean - expected.mean).norm() < 1e-9 * size, "{here:?} {expected:?}");
        prop_assert!((here.half_gap_squared - expected.half_gap_squared).norm() < 1e-9 * size * size, "{here:?} {expected:?}");
        let [behind, ahead] = [mu - 1e-4, mu + 1e-4].map(of);
        let [mean, square] = [(ahead.mean - behind.mean) / 5e-5, (ahead.half_gap_squared - behind.half_gap_squared) / 5e-5];
        prop_assert!((rate.mean - mean).norm() < 1e-4 && (rate.half_gap_squared - square).norm() < 1e-4, "{rate:?} {mean} {square}");
    }
}

#[test]
fn a_mode_without_a_neighbour_is_none_of_a_pair() {
    let secular = brake(0.0);
    let [from, to] = [0.0, 4.0].map(|mu| Gain { mu, ..Gain::default() });
    let alone = modes(&secular.system(&from))[2].lambda;
    let (start, system) = (PathStart::Gain(GainPath { secular: &secular, from, to }), secular.system(&to));
    let path = Path { start, start_modes: &[], end: PathEnd { system: &system, modes: &[] } };
    let point = PathPoint { path, t: 0.0, lambda: alone };
    assert!(continue_pairs(&[point], &mut Workspace::default())[0].is_none());
}
