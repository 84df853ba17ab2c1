//! Systems that are affine in a few coefficients, as which all analyses take a brake.
//!
//! ```text
//! Q(lambda) = sum_k theta_k (lambda^2 M_k + lambda C_k + K_k)                       the structure, in named terms
//!           + sum_i b_i (mu_i r_i^T + lambda s_i(lambda) b_i^T)                     friction, one channel per contact
//! s_i(lambda) = slope_i + force_i drive_i / (lambda + decay_i)                      Ns/m
//! ```
//!
//! The terms and channels are the brake; the numbers `theta_k`, `mu_i`, `s_i` are one of its [`OperatingPoint`]s. A sample of
//! a study is an operating point, not a matrix.

mod channel;
mod point;
mod term;

pub use channel::Channel;
pub use point::{ChannelGain, Lag, OperatingPoint};
pub use term::Term;

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::{DofMap, Internal, LinsysError, SecondOrder};

/// The terms and friction channels of a brake over its free degrees of freedom.
///
/// ```
/// use linsys::{AffineSystem, Channel, ChannelGain, OperatingPoint, SecondOrder, Term};
/// use nalgebra::dmatrix;
///
/// // A mass in x and y; friction mu times the normal spring's force 5 y acts in x.
/// let (m, c) = (dmatrix![1.0, 0.0; 0.0, 1.0], dmatrix![0.1, 0.0; 0.0, 0.1]);
/// let structure = SecondOrder::new(m, c, dmatrix![4.0, 1.0; 1.0, 9.0])?;
/// let pad = Channel::new("pad", "friction", vec![(0, 1.0)], vec![(1, -5.0)]);
/// let brake = AffineSystem::new(vec![Term::new("structure", "damping", structure)?], vec![pad])?;
/// let at = OperatingPoint { coefficients: vec![1.0], channels: vec![ChannelGain::proportional(0.4)] };
/// assert_eq!(brake.assemble(&at)?.k, dmatrix![4.0, -1.0; 1.0, 9.0]);
/// # Ok::<(), linsys::LinsysError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct AffineSystem {
    terms: Vec<Term>,
    channels: Vec<Channel>,
    families: Vec<String>,
}

impl AffineSystem {
    /// A system of these terms, at least one, and channels.
    ///
    /// # Errors
    /// No term, terms of different order, a channel that acts on or reads a degree of freedom that does not exist, a number
    /// that is not finite.
    pub fn new(terms: Vec<Term>, channels: Vec<Channel>) -> Result<Self, LinsysError> {
        let order = terms.first().map(Term::order).ok_or(LinsysError::Empty)?;
        if let Some(other) = terms.iter().find(|term| term.order() != order) {
            return Err(LinsysError::TermOrder { term: other.name.clone(), found: other.order(), expected: order });
        }
        channels.iter().try_for_each(|channel| channel.check(order))?;
        let mut families: Vec<String> = Vec::new();
        let all = channels.iter().map(|channel| &channel.family).chain(terms.iter().map(|term| &term.family));
        for family in all {
            if !families.contains(family) {
                families.push(family.clone());
            }
        }
        Ok(Self { terms, channels, families })
    }

    /// The system over the degrees of freedom of this one that are free in `dofs`. Channels keep the entries of their forces and
    /// readings at these.
    ///
    /// # Errors
    /// Degrees of freedom of a system of another order.
    pub fn on(&self, dofs: &DofMap) -> Result<Self, LinsysError> {
        let (found, expected) = (dofs.total(), self.order());
        if found != expected {
            return Err(LinsysError::Count { what: "degrees of freedom", found, expected });
        }
        let term = |term: &Term| {
            let SecondOrder { m, c, k, .. } = term.matrices();
            let matrices = SecondOrder::new(dofs.reduce(m), dofs.reduce(c), dofs.reduce(k))?;
            Term::new(term.name.clone(), term.family.clone(), matrices)
        };
        let free = |entries: &[(usize, f64)]| {
            entries.iter().filter_map(|&(dof, value)| Some((dofs.position(dof)?, value))).collect()
        };
        let terms = self.terms.iter().map(term).collect::<Result<_, _>>()?;
        Self::new(terms, self.channels.iter().map(|channel| channel.mapped(free)).collect())
    }

