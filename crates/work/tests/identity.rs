//! Work against its definition in time, and the energy identity on random systems.

#![allow(clippy::unwrap_used)]

use std::f64::consts::{PI, TAU};

use cea::{EigenSolver, QrSolver, Workspace, right_vector};
use linsys::{Internal, SecondOrder};
use nalgebra::{DMatrix, DVector, dmatrix, dvector};
use num_complex::Complex;
use proptest::prelude::*;
use work::{WorkError, mode_work};

const ORDER: usize = 5;
const STATES: usize = 2;

/// A structure with symmetric matrices and any friction part at all.
fn systems() -> impl Strategy<Value = (SecondOrder, SecondOrder)> {
    let entries = |count: usize| prop::collection::vec(-1.0..1.0, count);
    let square = ORDER * ORDER;
    (
        [entries(square), entries(square), entries(square), entries(square), entries(square)],
        entries(STATES * ORDER),
        entries(STATES * ORDER),
        prop::collection::vec(0.5..3.0, STATES),
    )
        .prop_map(|([m, c, k, friction_c, friction_k], drive, force, decay)| {
            let matrix = |entries: &[f64]| DMatrix::from_column_slice(ORDER, ORDER, entries);
            let positive = |entries: &[f64]| matrix(entries) * matrix(entries).transpose();
            let structure = SecondOrder::new(
                positive(&m) + DMatrix::identity(ORDER, ORDER),
                0.2 * matrix(&c),
                positive(&k) * 4.0 + DMatrix::identity(ORDER, ORDER),
            );
            let internal = Internal {
                decay: DVector::from_vec(decay),
                drive: DMatrix::from_column_slice(STATES, ORDER, &drive),
                force: DMatrix::from_column_slice(ORDER, STATES, &force),
            };
            let zero = DMatrix::zeros(ORDER, ORDER);
            let friction = SecondOrder::with_internal(zero, matrix(&friction_c), matrix(&friction_k), internal);
            (structure.unwrap(), friction.unwrap())
        })
}

fn sum(structure: &SecondOrder, friction: &SecondOrder) -> SecondOrder {
    let (c, k) = (&structure.c + &friction.c, &structure.k + &friction.k);
    SecondOrder::with_internal(structure.m.clone(), c, k, friction.internal.clone()).unwrap()
}

proptest! {
    #[test]
    fn net_work_is_what_the_mode_gains((structure, friction) in systems(), scale in 0.1..10.0, angle in 0.0..TAU) {
        let (system, work) = (sum(&structure, &friction), &mut Workspace::default());
        let bodies = [vec![0, 1], vec![2], vec![3, 4]];
        for lambda in QrSolver.eigenvalues(&system, work).unwrap().oscillatory() {
            let phi = right_vector(&system, lambda, work).unwrap();
            let found = mode_work(&structure, &friction, lambda, &phi, &bodies).unwrap();
            prop_assert!(found.identity_residual() < 1e-9, "{lambda}: {:e}", found.identity_residual());
            prop_assert!((found.net().iter().sum::<f64>() - found.total).abs() <= 1e-12 * found.magnitude);

            let rescaled = phi * Complex::from_polar(scale, angle);
            let again = mode_work(&structure, &friction, lambda, &rescaled, &bodies).unwrap();
            for (a, b) in found.net().iter().zip(again.net()) {
                prop_assert!((a - b).abs() <= 1e-12 * found.magnitude, "work depends on the scale of phi");
            }
        }
    }
}

/// Force times velocity over one period at frozen amplitude. The trapezoidal rule is exact for it.
#[test]
fn work_is_the_integral_of_force_times_velocity() {
    let structure = SecondOrder::new(dmatrix![2.0], dmatrix![0.6], dmatrix![50.0]).unwrap();
    let internal = Internal { decay: dvector![4.0], drive: dmatrix![-0.7], force: dmatrix![5.0] };
    let friction = SecondOrder::with_internal(dmatrix![0.0], dmatrix![-0.9], dmatrix![3.0], internal).unwrap();
    let (lambda, u) = (Complex::new(0.25, 4.5), Complex::new(0.3, -0.4));
    let bristle = lambda * -0.7 * u / (lambda + 4.0);
    let friction_force = -(lambda * -0.9 + 3.0) * u + 5.0 * bristle;
    let damping_force = -lambda * 0.6 * u;

    let steps = 64;
    let integral = |force: Complex<f64>| -> f64 {
        let step = TAU / lambda.im / f64::from(steps);
        let turning = |amplitude: Complex<f64>, t: f64| (amplitude * Complex::from_polar(1.0, lambda.im * t)).re;
        let power = |t: f64| turning(force, t) * turning(Complex::i() * lambda.im * u, t);
        (0..steps).map(|i| power(f64::from(i) * step) * step).sum()
    };
    let modal_mass = 2.0 * u.norm_sqr();
    let found = mode_work(&structure, &friction, lambda, &dvector![u], &[[0]]).unwrap();
    assert!((found.friction[0] - integral(friction_force) / modal_mass).abs() < 1e-12);
    assert!((found.damping[0] - integral(damping_force) / modal_mass).abs() < 1e-12);
    // Not an eigenpair, so the identity must fail visibly.
    assert!((found.expected_total - 2.0 * PI * 0.25 * 4.5).abs() < 1e-12);
    assert!(found.identity_residual() > 0.01);
}

#[test]
fn refuses_what_does_not_fit() {
    let one = |m: f64| SecondOrder::new(dmatrix![m], dmatrix![0.0], dmatrix![1.0]).unwrap();
    let two = SecondOrder::zeros(2, 0);
    let (i, phi) = (Complex::i(), dvector![Complex::i()]);
    let message = |result: Result<work::ModeWork, WorkError>| result.unwrap_err().to_string();
    assert_eq!(
        message(mode_work(&two, &two, i, &phi, &[[0]])),
        "the mode shape has 1 degrees of freedom, the structure has 2"
    );
    assert_eq!(
        message(mode_work(&one(1.0), &two, i, &phi, &[[0]])),
        "the friction part has 2 degrees of freedom, the structure has 1"
    );
    assert_eq!(
        message(mode_work(&one(1.0), &one(0.0), i, &phi, &[vec![0], vec![1]])),
        "body 1 owns degree of freedom 1; there are 1, numbered from 0"
    );
    assert_eq!(mode_work(&one(0.0), &one(0.0), i, &phi, &[[0]]), Err(WorkError::ModalMass { value: 0.0 }));
    let mut bristle = SecondOrder::zeros(1, 1);
    bristle.internal.decay[0] = 3.0;
    let lambda = Complex::new(-3.0, 0.0);
    assert_eq!(mode_work(&one(1.0), &bristle, lambda, &phi, &[[0]]), Err(WorkError::InternalPole { lambda, state: 0 }));
}
