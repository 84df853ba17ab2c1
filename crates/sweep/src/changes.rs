//! Changes of the number of unstable modes over one parameter, found by counting.
//!
//! Spectra at equal steps count unstable modes. An interval between two changes that is as long as a step or longer contains the end of a step, and so
//! shows in the counts: **two changes that are farther apart than a step are both found**, whatever the brake does between, and whichever modes they are
//! of. A step whose ends differ is halved until one change is left in it, or several at one place. Steps whose ends agree are halved too where the distance
//! of an eigenvalue from the threshold has a minimum that, by a parabola, is near zero; that finds nearly all changes that are nearer to each other, but
//! for those that no place shows a sign of.
//!
//! Eigenvalues on the axis count as neither growing nor decaying ([`CountedSpectrum`]), so that nothing starts or stops where all is undamped.

use cea::CountedSpectrum;
use num_complex::Complex;
use rayon::prelude::*;

use super::change::{Along, Band, Change, ChangeOf, Place};
use super::crossing::crossing;
use super::measure::Measure;
use super::parameter::SweptParameter;
use crate::Error;

/// Length of a step, as a fraction of the range, that is not halved any more; chosen: the last bits.
const SHORTEST: f64 = 1e-13;
/// Least error of a change that no smooth function gives, as a fraction of the range; chosen.
const LEAST_ERROR: f64 = 1e-10;
/// Distance from a change at which the rate of a real eigenvalue is taken, as a fraction of the range; chosen.
const NEXT_TO: f64 = 1e-5;
/// Least growth from which its law, a power of the distance from where it begins, is determined, as a multiple of the largest growth that is hidden;
/// chosen: a growth with the cube reaches it at twice the distance up to which it is hidden.
const CLEAR: f64 = 8.0;
/// Largest power of the distance with which growth may begin; chosen: a growth that seems to begin with a larger power is taken to begin with this one.
const STEEPEST: f64 = 4.0;
/// Largest growth at twice a distance at which it is below [`CLEAR`], as a multiple of the largest growth that is hidden, that follows the same law; a
/// larger one is of another law. Chosen: a fourth power makes 128 of 8.
const LEAP: f64 = 200.0;
/// Factor on the distance up to which growth is hidden; chosen: the power that it is computed from is known to some tenths.
const SAFETY: f64 = 3.0;
/// Largest growth at the place next to a divergence, as a multiple of the largest |lambda| of a rigid motion, of a real eigenvalue that was hidden among
/// rigid motions before; a larger growth is a jump. Chosen.
const SLOW: f64 = 100.0;
/// Largest growth at the place next to a change of flutter, as a fraction of the frequency, that is taken as exact; a larger one is known to few digits,
/// and a mode that seems not to grow farther away counts there as one of growth 0. Chosen.
const ROUNDED: f64 = 1e-8;
/// Shortest step, as a fraction of the range, in which a least distance from the threshold is looked for; chosen: shorter ones are listed as unresolved.
const SHORTEST_DIP: f64 = 1e-9;
/// Ratio of the depth that a distance may have between three places to the depth of the parabola through the three; chosen: with less, a dip between them may
/// be passed over; with more, more spectra are taken.
const DIP_MARGIN: f64 = 2.0;
/// Largest number of spectra of one line beside the equal steps, for dips; chosen: steps that are left then are listed as unresolved.
const MOST_DIPS: usize = 4096;
/// Number of halvings between two tries to find a change as a zero; chosen: a try that fails costs spectra, and one too late costs halvings.
const HALVINGS_BETWEEN: usize = 4;
/// Largest distance, as a fraction of the range, of two changes that undo each other and are nothing but rounding; chosen.
const UNDONE: f64 = 1e-10;

/// Largest |lambda|, as a fraction of the largest frequency on the line, of a rigid motion; chosen: where terms of a brake cancel, rounding
/// of the larger ones makes a double zero a pair so far from it.
const RIGID: f64 = 2e-7;

