//! The way from one friction to another: an eigenvalue at a place of it, and how fast it moves there.

use linsys::{ChannelGain, OperatingPoint};
use nalgebra::DVector;
use num_complex::Complex;

use super::FrictionModes;
use super::change::Seen;
use super::coupling::{self, Gains, Scratch};
use super::eigenvalue;
use super::real::cast;
use super::rows::Rows;

/// Most rounds, and the relative size of what the last one misses; chosen: A changes with lambda by some thousandths over the band, so that
/// what is left of an eigenvalue after the step of Newton's method is below 1e-8 of it, and paths ask for 1e-5.
const MOST_ROUNDS: usize = 6;
const CONVERGED: f64 = 1e-3;
/// Where A is factored, relative to the number: at an eigenvalue itself single precision may leave nothing of a pivot; chosen.
const BESIDE: f64 = 1e-6;
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
        let FrictionModes { ports, own, .. } = self.modes;
        let (p, scale) = (ports.near(), 1.0 / ports.middle.norm());
        let (mut scratch, mut a) = (Scratch::new(ports), Rows::zeros(p, p));
        let mut value = |&(t, lambda): &(f64, Complex<f64>)| {
            coupling::at(own, &ports.fine, lambda, self.gains(t), &mut scratch, &mut a);
            a.negate();
            eigenvalue::factor(&mut a, lambda, &mut scratch.elimination, p);
            scratch.elimination.pivots.iter().map(|pivot| pivot * scale).product()
        };
        at.iter().map(&mut value).collect()
    }

    fn gains(&self, t: f64) -> Gains<'_> {
        Gains { from: &self.from, to: Some((t, &self.to)) }
    }

    /// The eigenvalue next to a guess, rad/s, at a place t of the path, 0 at its beginning and 1 at its end; `None` where no
    /// eigenvalue is found in a few rounds.
    ///
    /// The eigenvalue mu of `A(lambda)` next to lambda is to be lambda, which hardly depends on where A is evaluated: so it takes the place
    /// of lambda until both agree, in the end by Newton's method, all in single precision but what is subtracted from Lambda. With the left vector y of A the rate is `(y^H (dA / dt) x / y^H x) / (1 - d mu / d lambda)`.
    #[must_use]
    pub fn next_to(&self, t: f64, guess: Complex<f64>) -> Option<OnFrictionPath> {
        let FrictionModes { ports, added, .. } = self.modes;
        let p = ports.near();
        let (mut scratch, mut a) = (Scratch::<f32>::new(ports), Rows::zeros(p, p));
        let mut x = vec![Complex::new(1.0, 0.0); p];
        let (mut at, mut miss) = (guess, Complex::default());
        for round in 0..MOST_ROUNDS {
            coupling::at(added, &ports.path, at, self.gains(t), &mut scratch, &mut a);
            a.negate();
            let beside = at * (1.0 + BESIDE);
            eigenvalue::factor_with(&mut a, |i| cast(beside - ports.lambdas[i]), &mut scratch.elimination, p);
            let steps = if round == 0 { STEPS_FROM_ANY } else { STEPS };
            miss = beside + cast::<f32, f64>(eigenvalue::apart(&a, &mut x, steps, &scratch.elimination)) - at;
            if miss.norm() <= CONVERGED * at.norm() {
                break;
            }
            at += miss;
        }
        if miss.is_nan() || miss.norm() > CONVERGED * at.norm() {
            return None;
        }
        let y = eigenvalue::left(&a, &x, &scratch.elimination);
        let along: Complex<f32> = y.iter().zip(&x).map(|(y, x)| y.conj() * x).sum();
        let seen = Seen::new(added, &scratch, [&y, &x]);
        let by_lambda = seen.by_lambda(&ports.path, at, self.gains(t));
        let ends = [&self.from, &self.to].map(|gains| Gains::of(gains));
        let change = self.gains(t).each(|port| {
            let [(mu, slope), (to_mu, to_slope)] = ends.map(|gains| gains.at(port, at));
            ((to_mu - mu) as f32, cast(to_slope - slope))
        });
        let slope: Complex<f64> = cast(along - by_lambda);
        let rate = cast::<f32, f64>(seen.by_gains(|port| change[port])) / slope;
        let lambda = at + miss * cast::<f32, f64>(along) / slope;
        let shape = ports.path_shapes.shape(at, &x, &seen.forces);
        (lambda.is_finite() && rate.is_finite()).then_some(OnFrictionPath { lambda, rate, shape })
    }
}
