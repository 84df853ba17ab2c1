//! Work against a time integral of its definition, and the energy identity on random systems.

#![allow(clippy::unwrap_used)]

use std::f64::consts::{PI, TAU};

use cea::{EigenSolver, QrSolver, Workspace, right_vector};
use linsys::{Internal, SecondOrder};
use nalgebra::{DMatrix, DVector, dmatrix, dvector};
use num_complex::Complex;
use proptest::prelude::*;
use work::{Energy, ForceFamily, ModeWork, StructurePart, WorkError, family_work, mode_energy};

const ORDER: usize = 5;
const STATES: usize = 2;

/// A structure with symmetric matrices, and a friction part of any kind.
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

/// Work of friction and of the structure's dashpots, in this order.
fn two_families(
    structure: &SecondOrder,
    friction: &SecondOrder,
    lambda: Complex<f64>,
    phi: &DVector<Complex<f64>>,
    bodies: &[Vec<usize>],
) -> Result<ModeWork, WorkError> {
    let damping = SecondOrder { c: structure.c.clone(), ..SecondOrder::zeros(structure.order(), 0) };
    let families =
        [ForceFamily { name: "friction", system: friction }, ForceFamily { name: "damping", system: &damping }];
    family_work(&structure.m, &families, lambda, phi, bodies)
}

