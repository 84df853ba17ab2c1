//! States whose eigenvalues are known, from which those of others are guessed.

use num_complex::Complex;

use super::enclosure::{Bristles, Cast};
use super::response::characteristic;
use super::{Gain, MIDDLE, Resolvent};
use crate::{Spectrum, Workspace};

/// Difference of gains, in spreads, from which derivatives are taken.
const DIFFERENCE: f64 = 1e-4;
/// |Im| / |sigma| of a real eigenvalue in a cluster that rounding has spread.
const NEARLY_REAL: f64 = 1e-4;
/// Ratios of [`reach`] between which that of a pilot says something about another's.
const COMPARABLE: (f64, f64) = (0.25, 4.0);

/// States of one structure whose eigenvalues are known.
#[derive(Debug, Clone, PartialEq)]
pub struct Pilots {
    pilots: Vec<Pilot>,
    /// Mean deviations of position and slope; 1 where there are none.
    spread: [f64; 2],
}

/// One state with its eigenvalues, in units.
#[derive(Debug, Clone, PartialEq)]
struct Pilot {
    gain: Gain,
    /// Slope at the middle frequency, to compare states by.
    slope: Complex<f64>,
    sigmas: Vec<Complex<f64>>,
    /// Their derivatives by position and slope.
    rates: Vec<[Complex<f64>; 2]>,
    /// How far the middle of the eigenvalues of internal states is moved and how far they spread, in decay rates.
    bristles: [f64; 2],
}

impl Pilot {
    /// `None` where some modes do not oscillate.
    fn new(resolvent: &Resolvent, gain: Gain, spectrum: &Spectrum) -> Option<Self> {
        let (n, m) = (resolvent.poles.len(), resolvent.places);
        let is_real = |l: &&Complex<f64>| l.im.abs() <= NEARLY_REAL * l.norm();
        let mut sigmas: Vec<Complex<f64>> =
            spectrum.oscillatory().filter(|l| !is_real(&l)).map(|l| l / resolvent.unit).collect();
        for still in &resolvent.still {
            let distances = sigmas.iter().map(|sigma| (sigma - still).norm_sqr());
            let (nearest, _) = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
            sigmas.remove(nearest);
        }
        let real: Vec<f64> = spectrum.eigenvalues.iter().filter(is_real).map(|l| l.re / resolvent.unit).collect();
        // Internal states that drive nothing have no part in the polynomial.
        let states = if gain.lag == 0.0 { 0 } else { m };
        if sigmas.len() != n || states > 0 && real.len() != states {
            return None;
        }
        let count = real.len().max(1) as f64;
        let middle = real.iter().sum::<f64>() / count;
        let variance = real.iter().map(|re| (re - middle).powi(2)).sum::<f64>() / count;
        let bristles = match states {
            0 => [0.0; 2],
            _ => [middle + gain.decay, (variance * count).sqrt()].map(|part| part / gain.decay),
        };
        let slope = gain.slope(MIDDLE);
        Some(Self { gain, slope, sigmas, rates: vec![[Complex::default(); 2]; n], bristles })
    }

    /// How far a gain is, in spreads, squared.
    fn distance(&self, position: f64, slope: Complex<f64>, spread: [f64; 2]) -> f64 {
        ((position - self.gain.position) / spread[0]).powi(2) + (slope - self.slope).norm_sqr() / spread[1].powi(2)
    }

    fn guess(&self, gain: &Gain) -> Cast {
        let position = gain.position - self.gain.position;
        let one = |(&sigma, [by_position, by_slope]): (&Complex<f64>, &[Complex<f64>; 2])| {
            sigma + by_position * position + by_slope * (gain.slope(sigma) - self.gain.slope(sigma))
        };
        let (least, most) = COMPARABLE;
        let [shift, size] =
            self.bristles.map(|part| part * (reach(gain) / reach(&self.gain)).clamp(least, most) * gain.decay);
        let bristles =
            (gain.lag != 0.0).then(|| Bristles { middle: shift - gain.decay, radius: size.max(0.1 * gain.decay) });
        Cast { sigmas: self.sigmas.iter().zip(&self.rates).map(one).collect(), bristles }
    }
}

impl Pilots {
    pub(super) fn new(resolvent: &Resolvent, states: &[(Gain, Spectrum)], work: &mut Workspace) -> Self {
        let pilot =
            |(gain, spectrum): &(Gain, Spectrum)| Pilot::new(resolvent, gain.in_units(resolvent.unit), spectrum);
        let pilots: Vec<Pilot> = states.iter().filter_map(pilot).collect();
        let mut pilots = Self { spread: spread(&pilots), pilots };
        pilots.differentiate(resolvent, work);
        pilots
    }

    /// Guesses of all eigenvalues from the nearest pilot; `None` without any.
    pub(super) fn guess(&self, gain: &Gain) -> Option<Cast> {
        let slope = gain.slope(MIDDLE);
        let distance = |pilot: &Pilot| pilot.distance(gain.position, slope, self.spread);
        let nearest = self.pilots.iter().map(|pilot| (distance(pilot), pilot)).min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(_, pilot)| pilot.guess(gain))
    }

    /// Finds how the eigenvalues of the pilots change with the gains.
    fn differentiate(&mut self, resolvent: &Resolvent, work: &mut Workspace) {
        let steps = self.spread.map(|spread| DIFFERENCE * spread);
        let mut values = Vec::new();
        for pilot in &mut self.pilots {
            let Gain { position, velocity, .. } = pilot.gain;
            let gains = [
                Gain { position: position + steps[0], ..pilot.gain },
                Gain { velocity: velocity + steps[1], ..pilot.gain },
            ];
            let points: Vec<_> =
                gains.iter().flat_map(|&gain| pilot.sigmas.iter().map(move |&sigma| gain.at(sigma))).collect();
            characteristic(resolvent, &points, &mut work.scratch, &mut values);
            work.counters.secular_values += values.len() as u64;
            let cast = pilot.guess(&pilot.gain);
            let n = pilot.sigmas.len();
            for (k, (&sigma, rates)) in pilot.sigmas.iter().zip(&mut pilot.rates).enumerate() {
                let others = cast.others(k, sigma);
                for (by, rate) in rates.iter_mut().enumerate() {
                    let bristles = cast.bristle_factor(sigma, &gains[by], resolvent.places);
                    *rate = -values[by * n + k] * bristles / others / steps[by];
                }
            }
        }
    }
}

/// How far feedback moves the eigenvalues of its internal states, relative to the decay rate: as a structure with
/// frequencies about 1 responds there.
fn reach(gain: &Gain) -> f64 {
    gain.lag / (1.0 + gain.decay * gain.decay)
}

/// Mean deviations of position and slope.
fn spread(pilots: &[Pilot]) -> [f64; 2] {
    let count = pilots.len().max(1) as f64;
    let position = pilots.iter().map(|pilot| pilot.gain.position).sum::<f64>() / count;
    let slope = pilots.iter().map(|pilot| pilot.slope).sum::<Complex<f64>>() / count;
    let positions: f64 = pilots.iter().map(|pilot| (pilot.gain.position - position).powi(2)).sum();
    let slopes: f64 = pilots.iter().map(|pilot| (pilot.slope - slope).norm_sqr()).sum();
    [positions, slopes].map(|sum| (sum / count).sqrt()).map(|spread| if spread > 0.0 { spread } else { 1.0 })
}
