//! The search: from guesses of all eigenvalues to error bounds that tell which modes grow, certified up to rounding.

use num_complex::Complex;

use super::enclosure::{Approximations, Enclosure, LARGEST_TOTAL_SHARE, Wanted, enclosure};
use super::response::{Point, characteristic};
use super::{Anchors, Gain, Growing, LeftOpen, Resolvent};
use crate::{Workspace, by_frequency};

/// Most rounds of corrections; chosen: what needs more is left to a spectrum.
const MOST_ROUNDS: usize = 24;
/// Largest share of a guess that is not corrected, as a fraction of the mean share that all may have; chosen: with less, more guesses are evaluated again; with
/// more, it takes more rounds until the shares of all are small enough together.
const CORRECTED_SHARE: f64 = 0.2;
/// Largest relative correction of a wanted mode that has converged; chosen: the next correction of the secant method would be rounding.
const CONVERGED_CORRECTION: f64 = 1e-9;
/// Largest distance from the axis, in the resolvent's unit, of an eigenvalue whose side rounding errors leave open; chosen: such a gain is left to a spectrum,
/// which brings a bound.
pub(super) const LEAST_AXIS_DISTANCE: f64 = 1e-6;

/// The search at one gain.
struct Search {
    wanted: Wanted,
    gain: Gain,
    excluded_frequencies: Vec<f64>,
    approximations: Approximations,
    /// The characteristic polynomial at each guess, and the product of the differences from all other guesses.
    values: Vec<Complex<f64>>,
    others: Vec<Complex<f64>>,
    corrections: Vec<Complex<f64>>,
    /// Guesses of internal states with Im >= 0, each with the size of its correction times the number of guesses it stands for.
    internal: Vec<(Complex<f64>, f64)>,
    stage: SearchStage,
}

enum SearchStage {
    /// The polynomial is to be evaluated at the guesses of these modes.
    Enclose(Vec<usize>),
    /// Enclosures of all eigenvalues; the wanted ones are refined within their discs.
    Refine(Enclosure, Vec<Secant>),
    GivenUp,
}

/// The secant method for one wanted mode: the last point with the function there, and the next point. Apart from the corrector of paths:
/// derivatives of the determinant would cost as much as a value, and values of all modes are computed side by side.
struct Secant {
    mode: usize,
    before: (Complex<f64>, Complex<f64>),
    here: Complex<f64>,
    is_converged: bool,
}

/// The modes with each of the gains: the wanted modes to rounding accuracy, the others with error bounds that exclude the
/// frequencies, rad/s, given with the gain.
pub(super) fn search(
    resolvent: &Resolvent,
    anchors: &Anchors,
    wanted: Wanted,
    gains: &[(Gain, &[f64])],
    work: &mut Workspace,
) -> Vec<Result<Growing, LeftOpen>> {
    let start = |(gain, excluded_frequencies): &(Gain, &[f64])| {
        let gain = gain.in_units(resolvent.unit);
        let excluded_frequencies = excluded_frequencies.iter().map(|im| im / resolvent.unit).collect();
        let guess = anchors.guess(&gain).ok_or(LeftOpen::NoAnchor)?;
        Ok(Search::new(wanted, gain, excluded_frequencies, guess))
    };
    let mut searches: Vec<Result<Search, LeftOpen>> = gains.iter().map(start).collect();
    let (mut points, mut values) = (Vec::new(), Vec::new());
    for round in 0..MOST_ROUNDS {
        points.clear();
        for search in searches.iter().flatten() {
            search.request_points(round == 0, resolvent.ports, &mut points);
        }
        // A first round without points happens where feedback moves no mode; it still encloses.
        if points.is_empty() && round > 0 {
            break;
        }
        characteristic(resolvent, &points, work, &mut values);
        let mut values = values.iter().copied();
        for search in searches.iter_mut().flatten() {
            search.receive_values(round == 0, resolvent.ports, &mut values);
        }
    }
    searches.into_iter().map(|search| search?.found(resolvent)).collect()
}

impl Search {
    fn new(wanted: Wanted, gain: Gain, excluded_frequencies: Vec<f64>, approximations: Approximations) -> Self {
        let n = approximations.sigmas.len();
        let zeros = || vec![Complex::default(); n];
        let stage = SearchStage::Enclose((0..n).collect());
        let internal = Vec::new();
        Self {
            wanted,
            gain,
            excluded_frequencies,
            values: zeros(),
            others: zeros(),
            corrections: zeros(),
            internal,
            approximations,
            stage,
        }
    }

    /// Appends the points at which this search needs the polynomial.
    fn request_points(&self, is_first: bool, ports: usize, points: &mut Vec<Point>) {
        match &self.stage {
            SearchStage::Enclose(modes) => {
                points.extend(modes.iter().map(|&i| self.gain.at(self.approximations.sigmas[i])))
            }
            SearchStage::Refine(_, secants) => {
                let open = secants.iter().filter(|secant| !secant.is_converged);
                points.extend(open.map(|secant| self.gain.at(secant.here)));
            }
            SearchStage::GivenUp => {}
        }
        if let (true, Some(internal)) = (is_first, self.approximations.internal) {
            points.extend(internal.guesses(ports).map(|(z, _)| self.gain.at(z)));
        }
    }

