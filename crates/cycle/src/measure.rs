//! What a cycle does: amplitudes, shares of its period open and stuck, power by family of forces.

use serde::{Deserialize, Serialize};

use crate::moments::rule;
use crate::path::Path;
use crate::stick::AT_REST;
use crate::{ContactSystem, Cycle, Error, SlidingContact};

/// Measures of a motion, over a period or a stretch of it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Measures {
    /// Root mean square of each velocity, m/s.
    pub rms_velocity: Vec<f64>,
    /// Largest displacement of each degree of freedom from steady sliding, m.
    pub peak: Vec<f64>,
    /// Mean kinetic energy, J.
    pub kinetic_energy: f64,
    /// Mean power of each family of forces, W; the sum is 0, and so is that of contacts that open alone. None of a motion that need not be periodic.
    pub powers: Vec<(String, f64)>,
    /// Shares of the period, by contact.
    pub contacts: Vec<Shares>,
}

/// Shares of the period in which a contact is open, and in which it is closed and sticks.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Shares {
    /// Share of the period in which the contact is open, 0 to 1.
    pub open: f64,
    /// Share of the period in which the contact is closed and slower than its stick speed, 0 to 1.
    pub stuck: f64,
}

/// A contact at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactMoment {
    /// Normal force N, N; 0 where the contact is open.
    pub normal_force: f64,
    /// Sliding velocity w, m/s.
    pub sliding_velocity: f64,
    /// State of the contact.
    pub state: ContactState,
}

/// State of a contact at a moment, as [`Shares`] count it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactState {
    /// Closed, and faster than its stick speed.
    Sliding,
    /// Closed, and slower than its stick speed.
    Stuck,
    /// Open.
    Open,
}

impl ContactState {
    /// The state in a word.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Sliding => "sliding",
            Self::Stuck => "stuck",
            Self::Open => "open",
        }
    }
}

impl Measures {
    /// Sum of all powers, relative to the sum of their magnitudes: what the balance leaves open.
    #[must_use]
    pub fn imbalance(&self) -> f64 {
        let sum: f64 = self.powers.iter().map(|(_, power)| power).sum();
        let magnitude: f64 = self.powers.iter().map(|(_, power)| power.abs()).sum();
        if magnitude > 0.0 { sum.abs() / magnitude } else { 0.0 }
    }

    /// Root mean square of the velocity of the given degrees of freedom together, m/s.
    #[must_use]
    pub fn rms_of(&self, dofs: &[usize]) -> f64 {
        // The sum of none is -0.
        (0.0 + dofs.iter().map(|&dof| self.rms_velocity[dof].powi(2)).sum::<f64>()).sqrt()
    }

    /// Measures of stretches of a motion together, each as long as the others; those of none are empty.
    #[must_use]
    pub fn together(stretches: &[Self]) -> Self {
        let part = 1.0 / stretches.len().max(1) as f64;
        let mut all = stretches.first().cloned().unwrap_or_default();
        for (dof, (rms, peak)) in all.rms_velocity.iter_mut().zip(&mut all.peak).enumerate() {
            *rms = (part * stretches.iter().map(|of| of.rms_velocity[dof].powi(2)).sum::<f64>()).sqrt();
            *peak = stretches.iter().map(|of| of.peak[dof]).fold(0.0, f64::max);
        }
        all.kinetic_energy = part * stretches.iter().map(|of| of.kinetic_energy).sum::<f64>();
        for (at, (_, power)) in all.powers.iter_mut().enumerate() {
            *power = part * stretches.iter().map(|of| of.powers[at].1).sum::<f64>();
        }
        for (at, shares) in all.contacts.iter_mut().enumerate() {
            shares.open = part * stretches.iter().map(|of| of.contacts[at].open).sum::<f64>();
            shares.stuck = part * stretches.iter().map(|of| of.contacts[at].stuck).sum::<f64>();
        }
        all
    }

    /// Largest displacement of one of the given degrees of freedom, m.
    #[must_use]
    pub fn peak_of(&self, dofs: &[usize]) -> f64 {
        dofs.iter().map(|&dof| self.peak[dof]).fold(0.0, f64::max)
    }
}

/// Goes through a period of a cycle and measures it.
///
/// # Errors
/// A motion that cannot be followed.
pub fn measure(system: &ContactSystem, cycle: &Cycle, tolerance: f64) -> Result<Measures, Error> {
    let scales = system.scales(std::f64::consts::TAU / cycle.period);
    let mut motion = Path::new(system, cycle.start.clone(), &scales, tolerance, 0.1 * cycle.period, &[])?;
    let mut meter = Meter::new(system, &cycle.start, system.families());
    while motion.time < cycle.period {
        motion.step(cycle.period)?;
        meter.add(&motion);
    }
    Ok(meter.take())
}

/// Measures of a motion while it goes on.
pub(crate) struct Meter<'a> {
    system: &'a ContactSystem,
    families: Vec<String>,
    /// Time that is measured, s, and what is integrated over it, as [`Measures`] names it.
    time: f64,
    squares: Vec<f64>,
    energy: f64,
    /// True where the mass matrix is diagonal, so that squares of velocities say what the energy is.
    has_diagonal_mass: bool,
    works: Vec<f64>,
    contacts: Vec<Shares>,
    peak: Vec<f64>,
    /// The state before, the next one, and the powers in it.
    before: Vec<f64>,
    x: Vec<f64>,
    powers: Vec<f64>,
}

