//! The search itself: from guesses of all modes to a proof of which of them grow.

use num_complex::Complex;

use super::enclosure::{Cast, Enclosure, MOST, Wanted, enclosure};
use super::response::{Point, characteristic};
use super::{Gain, Growing, Pilots, Resolvent};
use crate::{Workspace, by_frequency};

/// Rounds of corrections before a search is given up.
const MOST_ROUNDS: usize = 24;
/// A mode is corrected while its share is larger than this part of an even one.
const SMALL_SHARE: f64 = 0.2;
/// Correction of a growing mode, relatively, after which there is no other.
const SETTLED: f64 = 1e-9;
/// Distance from the axis, in units, that rounding errors leave no doubt about.
const NEAR_AXIS: f64 = 1e-6;

/// One state on its way.
struct Search {
    wanted: Wanted,
    gain: Gain,
    apart_from: Vec<f64>,
    cast: Cast,
    /// The characteristic polynomial at each guess, and the product of its distances from the others.
    values: Vec<Complex<f64>>,
    others: Vec<Complex<f64>>,
    corrections: Vec<Complex<f64>>,
    /// The corrections of internal states: where, and how large with all they stand for.
    bristles: Vec<(Complex<f64>, f64)>,
    stage: Stage,
}

enum Stage {
    /// Guesses of these modes are to be corrected.
    Enclose(Vec<usize>),
    /// All eigenvalues are enclosed; those wanted are found in their discs.
    Settle(Enclosure, Vec<Secant>),
    GivenUp,
}

/// The zero of a function next to two points.
struct Secant {
    mode: usize,
    before: (Complex<f64>, Complex<f64>),
    here: Complex<f64>,
    is_settled: bool,
}

/// The modes with each of the gains, those wanted found and the others apart from some frequencies, rad/s.
pub(super) fn search(
    resolvent: &Resolvent,
    pilots: &Pilots,
    wanted: Wanted,
    gains: &[(Gain, &[f64])],
    work: &mut Workspace,
) -> Vec<Option<Growing>> {
    let start = |(gain, apart_from): &(Gain, &[f64])| {
        let gain = gain.in_units(resolvent.unit);
        let apart_from = apart_from.iter().map(|im| im / resolvent.unit).collect();
        Some(Search::new(wanted, gain, apart_from, pilots.guess(&gain)?))
    };
    let mut searches: Vec<Option<Search>> = gains.iter().map(start).collect();
    let (mut points, mut values) = (Vec::new(), Vec::new());
    for round in 0..MOST_ROUNDS {
        points.clear();
        for search in searches.iter().flatten() {
            search.ask(round == 0, resolvent.places, &mut points);
        }
        // Without modes that feedback moves there is nothing to ask.
        if points.is_empty() && round > 0 {
            break;
        }
        characteristic(resolvent, &points, &mut work.scratch, &mut values);
        work.counters.secular_values += values.len() as u64;
        let mut values = values.iter().copied();
        for search in searches.iter_mut().flatten() {
            search.hear(round == 0, resolvent.places, &mut values);
        }
    }
    searches.into_iter().map(|search| search?.found(resolvent)).collect()
}

impl Search {
    fn new(wanted: Wanted, gain: Gain, apart_from: Vec<f64>, cast: Cast) -> Self {
        let n = cast.sigmas.len();
        let zeros = || vec![Complex::default(); n];
        let stage = Stage::Enclose((0..n).collect());
        let bristles = Vec::new();
        Self { wanted, gain, apart_from, values: zeros(), others: zeros(), corrections: zeros(), bristles, cast, stage }
    }

    /// Where the polynomial is to be evaluated.
    fn ask(&self, is_first: bool, places: usize, points: &mut Vec<Point>) {
        match &self.stage {
            Stage::Enclose(modes) => points.extend(modes.iter().map(|&i| self.gain.at(self.cast.sigmas[i]))),
            Stage::Settle(_, secants) => {
                let open = secants.iter().filter(|secant| !secant.is_settled);
                points.extend(open.map(|secant| self.gain.at(secant.here)));
            }
            Stage::GivenUp => {}
        }
        if let (true, Some(bristles)) = (is_first, self.cast.bristles) {
            points.extend(bristles.guesses(places).map(|(z, _)| self.gain.at(z)));
        }
    }

