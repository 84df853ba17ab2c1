//! Motion in time, and when it is periodic.

use num_complex::Complex;
use serde::{Deserialize, Serialize};

use crate::measure::Meter;
use crate::path::Path;
use crate::shooting::shoot;
use crate::size::{amplitude, distance};
use crate::{ContactSystem, Cycle, Error, Measures};

/// Settings of the integration of a motion: its error and its length.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Allowed error of a piece of the motion, relative to its scales and size; chosen 1e-9.
    pub tolerance: f64,
    /// Periods of the mode after which a motion that does not repeat is not periodic; chosen 1,000.
    pub most_periods: usize,
    /// Periods of the mode in one period of the motion, at most; chosen 8.
    pub most_multiple: usize,
    /// Difference of the velocities of the stretches in which a motion is measured, relative, up to which it has settled and is followed no longer: see
    /// [`Motion::NotPeriodic`]. Without it nothing is measured.
    pub settled: Option<f64>,
}

impl Default for Settings {
    fn default() -> Self {
        Self { tolerance: 1e-9, most_periods: 1000, most_multiple: 8, settled: None }
    }
}

/// Fate of a motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
        /// True if its passages of a plane are alike to 1 %, come nearer to one another or have ceased in the last quarter of that time: it has not settled, and
        /// may yet come to a cycle or to rest.
        may_settle: bool,
        /// Measures of four equal stretches, the last half of that time; none where nothing was measured. There are no powers: a motion may end with another energy than
        /// it has at first.
        stretches: Vec<Measures>,
    },
}

/// Growth of the amplitude, relative to the scales of a motion, that nothing stops any more; chosen.
const UNBOUNDED: f64 = 1e6;

/// Periods of the mode in a block of a motion that is measured; chosen: some at least.
const BLOCK: usize = 5;

/// Blocks after which it is asked whether the motion has settled, and again after as many, from twice as many on; chosen: its last half are four equal stretches then.
const ASKED: usize = 8;

/// Part of the distance of passages in the quarter before to which it shrinks in the last quarter where a motion comes to a cycle; chosen.
const COMING: f64 = 0.8;

/// Distance of two passages, relative to the size of the motion, below which it may be on its way to a cycle however slowly; chosen: shooting decides.
const NEARLY: f64 = 0.01;

/// Passages from a first try of shooting in vain to the next one, each wait twice as long as the one before; chosen, as a try in vain takes as long as a hundred periods.
const WAIT: usize = 40;

/// Part of their distance at the last try to which passages come where the next one does not wait; chosen.
const NEARER: f64 = 0.1;

/// Part of the largest amplitude of a motion so far that counts as rest; chosen, far above what an allowed error keeps alive.
const REST: f64 = 1e-6;

/// Relative difference of the states after rounds of a cycle from which on it may be one round of them; chosen, the shooting decides.
const ALIKE: f64 = 1e-4;

/// Distance of a cycle from the passage that it was found from, relative to the size of the motion, at most; chosen.
const NEAR: f64 = 0.05;

/// Distance that the motion of a cycle would go in a period at the rate of its start, relative to its size, at least; chosen.
const MOVING: f64 = 1e-3;

/// Follows the motion from a state to what it becomes. Friction is not smoothed, as in harmonic balance it is. `omega`, rad/s, and `shape` are of a mode that it may swing in: they scale it, and its
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
    let mut meter = settings.settled.map(|_| Meter::new(system, &start, Vec::new()));
    let mut blocks = Blocks::default();
    let mut motion = Path::new(system, start, &scales, settings.tolerance, 0.1 * period, &section)?;
    let until = settings.most_periods as f64 * period;
    let end_of_block = |blocks: &Blocks| ((blocks.measured.len() + 1) * BLOCK) as f64 * period;
    let mut passages: Vec<(f64, Vec<f64>)> = Vec::new();
    let mut nearest: Vec<(f64, f64)> = Vec::new();
    let (mut next_try, mut wait, mut tried) = (0, WAIT, f64::INFINITY);
    let mut largest = amplitude(&motion.x, &scales);
    let mut told = 0;
    while motion.time < until {
        let is_passage = motion.step(if meter.is_some() { end_of_block(&blocks).min(until) } else { until })?;
        if let (Some(meter), Some(settled)) = (&mut meter, settings.settled) {
            meter.add(&motion);
            if motion.time >= end_of_block(&blocks) {
                blocks.end(meter.take());
                if blocks.have_settled(settled) {
                    break;
                }
            }
        }
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
        let distances = passages.iter().rev().skip(1).map(|(_, x)| distance(x, &motion.x, &scales) / size);
        let least = distances.fold(f64::INFINITY, f64::min);
        nearest.push((motion.time, least));
        blocks.nearest = blocks.nearest.min(least);
        let Some(((end, last), earlier)) = passages.split_last() else { continue };
        let near = if next_try == 0 { NEARLY } else { NEARLY.min(NEARER * tried) };
        let Some((begin, x)) = before_alike(earlier, last, near * size, &scales) else { continue };
        tried = distance(x, last, &scales) / size;
        if let Some(cycle) = closed(system, last, end - begin, &scales, settings) {
            return Ok(Motion::Cycle(cycle));
        }
        // Not yet there, or not at all.
        (next_try, wait) = (wait, 2 * wait);
    }
    // Waits grow, so that a motion may have come to a cycle since the last try.
    if let Some(((end, last), earlier)) = passages.split_last()
        && let Some((begin, _)) = before_alike(earlier, last, NEARLY * amplitude(last, &scales), &scales)
        && let Some(cycle) = closed(system, last, end - begin, &scales, settings)
    {
        return Ok(Motion::Cycle(cycle));
    }
    let may_settle = may_settle(&nearest, motion.time);
    Ok(Motion::NotPeriodic { time: motion.time, may_settle, stretches: blocks.stretches() })
}

