//! Motion in time as pieces, each a power series in time: Taylor's method.
//!
//! A piece ends where the force of a contact has a kink, so that within it all forces are smooth. There `x' = x_0' + J (x - x_0) + B r`, with the
//! Jacobian J at the begin of the piece and r, what friction has beyond its tangent there. A constant coefficient has no r: each term of
//! the series follows from the one before by a product with J, whatever is open. Else r is a polynomial of time through its values at some
//! moments of the piece, found by repeated substitution. Of a contact that slides slower than its stick speed the coefficient is a polynomial of the velocity, and so
//! r a product of series that is known term by term: there friction is stiff, and repeated substitution would need many short pieces.
//!
//! A. Jorba, M. Zou, A software package for the numerical integration of ODEs by means of high-order Taylor methods, Experiment. Math. 14 (2005)
//! 99-117.

use nalgebra::DMatrix;
use pulp::{Arch, Simd, WithSimd};

use crate::contact::along;
use crate::moments::{FITTED, LEADING, MOMENTS, fit, moment};
use crate::series::{MOST_TERMS, root, value_and_slope};
use crate::size::{amplitude, largest};
use crate::slow::Slow;
use crate::system::{ContactForces, product};
use crate::{ContactSystem, Error};

/// Number of terms fewer than in the piece before from which on their size is looked at; chosen.
const FEWER: usize = 6;

/// Part of a unit before which a kink is early, and the length of the next unit in that; chosen, by the time that motions of lattices took.
const EARLY: f64 = 0.4;
const SHORTER: f64 = 0.8;

/// Part of the allowed error that the last two terms of a series may have; chosen.
const LAST_TERMS: f64 = 0.01;

/// Part of the allowed error by which a substitution may change the end of a piece, and that the last power of the remainder may have; chosen.
const SUBSTITUTED: f64 = 0.1;

/// Substitutions after which a piece is too long; chosen.
const MOST_SUBSTITUTIONS: usize = 12;

/// Number of times as many entries as are not 0 from which on a matrix is read entry by entry; chosen, as wide registers multiply so many at once.
const SPARSE: usize = 8;

/// Pieces one after the other that may take no time; chosen, above the number of kinks that a motion of some symmetry has at once.
const MOST_STANDING: usize = 10_000;

/// A motion at a time, the piece by which it came there, and the way on.
pub(crate) struct Path<'a> {
    pub system: &'a ContactSystem,
    pub scales: &'a [f64],
    /// Allowed error of a piece, relative to the scales and the size of the motion; and that of the piece, relative to the scales.
    tolerance: f64,
    allowed: f64,
    /// 1 over the scales.
    per_scale: Vec<f64>,
    /// Functions whose changes of sign end a piece, by contact N, w + eps, w and w - eps, and at last the section: rows of `seen` and what is added.
    pub kinks: Vec<(usize, f64)>,
    /// Sides of the kinks on which the motion is in the piece, true where they are above 0.
    pub sides: Vec<bool>,
    /// Kink at the end of the piece.
    kink: Option<usize>,
    /// Time at the end of the piece, s.
    pub time: f64,
    /// State at the end of the piece.
    pub x: Vec<f64>,
    /// Time at its begin, s.
    begin: f64,
    /// Unit of time of its series, s, and its length in units.
    pub unit: f64,
    pub length: f64,
    /// Terms of its series, one a column, and the number of them after the first.
    terms: DMatrix<f64>,
    pub degree: usize,
    /// Matrix of the readings of a state by contacts, and that times the terms: by rows changes of the normal force, N, sliding velocities without v, m/s,
    /// bristles; and the section.
    reads: DMatrix<f64>,
    /// Entries of `reads` that are not 0, by rows, where most are 0.
    sparse_reads: Option<Vec<Vec<(usize, f64)>>>,
    pub seen: DMatrix<f64>,
    /// Forces of the contacts at its begin, and the rows of J below those that say that velocities are rates of displacements.
    pub forces: Vec<ContactForces>,
    pub below: DMatrix<f64>,
    /// Powers from the first on of the remainder of friction of each contact, and then of the rates of their bristles.
    remainder: DMatrix<f64>,
    /// The friction of each contact in the piece where that is known term by term.
    pub slow: Vec<Option<Slow<'a>>>,
    /// Change of the state in the time 1 s by a remainder of 1, in scales.
    pub weights: Vec<f64>,
    /// Unit of the next series.
    next: f64,
    standing: usize,
}