/// A range in which modes are on the axis.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Marginal {
    /// First place at which modes were on the axis.
    pub from: f64,
    /// Last place at which modes were on the axis.
    pub to: f64,
    /// Largest number of modes on the axis at one place of the range, rigid motions too.
    pub modes: usize,
    /// Least number of them at one place of the range: some leave the axis, and others stay.
    pub fewest: usize,
}

impl Marginal {
    /// Number of modes on the axis in words: "2 modes", "1 to 2 modes".
    #[must_use]
    pub fn in_words(&self) -> String {
        match (self.fewest, self.modes) {
            (1, 1) => "1 mode".into(),
            (fewest, modes) if fewest == modes => format!("{modes} modes"),
            (fewest, modes) => format!("{fewest} to {modes} modes"),
        }
    }

    /// The range, given in fractions of the range of a parameter, in values of the parameter.
    pub(super) fn in_values(self, parameter: &SweptParameter) -> Self {
        Self { from: parameter.at(self.from), to: parameter.at(self.to), ..self }
    }
}

/// A range in which modes grow next to the band that is studied, where they do not count.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct GrowingBeside {
    /// First place at which a mode grew there.
    pub from: f64,
    /// Last place at which a mode grew there.
    pub to: f64,
    /// Largest number of modes at one place.
    pub modes: usize,
    /// Least and largest frequency of the modes, Im lambda, rad/s.
    pub omega: [f64; 2],
}

impl GrowingBeside {
    /// The range, given in fractions of the range of a parameter, in values of the parameter.
    pub(super) fn in_values(self, parameter: &SweptParameter) -> Self {
        Self { from: parameter.at(self.from), to: parameter.at(self.to), ..self }
    }

    /// Modes that grow at a place, Im lambda from `from` to below `to`, rad/s; `None` where none does.
    fn at(place: &Place, [from, to]: [f64; 2]) -> Option<Self> {
        let there = || place.counted.flutter.iter().map(|lambda| lambda.im).filter(|omega| (from..to).contains(omega));
        let omega = [there().fold(f64::INFINITY, f64::min), there().fold(0.0, f64::max)];
        let modes = there().count();
        (modes > 0).then_some(Self { from: place.at, to: place.at, modes, omega })
    }

    /// Both ranges, and what is between.
    pub(super) fn with(self, other: Self) -> Self {
        Self {
            from: self.from.min(other.from),
            to: self.to.max(other.to),
            modes: self.modes.max(other.modes),
            omega: [self.omega[0].min(other.omega[0]), self.omega[1].max(other.omega[1])],
        }
    }
}

/// Changes on a line.
#[derive(Debug, Default)]
pub(super) struct Changes {
    /// Changes found, ascending.
    pub found: Vec<Change>,
    /// Steps in which an eigenvalue comes so near the threshold that it is not known whether it crosses, or whose side has no bound.
    pub unresolved: Vec<(f64, f64)>,
    /// Ranges in which modes are on the axis at two neighbouring places or more.
    pub marginal: Vec<Marginal>,
    /// Modes that grow below the band, and above it, as far as they are followed.
    pub beside: [Option<GrowingBeside>; 2],
    /// Eigenvalues at place 0, and at place 1.
    pub ends: [CountedSpectrum; 2],
    /// Number of spectra solved.
    pub spectra: u64,
}

