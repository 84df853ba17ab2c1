//! One oscillator against closed forms.

#![allow(clippy::unwrap_used)]

use crate::common::{contact, coulomb, eigenvalues, held, lugre, uniform};
use num_complex::Complex;
use osc_model::{
    ContactArrangement, Grid, Lateral, LatticeModel, LatticeParameters, Lean, OscModelError, Preload, Sliding,
};

/// One oscillator that moves in x and z on a plate at rest, with damping `c` in both directions.
fn two_dofs(c: f64) -> LatticeParameters {
    let mut p = uniform(Grid::new(1, 1).unwrap());
    p.x_damping = vec![0.5 * c, 0.5 * c];
    p.z_damping = vec![c];
    p
}

fn largest_growth(p: &LatticeParameters, mu: f64) -> f64 {
    let model = LatticeModel::new(p.clone(), Lateral::None, &held("y1 xp yp zp")).unwrap();
    let sliding = Sliding { speed: 1.0, contacts: vec![contact(coulomb(mu))] };
    let system = model.prepare(&ContactArrangement::full(1)).unwrap().linearised(&sliding).unwrap();
    eigenvalues(&system).iter().map(|l| l.re / l.norm()).fold(f64::NEG_INFINITY, f64::max)
}

/// `m lambda^2 + c lambda + p = 0` with p an eigenvalue of `[k_x, mu k_z - kappa; -kappa, k_z']`. On the axis
/// `lambda = i w`: `m w^2 = Re p` and `c w = Im p`, where `Re p = (k_x + k_z') / 2` once p is complex. Hence
/// `4 kappa (mu k_z - kappa) = (k_x - k_z')^2 + 4 c^2 Re p / m`.
#[test]
fn flutter_begins_at_the_coefficient_found_by_hand() {
    for c in [0.0, 181.0, 600.0] {
        let p = two_dofs(c);
        let (sin, cos) = (60_f64.to_radians().sin(), 60_f64.to_radians().cos());
        let (inclined, contact_spring) = (p.inclined_stiffness[0], p.contact_stiffness[0]);
        let kappa = inclined * sin * cos * cos;
        let k_x = p.x_stiffness[0] + p.x_stiffness[1] + inclined * (cos * cos).powi(2);
        let k_z = inclined * sin * sin + contact_spring;
        let damping = 4.0 * c * c * 0.5 * (k_x + k_z) / p.oscillator_mass[0];
        let onset = (kappa + ((k_x - k_z).powi(2) + damping) / (4.0 * kappa)) / contact_spring;

        assert!(largest_growth(&p, onset * (1.0 - 1e-6)) < 1e-10, "damping {c}");
        assert!(largest_growth(&p, onset * (1.0 + 1e-6)) > 1e-9, "damping {c}");

        let along = LatticeParameters { lean: Lean::Along, ..p };
        assert!(largest_growth(&along, 4.0 * onset) < 1e-10, "springs that lean the other way never flutter here");
    }
}

/// Free x1, z1, zp. With `w = 1/k_p + 1/k_z`: `z_p = -N/k_p`, `z = -N w`, `x = (mu N - k_xz z) / k_xx`, and the z balance
/// gives `N = F / (1 + w (k_zz - k_xz^2 / k_xx) - mu k_xz / k_xx)`.
#[test]
fn equilibrium_load_is_the_one_found_by_hand() {
    let (sin, cos) = (60_f64.to_radians().sin(), 60_f64.to_radians().cos());
    for (lean, mu) in [(Lean::Against, 0.5), (Lean::Against, 0.0), (Lean::Along, 0.5), (Lean::Along, 20.0)] {
        let p = LatticeParameters { lean, ..uniform(Grid::new(1, 1).unwrap()) };
        let inclined = p.inclined_stiffness[0];
        let k_xx = p.x_stiffness[0] + p.x_stiffness[1] + inclined * (cos * cos).powi(2);
        let k_xz = lean.sign() * inclined * sin * cos * cos;
        let k_zz = inclined * sin * sin;
        let w = 1.0 / p.plate.stiffness[2] + 1.0 / p.contact_stiffness[0];
        let by_hand = 600.0 / (1.0 + w * (k_zz - k_xz * k_xz / k_xx) - mu * k_xz / k_xx);

        let model = LatticeModel::new(p, Lateral::None, &held("y1 xp yp")).unwrap();
        let lattice = model.prepare(&ContactArrangement::full(1)).unwrap();
        match lattice.normal_loads(Preload::Equilibrium(600.0), &[contact(coulomb(mu))]) {
            Ok(loads) => assert!((loads[0] - by_hand).abs() < 1e-10 * by_hand, "{loads:?} against {by_hand}"),
            Err(OscModelError::LostContact { oscillator, in_contact: 1, load }) => {
                assert!(by_hand < 0.0 && (load - by_hand).abs() < 1e-10 * by_hand.abs());
                assert_eq!(oscillator, 1);
            }
            Err(error) => panic!("{error}"),
        }
        assert_eq!(by_hand < 0.0, mu == 20.0);
    }
}

/// With x1 constrained the contact slides on: the plate keeps the whole slope, and drives the bristle alone.
#[test]
fn constraint_leaves_friction_on_the_plate() {
    let p = uniform(Grid::new(1, 1).unwrap());
    let model = LatticeModel::new(p, Lateral::None, &held("x1 y1 yp")).unwrap();
    let lattice = model.prepare(&ContactArrangement::full(1)).unwrap();
    let tangent = lugre(0.7);
    let system = lattice.linearised(&Sliding { speed: 0.7, contacts: vec![contact(tangent)] }).unwrap();
    let free = lattice.structural();
    let bodies: Vec<_> = lattice.brake().bodies.iter().map(|body| (&body.name[..], &body.dofs[..])).collect();
    assert_eq!(bodies, [("1", &[0][..]), ("plate", &[1, 2][..])]); // z1; xp, zp

    let lambda = Complex::new(-30.0, 9000.0);
    let friction = system.dynamic_stiffness(lambda) - free.dynamic_stiffness(lambda);
    let slope = 600.0 * lambda * tangent.complex_slope(lambda);
    assert!((friction[(1, 1)] - slope).norm() < 1e-9 * slope.norm());
    assert!((friction[(1, 0)] + tangent.mu * 3.47e7).norm() < 1e-6);
    assert!((friction[(1, 2)] - tangent.mu * 3.47e7).norm() < 1e-6);
}
