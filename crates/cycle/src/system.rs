//! The equations of motion of a structure with contacts, and states of motion.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use linsys::{AffineSystem, SecondOrder, Term};
use nalgebra::DMatrix;
use num_complex::Complex;

use crate::{Error, SlidingContact};

/// A part of a structure whose forces are one family: M, C and K.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Name of the family.
    pub family: String,
    /// Matrices of the part.
    pub matrices: SecondOrder,
}

impl Part {
    /// Terms of a structure at coefficients, each a part of its family.
    #[must_use]
    pub fn of_terms(system: &AffineSystem, coefficients: &[f64]) -> Vec<Self> {
        let part = |(term, &coefficient): (&Term, &f64)| {
            let SecondOrder { m, c, k, internal } = term.matrices().clone();
            let matrices = SecondOrder { m: m * coefficient, c: c * coefficient, k: k * coefficient, internal };
            Self { family: term.family.clone(), matrices }
        };
        system.terms().iter().zip(coefficients).map(part).collect()
    }
}

/// `M u'' + C u' + K u + sum_i [ c_i (N_i - N0_i - k_i c_i^T u) - b_i (mu_i N_i - mu0_i N0_i) ] = 0`, with `N_i = max(0, N0_i + k_i c_i^T u)`,
/// the velocities `w_i = v_i - b_i^T u'`, and bristles `z_i' = f(w_i, z_i)`; see [`SlidingContact`]. Of a contact that is open in steady sliding the
/// bracket is `c_i N_i - b_i mu_i N_i`.
///
/// K holds the springs of contacts that are closed in steady sliding. A state of motion is `(u, u', dz)`, with the bristles' deviation dz from steady sliding, which so
/// is the state 0.
#[derive(Debug, Clone)]
pub struct ContactSystem {
    pub(crate) parts: Vec<Part>,
    pub(crate) structure: SecondOrder,
    pub(crate) contacts: Vec<SlidingContact>,
    /// z and mu of steady sliding, by contact.
    steady: Vec<(f64, f64)>,
    /// Place of the bristle of each contact in a state of motion.
    pub(crate) bristles: Vec<Option<usize>>,
    pub(crate) dimension: usize,
    /// `M^-1 [K C]` by rows, as products with a state take it.
    rows: Vec<f64>,
    /// `M^-1 c_i` and `M^-1 b_i`, n by n.
    normal: DMatrix<f64>,
    sliding: DMatrix<f64>,
    /// Flag that ends all work with the system.
    stop: Option<Arc<AtomicBool>>,
}

/// Forces of a contact in a state of motion, with their derivatives.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ContactForces {
    /// `N - N0 - k c^T u`, what an open contact lacks, N; N of one that is open in steady sliding.
    pub excess: f64,
    pub excess_by_gap: f64,
    /// `mu N - mu0 N0`, N; `mu N` of one that is open in steady sliding.
    pub friction: f64,
    pub friction_by_gap: f64,
    pub friction_by_velocity: f64,
    pub friction_by_state: f64,
    /// z', and its derivatives.
    pub rate: f64,
    pub rate_by_velocity: f64,
    pub rate_by_state: f64,
}

impl ContactSystem {
    /// A structure with its closed contact springs, and the contacts on it.
    ///
    /// # Errors
    /// No part, no contact, parts of different order, one with internal states, a mass matrix without an inverse, a contact with a number that is not
    /// allowed.
    pub fn new(parts: Vec<Part>, contacts: Vec<SlidingContact>) -> Result<Self, Error> {
        let order = parts.first().map_or(0, |part| part.matrices.order());
        let mut structure = SecondOrder::zeros(order, 0);
        for Part { matrices, .. } in &parts {
            matrices.check()?;
            if matrices.order() != order {
                let (found, expected) = (matrices.order(), order);
                return Err(linsys::LinsysError::Count { what: "degrees of freedom of a part", found, expected }.into());
            }
            if matrices.states() > 0 {
                return Err(Error::Structure("the structure has internal states; allowed: those of contacts alone"));
            }
            structure.m += &matrices.m;
            structure.c += &matrices.c;
            structure.k += &matrices.k;
        }
        structure.check()?;
        if contacts.is_empty() {
            return Err(Error::Structure(
                "the brake has no contact that could open, slide or stick: its motion is linear",
            ));
        }
        contacts.iter().try_for_each(|contact| contact.check(order))?;
        let inverse_mass = structure.m.clone().try_inverse().filter(|inverse| inverse.iter().all(|x| x.is_finite()));
        let inverse_mass = inverse_mass.ok_or(Error::Structure("the mass matrix has no inverse"))?;
        let columns = |of: fn(&SlidingContact) -> &Vec<(usize, f64)>| {
            let mut columns = DMatrix::zeros(order, contacts.len());
            for (at, contact) in contacts.iter().enumerate() {
                of(contact).iter().for_each(|&(dof, value)| columns[(dof, at)] += value);
            }
            &inverse_mass * columns
        };
        let (normal, sliding) = (columns(|contact| &contact.normal), columns(|contact| &contact.sliding));
        let mut dimension = 2 * order;
        let bristles = contacts.iter().map(|contact| {
            contact.friction.steady_state(contact.speed).map(|_| {
                dimension += 1;
                dimension - 1
            })
        });
        let bristles = bristles.collect();
        let (k, c) = (&inverse_mass * &structure.k, &inverse_mass * &structure.c);
        let rows =
            (0..order).flat_map(|i| k.row(i).iter().chain(c.row(i).iter()).copied().collect::<Vec<_>>()).collect();
        let steady = contacts.iter().map(SlidingContact::steady).collect();
        Ok(Self { parts, structure, contacts, steady, bristles, dimension, rows, normal, sliding, stop: None })
    }

