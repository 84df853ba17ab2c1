//! What a cycle does: amplitudes, shares of its period open and stuck, power by family of forces.

use crate::dopri::{Flow, Integrator};
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
    /// Mean power of each family of forces, W; the sum is 0, and so is that of contacts that open alone.
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

/// A motion with integrals over it after its state: work by family, squares of velocities, kinetic energy.
struct Measured<'a> {
    system: &'a ContactSystem,
    scales: Vec<f64>,
    families: Vec<String>,
    /// Steps end where a contact opens, closes or sticks and where a displacement peaks; else these are known to a step of time.
    is_exact: bool,
}

impl Measured<'_> {
    /// By contact its normal force and its velocity against both stick speeds; then all velocities, which turn where displacements peak.
    fn kinks(&self, x: &[f64], out: &mut Vec<f64>) {
        out.clear();
        let (u, velocity) = x.split_at(self.system.order());
        for contact in self.system.contacts() {
            let (slip, stick) = (contact.slip(velocity), contact.friction.stick_speed());
            out.extend([contact.load + contact.approach(u), slip + stick, slip - stick]);
        }
        out.extend_from_slice(&velocity[..u.len()]);
    }

    /// Sides of all kinks on which a motion is.
    fn sides(&self, motion: &Integrator<'_, Self>, out: &mut Vec<bool>, values: &mut Vec<f64>) {
        out.clear();
        match self.is_exact {
            // At a kink a value may have either sign.
            true => out.extend_from_slice(&motion.sides),
            false => {
                self.kinks(&motion.x, values);
                out.extend(values.iter().map(|value| *value > 0.0));
            }
        }
    }
}

impl Flow for Measured<'_> {
    fn rate(&self, x: &[f64], out: &mut [f64]) {
        let (d, n) = (self.system.dimension(), self.system.order());
        let (x, (out, integrals)) = (&x[..d], out.split_at_mut(d));
        self.system.rate(x, out);
        let (works, rest) = integrals.split_at_mut(self.families.len());
        self.system.powers(&self.families, x, works);
        rest[..n].iter_mut().zip(&x[n..2 * n]).for_each(|(square, v)| *square = v * v);
        rest[n] = self.system.kinetic_energy(x);
    }

    fn switches(&self, x: &[f64], out: &mut Vec<f64>) {
        match self.is_exact {
            true => self.kinks(x, out),
            false => out.clear(),
        }
    }

    fn scales(&self) -> &[f64] {
        &self.scales
    }

    fn go_on(&self) -> Result<(), Error> {
        self.system.go_on()
    }
}

/// Goes through a period of a cycle and measures it.
///
/// # Errors
/// A motion that cannot be followed.
pub fn measure(system: &ContactSystem, cycle: &Cycle, tolerance: f64) -> Result<Measures, Error> {
    Ok(measured(system, &cycle.start, [cycle.period, cycle.period], tolerance, true)?.0)
}

/// Goes on with a motion that need not be periodic for a time, s, of many periods, and measures it; gives its last state too. `period`, s, is
/// about that in which it swings, and scales it. Peaks and shares are known to the steps of time alone, and powers need not sum to zero: the
/// motion may end with another energy than it has at first.
///
/// # Errors
/// A motion that cannot be followed.
pub fn measure_over(
    system: &ContactSystem,
    start: &[f64],
    [time, period]: [f64; 2],
    tolerance: f64,
) -> Result<(Measures, Vec<f64>), Error> {
    measured(system, start, [time, period], tolerance, false)
}

fn measured(
    system: &ContactSystem,
    start: &[f64],
    [time, period]: [f64; 2],
    tolerance: f64,
    is_exact: bool,
) -> Result<(Measures, Vec<f64>), Error> {
    let (d, n, families) = (system.dimension(), system.order(), system.families());
    let mut x = start.to_vec();
    x.resize(d + families.len() + n + 1, 0.0);
    let mut scales = system.scales(std::f64::consts::TAU / period);
    // The works are controlled too, by the energy of the motion.
    let energy = start.iter().zip(&scales).map(|(x, scale)| (x / scale).abs()).fold(0.0, f64::max).powi(2)
        * system.kinetic_energy(&scales);
    scales.resize(d + families.len(), energy.max(f64::MIN_POSITIVE));
    let flow = Measured { system, scales, families, is_exact };
    let mut motion = Integrator::new(&flow, x, tolerance, 0.01 * period);
    let contacts = system.contacts().len();
    let (mut sides, mut values) = (Vec::new(), Vec::new());
    let mut shares = vec![Shares::default(); contacts];
    let mut peak: Vec<f64> = motion.x[..n].iter().map(|u| u.abs()).collect();
    while motion.time < time {
        let from = motion.time;
        flow.sides(&motion, &mut sides, &mut values);
        motion.step(time)?;
        let part = (motion.time - from) / time;
        for (share, sides) in shares.iter_mut().zip(sides.chunks_exact(3)) {
            let [is_closed, is_above, is_beyond] = [sides[0], sides[1], sides[2]];
            share.open += if is_closed { 0.0 } else { part };
            share.stuck += if is_closed && is_above && !is_beyond { part } else { 0.0 };
        }
        peak.iter_mut().zip(&motion.x).for_each(|(peak, u)| *peak = peak.max(u.abs()));
    }
    let integrals = &motion.x[d..];
    let (works, rest) = integrals.split_at(flow.families.len());
    let mean = |integral: &f64| integral / time;
    let measures = Measures {
        rms_velocity: rest[..n].iter().map(|square| mean(square).sqrt()).collect(),
        peak,
        kinetic_energy: mean(&rest[n]),
        powers: flow.families.iter().cloned().zip(works.iter().map(mean)).collect(),
        contacts: shares,
    };
    motion.x.truncate(d);
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
    let flow = Measured { system, scales, families: system.families(), is_exact: true };
    let mut x = cycle.start.clone();
    x.resize(system.dimension() + flow.families.len() + system.order() + 1, 0.0);
    let mut motion = Integrator::new(&flow, x, tolerance, 0.01 * cycle.period);
    let mut states = Vec::with_capacity(steps);
    for step in 0..steps {
        let time = cycle.period * step as f64 / steps as f64;
        while motion.time < time {
            motion.step(time)?;
        }
        states.push(motion.x[..system.dimension()].to_vec());
    }
    Ok(states)
}