/// The last of the passages `earlier` that is nearer than this to the state `last`, in scales.
fn before_alike<'a>(
    earlier: &'a [(f64, Vec<f64>)],
    last: &[f64],
    near: f64,
    scales: &[f64],
) -> Option<&'a (f64, Vec<f64>)> {
    earlier.iter().rev().find(|(_, x)| distance(x, last, scales) < near)
}

/// The stable cycle that shooting finds next to a passage.
fn closed(system: &ContactSystem, passage: &[f64], period: f64, scales: &[f64], settings: &Settings) -> Option<Cycle> {
    let size = amplitude(passage, scales);
    let cycle = shoot(system, passage.to_vec(), period, scales, settings.tolerance).ok()?;
    let is_near = amplitude(&cycle.start, scales) > 1e-3 * size
        && distance(&cycle.start, passage, scales) < NEAR * size
        && is_moving(system, &cycle, scales);
    (is_near && cycle.is_stable()).then(|| with_least_period(system, cycle, scales, settings))
}

/// True of passages that are alike, come nearer to one another or cease towards the end, at `until`: of each the time and the distance to the nearest one before.
fn may_settle(nearest: &[(f64, f64)], until: f64) -> bool {
    let least = |from: f64, to: f64| {
        let within = nearest.iter().filter(|(time, _)| (from * until..=to * until).contains(time));
        within.map(|(_, distance)| *distance).fold(f64::INFINITY, f64::min)
    };
    let (before, last) = (least(0.5, 0.75), least(0.75, 1.0));
    last.is_infinite() || comes_nearer(before, last)
}

/// True if passages that were this far from each other at least, and are so far now, are alike or come nearer.
fn comes_nearer(before: f64, now: f64) -> bool {
    now < (COMING * before).max(NEARLY)
}

/// Blocks of a motion that is measured, one after the other.
struct Blocks {
    measured: Vec<Measures>,
    /// The least distance of two passages in each, relative to the size of the motion, and in the block that has not ended.
    distances: Vec<f64>,
    nearest: f64,
}

impl Default for Blocks {
    fn default() -> Self {
        Self { measured: Vec::new(), distances: Vec::new(), nearest: f64::INFINITY }
    }
}

impl Blocks {
    fn end(&mut self, measures: Measures) {
        self.measured.push(measures);
        self.distances.push(std::mem::replace(&mut self.nearest, f64::INFINITY));
    }

    /// Measures of the last half in four equal stretches; with some blocks less where it has no four.
    fn stretches(&self) -> Vec<Measures> {
        let each = (self.measured.len() / ASKED).max(1);
        let last = &self.measured[self.measured.len().saturating_sub(ASKED / 2 * each)..];
        last.chunks(each).map(Measures::together).collect()
    }

    /// True where the stretches are as fast as each other and passages do not come nearer to one another.
    fn have_settled(&self, settled: f64) -> bool {
        let blocks = self.measured.len();
        if blocks < 2 * ASKED || !blocks.is_multiple_of(ASKED) {
            return false;
        }
        let nearest = |part: &[f64]| part.iter().copied().fold(f64::INFINITY, f64::min);
        let (before, last) = self.distances[blocks / 2..].split_at(blocks / 4);
        let velocities: Vec<f64> = self.stretches().iter().map(|stretch| stretch.kinetic_energy.sqrt()).collect();
        let (least, most) =
            velocities.iter().fold((f64::INFINITY, 0.0_f64), |(least, most), v| (least.min(*v), most.max(*v)));
        most - least <= settled * most && !comes_nearer(nearest(before), nearest(last))
    }
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
    let mut motion = Path::new(system, start, &scales, tolerance, 0.1 / omega, &[])?;
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