impl<'a> Path<'a> {
    /// The motion from a state at time 0, with a first unit of time, s. `section` is a plane of velocities, whose crossings end a piece; empty without.
    pub fn new(
        system: &'a ContactSystem,
        start: Vec<f64>,
        scales: &'a [f64],
        tolerance: f64,
        first: f64,
        section: &[f64],
    ) -> Self {
        let (d, n, contacts) = (system.dimension(), system.order(), system.contacts().len());
        let mut kinks = Vec::with_capacity(4 * contacts + 1);
        for (at, contact) in system.contacts().iter().enumerate() {
            let (slip, stick) = (contacts + at, contact.friction.stick_speed());
            kinks.extend([(at, contact.load), (slip, contact.speed + stick)]);
            kinks.extend([(slip, contact.speed), (slip, contact.speed - stick)]);
        }
        let rows = 2 * contacts + d - 2 * n;
        let mut reads = system.reads.clone();
        if !section.is_empty() {
            reads = reads.insert_row(rows, 0.0);
            reads.view_mut((rows, n), (1, n)).copy_from_slice(section);
            kinks.push((rows, 0.0));
        }
        let filled = reads.iter().filter(|entry| **entry != 0.0).count();
        let row = |row: usize| {
            let entries = reads.row(row).iter().copied().enumerate().collect::<Vec<_>>();
            entries.into_iter().filter(|(_, entry)| *entry != 0.0).collect()
        };
        let sparse_reads = (filled < reads.len() / SPARSE).then(|| (0..reads.nrows()).map(row).collect());
        let weight = |at: usize| {
            system.sliding.column(at).iter().zip(&scales[n..]).map(|(b, scale)| (b / scale).abs()).fold(0.0, f64::max)
        };
        let of_rate = |at: usize| system.bristle(at).map_or(0.0, |place| 1.0 / scales[place]);
        let mut path = Self {
            system,
            scales,
            tolerance,
            allowed: tolerance,
            per_scale: scales.iter().map(|scale| 1.0 / scale).collect(),
            sides: Vec::new(),
            kink: None,
            time: 0.0,
            begin: 0.0,
            unit: first,
            length: 0.0,
            terms: DMatrix::zeros(d, MOST_TERMS + 1),
            degree: 0,
            seen: DMatrix::zeros(reads.nrows(), MOST_TERMS + 1),
            reads,
            sparse_reads,
            forces: Vec::new(),
            below: DMatrix::zeros(0, 0),
            remainder: DMatrix::zeros(2 * contacts, FITTED),
            slow: vec![None; contacts],
            weights: (0..contacts).map(weight).chain((0..contacts).map(of_rate)).collect(),
            next: first,
            kinks,
            x: start,
            standing: 0,
        };
        path.terms.column_mut(0).copy_from_slice(&path.x);
        path.see();
        path.sides = path.kinks.iter().map(|&(row, offset)| path.seen[(row, 0)] + offset > 0.0).collect();
        path
    }

    /// True of a contact that is closed in the piece.
    pub fn is_closed(&self, contact: usize) -> bool {
        self.sides[4 * contact]
    }

    /// True of a contact that slides slower than its stick speed in the piece.
    pub fn is_slow(&self, contact: usize) -> bool {
        self.sides[4 * contact + 1] && !self.sides[4 * contact + 3]
    }

    /// Powers of time that the series needs as far as the piece goes, about: it may go on beyond its end.
    pub fn degree(&self) -> usize {
        (self.degree as f64 * self.length).ceil() as usize
    }

    /// Length of the piece, s.
    pub fn duration(&self) -> f64 {
        self.length * self.unit
    }

