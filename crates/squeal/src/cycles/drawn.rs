//! The motion that an unstable mode of a draw grows into, and how loud it is.

use cea::{Mode, Workspace};
use cycle::{ContactSystem, Measures, Motion, Settings, follow, measure, measure_over};
use linsys::SecondOrder;
use num_complex::Complex;
use osc_model::Brake;
use serde::{Deserialize, Serialize};
use study::{Moves, Plan, Units};

use super::{GrowingMode, TOLERANCE, in_si, starts};
use crate::Error;

/// Stretches in which a motion that is not periodic is measured; chosen, so that they can be compared with each other.
const STRETCHES: usize = 4;

/// Settings by which motions of draws are followed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Following {
    /// Settings of the integration.
    pub settings: Settings,
    /// Periods of the mode in each of the stretches in which a motion that is not periodic is measured.
    pub stretch: usize,
    /// A contact sticks where it slides with less than this part of its steady speed.
    pub stick: f64,
}

impl Following {
    /// Settings as at medians; chosen: stretches of 50 periods.
    pub fn of_study(stick: f64) -> Self {
        Self { settings: Settings { tolerance: TOLERANCE, ..Settings::default() }, stretch: 50, stick }
    }

    /// Settings for a screening, shorter and with a larger error, as a screening follows many; chosen: 200 periods, stretches of 25, 1e-8.
    pub fn of_screen(stick: f64) -> Self {
        Self { settings: Settings { tolerance: 1e-8, most_periods: 200, ..Settings::default() }, stretch: 25, stick }
    }
}

/// Fate of a motion of a draw.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum DrawnFate {
    /// A stable limit cycle.
    Cycle {
        /// Frequency, Hz.
        hz: f64,
        /// Largest magnitude of a Floquet multiplier.
        largest_multiplier: f64,
        /// Measures over a period.
        measured: MeasuredMotion,
    },
    /// A motion that does not repeat itself.
    NotPeriodic {
        /// Measures over some stretches of it together.
        measured: MeasuredMotion,
        /// Difference of the loudest and the least loud of the stretches, relative to their mean.
        spread: f64,
    },
    /// Rest in steady sliding.
    Rest,
    /// Growth that no contact stops.
    Unbounded,
    /// A motion that could not be followed, with the reason.
    NotFollowed(String),
}

/// Measures of a motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeasuredMotion {
    /// Loudness: root mean square of the velocities of all degrees of freedom that are no rotations, together, m/s.
    pub loudness: f64,
    /// Root mean square of the velocity, m/s, and largest displacement, m, of each body.
    pub bodies: Vec<(f64, f64)>,
    /// Shares of the time in which each contact is open, and closed and stuck.
    pub contacts: Vec<(f64, f64)>,
}

impl DrawnFate {
    /// Kind of the motion, in words.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Cycle { .. } => "cycle",
            Self::NotPeriodic { .. } => "not periodic",
            Self::Rest => "rest",
            Self::Unbounded => "unbounded",
            Self::NotFollowed(_) => "not followed",
        }
    }

    /// Measures of the motion, where it has some.
    #[must_use]
    pub fn measured(&self) -> Option<&MeasuredMotion> {
        match self {
            Self::Cycle { measured, .. } | Self::NotPeriodic { measured, .. } => Some(measured),
            Self::Rest | Self::Unbounded | Self::NotFollowed(_) => None,
        }
    }

    /// Loudness, m/s, 0 at rest; `None` of a motion that is unbounded or could not be followed.
    #[must_use]
    pub fn loudness(&self) -> Option<f64> {
        match self {
            Self::Rest => Some(0.0),
            moving => moving.measured().map(|measured| measured.loudness),
        }
    }
}

/// Degrees of freedom of a brake, as its system counts them, that are no rotations: a velocity of theirs adds to the loudness.
pub(crate) fn displacements(plan: &Plan, brake: &Brake) -> Vec<usize> {
    let free = brake.dofs.free().iter().enumerate();
    free.filter(|(_, full)| plan.labels.moves(**full) != Moves::Turns).map(|(at, _)| at).collect()
}