    /// n, the number of free degrees of freedom.
    pub fn order(&self) -> usize {
        self.terms.first().map_or(0, Term::order)
    }

    /// The terms of the structure.
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// The channels: of friction, and of what relaxes.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The channels of friction.
    pub fn contacts(&self) -> impl Iterator<Item = &Channel> {
        self.channels.iter().filter(|channel| channel.is_contact)
    }

    /// Names of the force families, whose work is computed separately; the families of channels come first.
    pub fn families(&self) -> &[String] {
        &self.families
    }

    /// Force matrix: the b_i as columns, n x m.
    pub fn force_matrix(&self) -> DMatrix<f64> {
        let mut force = DMatrix::zeros(self.order(), self.channels.len());
        for (at, channel) in self.channels.iter().enumerate() {
            channel.force.iter().for_each(|&(dof, value)| force[(dof, at)] += value);
        }
        force
    }

    /// Reading matrix: the r_i as rows, m x n.
    pub fn reading_matrix(&self) -> DMatrix<f64> {
        let mut reading = DMatrix::zeros(self.channels.len(), self.order());
        for (at, channel) in self.channels.iter().enumerate() {
            channel.reading.iter().for_each(|&(dof, value)| reading[(at, dof)] += value);
        }
        reading
    }

    /// The structure without friction: `sum_k theta_k (M_k, C_k, K_k)`.
    ///
    /// # Errors
    /// Not one finite coefficient for each term.
    pub fn structure(&self, coefficients: &[f64]) -> Result<SecondOrder, LinsysError> {
        self.check_coefficients(coefficients)?;
        let mut out = SecondOrder::zeros(self.order(), 0);
        self.add_structure(coefficients, &mut out);
        Ok(out)
    }

    /// The mass matrix of the structure, `sum_k theta_k M_k`.
    ///
    /// # Errors
    /// Not one finite coefficient for each term.
    pub fn mass(&self, coefficients: &[f64]) -> Result<DMatrix<f64>, LinsysError> {
        self.check_coefficients(coefficients)?;
        let mut mass = DMatrix::zeros(self.order(), self.order());
        for (term, &coefficient) in self.terms.iter().zip(coefficients) {
            add_scaled(&mut mass, &term.matrices().m, coefficient);
        }
        Ok(mass)
    }

    /// The system at an operating point.
    ///
    /// # Errors
    /// As [`AffineSystem::assemble_into`].
    pub fn assemble(&self, at: &OperatingPoint) -> Result<SecondOrder, LinsysError> {
        self.check(at)?;
        let states = at.channels.iter().filter(|gain| gain.lag.is_some()).count();
        let mut out = SecondOrder::zeros(self.order(), states);
        self.add_structure(&at.coefficients, &mut out);
        self.add_friction(at, |_| true, &mut out);
        Ok(out)
    }

    /// The system on the columns of a real n x k matrix V, term by term and channel by channel.
    ///
    /// # Errors
    /// Another number of rows than degrees of freedom, entries that are not finite.
    pub fn projected(&self, basis: &DMatrix<f64>) -> Result<Self, LinsysError> {
        let term = |term: &Term| Term::new(&term.name, &term.family, term.matrices().projected(basis)?);
        let terms = self.terms.iter().map(term).collect::<Result<_, _>>()?;
        Self::new(terms, self.channels.iter().map(|channel| channel.projected(basis)).collect())
    }