    /// Goes on to the next kink, as far as a series holds, or to `until`, whichever comes first. True where it comes through the section from below.
    ///
    /// # Errors
    /// Numbers that are not finite, pieces that vanish, work that is to end.
    pub fn step(&mut self, until: f64) -> Result<bool, Error> {
        self.system.go_on()?;
        let failed = |time, reason| Error::Motion { time, reason };
        if let Some(kink) = self.kink.take() {
            self.sides[kink] = !self.sides[kink];
        }
        self.begin = self.time;
        self.allowed = self.tolerance * amplitude(&self.x, self.scales).max(1.0);
        self.take_tangent();
        let rest = until - self.time;
        let (next, mut unit) = (self.next, self.next.min(rest));
        let kink = loop {
            match self.piece(unit) {
                Ok(kink) => break kink,
                Err(part) => unit *= part,
            }
            if unit < 1e-30 {
                return Err(failed(self.time, "its numbers are not finite"));
            }
            if self.time + 1e-3 * unit == self.time {
                return Err(failed(self.time, "its steps of time vanish"));
            }
        };
        if rest < next {
            self.next = self.next.max(next);
        }
        let taken = self.length * self.unit;
        let end = if kink.is_none() && taken == rest { until } else { self.begin + taken };
        self.standing = if end > self.begin { 0 } else { self.standing + 1 };
        if self.standing > MOST_STANDING {
            return Err(failed(self.time, "its steps of time vanish"));
        }
        let mut x = std::mem::take(&mut self.x);
        self.at_units(self.length, &mut x);
        (self.x, self.time) = (x, end);
        self.kink = kink;
        Ok(kink.is_some_and(|kink| kink == 4 * self.forces.len() && !self.sides[kink]))
    }

    /// Tries a piece of one unit of time at most. Returns the kink at its end, or the part of the unit with which to try again.
    fn piece(&mut self, mut unit: f64) -> Result<Option<usize>, f64> {
        self.remainder.fill(0.0);
        let mut is_curved = false;
        for _ in 0..MOST_SUBSTITUTIONS {
            let reach = self.fill(unit, is_curved)?;
            self.see();
            let mut values = self.seen_at([0.0, reach]);
            let (length, kink) = self.first_kink(reach, &values);
            if kink.is_some() {
                values = self.seen_at([0.0, length]);
            }
            let [change, last] = self.take_remainder(unit, length, is_curved, &values);
            if !(change.is_finite() && last.is_finite()) {
                return Err(0.1);
            }
            if change <= SUBSTITUTED {
                (self.unit, self.length) = (unit, length);
                // One more term costs so much less than one more piece that only a kink early in the unit makes the next unit shorter; a series whose
                // terms have all been needed is as long as it can be.
                let growth = match kink {
                    Some(_) if !is_curved => {
                        if length < EARLY {
                            SHORTER
                        } else {
                            1.0
                        }
                    }
                    _ => 2.0,
                };
                let growth = if reach < 1.0 { reach } else { growth };
                let growth = if is_curved {
                    growth.min(0.9 * (SUBSTITUTED / last).powf(1.0 / (FITTED + 1) as f64))
                } else {
                    growth
                };
                self.next = unit * growth;
                return Ok(kink);
            }
            if last > SUBSTITUTED {
                return Err((0.9 * length * (SUBSTITUTED / last).powf(1.0 / (FITTED + 1) as f64)).clamp(0.05, 0.8));
            }
            // The remainder is one over this part alone.
            unit *= length;
            is_curved = true;
        }
        Err(0.5)
    }

    /// Takes forces and Jacobian at the begin of a piece, on the sides of the kinks where the motion goes on.
    fn take_tangent(&mut self) {
        let mut forces = std::mem::take(&mut self.forces);
        let is_first = forces.is_empty();
        let mut is_other = is_first;
        for contact in 0..self.system.contacts().len() {
            let found = self.system.forces_in_phase(contact, &self.x, self.is_closed(contact));
            match forces.get_mut(contact) {
                Some(before) => {
                    is_other |= !before.has_slopes_of(&found);
                    *before = found;
                }
                None => forces.push(found),
            }
        }
        if is_other {
            self.system.take_below(&forces, &mut self.below);
        }
        self.forces = forces;
        for contact in 0..self.slow.len() {
            let of = &self.forces[contact];
            let slow = self.system.slow_friction(contact, self.sides[4 * contact + 2]);
            let slow = slow.filter(|_| self.is_slow(contact) && self.is_closed(contact));
            let slopes = [of.friction_by_gap, of.friction_by_velocity];
            self.slow[contact] = slow.map(|slow| Slow::new(&self.system.contacts()[contact], slow, slopes));
        }
    }