    /// The system, all work with which ends with [`Error::Stopped`] soon after `stop` is set.
    #[must_use]
    pub fn until(self, stop: Arc<AtomicBool>) -> Self {
        Self { stop: Some(stop), ..self }
    }

    /// Refuses to go on where work is to end.
    pub(crate) fn go_on(&self) -> Result<(), Error> {
        match &self.stop {
            Some(stop) if stop.load(Ordering::Relaxed) => Err(Error::Stopped),
            _ => Ok(()),
        }
    }

    /// n, the number of degrees of freedom.
    #[must_use]
    pub fn order(&self) -> usize {
        self.structure.order()
    }

    /// 2 n and one for each bristle, the length of a state of motion.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// The contacts.
    #[must_use]
    pub fn contacts(&self) -> &[SlidingContact] {
        &self.contacts
    }

    /// M, C and K of the structure with its closed contacts, without friction.
    #[must_use]
    pub fn structure(&self) -> &SecondOrder {
        &self.structure
    }

    pub(crate) fn bristle(&self, contact: usize) -> Option<usize> {
        self.bristles[contact]
    }

    /// Bristle state of a contact in steady sliding.
    pub(crate) fn steady_bristle(&self, contact: usize) -> f64 {
        self.steady[contact].0
    }

    /// Forces of a contact at a change `gap` of its normal force, N, a sliding velocity, m/s, and the deviation of its bristle.
    pub(crate) fn forces(&self, contact: usize, gap: f64, velocity: f64, state: f64) -> ContactForces {
        let (of, (steady, mu0)) = (&self.contacts[contact], self.steady[contact]);
        let friction = of.friction.at(velocity, steady + state);
        let normal = of.load + gap;
        let (normal, by_gap) = if normal > 0.0 { (normal, 1.0) } else { (0.0, 0.0) };
        // K holds the spring of a contact that is closed in steady sliding.
        let (excess, held_by_gap) = if of.is_closed() { (normal - of.load - gap, 1.0) } else { (normal, 0.0) };
        ContactForces {
            excess,
            excess_by_gap: by_gap - held_by_gap,
            friction: friction.mu * normal - mu0 * of.steady_load(),
            friction_by_gap: friction.mu * by_gap,
            friction_by_velocity: friction.mu_by_velocity * normal,
            friction_by_state: friction.mu_by_state * normal,
            rate: friction.rate,
            rate_by_velocity: friction.rate_by_velocity,
            rate_by_state: friction.rate_by_state,
        }
    }

    /// Forces of a contact in a state of motion.
    pub(crate) fn forces_in(&self, contact: usize, x: &[f64]) -> ContactForces {
        let (u, velocity) = x.split_at(self.order());
        let of = &self.contacts[contact];
        let state = self.bristles[contact].map_or(0.0, |place| x[place]);
        self.forces(contact, of.approach(u), of.slip(velocity), state)
    }

    /// The rate x' of a state of motion x.
    pub fn rate(&self, x: &[f64], out: &mut [f64]) {
        let n = self.order();
        out[..n].copy_from_slice(&x[n..2 * n]);
        for (rate, row) in out[n..2 * n].iter_mut().zip(self.rows.chunks_exact(2 * n)) {
            *rate = -row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>();
        }
        for contact in 0..self.contacts.len() {
            let forces = self.forces_in(contact, x);
            let (normal, sliding) = (self.normal.column(contact), self.sliding.column(contact));
            for ((rate, c), b) in out[n..2 * n].iter_mut().zip(&normal).zip(&sliding) {
                *rate += b * forces.friction - c * forces.excess;
            }
            if let Some(place) = self.bristles[contact] {
                out[place] = forces.rate;
            }
        }
    }

