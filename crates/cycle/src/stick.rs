//! Contacts that stick, as a constraint: a stuck contact does not slide, and its friction is what keeps it so, up to what it can hold.
//!
//! Where the sliding of a contact turns, friction of a law of the speed alone jumps (Filippov). A stuck contact keeps its sliding velocity, and the forces f of all
//! stuck ones solve `(G + d) f = -B^T a`, with the accelerations a that all else makes, `G = B^T M^-1 B`, and a part of the diagonal of G as d, so that the forces of contacts
//! that move together are known too. So a contact creeps by that part of what its friction could accelerate it. Which contacts stick where several could is a linear
//! complementarity problem with one solution: no force is above `mu N`, and one that is there does not oppose the sliding that begins.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::contact::{Sliding, along};
use crate::system::ContactForces;
use crate::{ContactSystem, Error};

/// Part of G's diagonal that is added to it; chosen: contacts that move together have known forces, and one creeps by less than a smoothing would let it.
const CREEP: f64 = 1e-9;

/// Sliding velocity, as a part of that in steady sliding, below which a contact sticks where a state alone is known; chosen, above what a stuck one creeps.
pub(crate) const AT_REST: f64 = 1e-7;

/// Sliding velocity, as a part of that in steady sliding, by which one must turn to be said to; chosen, far above rounding.
pub(crate) const TURNED: f64 = 1e-10;

/// Part of the largest friction by which a stuck contact may be above it; chosen, above rounding.
const ABOVE: f64 = 1e-12;

/// Exchanges between sticking and sliding after which no state of the contacts was found.
const MOST_EXCHANGES: usize = 1000;

/// Contacts that stick at the same time.
#[derive(Debug, Clone)]
pub(crate) struct Stuck {
    contacts: Vec<usize>,
    /// Factor of G + d.
    factor: Cholesky<f64, Dyn>,
}

impl Stuck {
    /// The stuck ones of all contacts; `None` where there are none.
    pub fn new(system: &ContactSystem, sliding: &[Sliding]) -> Option<Self> {
        let contacts: Vec<usize> = (0..sliding.len()).filter(|at| sliding[*at] == Sliding::Stuck).collect();
        if contacts.is_empty() {
            return None;
        }
        let mobility = |i: usize, j: usize| {
            let (one, other) = (contacts[i], contacts[j]);
            let found = along(&system.contacts[one].sliding, system.sliding.column(other).as_slice());
            if i == j { found * (1.0 + CREEP) } else { found }
        };
        let factor = Cholesky::new(DMatrix::from_fn(contacts.len(), contacts.len(), mobility))?;
        Some(Self { contacts, factor })
    }

    /// Takes from a state of motion what its stuck contacts still slide.
    pub fn stop(&self, system: &ContactSystem, x: &mut [f64]) {
        let n = system.order();
        let slip = |contact: &usize| system.contacts[*contact].slip(&x[n..2 * n]);
        let mut impulses = DVector::from_iterator(self.contacts.len(), self.contacts.iter().map(slip));
        self.factor.solve_mut(&mut impulses);
        for (&contact, impulse) in self.contacts.iter().zip(&impulses) {
            x[n..2 * n].iter_mut().zip(&system.sliding.column(contact)).for_each(|(v, b)| *v += b * impulse);
        }
    }

    /// Adds to accelerations what the stuck contacts do to them, and gives their forces, N, by all contacts.
    pub fn hold(&self, system: &ContactSystem, acceleration: &mut [f64], mut force: impl FnMut(usize, f64)) {
        let along = |contact: &usize| -along(&system.contacts[*contact].sliding, acceleration);
        let mut forces = DVector::from_iterator(self.contacts.len(), self.contacts.iter().map(along));
        self.factor.solve_mut(&mut forces);
        for (&contact, &of_contact) in self.contacts.iter().zip(&forces) {
            let column = system.sliding.column(contact);
            acceleration.iter_mut().zip(&column).for_each(|(a, b)| *a += b * of_contact);
            force(contact, of_contact);
        }
    }
}

