//! Anchors: gains whose eigenvalues are known, from which the eigenvalues of other gains are guessed.

use num_complex::Complex;

use super::enclosure::{Approximations, InternalCluster};
use super::response::characteristic;
use super::{Gain, MIDDLE_FREQUENCY, Resolvent};
use crate::{Spectrum, Workspace};

/// Step of gain of the differences that derivatives are computed by, as a fraction of the standard deviation of the anchors' gains; chosen.
const GAIN_DIFFERENCE: f64 = 1e-4;
/// Largest |Im sigma| / |sigma| at which an eigenvalue counts as real; chosen, above the spread of a cluster by rounding.
const NEARLY_REAL: f64 = 1e-4;
/// Least and largest ratio of [`reach`] by which the shift of an anchor's internal eigenvalues is scaled; chosen: with a ratio farther from 1 the shift is
/// scaled by the nearer of these.
const REACH_RATIO: (f64, f64) = (0.25, 4.0);

/// Gains of one structure whose eigenvalues are known.
#[derive(Debug, Clone, PartialEq)]
pub struct Anchors {
    anchors: Vec<Anchor>,
    /// Standard deviations of mu and of the slope over the anchors; 1 where they are 0.
    spread: [f64; 2],
}

/// Anchor: a gain with its eigenvalues, in the units of the resolvent.
#[derive(Debug, Clone, PartialEq)]
struct Anchor {
    gain: Gain,
    /// The slope at the middle frequency, by which gains are compared.
    slope: Complex<f64>,
    sigmas: Vec<Complex<f64>>,
    /// Derivatives of each eigenvalue by mu and by the slope.
    rates: Vec<[Complex<f64>; 2]>,
    /// Eigenvalues of internal states: the distance of their mean from -decay, and their spread; both over decay.
    internal: [f64; 2],
}

impl Anchor {
    /// The anchor of a gain and its spectrum; `None` where some modes do not oscillate.
    fn new(resolvent: &Resolvent, gain: Gain, spectrum: &Spectrum) -> Option<Self> {
        let (n, m) = (resolvent.poles.len(), resolvent.ports);
        let is_real = |l: &&Complex<f64>| l.im.abs() <= NEARLY_REAL * l.norm();
        let mut sigmas: Vec<Complex<f64>> =
            spectrum.oscillatory().filter(|l| !is_real(&l)).map(|l| l / resolvent.unit).collect();
        for uncontrollable in &resolvent.uncontrollable {
            let distances = sigmas.iter().map(|sigma| (sigma - uncontrollable).norm_sqr());
            let (nearest, _) = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
            sigmas.remove(nearest);
        }
        let real: Vec<f64> = spectrum.eigenvalues.iter().filter(is_real).map(|l| l.re / resolvent.unit).collect();
        // Without lag the internal states act on nothing and are no zeros of the polynomial.
        let states = if gain.lag == 0.0 { 0 } else { m };
        if sigmas.len() != n || states > 0 && real.len() != states {
            return None;
        }
        let count = real.len().max(1) as f64;
        let middle = real.iter().sum::<f64>() / count;
        let variance = real.iter().map(|re| (re - middle).powi(2)).sum::<f64>() / count;
        let internal = match states {
            0 => [0.0; 2],
            _ => [middle + gain.decay, (variance * count).sqrt()].map(|part| part / gain.decay),
        };
        let slope = gain.complex_slope(MIDDLE_FREQUENCY);
        Some(Self { gain, slope, sigmas, rates: vec![[Complex::default(); 2]; n], internal })
    }

    /// Squared distance of a gain from this anchor, in standard deviations.
    fn distance(&self, mu: f64, slope: Complex<f64>, spread: [f64; 2]) -> f64 {
        ((mu - self.gain.mu) / spread[0]).powi(2) + (slope - self.slope).norm_sqr() / spread[1].powi(2)
    }

