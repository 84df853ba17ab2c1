//! What a cycle does: amplitudes, shares of its period open and stuck, power by family of forces.

use crate::moments::rule;
use crate::path::Path;
use crate::{ContactSystem, Cycle, Error, SlidingContact};

/// Measures of a periodic motion.
#[derive(Debug, Clone, PartialEq)]
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
#[derive(Debug, Clone, Copy, PartialEq, Default)]
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
    Ok(measured(system, &cycle.start, [cycle.period, cycle.period], tolerance, system.families())?.0)
}

/// Goes on with a motion that need not be periodic for a time, s, of many periods, and measures it; gives its last state too. `period`, s, is
/// about that in which it swings, and scales it. There are no powers: the motion may end with another energy than it has at first.
///
/// # Errors
/// A motion that cannot be followed.
pub fn measure_over(
    system: &ContactSystem,
    start: &[f64],
    [time, period]: [f64; 2],
    tolerance: f64,
) -> Result<(Measures, Vec<f64>), Error> {
    measured(system, start, [time, period], tolerance, Vec::new())
}

/// Measures of a motion over a time, with the powers of these families, and its last state.
fn measured(
    system: &ContactSystem,
    start: &[f64],
    [time, period]: [f64; 2],
    tolerance: f64,
    families: Vec<String>,
) -> Result<(Measures, Vec<f64>), Error> {
    let n = system.order();
    let scales = system.scales(std::f64::consts::TAU / period);
    let mut motion = Path::new(system, start.to_vec(), &scales, tolerance, 0.1 * period, &[]);
    let (mut squares, mut energy) = (vec![0.0; n], 0.0);
    let (mut works, mut powers) = (vec![0.0; families.len()], vec![0.0; families.len()]);
    let mut shares = vec![Shares::default(); system.contacts().len()];
    let mut peak: Vec<f64> = start[..n].iter().map(|u| u.abs()).collect();
    let (mut before, mut x) = (start.to_vec(), start.to_vec());
    while motion.time < time {
        motion.step(time)?;
        let duration = motion.duration();
        for (contact, share) in shares.iter_mut().enumerate() {
            share.open += if motion.is_closed(contact) { 0.0 } else { duration / time };
            share.stuck += if motion.is_closed(contact) && motion.is_slow(contact) { duration / time } else { 0.0 };
        }
        let mut part_before = 0.0;
        for (part, weight) in rule(motion.degree()).iter().copied().chain([(1.0, 0.0)]) {
            motion.at_part(part, &mut x);
            if weight > 0.0 {
                squares.iter_mut().zip(&x[n..2 * n]).for_each(|(square, v)| *square += weight * duration * v * v);
                energy += weight * duration * system.kinetic_energy(&x);
                if !families.is_empty() {
                    system.powers(&families, &x, &mut powers);
                }
                works.iter_mut().zip(&powers).for_each(|(work, power)| *work += weight * duration * power);
            }
            for (dof, peak) in peak.iter_mut().enumerate() {
                *peak = peak.max(x[dof].abs());
                // A displacement that turns in between is larger there.
                if (before[n + dof] > 0.0) != (x[n + dof] > 0.0) {
                    *peak = peak.max(motion.turning(dof, [part_before, part]).abs());
                }
            }
            std::mem::swap(&mut before, &mut x);
            part_before = part;
        }
    }
    let measures = Measures {
        rms_velocity: squares.iter().map(|square| (square / time).sqrt()).collect(),
        peak,
        kinetic_energy: energy / time,
        powers: families.into_iter().zip(works.iter().map(|work| work / time)).collect(),
        contacts: shares,
    };
    Ok((measures, motion.x))
}

/// The contacts in each of some states of motion, rows by contact.
pub fn history<'s>(system: &ContactSystem, states: impl IntoIterator<Item = &'s Vec<f64>>) -> Vec<Vec<ContactMoment>> {
    let of_contact = |contact: &SlidingContact, x: &[f64]| {
        let (u, velocity) = x.split_at(system.order());
        let (normal_force, sliding_velocity) = (contact.load + contact.approach(u), contact.slip(velocity));
        let state = match normal_force > 0.0 {
            false => ContactState::Open,
            true if sliding_velocity.abs() < contact.friction.stick_speed() => ContactState::Stuck,
            true => ContactState::Sliding,
        };
        ContactMoment { normal_force: normal_force.max(0.0), sliding_velocity, state }
    };
    let of_contacts = |x: &Vec<f64>| system.contacts().iter().map(|contact| of_contact(contact, x)).collect();
    states.into_iter().map(of_contacts).collect()
}

/// States of motion of a cycle at so many equal steps over its period.
///
/// # Errors
/// A motion that cannot be followed.
pub fn states(system: &ContactSystem, cycle: &Cycle, steps: usize, tolerance: f64) -> Result<Vec<Vec<f64>>, Error> {
    let scales = system.scales(std::f64::consts::TAU / cycle.period);
    let mut motion = Path::new(system, cycle.start.clone(), &scales, tolerance, 0.1 * cycle.period, &[]);
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
