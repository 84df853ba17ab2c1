//! Motion in time as pieces, each a power series in time: Taylor's method.
//!
//! A piece ends where the force of a contact has a kink, so that within it all forces are smooth. There `x' = x_0' + J (x - x_0) + B r`, with the
//! Jacobian J at the begin of the piece and r, what friction has beyond its tangent there. A constant coefficient has no r: each term of
//! the series follows from the one before by a product with J, whatever is open. Else r follows term by term from the motion (`terms.rs`), or, of
//! a law that does not tell its series, is a polynomial of time through its values at some moments of the piece, found by repeated substitution. A contact that sticks has the friction that keeps it from sliding, term by term (`stick.rs`).
//!
//! A. Jorba, M. Zou, A software package for the numerical integration of ODEs by means of high-order Taylor methods, Experiment. Math. 14 (2005)
//! 99-117.

use nalgebra::DMatrix;
use pulp::{Arch, Simd, WithSimd};

use crate::contact::{Sliding, along};
use crate::moments::{FITTED, LEADING, MOMENTS, fit, moment};
use crate::series::{MOST_TERMS, root, value_and_slope};
use crate::size::{amplitude, largest};
use crate::stick::{AT_REST, Stuck};
use crate::system::{ContactForces, add_product, product};
use crate::terms::Terms;
use crate::{ContactSystem, Error};

/// Number of terms fewer than in the piece before from which on their size is looked at; chosen.
const FEWER: usize = 6;

/// Part of a unit before which a kink is early, and the length of the next unit in that; chosen, by the time that motions of lattices took.
const EARLY: f64 = 0.4;
const SHORTER: f64 = 0.8;

/// Factor by which a unit with a remainder is longer than the one before, at most; chosen: where kinks are many the last one was short.
const MOST_GROWTH: f64 = 8.0;

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
    /// Functions whose changes of sign end a piece, by contact N, `mu N - f`, w and `mu N + f`, and at last the section: rows of `seen` and what is added. Of a contact that cannot
    /// stick, without a multiplier f, the second and the fourth are not asked.
    pub kinks: Vec<(usize, f64)>,
    /// Sides of the kinks on which the motion is in the piece, true where they are above 0.
    pub sides: Vec<bool>,
    /// Ways in which contacts slide in the piece, and those that stick.
    pub sliding: Vec<Sliding>,
    pub stuck: Option<Stuck>,
    /// The row of `reads` whose change of sign began the piece with a jump of the rate, and the rates before and after it.
    pub jump: Option<(usize, [Vec<f64>; 2])>,
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
    /// bristles; and the section; of `seen` also what stuck contacts hold back from `mu N` without N0 either way, N.
    reads: DMatrix<f64>,
    /// Entries of `reads` that are not 0, by rows, where most are 0.
    sparse_reads: Option<Vec<Vec<(usize, f64)>>>,
    pub seen: DMatrix<f64>,
    /// Forces of the contacts that stick, N, by terms.
    held: DMatrix<f64>,
    /// Forces of the contacts at its begin, and the rows of J below those that say that velocities are rates of displacements.
    pub forces: Vec<ContactForces>,
    pub below: DMatrix<f64>,
    /// Terms of the contacts whose friction is more than its tangent and has a series.
    exact: Vec<Terms>,
    /// Contacts whose friction is more than its tangent and has none.
    fitted: Vec<usize>,
    /// Parts of the next terms of friction, N, and of the rates of bristles beyond the tangent, by contacts.
    beyond: [Vec<f64>; 2],
    /// Powers from the first on of the remainder of friction of each contact, and then of the rates of their bristles.
    remainder: DMatrix<f64>,
    /// Change of the state in the time 1 s by a remainder of 1, in scales.
    pub weights: Vec<f64>,
    /// Unit of the next series.
    next: f64,
    standing: usize,
}

