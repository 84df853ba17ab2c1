//! The batched solver through its public interface.

#![allow(clippy::unwrap_used)]

use cea::{BatchSolver, CeaError, EigenSolver, QrSolver, Spectrum, Workspace};
use linsys::{Internal, SecondOrder};
use nalgebra::{DMatrix, DVector, dmatrix};
use num_complex::Complex;
use proptest::prelude::*;

/// A chain of `n` masses with a friction-like coupling `mu`, which takes the symmetry out of K, and `s` internal
/// states. The coupling alternates in sign; with one sign it would add up along the chain to a matrix far from normal.
fn chain(n: usize, s: usize, mu: f64) -> SecondOrder {
    let mut system = SecondOrder::zeros(n, s);
    for i in 0..n {
        system.m[(i, i)] = 0.39 + 0.1 * (i % 3) as f64;
        system.k[(i, i)] = 4.9e7 + 1e6 * i as f64;
        system.c[(i, i)] = 360.0;
        if i + 1 < n {
            let coupling = if i % 2 == 0 { mu * 3.5e7 } else { -mu * 3.5e7 };
            system.k[(i, i + 1)] = -1.05e7 + coupling;
            system.k[(i + 1, i)] = -1.05e7 - coupling;
        }
    }
    system.internal = Internal {
        decay: DVector::from_fn(s, |k, _| 2e4 * (1.0 + mu + k as f64)),
        drive: DMatrix::from_fn(s, n, |k, j| if j == k % n { -0.3 - mu } else { 0.0 }),
        force: DMatrix::from_fn(n, s, |i, k| if i == k % n { 6e7 } else { 0.0 }),
    };
    system.check().unwrap();
    system
}

fn solve(solver: &impl EigenSolver, systems: &[SecondOrder]) -> Vec<Result<Spectrum, CeaError>> {
    let mut spectra = Vec::new();
    solver.eigenvalues_of_all(systems, &mut Workspace::default(), &mut spectra);
    spectra
}

/// Largest distance between two sets of eigenvalues, relative to the size of the problem.
fn distance(a: &Spectrum, b: &Spectrum) -> f64 {
    assert_eq!(a.eigenvalues.len(), b.eigenvalues.len());
    let nearest = |x: &Complex<f64>, set: &[Complex<f64>]| set.iter().map(|y| (x - y).norm()).fold(f64::MAX, f64::min);
    let one_way = |a: &[Complex<f64>], b: &[Complex<f64>]| a.iter().map(|x| nearest(x, b)).fold(0.0, f64::max);
    one_way(&a.eigenvalues, &b.eigenvalues).max(one_way(&b.eigenvalues, &a.eigenvalues)) / a.scale
}

fn bits(spectra: &[Result<Spectrum, CeaError>]) -> Vec<Vec<(u64, u64)>> {
    let of = |s: &Spectrum| s.eigenvalues.iter().map(|l| (l.re.to_bits(), l.im.to_bits())).collect();
    spectra.iter().map(|s| of(s.as_ref().unwrap())).collect()
}

#[test]
fn what_is_too_fast_for_a_lane_is_handed_over_and_its_neighbours_are_not() {
    let ordinary = chain(6, 2, 0.1);
    let (mut fast, mut dashpot, mut full) = (ordinary.clone(), ordinary.clone(), ordinary.clone());
    fast.internal.decay.fill(1e9);
    dashpot.c[(1, 1)] = 1e9;
    (full.m[(0, 1)], full.m[(1, 0)], full.c[(1, 1)]) = (0.1, 0.1, 1e9);
    let systems = [ordinary.clone(), fast, dashpot, full, ordinary];
    let (batch, scalar) = (solve(&BatchSolver, &systems), solve(&QrSolver, &systems));
    assert_eq!(bits(&batch[1..4]), bits(&scalar[1..4]));
    let alone = solve(&BatchSolver, &systems[..1]);
    assert_eq!((bits(&batch[..1]), bits(&batch[4..])), (bits(&alone), bits(&alone)));
}

#[test]
fn agrees_with_the_scalar_solver_whatever_the_size() {
    for (n, s) in [(1, 0), (1, 1), (2, 0), (3, 0), (3, 2), (10, 0), (30, 0), (30, 9), (100, 0)] {
        let systems: Vec<_> = (0..11).map(|i| chain(n, s, 0.02 * f64::from(i))).collect();
        for (batch, scalar) in solve(&BatchSolver, &systems).iter().zip(solve(&QrSolver, &systems)) {
            let error = distance(batch.as_ref().unwrap(), &scalar.unwrap());
            assert!(error < 1e-12, "n = {n}, s = {s}: {error:e}");
        }
    }
}

