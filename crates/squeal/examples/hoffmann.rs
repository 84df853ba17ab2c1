//! Hoffmann's two-degree-of-freedom oscillator as a type of one's own: its equations, its draw and its study.
//! cases/hoffmann.toml is the same brake without a line of Rust, and says where the numbers come from.

use squeal::Error;
use squeal::cea::BatchSolver;
use squeal::linsys::{AffineSystem, Channel, ChannelGain, OperatingPoint, SecondOrder, Term};
use squeal::montecarlo::{Distribution, StreamRng};
use squeal::nalgebra::dmatrix;
use squeal::osc_model::Brake;
use squeal::results::Results;
use squeal::study::{self, Plan, Scene, Study, UncertainBrake};

struct Hoffmann {
    mu: Distribution,
    plan: Plan,
}

/// The operating point with this coefficient of friction.
fn sliding(mu: f64) -> OperatingPoint {
    OperatingPoint { coefficients: vec![1.0], channels: vec![ChannelGain::proportional(mu)] }
}

impl Hoffmann {
    fn new() -> Result<Self, Error> {
        let (m, c) = (dmatrix![1.0, 0.0; 0.0, 1.0], dmatrix![0.05, 0.0; 0.0, 0.05]);
        let springs = SecondOrder::new(m, c, dmatrix![2.0, 1.0; 1.0, 2.0])?;
        let belt = Channel::new("belt", "friction", vec![(0, -1.0)], vec![(1, 4.0 / 3.0)]);
        let system = AffineSystem::new(vec![Term::new("springs", "dashpots", springs)?], vec![belt])?;
        let mu = Distribution::Uniform { from: 0.5, to: 1.1 };
        let plan = Plan::single("Hoffmann's oscillator", Brake::new(system), sliding(mu.median()), 10_000, 1);
        Ok(Self { mu, plan })
    }
}

impl UncertainBrake for Hoffmann {
    type Sample = f64;

    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<f64, study::Error> {
        Ok(self.mu.draw(rng)?)
    }

    fn median(&self) -> f64 {
        self.mu.median()
    }

    fn operating_point(&self, _: &Scene, mu: &f64) -> Result<OperatingPoint, study::Error> {
        Ok(sliding(*mu))
    }
}

fn main() -> Result<(), Error> {
    let brake = Hoffmann::new()?;
    print!("{}", Results::sampled(&Study::new(&brake, &BatchSolver)?)?.text()?);
    Ok(())
}