impl<'a> Path<'a> {
    /// The motion from a state at time 0, with a first unit of time, s. `section` is a plane of velocities, whose crossings end a piece; empty without.
    ///
    /// # Errors
    /// A start of which it cannot be told which contacts stick.
    pub fn new(
        system: &'a ContactSystem,
        start: Vec<f64>,
        scales: &'a [f64],
        tolerance: f64,
        first: f64,
        section: &[f64],
    ) -> Result<Self, Error> {
        let (d, n, contacts) = (system.dimension(), system.order(), system.contacts().len());
        let rows = 2 * contacts + d - 2 * n;
        let mut reads = system.reads.clone();
        if !section.is_empty() {
            reads = reads.insert_row(rows, 0.0);
            reads.view_mut((rows, n), (1, n)).copy_from_slice(section);
        }
        let mut kinks = Vec::with_capacity(4 * contacts + 1);
        for (at, contact) in system.contacts().iter().enumerate() {
            let (slip, held) = ((contacts + at, contact.speed), reads.nrows() + 2 * at);
            let [forwards, backwards] =
                [0, 1].map(|side| system.static_friction[at].map_or(slip, |mu| (held + side, mu[side] * contact.load)));
            kinks.extend([(at, contact.load), forwards, slip, backwards]);
        }
        if !section.is_empty() {
            kinks.push((rows, 0.0));
        }
        let held = if (0..contacts).any(|contact| system.can_stick(contact)) { 2 * contacts } else { 0 };
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
        let is_curved = |at: &usize| !system.contacts()[*at].friction.is_constant();
        let (mut exact, mut fitted) = (Vec::new(), Vec::new());
        for contact in (0..contacts).filter(is_curved) {
            match Terms::new(system, contact) {
                Some(terms) => exact.push(terms),
                None => fitted.push(contact),
            }
        }
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
            seen: DMatrix::zeros(reads.nrows() + held, MOST_TERMS + 1),
            reads,
            sparse_reads,
            forces: Vec::new(),
            below: DMatrix::zeros(0, 0),
            exact,
            fitted,
            beyond: [vec![0.0; contacts], vec![0.0; contacts]],
            remainder: DMatrix::zeros(2 * contacts, FITTED),
            held: DMatrix::zeros(contacts, MOST_TERMS),
            sliding: vec![Sliding::Smooth; contacts],
            stuck: None,
            jump: None,
            weights: (0..contacts).map(weight).chain((0..contacts).map(of_rate)).collect(),
            next: first,
            kinks,
            x: start,
            standing: 0,
        };
        path.terms.column_mut(0).copy_from_slice(&path.x);
        path.see();
        path.sides = path.kinks.iter().map(|&(row, offset)| path.seen[(row, 0)] + offset > 0.0).collect();
        path.sliding = system.sliding_in(&path.x, &path.all_closed())?;
        path.take_sides();
        Ok(path)
    }

    /// Adds to accelerations what stuck contacts do to them, and gives their forces, N.
    pub fn hold(&self, acceleration: &mut [f64], force: impl FnMut(usize, f64)) {
        if let Some(stuck) = &self.stuck {
            stuck.hold(self.system, acceleration, force);
        }
    }

    /// True where friction is its tangent in all contacts.
    pub fn is_linear(&self) -> bool {
        self.exact.is_empty() && self.fitted.is_empty()
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
        self.jump = None;
        if let Some(kink) = self.kink.take() {
            self.cross(kink)?;
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
            let (length, kink) = self.first_kink(reach, &self.seen_at([0.0, reach]));
            let [change, last] = match self.fitted.is_empty() {
                true => [0.0; 2],
                false => self.take_remainder(unit, length, is_curved, &self.seen_at([0.0, length])),
            };
            if !(change.is_finite() && last.is_finite()) {
                return Err(0.1);
            }
            if change <= SUBSTITUTED {
                (self.unit, self.length) = (unit, length);
                // One more term costs so much less than one more piece that only a kink early in the unit makes the next unit shorter; a series whose
                // terms have all been needed is as long as it can be.
                let growth = match kink {
                    _ if reach < 1.0 => reach,
                    _ if is_curved => MOST_GROWTH,
                    None => 2.0,
                    Some(_) if length < EARLY => SHORTER,
                    Some(_) => 1.0,
                };
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
            let found = self.system.forces_in_phase(contact, &self.x, self.phase(contact));
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
    }

    /// Fills in the terms of the series in a unit of time. Returns the part of the unit, up to 1, over which it holds; fails with the part of the unit
    /// with which to try again.
    fn fill(&mut self, unit: f64, is_curved: bool) -> Result<f64, f64> {
        let (n, contacts, is_linear) = (self.system.order(), self.system.contacts().len(), self.is_linear());
        self.terms.column_mut(0).copy_from_slice(&self.x);
        for at in 0..self.exact.len() {
            let phase = self.phase(self.exact[at].contact);
            self.exact[at].begin(phase);
        }
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
            if !is_linear {
                let [friction, rates] = &mut self.beyond;
                for terms in &mut self.exact {
                    let contact = terms.contact;
                    [friction[contact], rates[contact]] = terms.beyond(self.system, &self.forces[contact], from);
                }
                for &contact in &self.fitted {
                    let power = if is_curved && (1..=FITTED).contains(&k) { Some(k - 1) } else { None };
                    let remainder = |row: usize| power.map_or(0.0, |power| self.remainder[(row, power)]);
                    [friction[contact], rates[contact]] = [contact, contacts + contact].map(remainder);
                }
                add_product(&self.system.sliding, friction, &mut to[n..2 * n]);
                for (contact, rate) in rates.iter().enumerate() {
                    if let Some(place) = self.system.bristle(contact) {
                        to[place] += rate;
                    }
                }
            }
            if let Some(stuck) = &self.stuck {
                stuck.hold(self.system, &mut to[n..2 * n], |contact, force| self.held[(contact, k)] = force);
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
        let (terms, rows) = (self.degree + 1, self.reads.nrows());
        match &self.sparse_reads {
            None => {
                let mut seen = self.seen.view_mut((0, 0), (rows, terms));
                seen.gemm(1.0, &self.reads, &self.terms.columns(0, terms), 0.0);
            }
            Some(entries) => {
                for (mut seen, term) in self.seen.column_iter_mut().zip(self.terms.column_iter()).take(terms) {
                    seen.iter_mut().zip(entries).for_each(|(seen, row)| *seen = along(row, term.as_slice()));
                }
            }
        }
        let stuck = (0..self.sliding.len()).filter(|contact| self.sliding[*contact] == Sliding::Stuck);
        for contact in stuck {
            let mu = self.system.static_friction[contact].unwrap_or_default();
            for k in 0..terms {
                // The force has one term less than the motion.
                let force = if k < self.degree { self.held[(contact, k)] } else { 0.0 };
                let [forwards, backwards] = mu.map(|mu| mu * self.seen[(contact, k)]);
                self.seen[(rows + 2 * contact, k)] = forwards - force;
                self.seen[(rows + 2 * contact + 1, k)] = backwards + force;
            }
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
        // What stuck contacts hold back is of no use where there are none.
        let rows = if self.stuck.is_some() { self.seen.nrows() } else { self.reads.nrows() };
        self.seen.view((0, 0), (rows, terms)) * powers
    }

    /// Takes the remainder over the first part of the unit. Returns how much it changes the end of the piece against the remainder so far, and how much its
    /// last power adds to it, in allowed errors.
    fn take_remainder(&mut self, unit: f64, length: f64, is_curved: bool, values: &DMatrix<f64>) -> [f64; 2] {
        let contacts = self.system.contacts().len();
        let (mut change, mut last) = (0.0_f64, 0.0_f64);
        let fitted = self.fitted.iter().copied().filter(|contact| self.sliding[*contact] != Sliding::Stuck);
        for contact in fitted {
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
                let found = self.system.forces(contact, self.phase(contact), [gap, velocity, of_state]);
                let moved = [
                    gap - self.seen[(contact, 0)],
                    slip - self.seen[(contacts + contact, 0)],
                    of_state - state(&self.seen, 0),
                ];
                let linear = at_begin.linear(moved);
                *friction = found.friction - at_begin.friction - linear[0];
                *rate = found.rate - at_begin.rate - linear[1];
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

    /// Time of the piece for which a contact sticks, or slides slower than its stick speed under friction that does not jump, s. Of contacts that stick together,
    /// on one node for example, some may be held with all of their friction: these stick too, though they creep.
    pub fn slow_time(&self, contact: usize) -> f64 {
        let (of, row) = (&self.system.contacts()[contact], self.sliding.len() + contact);
        let velocity_and_slope = |part: f64| {
            let [slip, slope] = value_and_slope((0..=self.degree).rev().map(|k| self.seen[(row, k)]), part);
            [of.speed + slip, slope]
        };
        if self.sliding[contact] != Sliding::Smooth {
            let creeps = |part: f64| velocity_and_slope(part * self.length)[0].abs() <= AT_REST * of.speed;
            let is_stuck = self.sliding[contact] == Sliding::Stuck || [0.5, 1.0].into_iter().all(creeps);
            return if is_stuck { self.duration() } else { 0.0 };
        }
        let above = |part: f64| {
            let [velocity, slope] = velocity_and_slope(part);
            [velocity.abs() - of.friction.stick_speed(), velocity.signum() * slope]
        };
        let slip = self.seen.row(row);
        let least =
            (of.speed + slip[0]).abs() - slip.iter().take(self.degree + 1).skip(1).map(|x| x.abs()).sum::<f64>();
        if least > of.friction.stick_speed() {
            return 0.0;
        }
        let (mut slow, mut before) = (0.0, (0.0, above(0.0)[0] < 0.0));
        for at in 0..MOMENTS {
            let part = self.length * moment(at);
            let now = (part, above(part)[0] < 0.0);
            slow += match (before.1, now.1) {
                (true, true) => now.0 - before.0,
                (false, false) => 0.0,
                (true, false) => root(|part| above(part).map(|x| -x), [before.0, now.0], 1e-12) - before.0,
                (false, true) => now.0 - root(above, [before.0, now.0], 1e-12),
            };
            before = now;
        }
        slow * self.unit
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
