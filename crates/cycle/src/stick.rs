//! Contacts that stick, as a constraint: a stuck contact does not slide, and its friction is what keeps it so, up to what it can hold.
//!
//! Where the sliding of a contact turns, friction of a law of the speed alone jumps (Filippov). The sliding velocity of a stuck contact, 0, does not change: the forces f of
//! all stuck ones, on the structure along b, solve `G f = -B^T a`, with the accelerations a that all else makes and `G = B^T M^-1 B`; the least ones where contacts move
//! together. Which contacts stick where several could is a linear complementarity problem with one solution: no force is above `mu N`, and a contact whose force is there
//! begins to slide the way that friction with this force belongs to.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::contact::{Sliding, along};
use crate::system::ContactForces;
use crate::{ContactSystem, Error};

/// Part of G's diagonal that is added to it, so that contacts that move together have known forces; chosen, its square as far below 1 as rounding.
const ADDED: f64 = 1e-9;

/// Sliding velocity, as a part of that in steady sliding, up to which a contact may stick where its state of motion alone is known, and not how it came there; chosen, above what roundings
/// make a stuck one creep.
pub(crate) const AT_REST: f64 = 1e-7;

/// Sliding velocity beyond 0, as a part of that in steady sliding, from which on a contact has turned; chosen, far above rounding.
pub(crate) const TURNED: f64 = 1e-10;

/// Part of the largest friction by which a stuck contact may be above it; chosen, above rounding.
const ABOVE: f64 = 1e-12;

/// Exchanges between sticking and sliding for each contact in question after which no state of them was found; chosen, as one or two are the rule.
const MOST_EXCHANGES: usize = 1000;

/// Contacts that stick at the same time.
#[derive(Debug, Clone)]
pub(crate) struct Stuck {
    contacts: Vec<usize>,
    /// G.
    mobility: DMatrix<f64>,
    /// Factor of G with the added part.
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
            along(&system.contacts[one].sliding, system.sliding.column(other).as_slice())
        };
        let mobility = DMatrix::from_fn(contacts.len(), contacts.len(), mobility);
        let mut definite = mobility.clone();
        (0..contacts.len()).for_each(|at| definite[(at, at)] *= 1.0 + ADDED);
        let factor = Cholesky::new(definite)?;
        Some(Self { contacts, mobility, factor })
    }

    /// The forces, or impulses, f of `G f = right`, the least ones where contacts move together: `right` is a product with B^T, so that there are some. What the added part of the
    /// diagonal leaves of it, a second solution takes away.
    fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        let mut forces = self.factor.solve(right);
        let left = right - &self.mobility * &forces;
        forces += self.factor.solve(&left);
        forces
    }

    /// Takes from a state of motion what its stuck contacts still slide.
    pub fn stop(&self, system: &ContactSystem, x: &mut [f64]) {
        let n = system.order();
        let slip = |contact: &usize| system.contacts[*contact].slip(&x[n..2 * n]);
        let impulses = self.solve(&DVector::from_iterator(self.contacts.len(), self.contacts.iter().map(slip)));
        for (&contact, impulse) in self.contacts.iter().zip(&impulses) {
            x[n..2 * n].iter_mut().zip(&system.sliding.column(contact)).for_each(|(v, b)| *v += b * impulse);
        }
    }

    /// Adds to accelerations what the stuck contacts do to them, and gives their forces, N, by all contacts.
    pub fn hold(&self, system: &ContactSystem, acceleration: &mut [f64], mut force: impl FnMut(usize, f64)) {
        let along = |contact: &usize| -along(&system.contacts[*contact].sliding, acceleration);
        let forces = self.solve(&DVector::from_iterator(self.contacts.len(), self.contacts.iter().map(along)));
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
        for _ in 0..MOST_EXCHANGES * open.len() {
            self.rate_of(x, is_closed, sliding, &mut rate, |contact, force| held[contact] = force);
            // The least of those that are wrong is exchanged (Murty): a problem of this kind ends so.
            let wrong = open.iter().find_map(|&contact| {
                let of = &self.contacts[contact];
                let normal = (of.load + of.change_of_load(x)).max(0.0) * (1.0 + ABOVE);
                let [forwards, backwards] = self.static_friction[contact].unwrap_or_default().map(|mu| mu * normal);
                let sliding_rate = -along(&of.sliding, &rate[self.order()..2 * self.order()]);
                match sliding[contact] {
                    Sliding::Stuck if held[contact] < -backwards => Some((contact, Sliding::Backwards)),
                    // What a law has no coefficient for is not held, and integration fails where it slides.
                    Sliding::Stuck if held[contact].is_nan() || forwards.is_nan() || held[contact] > forwards => {
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

    /// The rate x' of a state of motion by the contacts that are closed, as `is_closed` says, and how each of them slides, and the forces of those that stick.
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