    fn guess(&self, gain: &Gain) -> Approximations {
        let mu = gain.mu - self.gain.mu;
        let one = |(&sigma, [by_mu, by_slope]): (&Complex<f64>, &[Complex<f64>; 2])| {
            sigma + by_mu * mu + by_slope * (gain.complex_slope(sigma) - self.gain.complex_slope(sigma))
        };
        let (least, most) = REACH_RATIO;
        let [shift, size] =
            self.internal.map(|part| part * (reach(gain) / reach(&self.gain)).clamp(least, most) * gain.decay);
        let internal = (gain.lag != 0.0)
            .then(|| InternalCluster { middle: shift - gain.decay, radius: size.max(0.1 * gain.decay) });
        Approximations { sigmas: self.sigmas.iter().zip(&self.rates).map(one).collect(), internal }
    }
}

impl Anchors {
    pub(super) fn new(resolvent: &Resolvent, states: &[(Gain, Spectrum)], work: &mut Workspace) -> Self {
        let anchor =
            |(gain, spectrum): &(Gain, Spectrum)| Anchor::new(resolvent, gain.in_units(resolvent.unit), spectrum);
        let anchors: Vec<Anchor> = states.iter().filter_map(anchor).collect();
        let mut anchors = Self { spread: spread(&anchors), anchors };
        anchors.differentiate(resolvent, work);
        anchors
    }

    /// Guesses of all eigenvalues from the nearest anchor; `None` without anchors.
    pub(super) fn guess(&self, gain: &Gain) -> Option<Approximations> {
        let slope = gain.complex_slope(MIDDLE_FREQUENCY);
        let distance = |anchor: &Anchor| anchor.distance(gain.mu, slope, self.spread);
        let nearest = self.anchors.iter().map(|anchor| (distance(anchor), anchor)).min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(_, anchor)| anchor.guess(gain))
    }

    /// Computes the derivatives of the anchors' eigenvalues by mu and by the slope.
    fn differentiate(&mut self, resolvent: &Resolvent, work: &mut Workspace) {
        let steps = self.spread.map(|spread| GAIN_DIFFERENCE * spread);
        let mut values = Vec::new();
        for anchor in &mut self.anchors {
            let Gain { mu, slope, .. } = anchor.gain;
            let gains = [Gain { mu: mu + steps[0], ..anchor.gain }, Gain { slope: slope + steps[1], ..anchor.gain }];
            let points: Vec<_> =
                gains.iter().flat_map(|&gain| anchor.sigmas.iter().map(move |&sigma| gain.at(sigma))).collect();
            characteristic(resolvent, &points, work, &mut values);
            let approximations = anchor.guess(&anchor.gain);
            let n = anchor.sigmas.len();
            for (k, (&sigma, rates)) in anchor.sigmas.iter().zip(&mut anchor.rates).enumerate() {
                let others = approximations.others(k, sigma);
                for (by, rate) in rates.iter_mut().enumerate() {
                    let internal = approximations.internal_factor(sigma, &gains[by], resolvent.ports);
                    *rate = -values[by * n + k] * internal / others / steps[by];
                }
            }
        }
    }
}

/// Estimate, up to a factor, of the shift of internal eigenvalues over their decay rate, for a structure with frequencies
/// about 1.
fn reach(gain: &Gain) -> f64 {
    gain.lag / (1.0 + gain.decay * gain.decay)
}

/// Standard deviations of mu and of the slope over the anchors.
fn spread(anchors: &[Anchor]) -> [f64; 2] {
    let count = anchors.len().max(1) as f64;
    let mu = anchors.iter().map(|anchor| anchor.gain.mu).sum::<f64>() / count;
    let slope = anchors.iter().map(|anchor| anchor.slope).sum::<Complex<f64>>() / count;
    let mus: f64 = anchors.iter().map(|anchor| (anchor.gain.mu - mu).powi(2)).sum();
    let slopes: f64 = anchors.iter().map(|anchor| (anchor.slope - slope).norm_sqr()).sum();
    [mus, slopes].map(|sum| (sum / count).sqrt()).map(|spread| if spread > 0.0 { spread } else { 1.0 })
}
