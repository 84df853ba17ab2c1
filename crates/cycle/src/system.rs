//! The equations of motion of a structure with contacts, and states of motion.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use friction::BristleMotion;
use linsys::{AffineSystem, SecondOrder, Term};
use nalgebra::{DMatrix, DVectorView};
use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd};

use crate::contact::Sliding;
use crate::{Error, SlidingContact};

/// Largest difference of a mass matrix and its transpose, as a part of its largest entry; chosen, above what rounding makes.
const ASYMMETRY: f64 = 1e-9;

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
    /// Coefficients up to which each contact does not begin to slide forwards, and backwards, where its friction jumps.
    pub(crate) static_friction: Vec<Option<[f64; 2]>>,
    /// Place of the bristle of each contact in a state of motion.
    pub(crate) bristles: Vec<Option<usize>>,
    pub(crate) dimension: usize,
    /// `-M^-1 [K C]`, n by 2 n.
    free: DMatrix<f64>,
    /// `M^-1 c_i` and `M^-1 b_i`, n by contacts.
    normal: DMatrix<f64>,
    pub(crate) sliding: DMatrix<f64>,
    /// Matrix of the readings of a state by contacts: `k_i c_i^T u`, `-b_i^T u'` and the bristles, by rows.
    pub(crate) reads: DMatrix<f64>,
    /// Forces in steady sliding, and the rows of the Jacobian there below those that say that velocities are rates of displacements.
    at_rest: (Vec<ContactForces>, DMatrix<f64>),
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

impl ContactForces {
    /// Derivatives of the friction by gap, velocity and state, and of the rate of the state by velocity and state.
    pub fn slopes(&self) -> [f64; 5] {
        [
            self.friction_by_gap,
            self.friction_by_velocity,
            self.friction_by_state,
            self.rate_by_velocity,
            self.rate_by_state,
        ]
    }

    /// Changes of friction and of the rate of the state by their tangents, where gap, velocity and state differ so much.
    pub fn linear(&self, [gap, velocity, state]: [f64; 3]) -> [f64; 2] {
        let [by_gap, by_velocity, by_state, rate_by_velocity, rate_by_state] = self.slopes();
        [by_gap * gap + by_velocity * velocity + by_state * state, rate_by_velocity * velocity + rate_by_state * state]
    }

    /// True if all derivatives are the same.
    pub fn has_slopes_of(&self, other: &Self) -> bool {
        self.excess_by_gap == other.excess_by_gap && self.slopes() == other.slopes()
    }
}

