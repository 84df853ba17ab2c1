//! Motion in time, and when it is periodic.

use num_complex::Complex;

use crate::path::Path;
use crate::shooting::shoot;
use crate::size::{amplitude, distance};
use crate::{ContactSystem, Cycle, Error};

/// Settings of the integration of a motion: its error and its length.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Allowed error of a piece of the motion, relative to its scales and size; chosen 1e-9.
    pub tolerance: f64,
    /// Periods of the mode after which a motion that does not repeat is not periodic; chosen 1,000.
    pub most_periods: usize,
    /// Periods of the mode in one period of the motion, at most; chosen 8.
    pub most_multiple: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self { tolerance: 1e-9, most_periods: 1000, most_multiple: 8 }
    }
}

/// Fate of a motion.
#[derive(Debug, Clone, PartialEq)]
pub enum Motion {
    /// A stable limit cycle: the motion repeats itself, and neighbouring motions come to it.
    Cycle(Cycle),
    /// Rest in steady sliding.
    Rest,
    /// Growth beyond all bounds of the model: no contact that opens or sticks stops it.
    Unbounded,
    /// A motion that does not repeat itself within the periods allowed.
    NotPeriodic {
        /// Time that was looked at, s.
        time: f64,
        /// State of motion at its end.
        state: Vec<f64>,
    },
}

/// Growth of the amplitude, relative to the scales of a motion, that nothing stops any more; chosen.
const UNBOUNDED: f64 = 1e6;

/// Part of the largest amplitude of a motion so far that counts as rest; chosen, far above what an allowed error keeps alive.
const REST: f64 = 1e-6;

/// Relative difference of two passages from which on they may be of one cycle; chosen, the shooting decides.
const ALIKE: f64 = 1e-4;

/// Distance of a cycle from the passage that it was found from, relative to the size of the motion, at most; chosen.
const NEAR: f64 = 0.05;

/// Distance that the motion of a cycle would go in a period at the rate of its start, relative to its size, at least; chosen.
const MOVING: f64 = 1e-3;

/// Follows the motion from a state to what it becomes. `omega`, rad/s, and `shape` are of a mode that it may swing in: they scale it, and its
/// velocity along the shape is what passes 0 once a period.
///
/// # Errors
/// A motion that cannot be followed, settings that are not allowed.
pub fn follow(
    system: &ContactSystem,
    start: Vec<f64>,
    omega: f64,
    shape: &[Complex<f64>],
    settings: &Settings,
) -> Result<Motion, Error> {
    follow_telling(system, start, omega, shape, settings, &mut || ())
}

/// Follows the motion as [`follow`], and calls `each_period` after each period of the mode, at most [`Settings::most_periods`] times.
///
/// # Errors
/// As [`follow`].
pub fn follow_telling(
    system: &ContactSystem,
    start: Vec<f64>,
    omega: f64,
    shape: &[Complex<f64>],
    settings: &Settings,
    each_period: &mut dyn FnMut(),
) -> Result<Motion, Error> {
    check(system, &start, omega, settings)?;
    let scales = system.scales(omega);
    let section = section(system, shape);
    let period = std::f64::consts::TAU / omega;
    let mut motion = Path::new(system, start, &scales, settings.tolerance, 0.1 * period, &section);
    let until = settings.most_periods as f64 * period;
    let mut passages: Vec<(f64, Vec<f64>)> = Vec::new();
    let (mut next_try, mut largest) = (0, amplitude(&motion.x, &scales));
    let mut told = 0;
    while motion.time < until {
        let is_passage = motion.step(until)?;
        while told < settings.most_periods && (told + 1) as f64 * period <= motion.time {
            each_period();
            told += 1;
        }
        let size = amplitude(&motion.x, &scales);
        largest = size.max(largest);
        if size > UNBOUNDED {
            return Ok(Motion::Unbounded);
        }
        if size < REST * largest {
            return Ok(Motion::Rest);
        }
        if !is_passage {
            continue;
        }
        passages.push((motion.time, motion.x.clone()));
        if passages.len() > settings.most_multiple + 1 {
            passages.remove(0);
        }
        next_try = usize::saturating_sub(next_try, 1);
        let Some(((end, last), earlier)) = passages.split_last() else { continue };
        let alike = |(_, x): &&(f64, Vec<f64>)| distance(x, last, &scales) < ALIKE * size;
        let Some((begin, _)) = earlier.iter().rev().find(alike).filter(|_| next_try == 0) else { continue };
        let found = shoot(system, last.clone(), end - begin, &scales, settings.tolerance);
        let is_near = |cycle: &Cycle| {
            amplitude(&cycle.start, &scales) > 1e-3 * size
                && distance(&cycle.start, last, &scales) < NEAR * size
                && is_moving(system, cycle, &scales)
        };
        if let Some(cycle) = found.ok().filter(|cycle| is_near(cycle) && cycle.is_stable()) {
            return Ok(Motion::Cycle(with_least_period(system, cycle, &scales, settings)));
        }
        // Not yet there, or not at all: a shooting costs more than some periods.
        next_try = 20;
    }
    Ok(Motion::NotPeriodic { time: motion.time, state: motion.x })
}

