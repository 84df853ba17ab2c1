//! Cycles against another integrator, Hairer's DOP853 of the crate `ode_solvers`.

#![allow(clippy::unwrap_used, clippy::panic)] // Test code, which the lints do not recognise outside test functions.

mod common;

use std::sync::Arc;

use common::{hoffmann, hoffmann_mode, mass_on_belt};
use cycle::{Bristled, ContactSystem, Cycle, Motion, Settings, follow};
use friction::{BristleDamping, LuGre, LuGreParameters};
use num_complex::Complex;
use ode_solvers::{DVector, Dop853, OutputType, System};

struct Equations<'a>(&'a ContactSystem);

impl System<f64, DVector<f64>> for Equations<'_> {
    fn system(&self, _: f64, x: &DVector<f64>, rate: &mut DVector<f64>) {
        self.0.rate(x.as_slice(), rate.as_mut_slice());
    }
}

/// Largest difference of the states at begin and end of a cycle by the other integrator.
fn difference(system: &ContactSystem, cycle: &Cycle) -> f64 {
    let start = DVector::from_column_slice(&cycle.start);
    // Defaults of the crate but for a longest step, so that none jumps over a kink, and output at its own steps.
    let longest = cycle.period / 200.0;
    let mut other = Dop853::from_param(
        Equations(system),
        0.0,
        cycle.period,
        cycle.period,
        start,
        1e-12,
        1e-12,
        0.9,
        0.0,
        0.333,
        6.0,
        longest,
        1e-4 * cycle.period,
        1_000_000,
        1_000_000,
        OutputType::Sparse,
    );
    other.integrate().unwrap();
    let end = other.y_out().last().unwrap();
    end.iter().zip(&cycle.start).map(|(end, start)| (end - start).abs()).fold(0.0, f64::max)
}

fn cycle_of(system: &ContactSystem, start: Vec<f64>, omega: f64, shape: &[Complex<f64>]) -> Cycle {
    let settings = Settings { tolerance: 1e-11, ..Settings::default() };
    let Motion::Cycle(cycle) = follow(system, start, omega, shape, &settings).unwrap() else { panic!() };
    cycle
}

#[test]
fn another_integrator_comes_back_to_where_a_cycle_began() {
    for mu in [0.76, 0.9, 1.1] {
        let system = hoffmann(mu, 1.0);
        let (lambda, shape) = hoffmann_mode(mu);
        let start = system.state_of_mode(lambda, &shape, 1.1 * system.grazing(&shape));
        let cycle = cycle_of(&system, start, lambda.im, &shape);
        let found = difference(&system, &cycle);
        assert!(found < 1e-8, "{mu}: {found}");
    }
}

#[test]
fn another_integrator_follows_bristles_that_slide_and_stick() {
    let law = LuGre::new(LuGreParameters {
        mu_s: 1.0,
        mu_k: 0.6,
        v_s: 0.1,
        sigma0: 100.0,
        sigma1: 1.0,
        sigma2: 0.0,
        bristle_damping: BristleDamping::Constant,
    })
    .unwrap();
    let system = mass_on_belt(0.1, 0.01, Arc::new(Bristled { law, stick_speed: 1e-3 }));
    let cycle = cycle_of(&system, vec![0.2, 0.0, 0.0], 1.0, &[Complex::from(1.0)]);
    let found = difference(&system, &cycle);
    assert!(found < 1e-8, "{found}");
}