/// The motions from modes of a draw, by their eigenvalues, 1/s.
///
/// # Errors
/// Work that is stopped; what else keeps a motion from being followed is its fate.
pub(crate) fn motions(
    system: Result<ContactSystem, Error>,
    of_cea: &SecondOrder,
    lambdas: &[Complex<f64>],
    (plan, brake): (&Plan, &Brake),
    following: &Following,
) -> Result<Vec<DrawnFate>, Error> {
    let loud = displacements(plan, brake);
    let checked = system.and_then(|system| {
        let omega = lambdas.iter().map(|lambda| lambda.im).fold(0.0, f64::max);
        system.check_tangent(of_cea, omega)?;
        Ok(system)
    });
    let motion = |&lambda: &Complex<f64>| -> Result<DrawnFate, Error> {
        let system = checked.as_ref().map_err(ToString::to_string);
        let found = system.and_then(|system| {
            let shape = Mode::at(of_cea, &[lambda], &mut Workspace::default()).map_err(|error| error.to_string())?;
            let shape = shape.iter().flat_map(|mode| mode.shape.iter().copied()).collect();
            Ok((system, GrowingMode { rank: 0, lambda, shape }))
        });
        match found {
            Ok((system, mode)) => fate(system, &mode, (&loud, brake, plan.units), following),
            Err(reason) => Ok(DrawnFate::NotFollowed(reason)),
        }
    };
    lambdas.iter().map(motion).collect()
}

/// Loudness of the loudest of some motions, m/s: 0 of none, infinite where one is unbounded or could not be followed.
pub(crate) fn loudest(fates: &[DrawnFate]) -> f64 {
    fates.iter().map(|fate| fate.loudness().unwrap_or(f64::INFINITY)).fold(0.0, f64::max)
}

/// Follows the motion from just beyond the first kink in a mode.
fn fate(
    system: &ContactSystem,
    mode: &GrowingMode,
    (loud, brake, units): (&[usize], &Brake, Units),
    following: &Following,
) -> Result<DrawnFate, Error> {
    let Following { settings, stretch, .. } = following;
    let omega = mode.lambda.im;
    let of_si = |measures: &Measures| MeasuredMotion {
        loudness: measures.rms_of(loud),
        bodies: brake.bodies.iter().map(|body| (measures.rms_of(&body.dofs), measures.peak_of(&body.dofs))).collect(),
        contacts: measures.contacts.iter().map(|shares| (shares.open, shares.stuck)).collect(),
    };
    let measured = |measures: Measures| of_si(&in_si(measures, units));
    let found = || -> Result<DrawnFate, cycle::Error> {
        Ok(match follow(system, starts::in_mode(system, mode), omega, &mode.shape, settings)? {
            Motion::Rest => DrawnFate::Rest,
            Motion::Unbounded => DrawnFate::Unbounded,
            Motion::Cycle(cycle) => DrawnFate::Cycle {
                hz: cycle.frequency_hz(),
                largest_multiplier: cycle.largest_multiplier(),
                measured: measured(measure(system, &cycle, settings.tolerance)?),
            },
            Motion::NotPeriodic { mut state, .. } => {
                let period = std::f64::consts::TAU / omega;
                let mut stretches = Vec::with_capacity(STRETCHES);
                for _ in 0..STRETCHES {
                    let time = *stretch as f64 * period;
                    let (measures, last) = measure_over(system, &state, [time, period], settings.tolerance)?;
                    stretches.push(measured(measures));
                    state = last;
                }
                let loudness = || stretches.iter().map(|stretch| stretch.loudness);
                let (least, most) = (loudness().fold(f64::INFINITY, f64::min), loudness().fold(0.0, f64::max));
                let measured = together(&stretches);
                let spread = if measured.loudness > 0.0 { (most - least) / measured.loudness } else { 0.0 };
                DrawnFate::NotPeriodic { measured, spread }
            }
        })
    };
    match found() {
        Err(cycle::Error::Stopped) => Err(cycle::Error::Stopped.into()),
        Err(error) => Ok(DrawnFate::NotFollowed(error.to_string())),
        Ok(fate) => Ok(fate),
    }
}

/// Measures of equal stretches of a motion together.
fn together(stretches: &[MeasuredMotion]) -> MeasuredMotion {
    let mean = |of: &dyn Fn(&MeasuredMotion) -> f64| stretches.iter().map(of).sum::<f64>() / stretches.len() as f64;
    let first = &stretches[0];
    let body = |at: usize| {
        let peak = stretches.iter().map(|stretch| stretch.bodies[at].1).fold(0.0, f64::max);
        (mean(&|stretch| stretch.bodies[at].0.powi(2)).sqrt(), peak)
    };
    let contact = |at: usize| (mean(&|stretch| stretch.contacts[at].0), mean(&|stretch| stretch.contacts[at].1));
    MeasuredMotion {
        loudness: mean(&|stretch| stretch.loudness.powi(2)).sqrt(),
        bodies: (0..first.bodies.len()).map(body).collect(),
        contacts: (0..first.contacts.len()).map(contact).collect(),
    }
}