    fn hear(&mut self, is_first: bool, places: usize, values: &mut impl Iterator<Item = Complex<f64>>) {
        match &mut self.stage {
            Stage::Enclose(modes) => {
                let modes = std::mem::take(modes);
                for &i in &modes {
                    self.values[i] = values.next().unwrap_or_default();
                    self.others[i] = self.cast.others(i, self.cast.sigmas[i]);
                }
                if let (true, Some(bristles)) = (is_first, self.cast.bristles) {
                    for (z, stands_for) in bristles.guesses(places) {
                        let value = values.next().unwrap_or_default();
                        let correction = self.cast.bristle_correction(z, value, &self.gain, places);
                        self.bristles.push((z, stands_for * correction.norm()));
                    }
                }
                self.enclose(places);
            }
            Stage::Settle(_, secants) => {
                for secant in secants.iter_mut().filter(|secant| !secant.is_settled) {
                    let z = secant.here;
                    let factor = self.cast.bristle_factor(z, &self.gain, places);
                    let value = values.next().unwrap_or_default() * factor / self.cast.others(secant.mode, z);
                    secant.go(value);
                }
            }
            Stage::GivenUp => {}
        }
    }

    /// Encloses the eigenvalues, or corrects those guesses that stand in the way.
    fn enclose(&mut self, places: usize) {
        let sigmas = &self.cast.sigmas;
        for (i, correction) in self.corrections.iter_mut().enumerate() {
            let factor = self.cast.bristle_factor(sigmas[i], &self.gain, places);
            *correction = self.values[i] / self.others[i] * factor;
        }
        let found = enclosure(self.wanted, sigmas, &self.corrections, &self.bristles, &self.apart_from);
        if found.total <= MOST {
            let first = |(i, sigma): (usize, &Complex<f64>)| {
                self.wanted.is_found(*sigma).then(|| Secant::new(i, *sigma, self.corrections[i]))
            };
            let secants = sigmas.iter().enumerate().filter_map(first).collect();
            self.stage = Stage::Settle(found, secants);
            return;
        }
        let small = SMALL_SHARE * MOST / sigmas.len() as f64;
        let modes: Vec<usize> = (0..sigmas.len()).filter(|&i| found.shares[i] > small).collect();
        if modes.is_empty() || found.total.is_nan() {
            self.stage = Stage::GivenUp;
            return;
        }
        for &i in &modes {
            self.correct(i);
        }
        self.stage = Stage::Enclose(modes);
    }

    fn correct(&mut self, i: usize) {
        let before = self.cast.sigmas[i];
        let after = before - self.corrections[i];
        self.cast.sigmas[i] = after;
        for (j, z) in self.cast.sigmas.iter().enumerate() {
            if j != i {
                self.others[j] *= (z - after) * (z - after.conj()) / ((z - before) * (z - before.conj()));
            }
        }
    }

    fn found(mut self, resolvent: &Resolvent) -> Option<Growing> {
        let Stage::Settle(enclosure, secants) = self.stage else { return None };
        let (sigmas, mut radii) = (&mut self.cast.sigmas, enclosure.smallest().collect::<Vec<f64>>());
        for Secant { mode, here, is_settled, .. } in secants {
            if !is_settled || (here - sigmas[mode]).norm() > enclosure.radii[mode] {
                return None;
            }
            sigmas[mode] = here;
            radii[mode] = 0.0;
        }
        if sigmas.iter().chain(&resolvent.still).any(|sigma| sigma.re.abs() <= NEAR_AXIS) {
            return None;
        }
        let still = resolvent.still.iter().map(|sigma| (sigma, 0.0));
        let all = sigmas.iter().zip(radii).chain(still);
        let mut modes: Vec<(Complex<f64>, f64)> =
            all.map(|(sigma, radius)| (sigma * resolvent.unit, radius * resolvent.unit)).collect();
        modes.sort_by(|(a, _), (b, _)| by_frequency(a, b));
        let (modes, radii) = modes.into_iter().unzip();
        Some(Growing { modes, radii })
    }
}

impl Secant {
    fn new(mode: usize, at: Complex<f64>, correction: Complex<f64>) -> Self {
        Self { mode, before: (at, correction), here: at - correction, is_settled: false }
    }

    fn go(&mut self, value: Complex<f64>) {
        let (at, before) = self.before;
        let slope = (value - before) / (self.here - at);
        let step = value / slope;
        self.before = (self.here, value);
        if step.is_finite() {
            self.here -= step;
            self.is_settled = step.norm() <= SETTLED * self.here.norm();
        }
    }
}