    /// Fills in the terms of the series in a unit of time. Returns the part of the unit, up to 1, over which it holds; fails with the part of the unit
    /// with which to try again.
    fn fill(&mut self, unit: f64, is_curved: bool) -> Result<f64, f64> {
        let (n, contacts) = (self.system.order(), self.system.contacts().len());
        self.terms.column_mut(0).copy_from_slice(&self.x);
        let (expected, mut before, mut last) = (self.degree, f64::INFINITY, f64::INFINITY);
        for k in 0..MOST_TERMS {
            let (from, mut to) = self.terms.columns_range_pair_mut(k, k + 1);
            let (from, to) = (from.as_slice(), to.as_mut_slice());
            if k == 0 {
                self.system.rate_with(&self.forces, from, to);
            } else {
                to[..n].copy_from_slice(&from[n..2 * n]);
                product(&self.below, from, &mut to[n..]);
            }
            for (contact, slow) in self.slow.iter_mut().enumerate() {
                let Some(slow) = slow else { continue };
                let friction = slow.remainder(k, &from[..n], &from[n..]);
                if k > 0 {
                    let column = self.system.sliding.column(contact);
                    to[n..2 * n].iter_mut().zip(&column).for_each(|(to, b)| *to += b * friction);
                }
            }
            if is_curved && (1..=FITTED).contains(&k) {
                for contact in 0..contacts {
                    let friction = self.remainder[(contact, k - 1)];
                    let column = self.system.sliding.column(contact);
                    to[n..2 * n].iter_mut().zip(&column).for_each(|(to, b)| *to += b * friction);
                    if let Some(place) = self.system.bristle(contact) {
                        to[place] += self.remainder[(contacts + contact, k - 1)];
                    }
                }
            }
            let factor = unit / (k + 1) as f64;
            to.iter_mut().for_each(|x| *x *= factor);
            self.degree = k + 1;
            // As many are needed as in the piece before, or nearly.
            if k + FEWER < expected {
                continue;
            }
            let size = to.iter().zip(&self.per_scale).fold(0.0, |size, (x, per_scale)| largest(size, x * per_scale));
            (before, last) = (last, size / self.allowed);
            if !last.is_finite() {
                return Err(0.1);
            }
            if before.max(last) <= LAST_TERMS && (!is_curved || k > FITTED) {
                return Ok(1.0);
            }
        }
        let reach = |term: f64, power: usize| (LAST_TERMS / term).powf(1.0 / power as f64);
        Ok(reach(before, MOST_TERMS - 1).min(reach(last, MOST_TERMS)).min(1.0))
    }

    /// Takes what contacts and section see of the terms.
    fn see(&mut self) {
        let terms = self.degree + 1;
        let Some(rows) = &self.sparse_reads else {
            self.seen.columns_mut(0, terms).gemm(1.0, &self.reads, &self.terms.columns(0, terms), 0.0);
            return;
        };
        for (mut seen, term) in self.seen.column_iter_mut().zip(self.terms.column_iter()).take(terms) {
            seen.iter_mut().zip(rows).for_each(|(seen, row)| *seen = along(row, term.as_slice()));
        }
    }

    /// Readings of contacts and section at the moments of a part of the unit, by columns.
    fn seen_at(&self, [from, to]: [f64; 2]) -> DMatrix<f64> {
        let terms = self.degree + 1;
        let mut powers = DMatrix::zeros(terms, MOMENTS);
        for (at, mut column) in powers.column_iter_mut().enumerate() {
            let (part, mut power) = (from + (to - from) * moment(at), 1.0);
            for entry in &mut column {
                *entry = power;
                power *= part;
            }
        }
        self.seen.columns(0, terms) * powers
    }