    /// The Jacobian of [`ContactSystem::rate`] in a state of motion, square. Next to a change between open and closed it is that of the side
    /// on which the state is.
    #[must_use]
    pub fn jacobian(&self, x: &[f64]) -> DMatrix<f64> {
        let n = self.order();
        let mut jacobian = DMatrix::zeros(self.dimension, self.dimension);
        for i in 0..n {
            jacobian[(i, n + i)] = 1.0;
            for j in 0..2 * n {
                jacobian[(n + i, j)] = -self.rows[2 * n * i + j];
            }
        }
        for (contact, of) in self.contacts.iter().enumerate() {
            let forces = self.forces_in(contact, x);
            let (normal, sliding) = (self.normal.column(contact), self.sliding.column(contact));
            for i in 0..n {
                let by_gap = sliding[i] * forces.friction_by_gap - normal[i] * forces.excess_by_gap;
                of.normal.iter().for_each(|&(dof, c)| jacobian[(n + i, dof)] += by_gap * of.stiffness * c);
                let by_velocity = sliding[i] * forces.friction_by_velocity;
                of.sliding.iter().for_each(|&(dof, b)| jacobian[(n + i, n + dof)] -= by_velocity * b);
                if let Some(place) = self.bristles[contact] {
                    jacobian[(n + i, place)] += sliding[i] * forces.friction_by_state;
                }
            }
            if let Some(place) = self.bristles[contact] {
                of.sliding.iter().for_each(|&(dof, b)| jacobian[(place, n + dof)] -= forces.rate_by_velocity * b);
                jacobian[(place, place)] = forces.rate_by_state;
            }
        }
        jacobian
    }

    /// Scale of each entry of a state in a motion near the angular frequency `omega`, rad/s: the displacement at which a contact opens, or closes, or
    /// else that at which one sticks.
    #[must_use]
    pub fn scales(&self, omega: f64) -> Vec<f64> {
        let opening = self.contacts.iter().filter(|contact| !contact.normal.is_empty());
        let least = opening.map(|contact| contact.load.abs() / contact.stiffness).fold(f64::INFINITY, f64::min);
        let slowest = self.contacts.iter().map(|contact| contact.speed / omega).fold(f64::INFINITY, f64::min);
        let length = [least, slowest, 1.0].into_iter().find(|length| length.is_finite()).unwrap_or(1.0);
        let mut scales = vec![length; self.order()];
        scales.extend(vec![length * omega; self.order()]);
        let bristles = self.bristles.iter().zip(&self.steady).filter(|(bristle, _)| bristle.is_some());
        scales.extend(bristles.map(|(_, (steady, _))| if *steady == 0.0 { 1.0 } else { steady.abs() }));
        scales
    }

    /// The amplitude of a mode, as a factor of its shape, from which on a contact opens, or closes: `min_i |N0_i| / |k_i c_i^T phi|`; infinite where none
    /// does.
    #[must_use]
    pub fn grazing(&self, shape: &[Complex<f64>]) -> f64 {
        let amplitude = |contact: &SlidingContact| {
            let approach: Complex<f64> = contact.normal.iter().map(|&(dof, c)| shape[dof] * c).sum();
            contact.load.abs() / (contact.stiffness * approach.norm())
        };
        self.contacts.iter().filter(|contact| !contact.normal.is_empty()).map(amplitude).fold(f64::INFINITY, f64::min)
    }

    /// The amplitude of a mode of angular frequency `omega`, rad/s, as a factor of its shape, from which on a contact opens or sticks: up to
    /// there a law of constant coefficient is linear. Infinite where no contact does either.
    #[must_use]
    pub fn first_kink(&self, omega: f64, shape: &[Complex<f64>]) -> f64 {
        let sticks = self.contacts.iter().map(|contact| {
            let slip: Complex<f64> = contact.sliding.iter().map(|&(dof, b)| shape[dof] * b).sum();
            contact.speed / (omega * slip.norm())
        });
        sticks.fold(self.grazing(shape), f64::min)
    }

    /// The state of a motion `Re(a phi e^(lambda t))` at t = 0: displacements, velocities, and bristles that follow `lambda`.
    #[must_use]
    pub fn state_of_mode(&self, lambda: Complex<f64>, shape: &[Complex<f64>], amplitude: f64) -> Vec<f64> {
        let mut x = vec![0.0; self.dimension];
        let n = self.order();
        let at_rest = x.clone();
        for (dof, phi) in shape.iter().enumerate().take(n) {
            (x[dof], x[n + dof]) = (amplitude * phi.re, amplitude * (lambda * phi).re);
        }
        for (contact, of) in self.contacts.iter().enumerate() {
            let Some(place) = self.bristles[contact] else { continue };
            let forces = self.forces_in(contact, &at_rest);
            let slip: Complex<f64> = of.sliding.iter().map(|&(dof, b)| -lambda * shape[dof] * b).sum();
            x[place] = amplitude * (slip * forces.rate_by_velocity / (lambda - forces.rate_by_state)).re;
        }
        x
    }
}