impl<'a> Meter<'a> {
    /// A meter of a motion from its start, with the powers of these families.
    pub fn new(system: &'a ContactSystem, start: &[f64], families: Vec<String>) -> Self {
        let (n, powers) = (system.order(), vec![0.0; families.len()]);
        let mass = &system.structure().m;
        Self {
            system,
            families,
            time: 0.0,
            squares: vec![0.0; n],
            energy: 0.0,
            has_diagonal_mass: mass.iter().filter(|m| **m != 0.0).count() == n,
            works: powers.clone(),
            contacts: vec![Shares::default(); system.contacts().len()],
            peak: start[..n].iter().map(|u| u.abs()).collect(),
            before: start.to_vec(),
            x: start.to_vec(),
            powers,
        }
    }

    /// Measures the piece that the motion has come to the end of.
    pub fn add(&mut self, motion: &Path<'_>) {
        let (n, duration) = (self.system.order(), motion.duration());
        self.time += duration;
        for (contact, share) in self.contacts.iter_mut().enumerate() {
            share.open += if motion.is_closed(contact) { 0.0 } else { duration };
            share.stuck += if motion.is_closed(contact) { motion.slow_time(contact) } else { 0.0 };
        }
        let (mut part_before, x) = (0.0, &mut self.x);
        for (part, weight) in rule(motion.degree()).iter().copied().chain([(1.0, 0.0)]) {
            motion.at_part(part, x);
            if weight > 0.0 {
                self.squares.iter_mut().zip(&x[n..2 * n]).for_each(|(square, v)| *square += weight * duration * v * v);
                if !self.has_diagonal_mass {
                    self.energy += weight * duration * self.system.kinetic_energy(x);
                }
                if !self.families.is_empty() {
                    self.system.powers(&self.families, (motion, x), &mut self.powers);
                }
                self.works.iter_mut().zip(&self.powers).for_each(|(work, power)| *work += weight * duration * power);
            }
            for (dof, peak) in self.peak.iter_mut().enumerate() {
                *peak = peak.max(x[dof].abs());
                // A displacement that turns in between is larger there, by less than both velocities go on for.
                let beyond = (part - part_before) * duration * (self.before[n + dof].abs() + x[n + dof].abs());
                if (self.before[n + dof] > 0.0) != (x[n + dof] > 0.0) && x[dof].abs() + beyond > *peak {
                    *peak = peak.max(motion.turning(dof, [part_before, part]).abs());
                }
            }
            std::mem::swap(&mut self.before, x);
            part_before = part;
        }
    }

    /// Measures of the motion since its start or since they were taken last.
    pub fn take(&mut self) -> Measures {
        let next = Self::new(self.system, &self.before, self.families.clone());
        let Self { families, time, squares, mut energy, has_diagonal_mass, works, contacts, peak, .. } =
            std::mem::replace(self, next);
        if has_diagonal_mass {
            let mass = self.system.structure().m.diagonal();
            energy = 0.5 * mass.iter().zip(&squares).map(|(m, square)| m * square).sum::<f64>();
        }
        let share = |Shares { open, stuck }| Shares { open: open / time, stuck: stuck / time };
        Measures {
            rms_velocity: squares.iter().map(|square| (square / time).sqrt()).collect(),
            peak,
            kinetic_energy: energy / time,
            powers: families.into_iter().zip(works.iter().map(|work| work / time)).collect(),
            contacts: contacts.into_iter().map(share).collect(),
        }
    }
}

/// The contacts in each of some states of motion, rows by contact.
pub fn history<'s>(system: &ContactSystem, states: impl IntoIterator<Item = &'s Vec<f64>>) -> Vec<Vec<ContactMoment>> {
    let slowest = |at: usize, contact: &SlidingContact| {
        if system.can_stick(at) { AT_REST * contact.speed } else { contact.friction.stick_speed() }
    };
    let of_contact = |(at, contact): (usize, &SlidingContact), x: &[f64]| {
        let (u, velocity) = x.split_at(system.order());
        let (normal_force, sliding_velocity) = (contact.load + contact.change_of_load(u), contact.slip(velocity));
        let state = match normal_force > 0.0 {
            false => ContactState::Open,
            true if sliding_velocity.abs() < slowest(at, contact) => ContactState::Stuck,
            true => ContactState::Sliding,
        };
        ContactMoment { normal_force: normal_force.max(0.0), sliding_velocity, state }
    };
    let of_contacts =
        |x: &Vec<f64>| system.contacts().iter().enumerate().map(|contact| of_contact(contact, x)).collect();
    states.into_iter().map(of_contacts).collect()
}

/// States of motion of a cycle at so many equal steps over its period.
///
/// # Errors
/// A motion that cannot be followed.
pub fn states(system: &ContactSystem, cycle: &Cycle, steps: usize, tolerance: f64) -> Result<Vec<Vec<f64>>, Error> {
    let scales = system.scales(std::f64::consts::TAU / cycle.period);
    let mut motion = Path::new(system, cycle.start.clone(), &scales, tolerance, 0.1 * cycle.period, &[])?;
    let mut states = Vec::with_capacity(steps);
    for step in 0..steps {
        let time = cycle.period * step as f64 / steps as f64;
        while motion.time < time {
            motion.step(cycle.period)?;
        }
        let mut x = motion.x.clone();
        motion.at(time, &mut x);
        states.push(x);
    }
    Ok(states)
}
