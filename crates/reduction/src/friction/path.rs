//! The way from one friction to another: an eigenvalue at a place of it, and how fast it moves there.

use linsys::{ChannelGain, OperatingPoint};
use nalgebra::DVector;
use num_complex::Complex;

use super::FrictionModes;
use super::change::Seen;
use super::coupling::{self, Gains, Scratch};
use super::own::Own;
use super::shapes::Pair;
use crate::eigenvalue;
use crate::nearest::{is_apart, nearest, nearest_of};
use crate::rows::Rows;
use cea::certified::lanes::cast;

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
    /// A function of lambda, rad/s, and of the place t, 0 at the beginning and 1 at the end, that has the eigenvalues as zeros and no poles
    /// near the band, at places and numbers: the determinants of what is kept and of what is eliminated, up to a factor that is always the
    /// same, so that no product of many large numbers overflows.
    #[must_use]
    pub fn characteristic(&self, at: &[(f64, Complex<f64>)]) -> Vec<Complex<f64>> {
        let mut a = Own::new(&self.modes.ports, &self.modes.own, self.gains(0.0));
        let value = |&(t, lambda): &(f64, Complex<f64>)| {
            a.gains = self.gains(t);
            a.determinant(lambda)
        };
        at.iter().map(value).collect()
    }

    /// For each of some numbers, rad/s, the `count` eigenvalues at a place of the path that are nearest to it, each of them once, with shapes
    /// over the coordinates of the reduced system, up to a factor; `None` where they are not told apart, or where others may be nearer that
    /// are not near the band.
    ///
    /// Guesses are the eigenvalues of A amid the numbers: it hardly depends on lambda.
    #[must_use]
    pub fn nearest(&self, t: f64, to: &[Complex<f64>], count: usize) -> Option<Vec<Pair>> {
        let FrictionModes { ports, own, .. } = self.modes;
        let mut a = Own::new(ports, own, self.gains(t));
        let middle = to.iter().sum::<Complex<f64>>() / to.len() as f64;
        let (guesses, mut vectors) = a.eigen(middle).ok()?;
        let (mut found, mut before): (Vec<Pair>, Vec<Complex<f64>>) = (Vec::new(), Vec::new());
        // One more of each: the order of the last ones may be another.
        for at in nearest(to, &guesses, count + 1) {
            let mut vector = vectors.column_mut(at);
            let vector = vector.as_mut_slice();
            let lambda = match a.next_to(guesses[at], vector).filter(|&lambda| is_apart(&before, lambda)) {
                Some(lambda) => lambda,
                None => a.other_than(&before, guesses[at], vector)?,
            };
            before.push(lambda);
            found.push((lambda, ports.shapes.shape(lambda, vector, &a.forces(vector))));
        }
        let found = nearest_of(to, found, |(lambda, _)| *lambda, count)?;
        let is_inside = |number: &Complex<f64>| {
            let within = found.iter().filter(|(lambda, _)| (lambda - number).norm() <= ports.end - number.im);
            within.count() >= count
        };
        to.iter().all(is_inside).then_some(found)
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