/// False for an equilibrium beside steady sliding, where the state after any time is that before.
fn is_moving(system: &ContactSystem, cycle: &Cycle, scales: &[f64]) -> bool {
    let mut rate = vec![0.0; system.dimension()];
    system.rate(&cycle.start, &mut rate);
    cycle.period * amplitude(&rate, scales) > MOVING * amplitude(&cycle.start, scales)
}

/// The cycle once, where it was found as several rounds of itself. Next to a period doubling, where the rounds differ by less than can be told
/// from one another, the single round is another cycle that is not stable, and the cycle stays as it is.
fn with_least_period(system: &ContactSystem, cycle: Cycle, scales: &[f64], settings: &Settings) -> Cycle {
    let size = amplitude(&cycle.start, scales);
    for rounds in (2..=settings.most_multiple).rev() {
        let period = cycle.period / rounds as f64;
        let omega = std::f64::consts::TAU / period;
        let after = state_after(system, cycle.start.clone(), period, omega, settings.tolerance);
        if after.is_ok_and(|after| distance(&after, &cycle.start, scales) < ALIKE * size)
            && let Ok(once) = shoot(system, cycle.start.clone(), period, scales, settings.tolerance)
            && once.is_stable()
            && distance(&once.start, &cycle.start, scales) < 10.0 * ALIKE * size
        {
            return once;
        }
    }
    cycle
}

fn check(system: &ContactSystem, start: &[f64], omega: f64, settings: &Settings) -> Result<(), Error> {
    let refused = |field, value, allowed: &str| Err(Error::Setting { field, value, allowed: allowed.into() });
    if start.len() != system.dimension() {
        return refused("entries of the start", start.len() as f64, "one for each entry of a state");
    }
    if !(omega > 0.0 && omega.is_finite()) {
        return refused("omega", omega, "finite and > 0");
    }
    if !(settings.tolerance > 0.0 && settings.tolerance < 1.0) {
        return refused("tolerance", settings.tolerance, "above 0 and below 1");
    }
    Ok(())
}

/// Plane of velocities that a motion in a mode passes once a period: `Re(phi)^T M u' = 0`.
fn section(system: &ContactSystem, shape: &[Complex<f64>]) -> Vec<f64> {
    let m = &system.structure().m;
    m.column_iter().map(|column| column.iter().zip(shape).map(|(m, phi)| m * phi.re).sum()).collect()
}

/// State of the motion from `start` after a time, s.
///
/// # Errors
/// A motion that cannot be followed.
pub fn state_after(
    system: &ContactSystem,
    start: Vec<f64>,
    time: f64,
    omega: f64,
    tolerance: f64,
) -> Result<Vec<f64>, Error> {
    let settings = Settings { tolerance, ..Settings::default() };
    check(system, &start, omega, &settings)?;
    let scales = system.scales(omega);
    let mut motion = Path::new(system, start, &scales, tolerance, 0.1 / omega, &[]);
    while motion.time < time {
        motion.step(time)?;
    }
    Ok(motion.x)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use friction::BristleMotion;
    use linsys::SecondOrder;
    use nalgebra::dmatrix;

    use super::*;
    use crate::{ContactFriction, Part, SlidingContact};

    /// Friction of Rayleigh's equation backwards in time: a cycle that motions leave.
    #[derive(Debug)]
    struct Backwards;

    impl ContactFriction for Backwards {
        fn at(&self, velocity: f64, _: f64) -> BristleMotion {
            let y = 10.0 - velocity;
            let (mu, mu_by_velocity) = (0.1 * (y.powi(3) / 3.0 - y), 0.1 * (1.0 - y * y));
            BristleMotion { mu, mu_by_velocity, ..BristleMotion::default() }
        }

        fn steady_state(&self, _: f64) -> Option<f64> {
            None
        }

        fn stick_speed(&self) -> f64 {
            1e-6
        }
    }

    #[test]
    fn a_stable_cycle_of_two_rounds_is_not_exchanged_for_an_unstable_one_of_one_round() {
        let one = || dmatrix![1.0];
        let mass = Part { family: "mass".into(), matrices: SecondOrder::new(one(), dmatrix![0.0], one()).unwrap() };
        let belt = SlidingContact {
            name: "belt".into(),
            family: "friction".into(),
            sliding: vec![(0, 1.0)],
            normal: Vec::new(),
            stiffness: 0.0,
            load: 1.0,
            speed: 10.0,
            friction: Arc::new(Backwards),
        };
        let system = ContactSystem::new(vec![mass], vec![belt]).unwrap();
        let (scales, settings) = (system.scales(1.0), Settings::default());
        let once = shoot(&system, vec![2.0, 0.0], 6.3, &scales, settings.tolerance).unwrap();
        assert!(!once.is_stable(), "{once:?}");
        // Just beyond a period doubling, two rounds are a stable cycle that differs by less than ALIKE from this one.
        let twice = Cycle { period: 2.0 * once.period, multipliers: vec![Complex::from(0.9)], ..once };
        assert_eq!(with_least_period(&system, twice.clone(), &scales, &settings), twice);
    }
}
