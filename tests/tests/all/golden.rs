//! The 32 cases of `fixtures/lattice/golden.json`, solved by an independent implementation (see its README).

#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::Path;

use cea::{BatchSolver, EigenSolver, QrSolver, Workspace, certified, right_vector};
use friction::{
    AmontonsCoulomb, BristleDamping, FrictionLaw, LuGre, LuGreParameters, Tangent, VelocityDependent,
    VelocityDependentParameters,
};
use linsys::SecondOrder;
use num_complex::Complex;
use osc_model::{
    ContactArrangement, ContactPoint, Dof, Grid, Lateral, LatticeModel, LatticeParameters, Lean, PlateParameters,
    PreparedLattice, Sign, Sliding,
};
use serde::Deserialize;
use work::{ForceFamily, ModeWork, family_work};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Golden {
    case: Case,
    eigenvalues_upper: Vec<[f64; 2]>,
    work_mode: WorkMode,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Case {
    contact: Vec<usize>,
    law: String,
    params: Vec<Parameters>,
    lateral: String,
    mu_y: Vec<f64>,
    constrained: Vec<usize>,
    speed: f64,
    preload: f64,
    oscillator_mass: f64,
    lean: i32,
    lateral_sign: i32,
}

#[derive(Deserialize, Clone, Copy, Default)]
#[serde(deny_unknown_fields, default)]
struct Parameters {
    mu: f64,
    mu_k: f64,
    mu_s: f64,
    alpha: f64,
    v_s: f64,
    sigma0: f64,
    sigma1: f64,
    sigma2: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WorkMode {
    lambda: [f64; 2],
    friction_work: Vec<f64>,
    damping_work: Vec<f64>,
    net_work_total: f64,
}

fn golden() -> Vec<Golden> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/lattice/golden.json");
    let cases: Vec<Golden> = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    assert_eq!(cases.len(), 32);
    cases
}

impl Case {
    fn tangent(&self, p: Parameters) -> Tangent {
        let Parameters { mu, mu_k, mu_s, alpha, v_s, sigma0, sigma1, sigma2 } = p;
        let law: Box<dyn FrictionLaw> = match self.law.as_str() {
            "amontons-coulomb" => Box::new(AmontonsCoulomb::new(mu).unwrap()),
            "velocity-dependent" => {
                Box::new(VelocityDependent::new(VelocityDependentParameters { mu_s, mu_k, alpha }).unwrap())
            }
            "lugre" => {
                let bristle_damping = BristleDamping::Constant;
                let parameters = LuGreParameters { mu_s, mu_k, v_s, sigma0, sigma1, sigma2, bristle_damping };
                Box::new(LuGre::new(parameters).unwrap())
            }
            other => panic!("law {other}"),
        };
        law.tangent_at(self.speed).unwrap()
    }

    /// Table 1.
    fn parameters(&self) -> LatticeParameters {
        let grid = Grid::new(3, 3).unwrap();
        LatticeParameters {
            grid,
            x_stiffness: grid.x_chains(2.45e7, 1.05e7),
            y_stiffness: grid.y_chains(3.05e7, 3.01e7),
            x_damping: grid.x_chains(181.0, 181.0),
            y_damping: grid.y_chains(181.0, 181.0),
            z_damping: vec![181.0; 9],
            inclined_stiffness: vec![3.10e7; 9],
            theta: 60_f64.to_radians(),
            phi: 60_f64.to_radians(),
            lean: if self.lean < 0 { Lean::Against } else { Lean::Along },
            contact_stiffness: vec![3.47e7; 9],
            oscillator_mass: vec![self.oscillator_mass; 9],
            plate: PlateParameters { mass: 9.05, stiffness: [4.87e8, 4.87e8, 4.25e8], damping: [1.55e3; 3] },
        }
    }

    fn lattice(&self) -> PreparedLattice {
        let sign = if self.lateral_sign < 0 { Sign::Minus } else { Sign::Plus };
        let lateral = match self.lateral.as_str() {
            "none" => Lateral::None,
            "coupled" => Lateral::Coupled { sign },
            "vector" => Lateral::Vector,
            other => panic!("lateral {other}"),
        };
        let constraints: Vec<Dof> = self.constrained.iter().map(|&i| Dof::at(i, 9).unwrap()).collect();
        let model = LatticeModel::new(self.parameters(), lateral, &constraints).unwrap();
        model.prepare(&ContactArrangement::new(9, &self.contact).unwrap()).unwrap()
    }

    fn sliding(&self) -> Sliding {
        let contacts = self.params.iter().zip(&self.mu_y).map(|(&p, &lateral_mu)| ContactPoint {
            tangent: self.tangent(p),
            lateral_mu,
            normal_load: self.preload,
        });
        assert!(self.contact.is_sorted(), "contacts are listed in the order of the arrangement");
        Sliding { speed: self.speed, contacts: contacts.collect() }
    }
}

fn general_route(system: &SecondOrder) -> Vec<Complex<f64>> {
    certified::solve(system, &mut certified::Counters::default()).unwrap().eigenvalues
}

fn by(solver: &dyn EigenSolver, system: &SecondOrder) -> Vec<Complex<f64>> {
    solver.eigenvalues(system, &mut Workspace::default()).unwrap().eigenvalues
}

#[test]
fn eigenvalues_are_the_golden_ones_by_every_route() {
    type Route = fn(&SecondOrder) -> Vec<Complex<f64>>;
    let routes: [(&str, Route); 3] = [
        ("QrSolver", |system| by(&QrSolver, system)),
        ("BatchSolver", |system| by(&BatchSolver, system)),
        ("general", general_route),
    ];
    for (route, eigenvalues) in routes {
        let mut worst = 0.0_f64;
        for (number, golden) in golden().iter().enumerate() {
            let system: SecondOrder = golden.case.lattice().linearised(&golden.case.sliding()).unwrap();
            let mut ours: Vec<Complex<f64>> = eigenvalues(&system).into_iter().filter(|l| l.im > 0.0).collect();
            for &[re, im] in &golden.eigenvalues_upper {
                let expected = Complex::new(re, im);
                let distance = |l: &Complex<f64>| (l - expected).norm();
                let nearest =
                    (0..ours.len()).min_by(|&i, &j| distance(&ours[i]).total_cmp(&distance(&ours[j]))).unwrap();
                worst = worst.max(distance(&ours.swap_remove(nearest)) / expected.norm());
            }
            // Equal bristles are a multiple real eigenvalue, which rounding may spread off the axis.
            assert!(ours.iter().all(|l| l.im <= 1e-4 * l.norm()), "{route}, case {number}: {ours:?}");
        }
        println!("{route}: largest relative distance {worst:.1e}");
        assert!(worst < 1e-9, "{route}: {worst:e}");
    }
}

fn work_of(golden: &Golden, lambda: Complex<f64>) -> ModeWork {
    let (lattice, sliding) = (golden.case.lattice(), golden.case.sliding());
    let at = lattice.operating_point(&sliding).unwrap();
    let brake = lattice.brake();
    let mut friction = SecondOrder::zeros(brake.system.order(), 0);
    brake.system.friction_into(&at, &mut friction).unwrap();
    let system = lattice.linearised(&sliding).unwrap();
    let phi = right_vector(&system, lambda, &mut Workspace::default()).unwrap();
    let structure = lattice.structural();
    let damping = SecondOrder { c: structure.c.clone(), ..SecondOrder::zeros(structure.order(), 0) };
    let families =
        [ForceFamily { name: "friction", system: &friction }, ForceFamily { name: "damping", system: &damping }];
    family_work(&system.m, &families, lambda, &phi, &brake.bodies).unwrap()
}

#[test]
fn work_is_the_golden_one() {
    let mut worst = 0.0_f64;
    for golden in &golden() {
        let expected = &golden.work_mode;
        let [re, im] = expected.lambda;
        let ours = work_of(golden, Complex::new(re, im));
        let found = ours.families.iter().map(|family| &family.bodies);
        let families: Vec<_> = found.zip([&expected.friction_work, &expected.damping_work]).collect();
        assert_eq!(families.len(), 2);
        let largest = families.iter().flat_map(|(_, w)| w.iter()).fold(0.0_f64, |most, w| most.max(w.abs()));
        for (found, expected) in families {
            assert_eq!(found.len(), expected.len());
            for (a, b) in found.iter().zip(expected) {
                worst = worst.max((a - b).abs() / largest);
            }
        }
        worst = worst.max((ours.total - expected.net_work_total).abs() / largest);
    }
    println!("largest error over max|W_j| {worst:.1e}");
    assert!(worst < 1e-7, "{worst:e}");
}

#[test]
fn every_golden_mode_gains_its_net_work() {
    let mut worst = 0.0_f64;
    for golden in &golden() {
        for &[re, im] in &golden.eigenvalues_upper {
            worst = worst.max(work_of(golden, Complex::new(re, im)).identity_residual());
        }
    }
    println!("largest residual of the energy identity {worst:.1e}");
    assert!(worst < 1e-9, "{worst:e}");
}