    /// Takes the remainder over the first part of the unit. Returns how much it changes the end of the piece against the remainder so far, and how much its
    /// last power adds to it, in allowed errors.
    fn take_remainder(&mut self, unit: f64, length: f64, is_curved: bool, values: &DMatrix<f64>) -> [f64; 2] {
        let contacts = self.system.contacts().len();
        let (mut change, mut last) = (0.0_f64, 0.0_f64);
        for contact in (0..contacts).filter(|contact| self.slow[*contact].is_none()) {
            let at_begin = &self.forces[contact];
            let bristle = self.system.bristle(contact).map(|place| 2 * contacts + place - 2 * self.system.order());
            let state = |values: &DMatrix<f64>, moment: usize| bristle.map_or(0.0, |row| values[(row, moment)]);
            let mut remainders = [[0.0; FITTED]; 2];
            let [of_friction, of_rate] = &mut remainders;
            for (at, (friction, rate)) in of_friction.iter_mut().zip(of_rate).enumerate() {
                // Every second moment.
                let moment = 2 * at + 1;
                let [gap, slip] = [values[(contact, moment)], values[(contacts + contact, moment)]];
                let of_state = state(values, moment);
                let velocity = self.system.contacts()[contact].speed + slip;
                let found = self.system.forces(contact, self.is_closed(contact), gap, velocity, of_state);
                let moved = [
                    gap - self.seen[(contact, 0)],
                    slip - self.seen[(contacts + contact, 0)],
                    of_state - state(&self.seen, 0),
                ];
                let linear = at_begin.linear(moved);
                (*friction, *rate) = (found.friction - linear[0], found.rate - linear[1]);
            }
            for (row, values) in [(contact, remainders[0]), (contacts + contact, remainders[1])] {
                let weight = unit * length * self.weights[row] / self.allowed;
                let size = weight * values.iter().fold(0.0, |size, value| largest(size, *value));
                if !is_curved && size <= SUBSTITUTED {
                    continue;
                }
                for (at, value) in values.iter().enumerate() {
                    let part = length * moment(2 * at + 1);
                    let before = (0..FITTED).rev().fold(0.0, |sum, k| (sum + self.remainder[(row, k)]) * part);
                    change = largest(change, (value - before) * weight);
                }
                let powers = fit(&values);
                last = largest(last, powers[FITTED - 1] / LEADING * weight);
                self.remainder.row_mut(row).copy_from_slice(&powers);
            }
        }
        [change, last]
    }

    /// State at a time of the piece, s since the start of the motion.
    pub fn at(&self, time: f64, x: &mut [f64]) {
        self.at_units((time - self.begin) / self.unit, x);
    }

    /// State at a part of the piece, 0 to 1.
    pub fn at_part(&self, part: f64, x: &mut [f64]) {
        self.at_units(part * self.length, x);
    }

    /// The displacement of a degree of freedom where its velocity is 0, between two parts of the piece at which its velocity has different signs.
    pub fn turning(&self, dof: usize, [low, high]: [f64; 2]) -> f64 {
        let series = |row: usize| (0..=self.degree).rev().map(move |k| self.terms[(row, k)]);
        let velocity: Vec<f64> = series(self.system.order() + dof).collect();
        let at = |part: f64| value_and_slope(velocity.iter().copied(), part);
        let sign = if at(low * self.length)[0] > 0.0 { 1.0 } else { -1.0 };
        // A displacement turns so slowly that half of the digits of the time will do.
        let turn = root(|part| at(part).map(|x| sign * x), [low * self.length, high * self.length], 1e-8);
        value_and_slope(series(dof), turn)[0]
    }

    /// State at so many units of time after the begin of the piece.
    fn at_units(&self, part: f64, x: &mut [f64]) {
        Arch::new().dispatch(Sum { terms: &self.terms, degree: self.degree, part, x });
    }
}

/// The sum of a series at a part of its unit, by Horner's rule: the same bits on registers of any width.
struct Sum<'a> {
    terms: &'a DMatrix<f64>,
    degree: usize,
    part: f64,
    x: &'a mut [f64],
}

impl WithSimd for Sum<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { terms, degree, part, x } = self;
        let mut terms = terms.as_slice().chunks_exact(x.len().max(1)).take(degree + 1).rev();
        x.copy_from_slice(terms.next().unwrap_or_default());
        for term in terms {
            x.iter_mut().zip(term).for_each(|(x, term)| *x = *x * part + term);
        }
    }
}
