//! The motion that an unstable mode of a draw grows into, and how loud it is.

use cea::{Mode, Workspace};
use cycle::{ContactSystem, Measures, Motion, Settings, follow, measure};
use linsys::SecondOrder;
use num_complex::Complex;
use osc_model::Brake;
use serde::{Deserialize, Serialize};
use study::{Moves, Plan, Units};

use super::{GrowingMode, TOLERANCE, in_si, starts};
use crate::Error;

/// Relative difference of the velocities of the four stretches of a motion up to which it has settled; chosen: the mean of all four is nearer still.
const SETTLED: f64 = 0.01;

/// Settings by which motions of draws are followed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Following {
    /// Settings of the integration.
    pub settings: Settings,
    /// Part of the steady speed of a contact below which one with a bristle is said to stick.
    pub stick: f64,
}

impl Following {
    /// Settings as at medians, until a motion has settled.
    pub fn of_study(stick: f64) -> Self {
        let settings = Settings { tolerance: TOLERANCE, settled: Some(SETTLED), ..Settings::default() };
        Self { settings, stick }
    }

    /// Settings for a screening, shorter and with a larger error, as a screening follows many; chosen: 200 periods, 1e-8.
    pub fn of_screen(stick: f64) -> Self {
        let of_study = Self::of_study(stick);
        Self { settings: Settings { tolerance: 1e-8, most_periods: 200, ..of_study.settings }, stick }
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
        /// True if it has not settled, and may yet come to a cycle.
        may_settle: bool,
        /// Measures over four stretches of it together.
        measured: MeasuredMotion,
        /// Difference of the loudest and the least loud of the stretches, relative to their mean.
        spread: f64,
        /// Periods of the mode for which it was followed; the stretches are their last half.
        periods: f64,
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
            Self::NotPeriodic { may_settle: true, .. } => "not settled",
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

/// Follows the motion from just beyond the first kink, beside a mode.
fn fate(
    system: &ContactSystem,
    mode: &GrowingMode,
    (loud, brake, units): (&[usize], &Brake, Units),
    following: &Following,
) -> Result<DrawnFate, Error> {
    let Following { settings, .. } = following;
    let omega = mode.lambda.im;
    let of_si = |measures: &Measures| MeasuredMotion {
        loudness: measures.rms_of(loud),
        bodies: brake.bodies.iter().map(|body| (measures.rms_of(&body.dofs), measures.peak_of(&body.dofs))).collect(),
        contacts: measures.contacts.iter().map(|shares| (shares.open, shares.stuck)).collect(),
    };
    let measured = |measures: Measures| of_si(&in_si(measures, units));
    let found = || -> Result<DrawnFate, cycle::Error> {
        Ok(match follow(system, starts::beside_mode(system, mode), omega, &mode.shape, settings)? {
            Motion::Rest => DrawnFate::Rest,
            Motion::Unbounded => DrawnFate::Unbounded,
            Motion::Cycle(cycle) => DrawnFate::Cycle {
                hz: cycle.frequency_hz(),
                largest_multiplier: cycle.largest_multiplier(),
                measured: measured(measure(system, &cycle, settings.tolerance)?),
            },
            Motion::NotPeriodic { time, may_settle, stretches } => {
                let loudness = || stretches.iter().map(|stretch| measured(stretch.clone()).loudness);
                let (least, most) = (loudness().fold(f64::INFINITY, f64::min), loudness().fold(0.0, f64::max));
                let measured = measured(Measures::together(&stretches));
                let spread = if measured.loudness > 0.0 { (most - least) / measured.loudness } else { 0.0 };
                let periods = (time * omega / std::f64::consts::TAU).round();
                DrawnFate::NotPeriodic { may_settle, measured, spread, periods }
            }
        })
    };
    match found() {
        Err(cycle::Error::Stopped) => Err(cycle::Error::Stopped.into()),
        Err(error) => Ok(DrawnFate::NotFollowed(error.to_string())),
        Ok(fate) => Ok(fate),
    }
}
