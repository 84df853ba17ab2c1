//! The way from one friction to another: an eigenvalue at a place of it, and how fast it moves there.

use linsys::{ChannelGain, OperatingPoint};
use nalgebra::DVector;
use num_complex::Complex;

use super::FrictionModes;
use super::change::Seen;
use super::coupling::{self, Gains, Scratch};
use super::eigenvalue;
use super::rows::Rows;

/// Most rounds, and the relative size of what the last one misses; chosen: A changes with lambda by some thousandths over the band, so that
/// what is left of an eigenvalue after the step of Newton's method is below 1e-8 of it, and paths ask for 1e-5.
const MOST_ROUNDS: usize = 6;
const CONVERGED: f64 = 1e-3;
/// Steps of inverse iteration from a vector that is not known, and from one that is nearly right; chosen.
const STEPS_FROM_ANY: usize = 4;
const STEPS: usize = 2;

/// The straight line between the systems of two operating points that differ in friction alone.
#[derive(Debug)]
pub struct FrictionPath<'a> {
    modes: &'a FrictionModes,
    from: Vec<ChannelGain>,
    to: Vec<ChannelGain>,
}

/// An eigenvalue on a [`FrictionPath`].
#[derive(Debug, Clone, PartialEq)]
pub struct OnFrictionPath {
    /// rad/s.
    pub lambda: Complex<f64>,
    /// `d lambda / d t`, rad/s.
    pub rate: Complex<f64>,
    /// The shape over the coordinates of the reduced system, up to a factor.
    pub shape: DVector<Complex<f64>>,
}

impl FrictionModes {
    /// The way from one operating point to another; `None` where either differs from the known ones in more than friction.
    #[must_use]
    pub fn path(&self, from: &OperatingPoint, to: &OperatingPoint) -> Option<FrictionPath<'_>> {
        let gains = |point: &OperatingPoint| self.channels.iter().map(|&channel| point.channels[channel]).collect();
        (self.is_of(from) && self.is_of(to)).then(|| FrictionPath { modes: self, from: gains(from), to: gains(to) })
    }
}

impl FrictionPath<'_> {
    /// `det(lambda - A(lambda))` at places of the path, 0 at its beginning and 1 at its end, and numbers, rad/s: up to a factor that is
    /// always the same, so that no product of many large numbers overflows.
    #[must_use]
    pub fn characteristic(&self, at: &[(f64, Complex<f64>)]) -> Vec<Complex<f64>> {
        let ports = &self.modes.ports;
        let (p, scale) = (ports.near(), 1.0 / ports.middle.norm());
        let (mut scratch, mut a) = (Scratch::new(ports), Rows::zeros(p, p));
        let mut value = |&(t, lambda): &(f64, Complex<f64>)| {
            self.matrix(t, lambda, &mut scratch, &mut a);
            a.negate();
            eigenvalue::factor(&mut a, lambda, &mut scratch.elimination, p);
            scratch.elimination.pivots.iter().map(|pivot| pivot * scale).product()
        };
        at.iter().map(&mut value).collect()
    }

    /// A at a place of the path.
    fn matrix(&self, t: f64, lambda: Complex<f64>, scratch: &mut Scratch, out: &mut Rows) {
        coupling::at(&self.modes.own, &self.modes.ports.path, lambda, self.gains(t), scratch, out);
    }

    fn gains(&self, t: f64) -> Gains<'_> {
        Gains { from: &self.from, to: Some((t, &self.to)) }
    }

    /// The eigenvalue next to a guess, rad/s, at a place t of the path, 0 at its beginning and 1 at its end; `None` where no
    /// eigenvalue is found in a few rounds.
    ///
    /// The eigenvalue mu of `A(lambda)` next to lambda is to be lambda, which hardly depends on where A is evaluated: so it takes the place
    /// of lambda until both agree, in the end by Newton's method. With the left vector y of A the rate is `(y^H (dA / dt) x / y^H x) / (1 - d mu / d lambda)`.
    #[must_use]
    pub fn next_to(&self, t: f64, guess: Complex<f64>) -> Option<OnFrictionPath> {
        let ports = &self.modes.ports;
        let p = ports.near();
        let (mut scratch, mut a, mut x) = (Scratch::new(ports), Rows::zeros(p, p), vec![Complex::new(1.0, 0.0); p]);
        let (mut at, mut miss) = (guess, Complex::default());
        for round in 0..MOST_ROUNDS {
            self.matrix(t, at, &mut scratch, &mut a);
            let steps = if round == 0 { STEPS_FROM_ANY } else { STEPS };
            miss = eigenvalue::next_to(&mut a, at, &mut x, steps, &mut scratch.elimination) - at;
            if miss.norm() <= CONVERGED * at.norm() {
                break;
            }
            at += miss;
        }
        if miss.is_nan() || miss.norm() > CONVERGED * at.norm() {
            return None;
        }
        let y = eigenvalue::left(&a, &x, &scratch.elimination);
        let along: Complex<f64> = y.iter().zip(&x).map(|(y, x)| y.conj() * x).sum();
        let seen = Seen::new(&self.modes.own, &scratch, [&y, &x]);
        let slope = along - seen.by_lambda(&ports.path, at, self.gains(t));
        let change = |port: usize| {
            let [(mu, slope), (to_mu, to_slope)] = [&self.from, &self.to].map(|gains| Gains::of(gains).at(port, at));
            (to_mu - mu, to_slope - slope)
        };
        let (lambda, rate) = (at + miss * along / slope, seen.by_gains(change) / slope);
        let shape = coupling::shape(ports, at, &x, &seen.forces);
        (lambda.is_finite() && rate.is_finite()).then_some(OnFrictionPath { lambda, rate, shape })
    }
}