impl Along<'_> {
    /// The changes on the line, by spectra at `steps` equal steps, at the places `beside` these, and between.
    ///
    /// # Errors
    /// Those of the brake and of the solver.
    pub fn changes(&self, steps: usize, beside: &[f64]) -> Result<Changes, Error> {
        let at = |step: usize| step as f64 / steps as f64;
        let mut all: Vec<f64> = (0..=steps).map(at).chain(beside.iter().copied()).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        let mut places = all.into_par_iter().map(|at| self.place(at)).collect::<Result<Vec<_>, Error>>()?;
        let fastest = places.iter().flat_map(Place::sides).map(|(lambda, _)| lambda.im).fold(0.0, f64::max);
        let along = Self { rigid: if self.threshold.is_axis() { RIGID * fastest } else { 0.0 }, ..*self };
        places.iter_mut().for_each(|place| place.put_rigid_motions_on_the_axis(along.rigid));
        along.between(places)
    }

    /// The changes on the line, by spectra at `places` and between.
    fn between(&self, mut places: Vec<Place>) -> Result<Changes, Error> {
        let mut changes = Changes::default();
        self.look_into_dips(&mut places, &mut changes)?;
        changes.spectra = places.len() as u64;
        for step in places.windows(2) {
            self.resolve([&step[0], &step[1]], 0, &mut changes)?;
        }
        changes.found.sort_by(|a, b| a.at.total_cmp(&b.at));
        undo(&mut changes.found);
        changes.enter_ranges(&places);
        if let Some(Band { studied: [from, to], followed: [lowest, highest], .. }) = self.band {
            let grown = |there: [f64; 2]| {
                places.iter().filter_map(|place| GrowingBeside::at(place, there)).reduce(GrowingBeside::with)
            };
            changes.beside = [[lowest, from], [to.next_up(), highest]].map(grown);
        }
        if let (Some(last), Some(first)) = (places.pop(), places.into_iter().next()) {
            changes.ends = [first.counted, last.counted];
        }
        Ok(changes)
    }

    /// Distance from a change that was found between two places, as a fraction of the range, up to which growth is hidden, and where it may truly begin:
    /// there a real eigenvalue is so small that it is taken for a rigid motion, or a mode grows so little that it is taken to be on the axis. 0 of a change
    /// by the band and of an exchange; 1 where no law of the growth is found.
    fn hidden(&self, change: &Change, [a, b]: [&Place; 2]) -> Result<f64, Error> {
        let (side, grown) = if change.starts { (1.0, b) } else { (-1.0, a) };
        let growth_of = |place: &Place| {
            let CountedSpectrum { flutter, divergence, .. } = &place.counted;
            if change.of == ChangeOf::Divergence {
                return divergence.iter().copied().fold(f64::INFINITY, f64::min);
            }
            let distance = |lambda: &&Complex<f64>| (lambda.im - change.lambda.im).abs();
            let nearest = flutter.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
            nearest.map_or(f64::INFINITY, |lambda| self.threshold.margin(*lambda))
        };
        let zone = match change.of {
            ChangeOf::Divergence => {
                self.rigid.max(Some(growth_of(grown)).filter(|least| *least < SLOW * self.rigid).unwrap_or(0.0))
            }
            ChangeOf::Flutter => growth_of(grown),
            ChangeOf::Band | ChangeOf::Exchange => return Ok(0.0),
        };
        // Where growth is known to few digits a mode may seem not to grow farther away.
        let is_rounded = change.of == ChangeOf::Flutter && zone > ROUNDED * change.lambda.norm();
        let growth_at = |distance: f64| {
            let growth = growth_of(&self.place((change.at + side * distance).clamp(0.0, 1.0))?);
            Ok::<f64, Error>(if is_rounded && growth.is_infinite() { 0.0 } else { growth })
        };
        let (mut distance, mut growth) = (NEXT_TO, growth_at(NEXT_TO)?);
        while growth < CLEAR * zone && distance < 1.0 {
            let next = growth_at(2.0 * distance)?;
            if next > LEAP * zone {
                // Two modes meet in between, beyond which another law holds: where growth began before is not known.
                return Ok(1.0);
            }
            (distance, growth) = (2.0 * distance, next);
        }
        if !growth.is_finite() {
            return Ok(distance);
        }
        // Growth is taken as a power of the distance from where it begins; the power says how far before the change that is.
        let ratio = growth_at(2.0 * distance)? / growth;
        // A real eigenvalue leaves zero in proportion to the distance, though it grows like the root of the distance as soon as it outgrows its damping: a
        // power below 1 is not that of its beginning.
        let flattest = if change.of == ChangeOf::Divergence { 1.0 } else { 0.5 };
        let power = if ratio > 1.0 { ratio.log2().clamp(flattest, STEEPEST) } else { STEEPEST };
        let hidden = distance / ((growth / zone).powf(1.0 / power) - 1.0);
        Ok(if hidden.is_finite() { (SAFETY * hidden.abs()).clamp(f64::EPSILON * distance, 1.0) } else { 1.0 })
    }

    /// Adds places where an eigenvalue may cross and come back between two of them.
    fn look_into_dips(&self, places: &mut Vec<Place>, changes: &mut Changes) -> Result<(), Error> {
        let mut added = 0;
        loop {
            let mut middles: Vec<f64> = Vec::new();
            for three in places.windows(3) {
                if three.iter().all(|place| place.is_settled) || !self.dips(three) {
                    continue;
                }
                let [a, _, c] = [&three[0], &three[1], &three[2]].map(|place| place.at);
                if c - a <= 2.0 * SHORTEST_DIP || added + middles.len() >= MOST_DIPS {
                    changes.unresolved.push((a, c));
                    continue;
                }
                middles.extend(three.windows(2).map(|step| 0.5 * (step[0].at + step[1].at)));
            }
            for step in places.windows(2) {
                if step.iter().all(|place| place.is_settled) || !self.swaps([&step[0], &step[1]]) {
                    continue;
                }
                let [a, b] = [step[0].at, step[1].at];
                if b - a <= SHORTEST_DIP || added + middles.len() >= MOST_DIPS {
                    changes.unresolved.push((a, b));
                    continue;
                }
                middles.push(0.5 * (a + b));
            }
            places.iter_mut().for_each(|place| place.is_settled = true);
            middles.sort_by(f64::total_cmp);
            middles.dedup();
            if middles.is_empty() {
                return Ok(());
            }
            added += middles.len();
            let new = middles.into_par_iter().map(|at| self.place(at)).collect::<Result<Vec<_>, Error>>()?;
            places.extend(new);
            places.sort_by(|a, b| a.at.total_cmp(&b.at));
        }
    }

    /// Enters the changes between two places.
    fn resolve(&self, [a, b]: [&Place; 2], depth: usize, changes: &mut Changes) -> Result<(), Error> {
        let [flutter, beside, divergence] = self.difference([a, b]);
        // What changes beside the band alone counts nowhere.
        if (flutter, divergence) == (0, 0) {
            return Ok(());
        }
        let one = match (flutter, beside, divergence) {
            (1 | -1, 0, 0) => Some((ChangeOf::Flutter, flutter > 0)),
            (1, -1, 0) | (-1, 1, 0) => Some((ChangeOf::Band, flutter > 0)),
            (0, _, 1 | -1) => Some((ChangeOf::Divergence, divergence > 0)),
            (-1, 0, 2) => Some((ChangeOf::Exchange, true)),
            (1, 0, -2) => Some((ChangeOf::Exchange, false)),
            _ => None,
        };
        if let Some((of, starts)) = one.filter(|_| depth.is_multiple_of(HALVINGS_BETWEEN)) {
            let (found, spectra) = crossing(self, [a, b], of, starts)?;
            changes.spectra += spectra;
            if let Some(change) = found {
                changes.found.push(change);
                return Ok(());
            }
        }
        let middle = 0.5 * (a.at + b.at);
        if b.at - a.at <= SHORTEST || middle <= a.at || middle >= b.at {
            let found = self.at_one_place([a, b]);
            for change in found {
                let error = change.error.max(self.hidden(&change, [a, b])?);
                changes.found.push(Change { error, ..change });
            }
            return Ok(());
        }
        let between = self.place(middle)?;
        changes.spectra += 1;
        self.resolve([a, &between], depth + 1, changes)?;
        self.resolve([&between, b], depth + 1, changes)
    }

    /// Changes in a step that is not halved any more: all at its middle.
    fn at_one_place(&self, [a, b]: [&Place; 2]) -> Vec<Change> {
        let [mut flutter, mut beside, mut divergence] = self.difference([a, b]);
        let (at, error) = (0.5 * (a.at + b.at), (b.at - a.at).max(LEAST_ERROR));
        let mut found = Vec::new();
        let more = |starts: bool| if starts { b } else { a };
        let mut add = |of: ChangeOf, starts: bool, lambda: Complex<f64>| {
            found.push(Change { at, error, lambda, of, starts, is_double: of == ChangeOf::Exchange });
        };
        while flutter * divergence < 0 && divergence.abs() >= 2 {
            let starts = divergence > 0;
            // The pair that has the least frequency is the one that became real.
            let lambda = more(!starts).counted.flutter.first().map_or(0.0, |lambda| lambda.re);
            add(ChangeOf::Exchange, starts, Complex::from(lambda));
            (flutter, divergence) = (flutter + divergence.signum(), divergence - 2 * divergence.signum());
        }
        let growing = more(flutter > 0);
        let to_end = |lambda| self.nearest_end(lambda).map_or(f64::INFINITY, |end| end.value(lambda));
        let mut at_end = self.growing(growing, to_end).into_iter();
        while flutter * beside < 0 {
            let Some(lambda) = at_end.next() else { break };
            add(ChangeOf::Band, flutter > 0, lambda);
            (flutter, beside) = (flutter - flutter.signum(), beside - beside.signum());
        }
        for lambda in self.nearest_to_threshold(growing).into_iter().take(flutter.unsigned_abs() as usize) {
            add(ChangeOf::Flutter, flutter > 0, Complex::new(0.0, lambda.im));
        }
        for _ in 0..divergence.unsigned_abs() {
            add(ChangeOf::Divergence, divergence > 0, Complex::default());
        }
        found
    }

    /// True if, at the middle one of three places, the distance of a mode that is studied from the threshold, or that of a growing mode from the nearest
    /// end of the band, is no larger than at the two others, and the mode may cross there and come back.
    fn dips(&self, places: &[Place]) -> bool {
        let [left, here, right] = [&places[0], &places[1], &places[2]].map(Place::sides);
        let at = [places[0].at, places[1].at, places[2].at];
        here.into_iter().any(|(lambda, side)| {
            let (Some((before, from)), Some((after, to))) = (nearest(&left, lambda), nearest(&right, lambda)) else {
                return false;
            };
            let three = [before, lambda, after];
            let margin = |lambda: Complex<f64>| self.threshold.margin(lambda).abs();
            let stays = side.is_some() && from == side && to == side;
            let to_threshold = || three.into_iter().any(|l| self.is_studied(l)) && dips_to_zero(at, three.map(margin));
            // A real eigenvalue has no frequency.
            let grows = side == Some(true) && three.into_iter().all(|lambda| lambda.im > 0.0);
            let to_end = |end: Measure| {
                let distances = three.map(|lambda| end.value(lambda));
                let is_one_side = distances.into_iter().all(|distance| (distance > 0.0) == (distances[0] > 0.0));
                is_one_side && dips_to_zero(at, distances.map(f64::abs))
            };
            stays && (to_threshold() || grows && self.nearest_end(lambda).is_some_and(to_end))
        })
    }

    /// True if one mode that is studied seems to become stable and another one unstable between two places that count alike.
    fn swaps(&self, [a, b]: [&Place; 2]) -> bool {
        let [flutter, _, divergence] = self.difference([a, b]);
        if (flutter, divergence) != (0, 0) {
            return false;
        }
        let [here, there] = [a.sides(), b.sides()];
        here.iter().any(|&(lambda, side)| {
            let Some((next, to)) = nearest(&there, lambda) else { return false };
            let is_other = side.is_some() && to.is_some() && side != to;
            let is_studied = self.is_studied(lambda) || self.is_studied(next);
            is_other && is_studied && nearest(&here, next).is_some_and(|(back, _)| back == lambda)
        })
    }
}

