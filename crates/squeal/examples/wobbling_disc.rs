//! A gyroscopic wobbling disc between two pads as a type of one's own. cases/wobbling-disc.toml is the same brake without a
//! line of Rust; its comments derive the equations and say where the numbers come from.

use squeal::cea::BatchSolver;
use squeal::linsys::{AffineSystem, OperatingPoint, SecondOrder, Term};
use squeal::montecarlo::{Distribution, StreamRng};
use squeal::study::{self, Plan, Scene, Study, UncertainBrake};
use squeal::{Error, nalgebra::DMatrix, osc_model::Brake, results::Results};

/// A 2 x 2 matrix by rows.
type Rows = [f64; 4];
/// Family, M, C and K of the terms whose coefficients are 1, Omega, N0, mu, mu N0, mu^2 N0 and mu N0 / Omega.
const TERMS: [(&str, Rows, Rows, Rows); 7] = [
    ("dashpots", [0.16, 0.0, 0.0, 0.16], [0.1, 0.0, 0.0, 0.269], [1.88e7, 0.0, 0.0, 1.90028e7]),
    ("gyroscopic", [0.0; 4], [0.0, 0.32, -0.32, 0.0], [0.0; 4]),
    ("preload", [0.0; 4], [0.0; 4], [0.02, 0.0, 0.0, 0.02]),
    ("friction", [0.0; 4], [0.0, 0.013, 0.0, 0.0], [0.0, 15600.0, 0.0, 0.0]),
    ("friction", [0.0; 4], [0.0; 4], [0.0, 0.26, -0.02 * 0.02 / 0.26, 0.0]),
    ("friction", [0.0; 4], [0.0; 4], [0.02, 0.0, 0.0, 0.0]),
    ("friction", [0.0; 4], [0.0, 0.0, 0.0, 0.02 * 0.02 / 0.26], [0.0; 4]),
];
const MU: Distribution = Distribution::Uniform { from: 0.3, to: 0.7 };
const OMEGA: Distribution = Distribution::Uniform { from: 5.0, to: 100.0 };
const N0: Distribution = Distribution::LogNormal { median: 3000.0, sigma: 0.2, at_least: None, at_most: None };

struct WobblingDisc(Plan);

fn at(&[mu, omega, n0]: &[f64; 3]) -> OperatingPoint {
    let coefficients = vec![1.0, omega, n0, mu, mu * n0, mu * mu * n0, mu * n0 / omega];
    OperatingPoint { coefficients, channels: Vec::new() }
}

impl UncertainBrake for WobblingDisc {
    type Sample = [f64; 3];

    fn plan(&self) -> &Plan {
        &self.0
    }
    fn draw(&self, rng: &mut StreamRng) -> Result<[f64; 3], study::Error> {
        Ok([MU.draw(rng)?, OMEGA.draw(rng)?, N0.draw(rng)?])
    }
    fn median(&self) -> [f64; 3] {
        [MU, OMEGA, N0].map(|parameter| parameter.median())
    }
    fn operating_point(&self, _: &Scene, sample: &[f64; 3]) -> Result<OperatingPoint, study::Error> {
        Ok(at(sample))
    }
}

fn main() -> Result<(), Error> {
    let matrix = |rows: [f64; 4]| DMatrix::from_row_slice(2, 2, &rows);
    let term = |(family, m, c, k)| Term::new(family, family, SecondOrder::new(matrix(m), matrix(c), matrix(k))?);
    let system = AffineSystem::new(TERMS.into_iter().map(term).collect::<Result<_, _>>()?, Vec::new())?;
    let median = at(&[MU, OMEGA, N0].map(|parameter| parameter.median()));
    let disc = WobblingDisc(Plan::single("wobbling disc", Brake::new(system), median, 10_000, 1));
    print!("{}", Results::sampled(&Study::new(&disc, &BatchSolver)?)?.text()?);
    Ok(())
}