proptest! {
    #[test]
    fn net_work_is_what_the_mode_gains((structure, friction) in systems(), scale in 0.1..10.0, angle in 0.0..TAU) {
        let (system, work) = (sum(&structure, &friction), &mut Workspace::default());
        let bodies = [vec![0, 1], vec![2], vec![3, 4]];
        for lambda in QrSolver.eigenvalues(&system, work).unwrap().oscillatory() {
            let phi = right_vector(&system, lambda, work).unwrap();
            let found = two_families(&structure, &friction, lambda, &phi, &bodies).unwrap();
            prop_assert!(found.identity_residual() < 1e-9, "{lambda}: {:e}", found.identity_residual());
            prop_assert!((found.net().iter().sum::<f64>() - found.total).abs() <= 1e-12 * found.magnitude);

            let rescaled = phi * Complex::from_polar(scale, angle);
            let again = two_families(&structure, &friction, lambda, &rescaled, &bodies).unwrap();
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
    let found = two_families(&structure, &friction, lambda, &dvector![u], &[vec![0]]).unwrap();
    assert!((found.families[0].bodies[0] - integral(friction_force) / modal_mass).abs() < 1e-12);
    assert!((found.families[1].bodies[0] - integral(damping_force) / modal_mass).abs() < 1e-12);
    // This is no eigenpair, so that the identity fails.
    assert!((found.expected_total - 2.0 * PI * 0.25 * 4.5).abs() < 1e-12);
    assert!(found.identity_residual() > 0.01);
}

/// Splitting a family into its terms, in any order, changes neither the work on a body nor a sum.
#[test]
fn families_add_up() {
    let mass = dmatrix![2.0, 0.0; 0.0, 1.0];
    let gyroscopic =
        SecondOrder::new(DMatrix::zeros(2, 2), dmatrix![0.0, 0.8; -0.8, 0.0], DMatrix::zeros(2, 2)).unwrap();
    let follower = SecondOrder::new(DMatrix::zeros(2, 2), DMatrix::zeros(2, 2), dmatrix![0.0, 3.0; -1.0, 0.0]).unwrap();
    let dashpots = SecondOrder::new(DMatrix::zeros(2, 2), dmatrix![0.1, 0.0; 0.0, 0.3], DMatrix::zeros(2, 2)).unwrap();
    let k = dmatrix![90.0, -20.0; -20.0, 50.0];
    let system = SecondOrder::new(mass.clone(), &gyroscopic.c + &dashpots.c, &k + &follower.k).unwrap();
    let together = SecondOrder::new(DMatrix::zeros(2, 2), &gyroscopic.c + &dashpots.c, follower.k.clone()).unwrap();

    let (bodies, work) = ([vec![0], vec![1]], &mut Workspace::default());
    let apart = [
        ForceFamily { name: "gyroscopic", system: &gyroscopic },
        ForceFamily { name: "follower", system: &follower },
        ForceFamily { name: "dashpots", system: &dashpots },
    ];
    let mut modes = 0;
    for lambda in QrSolver.eigenvalues(&system, work).unwrap().oscillatory() {
        let phi = right_vector(&system, lambda, work).unwrap();
        let apart = family_work(&mass, &apart, lambda, &phi, &bodies).unwrap();
        let together =
            family_work(&mass, &[ForceFamily { name: "all", system: &together }], lambda, &phi, &bodies).unwrap();
        assert!(apart.identity_residual() < 1e-12 && together.identity_residual() < 1e-12);
        for (a, b) in apart.net().iter().zip(&together.families[0].bodies) {
            assert!((a - b).abs() < 1e-12 * apart.magnitude);
        }
        assert_eq!(
            apart.families.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(),
            ["gyroscopic", "follower", "dashpots"]
        );
        // Dashpots take energy from every body.
        assert!(apart.families[2].bodies.iter().all(|&work| work < 0.0));
        modes += 1;
    }
    assert_eq!(modes, 2);
}

#[test]
fn refuses_what_does_not_fit() {
    let one = |m: f64| SecondOrder::new(dmatrix![m], dmatrix![0.0], dmatrix![1.0]).unwrap();
    let (mut broken, two) = (one(1.0), SecondOrder::zeros(2, 0));
    broken.c[0] = f64::NAN;
    let (i, phi) = (Complex::i(), dvector![Complex::i()]);
    fn friction(system: &SecondOrder) -> [ForceFamily<'_>; 1] {
        [ForceFamily { name: "friction", system }]
    }
    let message = |result: Result<ModeWork, WorkError>| result.unwrap_err().to_string();
    assert_eq!(
        message(family_work(&two.m, &friction(&two), i, &phi, &[[0]])),
        "the mode shape has 1 degrees of freedom, the mass matrix has 2"
    );
    assert_eq!(
        message(family_work(&dmatrix![1.0, 0.0], &friction(&two), i, &phi, &[[0]])),
        "the mass matrix is 1 x 2; it must be square"
    );
    assert_eq!(
        message(family_work(&one(1.0).m, &friction(&two), i, &phi, &[[0]])),
        "the force family \"friction\" has 2 degrees of freedom, the mass matrix has 1"
    );
    assert_eq!(
        message(family_work(&one(1.0).m, &friction(&broken), i, &phi, &[[0]])),
        "the force family \"friction\" is no system"
    );
    assert_eq!(family_work(&one(1.0).m, &[], i, &phi, &[[0]]), Err(WorkError::NoFamily));
    assert_eq!(
        message(family_work(&one(1.0).m, &friction(&one(0.0)), i, &phi, &[vec![0], vec![1]])),
        "body 1 owns degree of freedom 1; there are 1, numbered from 0"
    );
    assert_eq!(
        family_work(&one(0.0).m, &friction(&one(0.0)), i, &phi, &[[0]]),
        Err(WorkError::ModalMass { value: 0.0 })
    );
    let mut bristle = SecondOrder::zeros(1, 1);
    bristle.internal.decay[0] = 3.0;
    let lambda = Complex::new(-3.0, 0.0);
    let expected = WorkError::InternalPole { family: "friction".into(), lambda, state: 0 };
    assert_eq!(family_work(&one(1.0).m, &friction(&bristle), lambda, &phi, &[[0]]), Err(expected));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// `d E / d t = 2 Re(lambda) E` is the mean power of dashpots and friction, `Re(conj(lambda) phi^H f) / 2`.
    #[test]
    fn energy_grows_by_the_power_that_is_fed((structure, friction) in systems()) {
        let (system, work) = (sum(&structure, &friction), &mut Workspace::default());
        let half = SecondOrder { c: DMatrix::zeros(ORDER, ORDER), ..structure.clone() };
        let halves = [0.25, 0.75].map(|part| SecondOrder { m: &half.m * part, k: &half.k * (1.0 - part), ..half.clone() });
        let parts = [("one", &halves[0]), ("two", &halves[1])].map(|(name, system)| StructurePart { name, system });
        let bodies = [vec![0, 3], vec![1, 2, 4]];
        for lambda in QrSolver.eigenvalues(&system, work).unwrap().oscillatory() {
            let phi = right_vector(&system, lambda, work).unwrap();
            let energy = mode_energy(&parts, lambda, &phi, &bodies).unwrap();
            // The forces of all that is not elastic, from the elastic ones of the whole.
            let forces = SecondOrder { m: DMatrix::zeros(ORDER, ORDER), k: &system.k - &structure.k, ..system.clone() };
            let power = -0.5 * (lambda.conj() * phi.dotc(&(forces.dynamic_stiffness(lambda) * &phi))).re;
            let per_mass = power / phi.dotc(&(structure.m.map(Complex::from) * &phi)).re;
            let Energy { kinetic, strain } = energy.total;
            let grows = 2.0 * lambda.re * (kinetic + strain);
            prop_assert!((grows - per_mass).abs() < 1e-10 * (per_mass.abs() + lambda.norm() * kinetic), "{grows} {per_mass}");
            let [sum_of_parts, sum_of_bodies] = [
                energy.parts.iter().map(|(_, energy)| *energy).collect::<Vec<_>>(),
                energy.bodies.clone(),
            ].map(|list| list.into_iter().fold(Energy::default(), |mut sum, energy| { sum += energy; sum }));
            for sum in [sum_of_parts, sum_of_bodies] {
                prop_assert!((sum.kinetic - kinetic).abs() < 1e-12 * kinetic && (sum.strain - strain).abs() < 1e-10 * strain);
            }
            prop_assert!((energy.parts[0].1.kinetic / kinetic - 0.25).abs() < 1e-12);
            prop_assert!((energy.parts[0].1.strain / strain - 0.75).abs() < 1e-10);
        }
    }
}

#[test]
fn refuses_parts_that_do_not_fit() {
    let (one, phi) = (SecondOrder::zeros(1, 0), dvector![Complex::i(), Complex::i()]);
    let energy = |parts: &[StructurePart<'_>]| mode_energy(parts, Complex::i(), &phi, &[[0]]).unwrap_err().to_string();
    assert_eq!(energy(&[]), "no part of the structure is given; energy needs at least one");
    let part = StructurePart { name: "pad", system: &one };
    assert_eq!(energy(&[part]), "the part \"pad\" has 1 degrees of freedom, the mode shape has 2");
    let two = SecondOrder::zeros(2, 0);
    assert_eq!(
        energy(&[StructurePart { name: "pad", system: &two }]),
        "phi^H M phi = 0; it must be finite and positive"
    );
}
