//! Friction of a sliding contact term by term, where its law has a series: that of `mu N` follows from those of mu and of the normal force N.

use friction::{FrictionSeries, product_term};

use crate::ContactSystem;
use crate::contact::{Sliding, along};
use crate::system::ContactForces;

/// Terms of the friction of one contact in a piece of motion.
pub(crate) struct Terms {
    /// Place of the contact, from 0.
    pub contact: usize,
    series: Box<dyn FrictionSeries>,
    /// Terms of mu.
    coefficient: Vec<f64>,
    /// Terms of the normal force, N; 0 of a contact that is open.
    normal: Vec<f64>,
    /// Phase of the contact in the piece: whether it is closed, and how it slides.
    phase: (bool, Sliding),
}

impl Terms {
    /// Terms of a contact; `None` where its law has no series.
    pub fn new(system: &ContactSystem, contact: usize) -> Option<Self> {
        let series = system.contacts[contact].friction.series()?;
        Some(Self { contact, series, coefficient: Vec::new(), normal: Vec::new(), phase: (true, Sliding::Stuck) })
    }

    /// Begins another piece, in which the contact is closed, or not, and slides like this.
    pub fn begin(&mut self, phase: (bool, Sliding)) {
        self.phase = phase;
        self.series.begin(phase.1 == Sliding::Forwards);
        self.coefficient.clear();
        self.normal.clear();
    }

    /// Parts of the next terms of friction, N, and of the rate of the bristle beyond the tangent at the begin of the piece, by the term of the motion;
    /// 0 of the first ones, which are in the tangent.
    pub fn beyond(&mut self, system: &ContactSystem, tangent: &ContactForces, x: &[f64]) -> [f64; 2] {
        let (contact, (is_closed, sliding)) = (&system.contacts[self.contact], self.phase);
        if sliding == Sliding::Stuck {
            return [0.0; 2];
        }
        let is_first = self.normal.is_empty();
        let gap = contact.change_of_load(x);
        let slip = -along(&contact.sliding, &x[system.order()..]);
        let bristle = system.bristle(self.contact).map_or(0.0, |place| x[place]);
        let [load, speed, steady] = match is_first {
            true => [contact.load, contact.speed, system.steady_bristle(self.contact)],
            false => [0.0; 3],
        };
        let [coefficient, rate] = self.series.next(speed + slip, steady + bristle);
        self.coefficient.push(coefficient);
        self.normal.push(if is_closed { load + gap } else { 0.0 });
        if is_first {
            return [0.0; 2];
        }
        let friction = product_term(&self.coefficient, &self.normal);
        let linear = tangent.linear([gap, slip, bristle]);
        [friction - linear[0], rate - linear[1]]
    }
}
