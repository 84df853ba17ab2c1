//! The way from one friction to another: an eigenvalue at a place of it, and how fast it moves there.

use linsys::{ChannelGain, OperatingPoint};
use nalgebra::DVector;
use num_complex::Complex;

use super::FrictionModes;
use super::coupling::{self, Coordinates, Gains, Scratch};
use super::eigenvalue;
use super::rows::Rows;

/// Change of the place, and of lambda relative to it, over which A is differentiated; chosen: rates then have four digits.
const STEP: f64 = 1e-4;
/// Most rounds, and the relative size of the last correction; chosen: paths ask for 1e-5.
const MOST_ROUNDS: usize = 6;
const CONVERGED: f64 = 1e-7;
/// Steps of inverse iteration from a vector that is not known, and from one that is nearly right; chosen.
const STEPS_FROM_ANY: usize = 4;
const STEPS: usize = 2;

/// The straight line between the systems of two operating points that differ in friction alone.
#[derive(Debug)]
pub struct FrictionPath<'a> {
    modes: &'a FrictionModes,
    own: Coordinates,
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
        (self.is_of(from) && self.is_of(to)).then(|| FrictionPath {
            modes: self,
            own: Coordinates::of_structure(&self.ports),
            from: gains(from),
            to: gains(to),
        })
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
        let gains = Gains { from: &self.from, to: Some((t, &self.to)) };
        coupling::at(&self.own, &self.modes.ports.fine, lambda, gains, scratch, out);
    }

    /// The eigenvalue next to a guess, rad/s, at a place t of the path, 0 at its beginning and 1 at its end; `None` where it is not finite.
    ///
    /// The eigenvalue of `A(lambda)` next to lambda is to be lambda, which the secant method sees to. The rate is
    /// `y^H (dA / dt) x / y^H (1 - dA / d lambda) x` with the left vector y of A.
    #[must_use]
    pub fn next_to(&self, t: f64, guess: Complex<f64>) -> Option<OnFrictionPath> {
        let ports = &self.modes.ports;
        let p = ports.near();
        let (mut scratch, mut a, mut here) = (Scratch::new(ports), Rows::zeros(p, p), Rows::zeros(p, p));
        let mut x = vec![Complex::new(1.0, 0.0); p];
        let (mut lambda, mut before, mut steps) = (guess, None, STEPS_FROM_ANY);
        let mut at = guess;
        for _ in 0..MOST_ROUNDS {
            at = lambda;
            self.matrix(t, at, &mut scratch, &mut a);
            here.clone_from(&a);
            lambda = eigenvalue::next_to(&mut a, at, &mut x, steps, &mut scratch.elimination);
            let miss = lambda - at;
            if miss.norm() <= CONVERGED * lambda.norm() || !miss.is_finite() {
                break;
            }
            lambda = eigenvalue::secant(before.replace((at, miss)), (at, miss));
            steps = STEPS;
        }
        let y = eigenvalue::left(&a, &x, &scratch.elimination);
        let shape = coupling::shape(ports, &self.own, at, &x, &scratch.solved);
        // y^H (A there - A here) x.
        let change = |there: &Rows| -> Complex<f64> {
            let row = |i: usize| {
                x.iter().enumerate().map(|(j, x)| (there.at(i, j) - here.at(i, j)) * x).sum::<Complex<f64>>()
            };
            y.iter().enumerate().map(|(i, y)| y.conj() * row(i)).sum()
        };
        let later = if t < 0.5 { STEP } else { -STEP };
        self.matrix(t + later, at, &mut scratch, &mut a);
        let over_t = change(&a) / later;
        let beside = at * Complex::new(0.0, STEP);
        self.matrix(t, at + beside, &mut scratch, &mut a);
        let over_lambda = change(&a) / beside;
        let along: Complex<f64> = y.iter().zip(&x).map(|(y, x)| y.conj() * x).sum();
        let rate = over_t / (along - over_lambda);
        (lambda.is_finite() && rate.is_finite()).then_some(OnFrictionPath { lambda, rate, shape })
    }
}
