//! Shared by the tests of this crate: the lattice of the published case, and the comparison of spectra as sets.
#![allow(clippy::unwrap_used)]

use cea::{EigenSolver, QrSolver, Workspace};
use friction::{AmontonsCoulomb, BristleDamping, FrictionLaw, LuGre, LuGreParameters, Tangent};
use linsys::SecondOrder;
use num_complex::Complex;
use osc_model::{
    ContactArrangement, ContactPoint, Dof, Grid, Lateral, LatticeModel, LatticeParameters, Lean, PlateParameters,
    Sliding,
};

/// The 3 x 3 lattice of the published table, with oscillators of 0.39 kg.
pub fn table_1() -> LatticeParameters {
    uniform(Grid::new(3, 3).unwrap())
}

/// A lattice of any size with the springs and dashpots of that table.
pub fn uniform(grid: Grid) -> LatticeParameters {
    let each = |value: f64| vec![value; grid.oscillators()];
    LatticeParameters {
        grid,
        x_stiffness: grid.x_chains(2.45e7, 1.05e7),
        y_stiffness: grid.y_chains(3.05e7, 3.01e7),
        x_damping: grid.x_chains(181.0, 181.0),
        y_damping: grid.y_chains(181.0, 181.0),
        z_damping: each(181.0),
        inclined_stiffness: each(3.10e7),
        theta: 60_f64.to_radians(),
        phi: 60_f64.to_radians(),
        lean: Lean::Against,
        contact_stiffness: each(3.47e7),
        oscillator_mass: each(0.39),
        plate: PlateParameters { mass: 9.05, stiffness: [4.87e8, 4.87e8, 4.25e8], damping: [1.55e3; 3] },
    }
}

pub fn held(names: &str) -> Vec<Dof> {
    names.split_whitespace().map(|name| name.parse().unwrap()).collect()
}

pub fn model(lateral: Lateral, constraints: &str) -> LatticeModel {
    LatticeModel::new(table_1(), lateral, &held(constraints)).unwrap()
}

pub fn coulomb(mu: f64) -> Tangent {
    AmontonsCoulomb::new(mu).unwrap().tangent_at(1.0).unwrap()
}

pub fn lugre(speed: f64) -> Tangent {
    let parameters = LuGreParameters {
        mu_s: 0.55,
        mu_k: 0.45,
        v_s: 0.6,
        sigma0: 1e5,
        sigma1: 10.0,
        sigma2: 0.004,
        bristle_damping: BristleDamping::Constant,
    };
    LuGre::new(parameters).unwrap().tangent_at(speed).unwrap()
}

pub fn contact(tangent: Tangent) -> ContactPoint {
    ContactPoint { tangent, lateral_mu: 0.4, normal_load: 600.0 }
}

/// The same contact at each of `count` oscillators.
pub fn shared(tangent: Tangent, count: usize) -> Sliding {
    Sliding { speed: 0.7, contacts: vec![contact(tangent); count] }
}

pub fn eigenvalues(system: &SecondOrder) -> Vec<Complex<f64>> {
    QrSolver.eigenvalues(system, &mut Workspace::default()).unwrap().eigenvalues
}

pub fn spectrum(model: &LatticeModel, arrangement: &ContactArrangement, sliding: &Sliding) -> Vec<Complex<f64>> {
    eigenvalues(&model.prepare(arrangement).unwrap().linearised(sliding).unwrap())
}

/// Largest distance between two spectra as sets, each eigenvalue relative to its own size.
pub fn set_distance(a: &[Complex<f64>], b: &[Complex<f64>]) -> f64 {
    assert_eq!(a.len(), b.len());
    let mut left = b.to_vec();
    let mut worst = 0.0_f64;
    for x in a {
        let distance = |y: &Complex<f64>| (x - y).norm();
        let nearest = (0..left.len()).min_by(|&i, &j| distance(&left[i]).total_cmp(&distance(&left[j]))).unwrap();
        worst = worst.max(distance(&left.swap_remove(nearest)) / x.norm());
    }
    worst
}