    /// Writes the system at an operating point to `out`. Nothing is allocated if `out` already has the order and number of
    /// states.
    ///
    /// # Errors
    /// Not one finite coefficient for each term and one finite gain for each channel.
    pub fn assemble_into(&self, at: &OperatingPoint, out: &mut SecondOrder) -> Result<(), LinsysError> {
        self.check(at)?;
        self.clear(out, at.channels.iter().filter(|gain| gain.lag.is_some()).count());
        self.add_structure(&at.coefficients, out);
        self.add_friction(at, |_| true, out);
        Ok(())
    }

    /// Writes the contribution of friction alone to `out`: m = 0, k without any elastic part.
    ///
    /// # Errors
    /// As [`AffineSystem::assemble_into`].
    pub fn friction_into(&self, at: &OperatingPoint, out: &mut SecondOrder) -> Result<(), LinsysError> {
        self.check(at)?;
        self.clear(out, at.channels.iter().filter(|gain| gain.lag.is_some()).count());
        self.add_friction(at, |_| true, out);
        Ok(())
    }

    /// Writes the forces of one family that can do net work to `out`: the channels of that name, and of the terms of that
    /// name the damping and every stiffness that is not symmetric. Elastic and inertial forces are left out.
    ///
    /// # Errors
    /// As [`AffineSystem::assemble_into`].
    pub fn family_into(&self, family: &str, at: &OperatingPoint, out: &mut SecondOrder) -> Result<(), LinsysError> {
        self.check(at)?;
        let is_member = |channel: &Channel| channel.family == family;
        let members = self.channels.iter().zip(&at.channels);
        self.clear(out, members.filter(|(channel, gain)| is_member(channel) && gain.lag.is_some()).count());
        for (term, &coefficient) in self.terms.iter().zip(&at.coefficients).filter(|(term, _)| term.family == family) {
            add_scaled(&mut out.c, &term.matrices().c, coefficient);
            if !term.is_elastic() {
                add_scaled(&mut out.k, &term.matrices().k, coefficient);
            }
        }
        self.add_friction(at, is_member, out);
        Ok(())
    }

    /// The forces of each family that can do net work in a mode (lambda, phi), in the order of [`AffineSystem::families`]: the forces of
    /// [`AffineSystem::family_into`] without its matrices, `-(lambda C + K) phi` of the terms of a family and
    /// `-b (mu r^T + lambda s(lambda) b^T) phi` of its channels. A force is not finite where lambda is minus the decay rate of a lag.
    ///
    /// # Errors
    /// As [`AffineSystem::assemble_into`]; a shape of another order.
    pub fn family_forces(
        &self,
        at: &OperatingPoint,
        lambda: Complex<f64>,
        phi: &DVector<Complex<f64>>,
    ) -> Result<Vec<DVector<Complex<f64>>>, LinsysError> {
        self.check(at)?;
        let (found, expected) = (phi.len(), self.order());
        if found != expected {
            return Err(LinsysError::Count { what: "entries of a shape", found, expected });
        }
        let mut forces = vec![DVector::zeros(expected); self.families.len()];
        let mut of_family = |family: &str, add: &dyn Fn(&mut DVector<Complex<f64>>)| {
            self.families.iter().zip(&mut forces).filter(|(name, _)| *name == family).for_each(|(_, force)| add(force));
        };
        for (term, &coefficient) in self.terms.iter().zip(&at.coefficients) {
            of_family(&term.family, &|force| term.add_forces(coefficient, lambda, phi, force));
        }
        for (channel, gain) in self.channels.iter().zip(&at.channels) {
            of_family(&channel.family, &|force| channel.add_force(gain, lambda, phi, force));
        }
        Ok(forces)
    }

    /// Writes the contribution of one friction channel, by its index, to `out`.
    ///
    /// # Errors
    /// As [`AffineSystem::assemble_into`]; no channel with this index.
    pub fn channel_into(&self, channel: usize, at: &OperatingPoint, out: &mut SecondOrder) -> Result<(), LinsysError> {
        self.check(at)?;
        let Some(gain) = at.channels.get(channel) else {
            return Err(LinsysError::NoChannel { channel, total: self.channels.len() });
        };
        self.clear(out, usize::from(gain.lag.is_some()));
        self.channels[channel].add_instant(gain, out);
        self.channels[channel].add_lag(gain, 0, out);
        Ok(())
    }