/// Takes out pairs of changes of one kind and frequency, at the same place, that undo each other: rounding next to a single change, or a mode that touches
/// the threshold.
fn undo(changes: &mut Vec<Change>) {
    let mut kept: Vec<Change> = Vec::with_capacity(changes.len());
    for change in changes.drain(..) {
        let undone = kept.iter().rposition(|other| {
            change.at - other.at <= UNDONE
                && other.of == change.of
                && other.starts != change.starts
                && (other.lambda.im - change.lambda.im).abs() <= 1e-6 * (1.0 + change.lambda.im)
        });
        match undone {
            Some(place) => drop(kept.remove(place)),
            None => kept.push(change),
        }
    }
    *changes = kept;
}

impl Changes {
    /// Enters the ranges in which modes are on the axis at two neighbouring places or more, and, as unresolved, those in which no bound says on which side
    /// of the threshold a mode is. The error of a change in such an unresolved range, or next to it, becomes at least its distance from the farther end.
    fn enter_ranges(&mut self, places: &[Place]) {
        let neighbours = |has: fn(&CountedSpectrum) -> usize| {
            let mut ranges: Vec<Marginal> = Vec::new();
            let mut is_open = false;
            for step in places.windows(2) {
                let [a, b] = [has(&step[0].counted), has(&step[1].counted)];
                let is_inside = a > 0 && b > 0;
                match ranges.last_mut() {
                    Some(last) if is_open && is_inside => {
                        (last.to, last.modes, last.fewest) = (step[1].at, last.modes.max(b), last.fewest.min(b));
                    }
                    _ if is_inside => {
                        let (modes, fewest) = (a.max(b), a.min(b));
                        ranges.push(Marginal { from: step[0].at, to: step[1].at, modes, fewest });
                    }
                    _ => {}
                }
                is_open = is_inside;
            }
            ranges
        };
        self.marginal = neighbours(|counted| counted.marginal.len() - counted.blunt.len());
        let open = neighbours(|counted| counted.open + counted.blunt.len());
        // A change next to an unresolved range may be anywhere in it.
        for &Marginal { from, to, .. } in &open {
            let after = places.iter().map(|place| place.at).find(|at| *at > to).unwrap_or(to);
            let before = places.iter().map(|place| place.at).rfind(|at| *at < from).unwrap_or(from);
            for change in self.found.iter_mut().filter(|change| (before..=after).contains(&change.at)) {
                change.error = change.error.max(change.at - from).max(to - change.at);
            }
        }
        self.unresolved.extend(open.into_iter().map(|range| (range.from, range.to)));
        self.unresolved.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.unresolved.dedup();
    }
}