    /// Takes the values at the points that [`Search::request_points`] appended.
    fn receive_values(&mut self, is_first: bool, ports: usize, values: &mut impl Iterator<Item = Complex<f64>>) {
        match &mut self.stage {
            SearchStage::Enclose(modes) => {
                let modes = std::mem::take(modes);
                for &i in &modes {
                    self.values[i] = values.next().unwrap_or_default();
                    self.others[i] = self.approximations.others(i, self.approximations.sigmas[i]);
                }
                if let (true, Some(internal)) = (is_first, self.approximations.internal) {
                    for (z, stands_for) in internal.guesses(ports) {
                        let value = values.next().unwrap_or_default();
                        let correction = self.approximations.internal_correction(z, value, &self.gain, ports);
                        self.internal.push((z, stands_for * correction.norm()));
                    }
                }
                self.enclose(ports);
            }
            SearchStage::Refine(_, secants) => {
                for secant in secants.iter_mut().filter(|secant| !secant.is_converged) {
                    let z = secant.here;
                    let factor = self.approximations.internal_factor(z, &self.gain, ports);
                    let value = values.next().unwrap_or_default() * factor / self.approximations.others(secant.mode, z);
                    secant.step(value);
                }
            }
            SearchStage::GivenUp => {}
        }
    }

    /// Goes on to refinement where the eigenvalues are enclosed; otherwise corrects the guesses with large shares.
    fn enclose(&mut self, ports: usize) {
        let sigmas = &self.approximations.sigmas;
        for (i, correction) in self.corrections.iter_mut().enumerate() {
            let factor = self.approximations.internal_factor(sigmas[i], &self.gain, ports);
            *correction = self.values[i] / self.others[i] * factor;
        }
        let found = enclosure(self.wanted, sigmas, &self.corrections, &self.internal, &self.excluded_frequencies);
        if found.total <= LARGEST_TOTAL_SHARE {
            let first = |(i, sigma): (usize, &Complex<f64>)| {
                self.wanted.is_found(*sigma).then(|| Secant::new(i, *sigma, self.corrections[i]))
            };
            let secants = sigmas.iter().enumerate().filter_map(first).collect();
            self.stage = SearchStage::Refine(found, secants);
            return;
        }
        let small = CORRECTED_SHARE * LARGEST_TOTAL_SHARE / sigmas.len() as f64;
        let modes: Vec<usize> = (0..sigmas.len()).filter(|&i| found.shares[i] > small).collect();
        if modes.is_empty() || found.total.is_nan() {
            self.stage = SearchStage::GivenUp;
            return;
        }
        for &i in &modes {
            self.correct(i);
        }
        self.stage = SearchStage::Enclose(modes);
    }

    fn correct(&mut self, i: usize) {
        let before = self.approximations.sigmas[i];
        let after = before - self.corrections[i];
        self.approximations.sigmas[i] = after;
        for (j, z) in self.approximations.sigmas.iter().enumerate() {
            if j != i {
                self.others[j] *= (z - after) * (z - after.conj()) / ((z - before) * (z - before.conj()));
            }
        }
    }

    fn found(mut self, resolvent: &Resolvent) -> Result<Growing, LeftOpen> {
        let (enclosure, secants) = match self.stage {
            SearchStage::Refine(enclosure, secants) => (enclosure, secants),
            SearchStage::Enclose(_) => return Err(LeftOpen::RoundsExhausted { rounds: MOST_ROUNDS }),
            SearchStage::GivenUp => return Err(LeftOpen::NotSeparated),
        };
        let (sigmas, mut radii) = (&mut self.approximations.sigmas, enclosure.smallest().collect::<Vec<f64>>());
        for Secant { mode, here, is_converged, .. } in secants {
            if !is_converged || (here - sigmas[mode]).norm() > enclosure.radii[mode] {
                return Err(LeftOpen::NoConvergence);
            }
            sigmas[mode] = here;
            radii[mode] = 0.0;
        }
        if sigmas.iter().chain(&resolvent.uncontrollable).any(|sigma| sigma.re.abs() <= LEAST_AXIS_DISTANCE) {
            return Err(LeftOpen::NearAxis);
        }
        let uncontrollable = resolvent.uncontrollable.iter().map(|sigma| (sigma, 0.0));
        let all = sigmas.iter().zip(radii).chain(uncontrollable);
        let mut modes: Vec<(Complex<f64>, f64)> =
            all.map(|(sigma, radius)| (sigma * resolvent.unit, radius * resolvent.unit)).collect();
        modes.sort_by(|(a, _), (b, _)| by_frequency(a, b));
        let (modes, radii) = modes.into_iter().unzip();
        Ok(Growing { modes, radii })
    }
}

impl Secant {
    fn new(mode: usize, at: Complex<f64>, correction: Complex<f64>) -> Self {
        Self { mode, before: (at, correction), here: at - correction, is_converged: false }
    }

    fn step(&mut self, value: Complex<f64>) {
        let (at, before) = self.before;
        let slope = (value - before) / (self.here - at);
        let step = value / slope;
        self.before = (self.here, value);
        if step.is_finite() {
            self.here -= step;
            self.is_converged = step.norm() <= CONVERGED_CORRECTION * self.here.norm();
        }
    }
}