    /// Checks that an operating point belongs to this system.
    ///
    /// # Errors
    /// Not one finite coefficient for each term and one finite gain for each channel.
    pub fn check(&self, at: &OperatingPoint) -> Result<(), LinsysError> {
        at.check(
            self.terms.iter().map(|term| term.name.as_str()),
            self.channels.iter().map(|channel| channel.name.as_str()),
        )
    }

    fn check_coefficients(&self, coefficients: &[f64]) -> Result<(), LinsysError> {
        point::check_coefficients(coefficients, self.terms.iter().map(|term| term.name.as_str()))
    }

    /// Gives `out` the order of this system and this number of states, with all matrices zero.
    fn clear(&self, out: &mut SecondOrder, states: usize) {
        if out.order() != self.order() {
            *out = SecondOrder::zeros(self.order(), states);
            return;
        }
        if out.states() != states {
            out.internal = Internal::zeros(self.order(), states);
        }
        let Internal { drive, force, .. } = &mut out.internal;
        for matrix in [&mut out.m, &mut out.c, &mut out.k, drive, force] {
            matrix.fill(0.0);
        }
    }

    fn add_structure(&self, coefficients: &[f64], out: &mut SecondOrder) {
        // Part by part, so that the sums of large matrices stay in the cache.
        let (entries, terms) = (self.order() * self.order(), self.terms.iter().zip(coefficients));
        for start in (0..entries).step_by(SUMMED_AT_ONCE) {
            let part = start..entries.min(start + SUMMED_AT_ONCE);
            for (term, &coefficient) in terms.clone().filter(|(_, coefficient)| **coefficient != 0.0) {
                term.add(coefficient, part.clone(), out);
            }
        }
    }

    fn add_friction(&self, at: &OperatingPoint, is_wanted: impl Fn(&Channel) -> bool, out: &mut SecondOrder) {
        let wanted = || self.channels.iter().zip(&at.channels).filter(|(channel, _)| is_wanted(channel));
        let are_dense =
            wanted().nth(LEAST_DENSE - 1).is_some() && wanted().all(|(channel, _)| channel.is_dense(self.order()));
        if are_dense {
            // Of a reduced brake: one product for all.
            let all: Vec<(&Channel, &ChannelGain)> = wanted().collect();
            let of = |side: fn(&Channel) -> &[(usize, f64)], gain: fn(&ChannelGain) -> f64| {
                DMatrix::from_fn(all.len(), self.order(), |at, dof| side(all[at].0)[dof].1 * gain(all[at].1))
            };
            let force = of(|channel| &channel.force, |_| 1.0).transpose();
            if all.iter().any(|(_, gain)| gain.mu != 0.0) {
                out.k.gemm(1.0, &force, &of(|channel| &channel.reading, |gain| gain.mu), 1.0);
            }
            if all.iter().any(|(_, gain)| gain.slope != 0.0) {
                out.c.gemm(1.0, &force, &of(|channel| &channel.force, |gain| gain.slope), 1.0);
            }
        }
        let mut state = 0;
        for (channel, gain) in wanted() {
            if !are_dense {
                channel.add_instant(gain, out);
            }
            channel.add_lag(gain, state, out);
            state += usize::from(gain.lag.is_some());
        }
    }
}

/// Fewest channels, all dense, whose forces are added by one product of matrices; chosen.
const LEAST_DENSE: usize = 8;
/// Number of entries of a matrix to which all terms are added before the next entries; chosen.
const SUMMED_AT_ONCE: usize = 1024;

fn add_scaled(sum: &mut DMatrix<f64>, matrix: &DMatrix<f64>, factor: f64) {
    sum.zip_apply(matrix, |sum, value| *sum += factor * value);
}

#[cfg(test)]
mod tests;