#[test]
fn a_full_mass_matrix_and_its_diagonal_neighbours_share_a_batch() {
    let plain = chain(4, 1, 0.4);
    // The same system in turned coordinates.
    let (sin, cos) = 0.6_f64.sin_cos();
    let turn = dmatrix![cos, -sin, 0.0, 0.0; sin, cos, 0.0, 0.0; 0.0, 0.0, 1.0, 0.0; 0.0, 0.0, 0.0, 1.0];
    let there = |a: &DMatrix<f64>| &turn * a * turn.transpose();
    let mut turned = plain.clone();
    let m = there(&plain.m);
    turned.m = (&m + m.transpose()) * 0.5;
    (turned.c, turned.k) = (there(&plain.c), there(&plain.k));
    turned.internal.drive = &plain.internal.drive * turn.transpose();
    turned.internal.force = &turn * &plain.internal.force;

    let spectra = solve(&BatchSolver, &[plain.clone(), turned, plain]);
    assert_eq!(spectra[0], spectra[2]);
    assert!(distance(spectra[0].as_ref().unwrap(), spectra[1].as_ref().unwrap()) < 1e-13);
}

#[test]
fn what_is_wrong_with_one_sample_stays_with_it() {
    let mut systems: Vec<_> = (0..10).map(|i| chain(5, 1, 0.1 * f64::from(i))).collect();
    let before = solve(&BatchSolver, &systems);
    systems[2].k[(1, 3)] = f64::NAN;
    systems[4].m[(2, 2)] = 0.0;
    systems[7].c = DMatrix::zeros(3, 3);
    let after = solve(&BatchSolver, &systems);
    for (i, (before, after)) in before.iter().zip(&after).enumerate() {
        match i {
            2 => {
                assert!(matches!(
                    after,
                    Err(CeaError::System(linsys::LinsysError::NotFinite { row: 2, column: 4, .. }))
                ))
            }
            4 => assert_eq!(after, &Err(CeaError::MassNotPositiveDefinite { row: 3 })),
            7 => assert!(matches!(after, Err(CeaError::System(linsys::LinsysError::Shape { .. })))),
            _ => assert_eq!(before, after),
        }
    }
}

#[test]
fn counts_each_spectrum_once_and_accepts_an_empty_batch() {
    let mut work = Workspace::default();
    let mut spectra = vec![Err(CeaError::MassNotPositiveDefinite { row: 7 })];
    BatchSolver.eigenvalues_of_all(&[], &mut work, &mut spectra);
    assert!(spectra.is_empty());
    let systems: Vec<_> = (0..19).map(|i| chain(3, 0, 0.05 * f64::from(i))).collect();
    BatchSolver.eigenvalues_of_all(&systems, &mut work, &mut spectra);
    assert_eq!((spectra.len(), work.counters.eigenvalue_solves), (19, 19));
    assert_eq!(BatchSolver.eigenvalues(&systems[7], &mut work), spectra[7]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn bits_do_not_depend_on_lane_mates_or_batch_size(
        order in Just((0..20usize).collect::<Vec<_>>()).prop_shuffle(),
        count in 1..20usize,
        n in 1..9usize,
        s in 0..3usize,
        offset in 0.0..0.5f64,
    ) {
        let systems: Vec<_> = (0..20).map(|i| chain(n, s, offset + 0.05 * f64::from(i))).collect();
        let all = bits(&solve(&BatchSolver, &systems));
        let some: Vec<_> = order[..count].iter().map(|&i| systems[i].clone()).collect();
        let expected: Vec<_> = order[..count].iter().map(|&i| all[i].clone()).collect();
        prop_assert_eq!(bits(&solve(&BatchSolver, &some)), expected);
    }

    #[test]
    fn random_systems_agree_with_the_scalar_solver(
        entries in prop::collection::vec(-1.0..1.0f64, 75),
        damping in 0.0..1.0f64,
    ) {
        let part = |from: usize| DMatrix::from_column_slice(5, 5, &entries[from..from + 25]);
        let root = part(0);
        let m = &root * root.transpose() + DMatrix::identity(5, 5);
        let system = SecondOrder::new(m, part(25) * damping, part(50) * 1e4).unwrap();
        let batch = solve(&BatchSolver, std::slice::from_ref(&system));
        let scalar = solve(&QrSolver, &[system]);
        // Random eigenvalues may be ill conditioned, with large errors in both solvers.
        prop_assert!(distance(batch[0].as_ref().unwrap(), scalar[0].as_ref().unwrap()) < 1e-8);
    }
}