impl ContactSystem {
    /// A structure with its closed contact springs, and the contacts on it.
    ///
    /// # Errors
    /// No part, no contact, parts of different order, one with internal states, a mass matrix that is not symmetric and positive definite, a contact with a number that is not
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
        let asymmetry = (&structure.m - structure.m.transpose()).amax();
        if asymmetry > ASYMMETRY * structure.m.amax() {
            return Err(Error::Structure("the mass matrix is not symmetric"));
        }
        let inverse_mass = structure.m.clone().try_inverse().filter(|inverse| inverse.iter().all(|x| x.is_finite()));
        let inverse_mass = inverse_mass.ok_or(Error::Structure("the mass matrix has no inverse"))?;
        if structure.m.clone().cholesky().is_none() {
            return Err(Error::Structure("the mass matrix is not positive definite"));
        }
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
        let mut free = DMatrix::zeros(order, 2 * order);
        free.columns_mut(0, order).copy_from(&-(&inverse_mass * &structure.k));
        free.columns_mut(order, order).copy_from(&-(&inverse_mass * &structure.c));
        let mut reads = DMatrix::zeros(2 * contacts.len() + dimension - 2 * order, dimension);
        for (at, contact) in contacts.iter().enumerate() {
            contact.normal.iter().for_each(|&(dof, c)| reads[(at, dof)] += contact.stiffness * c);
            contact.sliding.iter().for_each(|&(dof, b)| reads[(contacts.len() + at, order + dof)] -= b);
        }
        reads
            .view_mut((2 * contacts.len(), 2 * order), (dimension - 2 * order, dimension - 2 * order))
            .fill_with_identity();
        let steady = contacts.iter().map(SlidingContact::steady).collect();
        let sticks = |contact: &SlidingContact| {
            let coefficient = |is_forwards| contact.friction.sliding(0.0, is_forwards).map(|at| at.mu.abs());
            Some([coefficient(true)?, coefficient(false)?])
        };
        let static_friction = contacts.iter().map(sticks).collect();
        let at_rest = (Vec::new(), DMatrix::zeros(dimension - order, dimension));
        let stop = None;
        let mut system = Self {
            parts,
            structure,
            contacts,
            steady,
            static_friction,
            bristles,
            dimension,
            free,
            normal,
            sliding,
            reads,
            at_rest,
            stop,
        };
        system.take_rest();
        Ok(system)
    }

    /// Takes forces and Jacobian of steady sliding.
    fn take_rest(&mut self) {
        let (n, at_rest) = (self.order(), vec![0.0; self.dimension]);
        let mut below = DMatrix::zeros(self.dimension - n, self.dimension);
        below.view_mut((0, 0), (n, 2 * n)).copy_from(&self.free);
        self.at_rest = (vec![ContactForces::default(); self.contacts.len()], below);
        let forces: Vec<_> = (0..self.contacts.len()).map(|contact| self.forces_in(contact, &at_rest)).collect();
        let mut below = DMatrix::zeros(0, 0);
        self.take_below(&forces, &mut below);
        self.at_rest = (forces, below);
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

    /// Forces of a contact at a change `gap` of its normal force, N, a sliding velocity, m/s, and the deviation of its bristle. Whether it is closed and how it slides say on which
    /// sides of its kinks they are, and continue them beyond; of a stuck one they are those without friction.
    pub(crate) fn forces(
        &self,
        contact: usize,
        (is_closed, sliding): (bool, Sliding),
        [gap, velocity, state]: [f64; 3],
    ) -> ContactForces {
        let (of, (steady, mu0)) = (&self.contacts[contact], self.steady[contact]);
        let sign = if sliding == Sliding::Forwards { 1.0 } else { -1.0 };
        let friction = match sliding {
            Sliding::Smooth => of.friction.at(velocity, steady + state),
            Sliding::Stuck => BristleMotion::default(),
            _ => of.friction.sliding(sign * velocity, sign > 0.0).unwrap_or_else(|| {
                // A velocity that is 0 but for rounding has the side of its piece.
                of.friction.at(sign * (sign * velocity).max(f64::MIN_POSITIVE), steady + state)
            }),
        };
        let (normal, by_gap) = if is_closed { (of.load + gap, 1.0) } else { (0.0, 0.0) };
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
        let of = &self.contacts[contact];
        self.forces_in_phase(contact, x, (of.load + of.change_of_load(x) > 0.0, Sliding::Smooth))
    }

    /// Forces of a contact in a state of motion, on one side of its kinks.
    pub(crate) fn forces_in_phase(&self, contact: usize, x: &[f64], phase: (bool, Sliding)) -> ContactForces {
        let of = &self.contacts[contact];
        let state = self.bristles[contact].map_or(0.0, |place| x[place]);
        self.forces(contact, phase, [of.change_of_load(x), of.slip(&x[self.order()..]), state])
    }

    /// The rate x' of a state of motion x; NaN where it cannot be told which contacts stick.
    pub fn rate(&self, x: &[f64], out: &mut [f64]) {
        let is_closed: Vec<bool> = self.contacts.iter().map(|of| of.load + of.change_of_load(x) > 0.0).collect();
        match self.sliding_in(x, &is_closed) {
            Ok(sliding) => self.rate_of(x, &is_closed, &sliding, out, |_, _| ()),
            Err(_) => out.fill(f64::NAN),
        }
    }

    /// The rate x' of a state of motion x under the forces of its contacts.
    pub(crate) fn rate_with(&self, forces: &[ContactForces], x: &[f64], out: &mut [f64]) {
        let n = self.order();
        out[..n].copy_from_slice(&x[n..2 * n]);
        product(&self.free, &x[..2 * n], &mut out[n..2 * n]);
        for (contact, forces) in forces.iter().enumerate() {
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
        let forces: Vec<_> = (0..self.contacts.len()).map(|contact| self.forces_in(contact, x)).collect();
        let mut below = DMatrix::zeros(0, 0);
        self.take_below(&forces, &mut below);
        let mut jacobian = DMatrix::zeros(self.dimension, self.dimension);
        jacobian.view_mut((0, n), (n, n)).fill_with_identity();
        jacobian.rows_mut(n, self.dimension - n).copy_from(&below);
        jacobian
    }

    /// Takes the rows of the Jacobian below those that say that velocities are rates of displacements, where contacts have these derivatives.
    pub(crate) fn take_below(&self, forces: &[ContactForces], below: &mut DMatrix<f64>) {
        let n = self.order();
        below.clone_from(&self.at_rest.1);
        for (contact, (forces, at_rest)) in forces.iter().zip(&self.at_rest.0).enumerate() {
            if forces.has_slopes_of(at_rest) {
                continue;
            }
            let (of, before) = (&self.contacts[contact], at_rest.slopes());
            let change: [f64; 5] = std::array::from_fn(|slope| forces.slopes()[slope] - before[slope]);
            let [by_gap, by_velocity, by_state, rate_by_velocity, rate_by_state] = change;
            let excess_by_gap = forces.excess_by_gap - at_rest.excess_by_gap;
            let (normal, sliding) = (self.normal.column(contact), self.sliding.column(contact));
            let mut add = |column: usize, factor: f64, to: &DVectorView<'_, f64>| {
                below.column_mut(column).rows_mut(0, n).axpy(factor, to, 1.0);
            };
            for &(dof, c) in &of.normal {
                add(dof, by_gap * of.stiffness * c, &sliding);
                add(dof, -excess_by_gap * of.stiffness * c, &normal);
            }
            of.sliding.iter().for_each(|&(dof, b)| add(n + dof, -by_velocity * b, &sliding));
            if let Some(place) = self.bristles[contact] {
                add(place, by_state, &sliding);
                of.sliding.iter().for_each(|&(dof, b)| below[(place - n, n + dof)] -= rate_by_velocity * b);
                below[(place - n, place)] += rate_by_state;
            }
        }
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

/// A matrix times a vector.
pub(crate) fn product(matrix: &DMatrix<f64>, x: &[f64], out: &mut [f64]) {
    out.fill(0.0);
    add_product(matrix, x, out);
}

/// Adds a matrix times a vector.
pub(crate) fn add_product(matrix: &DMatrix<f64>, x: &[f64], out: &mut [f64]) {
    Arch::new().dispatch(Product { matrix, x, out });
}

/// Product that is added: its sums are the same bits on registers of any width.
struct Product<'a> {
    matrix: &'a DMatrix<f64>,
    x: &'a [f64],
    out: &'a mut [f64],
}

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { matrix, x, out } = self;
        let rows = out.len();
        // Four columns at a time, so that each entry of the result is loaded and stored once for them.
        let (columns, entries) = (matrix.as_slice().chunks_exact(4 * rows.max(1)), x.chunks_exact(4));
        let (last, last_entries) = (columns.remainder(), entries.remainder());
        for (columns, x) in columns.zip(entries) {
            let (a, others) = columns.split_at(rows);
            let (b, others) = others.split_at(rows);
            let (c, d) = others.split_at(rows);
            for ((((out, a), b), c), d) in out.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                *out += (a * x[0] + b * x[1]) + (c * x[2] + d * x[3]);
            }
        }
        for (column, x) in last.chunks_exact(rows.max(1)).zip(last_entries) {
            out.iter_mut().zip(column).for_each(|(out, a)| *out += a * x);
        }
    }
}