/// The eigenvalue of a list that is nearest to another one.
fn nearest(list: &[(Complex<f64>, Option<bool>)], to: Complex<f64>) -> Option<(Complex<f64>, Option<bool>)> {
    let distance = |other: &(Complex<f64>, Option<bool>)| (other.0 - to).norm_sqr();
    list.iter().copied().min_by(|x, y| distance(x).total_cmp(&distance(y)))
}

/// True if a positive function, at three places, has its least value at the middle one and by a parabola comes near zero.
fn dips_to_zero([a, b, c]: [f64; 3], [left, here, right]: [f64; 3]) -> bool {
    if !(here <= left && here <= right && here < left.max(right)) {
        return false;
    }
    let (falls, rises) = ((left - here) / (b - a), (right - here) / (c - b));
    let curvature = (falls + rises) / (0.5 * (c - a));
    let slope = (rises * (b - a) - falls * (c - b)) / (c - a);
    let depth = 0.5 * slope * slope / curvature;
    // A function that turns faster goes deeper: by no more than it rises to its neighbours.
    here <= DIP_MARGIN * depth + 0.25 * (left - here).min(right - here)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_dips_to_zero_where_it_does() {
        let at = [0.0, 1.0, 2.0];
        let with = |f: fn(f64) -> f64| dips_to_zero(at, at.map(f));
        assert!(with(|x| (x - 1.2).powi(2) - 0.03));
        assert!(with(|x| (x - 1.2).powi(2) + 0.03));
        assert!(!with(|x| (x - 1.2).powi(2) + 1.0));
        assert!(!with(|x| 3.0 - x));
    }
}