impl ContactSystem {
    /// True of a contact whose friction jumps where its sliding turns.
    pub(crate) fn can_stick(&self, contact: usize) -> bool {
        self.static_friction[contact].is_some()
    }

    /// Ways in which contacts slide in a state of motion. One that may stick is left as [`ContactSystem::settle`] finds it.
    pub(crate) fn sliding_in(&self, x: &[f64], is_closed: &[bool]) -> Result<Vec<Sliding>, Error> {
        let mut open = Vec::new();
        let of = |(at, contact): (usize, &crate::SlidingContact)| {
            let slip = contact.slip(&x[self.order()..]);
            if !self.can_stick(at) {
                return Sliding::Smooth;
            }
            if is_closed[at] && slip.abs() <= AT_REST * contact.speed {
                open.push(at);
                return Sliding::Stuck;
            }
            Sliding::of(slip)
        };
        let mut sliding: Vec<Sliding> = self.contacts.iter().enumerate().map(of).collect();
        if !open.is_empty() {
            self.settle(x, is_closed, &mut sliding, &open)?;
        }
        Ok(sliding)
    }

    /// Finds which of some contacts without sliding velocity stick, and which way the others begin to slide.
    pub(crate) fn settle(
        &self,
        x: &[f64],
        is_closed: &[bool],
        sliding: &mut [Sliding],
        open: &[usize],
    ) -> Result<(), Error> {
        open.iter().for_each(|&contact| sliding[contact] = Sliding::Stuck);
        let mut rate = vec![0.0; self.dimension()];
        let mut held = vec![0.0; sliding.len()];
        for _ in 0..MOST_EXCHANGES {
            self.rate_of(x, is_closed, sliding, &mut rate, |contact, force| held[contact] = force);
            // The least of those that are wrong is exchanged (Murty): a problem of this kind ends so.
            let wrong = open.iter().find_map(|&contact| {
                let of = &self.contacts[contact];
                let most = self.static_friction[contact].unwrap_or(0.0) * (of.load + of.change_of_load(x)).max(0.0);
                let sliding_rate = -along(&of.sliding, &rate[self.order()..2 * self.order()]);
                match sliding[contact] {
                    Sliding::Stuck if held[contact] < -most * (1.0 + ABOVE) => Some((contact, Sliding::Backwards)),
                    // What a law has no coefficient for is not held, and integration fails where it slides.
                    Sliding::Stuck
                        if held[contact].is_nan() || most.is_nan() || held[contact] > most * (1.0 + ABOVE) =>
                    {
                        Some((contact, Sliding::Forwards))
                    }
                    Sliding::Forwards if sliding_rate < 0.0 => Some((contact, Sliding::Stuck)),
                    Sliding::Backwards if sliding_rate > 0.0 => Some((contact, Sliding::Stuck)),
                    _ => None,
                }
            });
            match wrong {
                Some((contact, other)) => sliding[contact] = other,
                None => return Ok(()),
            }
        }
        Err(Error::NoConvergence { method: "which contacts stick", residual: f64::NAN })
    }

    /// The rate x' of a state of motion whose contacts are closed and slide like this, and the forces of those that stick.
    pub(crate) fn rate_of(
        &self,
        x: &[f64],
        is_closed: &[bool],
        sliding: &[Sliding],
        out: &mut [f64],
        force: impl FnMut(usize, f64),
    ) {
        let forces: Vec<ContactForces> = (0..sliding.len())
            .map(|contact| self.forces_in_phase(contact, x, (is_closed[contact], sliding[contact])))
            .collect();
        self.rate_with(&forces, x, out);
        if let Some(stuck) = Stuck::new(self, sliding) {
            stuck.hold(self, &mut out[self.order()..2 * self.order()], force);
        }
    }
}
