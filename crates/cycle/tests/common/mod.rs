//! Systems with known answers.

#![allow(dead_code, clippy::unwrap_used)] // Each test takes some of them.

use std::sync::Arc;

use cycle::{ContactFriction, ContactSystem, Part, SlidingContact, Smoothed};
use friction::{AmontonsCoulomb, BristleMotion};
use linsys::SecondOrder;
use nalgebra::{DMatrix, dmatrix};
use num_complex::Complex;

/// A speed so far above all others that nothing sticks, m/s.
pub const FAST: f64 = 1e6;

pub fn part(family: &str, m: DMatrix<f64>, c: DMatrix<f64>, k: DMatrix<f64>) -> Part {
    Part { family: family.into(), matrices: SecondOrder::new(m, c, k).unwrap() }
}

/// Friction of a constant coefficient.
pub fn coulomb(mu: f64, stick_speed: f64) -> Arc<dyn ContactFriction> {
    Arc::new(Smoothed { law: AmontonsCoulomb::new(mu).unwrap(), stick_speed })
}

/// Hoffmann's oscillator of `cases/hoffmann.toml`, whose contact may open.
pub fn hoffmann(mu: f64, load: f64) -> ContactSystem {
    hoffmann_under(coulomb(mu, 1e-3), load, FAST)
}

/// Hoffmann's oscillator under another friction and at another speed.
pub fn hoffmann_under(friction: Arc<dyn ContactFriction>, load: f64, speed: f64) -> ContactSystem {
    let zero = || DMatrix::zeros(2, 2);
    let springs = part("springs", dmatrix![1.0, 0.0; 0.0, 1.0], zero(), dmatrix![2.0, 1.0; 1.0, 2.0]);
    let dashpots = part("dashpots", zero(), dmatrix![0.05, 0.0; 0.0, 0.05], zero());
    let belt = SlidingContact {
        name: "belt".into(),
        family: "friction".into(),
        sliding: vec![(0, 1.0)],
        normal: vec![(1, 1.0)],
        stiffness: 4.0 / 3.0,
        load,
        speed,
        friction,
    };
    ContactSystem::new(vec![springs, dashpots], vec![belt]).unwrap()
}

/// The growing mode of Hoffmann's oscillator: (lambda^2 + c lambda + 2) (x, y) = (mu k3 - 1, -1) crosswise.
pub fn hoffmann_mode(mu: f64) -> (Complex<f64>, Vec<Complex<f64>>) {
    let root = Complex::from(mu * 4.0 / 3.0 - 1.0).sqrt() * Complex::i();
    // x'' + c x' + 2 x + (1 - D) y = 0 with s^2 + c s + 2 = -+ root.
    let lambdas = [root, -root].map(|root| {
        let half = (Complex::from(0.000625 - 2.0) + root).sqrt();
        if half.im > 0.0 { half - 0.025 } else { -half - 0.025 }
    });
    let lambda = if lambdas[0].re > lambdas[1].re { lambdas[0] } else { lambdas[1] };
    let stiffness = lambda * lambda + lambda * 0.05 + 2.0;
    (lambda, vec![-stiffness, Complex::from(1.0)])
}

/// A mass of 1 on a spring of 1 whose belt moves with `speed` under a normal force of 1.
pub fn mass_on_belt(speed: f64, damping: f64, friction: Arc<dyn ContactFriction>) -> ContactSystem {
    mass_on_belts(&[1.0], speed, damping, friction)
}

/// A mass of 1 on a spring of 1 on several belts with these normal forces.
pub fn mass_on_belts(loads: &[f64], speed: f64, damping: f64, friction: Arc<dyn ContactFriction>) -> ContactSystem {
    let mass = part("damping", dmatrix![1.0], dmatrix![damping], dmatrix![1.0]);
    let belt = |&load: &f64| SlidingContact {
        name: "belt".into(),
        family: "friction".into(),
        sliding: vec![(0, 1.0)],
        normal: Vec::new(),
        stiffness: 0.0,
        load,
        speed,
        friction: Arc::clone(&friction),
    };
    ContactSystem::new(vec![mass], loads.iter().map(belt).collect()).unwrap()
}

/// A coefficient that is a function of the sliding velocity, with its derivative.
pub struct Curve(pub fn(f64) -> (f64, f64));

impl std::fmt::Debug for Curve {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a curve")
    }
}

impl ContactFriction for Curve {
    fn at(&self, velocity: f64, _: f64) -> BristleMotion {
        let (mu, mu_by_velocity) = (self.0)(velocity);
        BristleMotion { mu, mu_by_velocity, ..BristleMotion::default() }
    }

    fn steady_state(&self, _: f64) -> Option<f64> {
        None
    }

    fn stick_speed(&self) -> f64 {
        1e-6
    }
}
