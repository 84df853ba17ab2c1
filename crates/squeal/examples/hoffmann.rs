//! Hoffmann's two-degree-of-freedom oscillator from code: its equations, what is drawn and its study.
//! cases/hoffmann.toml is the same brake without a line of Rust, and says where the numbers come from.

use nalgebra::dmatrix;
use squeal::Error;
use squeal::cea::BatchSolver;
use squeal::linsys::{AffineSystem, Channel, ChannelGain, OperatingPoint, SecondOrder, Term};
use squeal::montecarlo::Distribution;
use squeal::osc_model::Brake;
use squeal::results::Results;
use squeal::study::{Drawn, IndependentBrake, Study};

fn main() -> Result<(), Error> {
    let (m, c) = (dmatrix![1.0, 0.0; 0.0, 1.0], dmatrix![0.05, 0.0; 0.0, 0.05]);
    let springs = SecondOrder::new(m, c, dmatrix![2.0, 1.0; 1.0, 2.0])?;
    let belt = Channel::new("belt", "friction", vec![(0, -1.0)], vec![(1, 4.0 / 3.0)]);
    let system = AffineSystem::new(vec![Term::new("springs", "dashpots", springs)?], vec![belt])?;
    let drawn = vec![Drawn::new("mu", "1", Distribution::Uniform { from: 0.5, to: 1.1 })];
    let brake = IndependentBrake::new("Hoffmann's oscillator", Brake::new(system), drawn, |_, values| {
        Ok(OperatingPoint { coefficients: vec![1.0], channels: vec![ChannelGain::proportional(values[0])] })
    })?
    .with_samples(10_000, 1);
    print!("{}", Results::sampled(&Study::new(&brake, &BatchSolver)?)?.text()?);
    Ok(())
}
