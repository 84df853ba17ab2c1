//! Continuation against small steps and differences, and of pairs that veer or coalesce.

use super::*;
use crate::mac::match_modes;
use crate::test_modes::modes;
use crate::{PathEnd, PathStart};
use cea::{EigenSolver, QrSolver};
use linsys::{Internal, SecondOrder};
use nalgebra::{DMatrix, dmatrix};
use proptest::prelude::*;

fn continued(from: &SecondOrder, to: &SecondOrder) -> Vec<Option<usize>> {
    let (start, end) = (modes(from), modes(to));
    let path = Path { start: PathStart::System(from), start_modes: &start, end: PathEnd { system: to, modes: &end } };
    let of: Vec<_> = start.iter().map(|mode| (path, mode)).collect();
    continue_modes(&of, false, &mut Workspace::default()).into_iter().map(Ending::known).collect()
}

impl Ending {
    /// The index of the known mode, if it is one.
    pub(crate) fn known(self) -> Option<usize> {
        if let Self::Known(to) = self { Some(to) } else { None }
    }
}

/// The eigenvalue at the end of a path whose end modes are not known; `None` where the continuation does not reach it.
pub(crate) fn end_of(path: Path<'_>, mode: &Mode, work: &mut Workspace) -> Option<Complex<f64>> {
    let here = modes_on_paths(&[PathPoint { path, t: 0.0, lambda: mode.lambda }], work).remove(0)?;
    let mut mode = Continuation::new(PathPoint { path, t: 0.0, lambda: mode.lambda }, false, here)?;
    while let Advance::UnderWay = mode.advance(modes_on_paths(&[mode.predict()], work).remove(0)) {}
    (mode.steps.t == 1.0).then_some(mode.here.mode.lambda)
}

/// Modes followed to the nearest eigenvalue over 4000 steps: of each the eigenvalue at the end, and the least ratio, over all
/// steps, of the distance of the second nearest eigenvalue to the distance of the nearest.
pub(crate) fn by_small_steps(path: Path<'_>) -> Vec<(Complex<f64>, f64)> {
    const STEPS: u32 = 4000;
    let lambdas = |t: f64| {
        let spectrum = QrSolver.eigenvalues(&path.system_at(t).unwrap(), &mut Workspace::default()).unwrap();
        spectrum.oscillatory().collect::<Vec<_>>()
    };
    let mut at: Vec<_> = lambdas(0.0).into_iter().map(|lambda| (lambda, f64::INFINITY)).collect();
    for i in 1..=STEPS {
        let next = lambdas(f64::from(i) / f64::from(STEPS));
        for (at, margin) in &mut at {
            let mut distances: Vec<(f64, Complex<f64>)> = next.iter().map(|l| ((l - *at).norm(), *l)).collect();
            distances.sort_by(|a, b| a.0.total_cmp(&b.0));
            *margin = margin.min(distances[1].0 / distances[0].0.max(1e-12));
            *at = distances[0].1;
        }
    }
    at
}

#[test]
fn veering_modes_are_told_apart_though_their_shapes_are_mixed() {
    let coupled = |a: f64, b: f64| {
        let k = dmatrix![a, 0.4; 0.4, b];
        SecondOrder::new(DMatrix::identity(2, 2), DMatrix::identity(2, 2) * 0.01, k).unwrap()
    };
    // MAC takes each mode for the other, with 0.68 against 0.32.
    let (from, to) = (coupled(1.0, 4.0), coupled(2.8, 2.2));
    assert_eq!(match_modes(&modes(&from), &modes(&to), &from.m)[0].to, Some(1));
    assert_eq!(continued(&from, &to), [Some(0), Some(1)]);
}

#[test]
fn through_a_coalescence_no_mode_is_continued_alone() {
    // The pair coalesces where the two stiffnesses differ by 1.
    let flutter = |a: f64, b: f64| {
        let k = dmatrix![a, 0.5, 0.0; -0.5, b, 0.0; 0.0, 0.0, 50.0];
        SecondOrder::new(DMatrix::identity(3, 3), DMatrix::zeros(3, 3), k).unwrap()
    };
    assert_eq!(continued(&flutter(5.0, 10.0), &flutter(7.6, 7.4)), [None, None, Some(2)]);
}

#[test]
fn the_rate_is_the_limit_of_differences() {
    let at = |decay: f64, drive: f64, force: f64, k: f64| {
        let internal =
            Internal { decay: nalgebra::dvector![decay], drive: dmatrix![drive, -0.3], force: dmatrix![force; 0.2] };
        let (m, c) = (dmatrix![1.0, 0.0; 0.0, 2.0], dmatrix![0.2, 0.1; 0.0, 0.3]);
        SecondOrder::with_internal(m, c, dmatrix![4.0, 1.0; -0.5, k], internal).unwrap()
    };
    let (from, to) = (at(3.0, 1.0, -0.7, 9.0), at(5.0, 0.4, 0.6, 12.0));
    let path = Path { start: PathStart::System(&from), start_modes: &[], end: PathEnd { system: &to, modes: &[] } };
    let mut work = Workspace::default();
    for Mode { lambda, .. } in modes(&path.system_at(0.4).unwrap()) {
        let mut at = |t: f64, lambda| modes_on_paths(&[PathPoint { path, t, lambda }], &mut work).remove(0).unwrap();
        let here = at(0.4, lambda);
        let [behind, ahead] = [0.4 - 1e-4, 0.4 + 1e-4].map(|t| at(t, lambda).mode.lambda);
        assert!((here.mode.lambda - lambda).norm() < 1e-9);
        assert!((here.rate - (ahead - behind) / 2e-4).norm() < 1e-5 * here.rate.norm());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn continued_modes_end_where_small_steps_end(
        springs in prop::collection::vec(0.5..2.0, 20),
        friction in prop::collection::vec(-0.5..0.5, 32),
        damping in 0.01..0.1,
    ) {
        let system = |at: usize| {
            let springs: &[f64] = &springs[5 * at..];
            let k = DMatrix::from_fn(4, 4, |i, j| match i.abs_diff(j) {
                0 => springs[i] + springs[i + 1] + i as f64,
                1 => -springs[i.max(j)],
                _ => 0.0,
            });
            let coupling = DMatrix::from_column_slice(4, 4, &friction[16 * at..16 * (at + 1)]);
            SecondOrder::new(DMatrix::identity(4, 4), damping * &k, k + coupling).unwrap()
        };
        let (from, to) = (system(0), system(1));
        let start = modes(&from);
        prop_assume!(start.len() == 4 && modes(&to).len() == 4);
        let path = Path {
 start: PathStart::System(&from), start_modes: &start, end: PathEnd { system: &to, modes: &[] } };
        for (mode, (end, margin)) in start.iter().zip(by_small_steps(path)) {
            // Small steps are a reference only where no other eigenvalue comes near.
            if margin > 1000.0 {
                let found = end_of(path, mode, &mut Workspace::default());
                prop_assert!(found.is_none_or(|l| (l - end).norm() < 1e-4 * end.norm()), "{found:?} {end} {margin}");
            }
        }
    }
}
