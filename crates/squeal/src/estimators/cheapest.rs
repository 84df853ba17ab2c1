//! The occurrences of a scene to a given half width, by the cheapest estimator that applies.

use std::collections::BTreeMap;
use std::fmt;

use cea::QrSolver;
use montecarlo::{Confidence, trials_for_half_width};
use serde::{Deserialize, Serialize};

use super::sampling::ScrambledSobol;
use super::{
    Estimated, Estimates, EstimatorError, FrictionPoints, OneParameterFamily, control_variate, exact, monte_carlo,
};
use crate::study::{ModeLabel, Study, UncertainBrake};

/// Systems that a control variate solves at least, by its sample points: below, plain sampling is cheaper. Measured on the
/// 3 x 3 lattice, where surrogates end between 1,000 and 8,000 sample points.
const FEWEST_BY_CONTROL_VARIATE: f64 = 2_000.0;
/// Number of pilot samples, which only determine the number of plain samples; chosen.
pub(super) const PLAIN_PILOT_SAMPLES: u64 = 400;
/// Half width that plain sampling is planned for, as a part of the half width asked for; chosen.
const PLANNED_WIDTH: f64 = 0.95;
/// Half width at and below which the mean of a prediction is taken over [`FINEST_POINTS`]; chosen.
const FINEST_HALF_WIDTH: f64 = 1e-3;
/// Largest and least number of Sobol points per scrambling, and number of scramblings; chosen: with the largest number, the
/// standard error of the mean of a prediction is about 1e-4.
const FINEST_POINTS: f64 = 32_768.0;
const COARSEST_POINTS: f64 = 1_024.0;
const SCRAMBLINGS: u32 = 32;
/// Scramblings where Sobol points are what is solved, and the logarithms of their numbers of points; chosen.
const SOBOL_SCRAMBLINGS: u32 = 16;
const SOBOL_POINTS: std::ops::RangeInclusive<u32> = 7..=16;

/// A way to estimate occurrences.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Estimator {
    /// Differences of the distribution function of the one uncertain parameter between onsets.
    ExactIntegral,
    /// The mean of a prediction from response surfaces, corrected by samples.
    ControlVariate,
    /// The points of a Sobol sequence under several scramblings.
    ScrambledSobol,
    /// Plain Monte Carlo.
    PlainSampling,
}

impl Estimator {
    /// All of them, the cheapest first where it applies.
    pub const ALL: [Self; 4] = [Self::ExactIntegral, Self::ControlVariate, Self::ScrambledSobol, Self::PlainSampling];
}

impl fmt::Display for Estimator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::ExactIntegral => "exact integral",
            Self::ControlVariate => "control variate",
            Self::ScrambledSobol => "scrambled Sobol points",
            Self::PlainSampling => "plain sampling",
        })
    }
}

/// The occurrences of one scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SceneOccurrences {
    /// The estimator used.
    pub estimator: Estimator,
    /// Occurrences by name of the mode; modes that are certainly never unstable are not listed.
    pub modes: BTreeMap<ModeLabel, Estimated>,
    /// The largest half width of any mode, listed or not, without the part that is due to open names.
    pub half_width: f64,
    /// Number of all systems solved.
    pub evaluations: u64,
    /// Number of systems that plain sampling would solve for the same half width of the occurrence nearest to one half.
    pub plain_evaluations: u64,
}

/// The occurrences of a scene to `half_width` at 95 %, or to the half width that the estimator reaches. `points` are friction
/// points of the scene, where [`friction_points`] returned some.
///
/// # Errors
/// A sample or a spectrum that cannot be solved.
pub fn scene_occurrences<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    half_width: f64,
    points: Option<&FrictionPoints>,
) -> Result<SceneOccurrences, EstimatorError> {
    let attempt = match by_integral(study, scene, half_width)? {
        Ok(found) => return Ok(found),
        Err(DoesNotApply { evaluations }) => evaluations,
    };
    let mut found = match points {
        Some(points) => by_control_variate(study, scene, half_width, points)?,
        None => by_sampling(study, scene, half_width)?,
    };
    found.evaluations += attempt;
    Ok(found)
}

/// An estimator that does not apply to a scene.
struct DoesNotApply {
    /// Systems solved until that was known.
    evaluations: u64,
}

/// Points of the friction of a scene for [`scene_occurrences`]; `None` where a control variate does not apply, or plain
/// sampling is cheaper.
///
/// # Errors
/// A sample that has no operating point.
pub fn friction_points<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    half_width: f64,
) -> Result<Option<FrictionPoints>, EstimatorError> {
    let plan = study.plan();
    // The exact integral is over onsets of the bare sign.
    let is_single = plan.threshold.is_axis() && study.brake().single_parameter(&plan.scenes[scene]).is_some();
    // A prediction would have the modes of all frequencies.
    if is_single || plan.band.is_some() || plain_samples(0.5, half_width) < FEWEST_BY_CONTROL_VARIATE {
        return Ok(None);
    }
    let modes = study.references()[scene].modes.iter().map(|mode| mode.lambda);
    let omega = modes.max_by(|a, b| a.re.total_cmp(&b.re)).map_or(0.0, |lambda| lambda.im);
    let count = (FINEST_POINTS * FINEST_HALF_WIDTH / half_width).clamp(COARSEST_POINTS, FINEST_POINTS);
    let count = (count as u32).next_power_of_two();
    match FrictionPoints::new(study.brake(), &study.plan().scenes[scene], omega, count, SCRAMBLINGS) {
        Ok(points) => Ok(Some(points)),
        Err(EstimatorError::NotShared) => Ok(None),
        Err(error) => Err(error),
    }
}

/// The occurrences by the exact integral; `None` where the scene has no single parameter, or its branches are not resolved.
fn by_integral<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    half_width: f64,
) -> Result<Result<SceneOccurrences, DoesNotApply>, EstimatorError> {
    let mut family = match OneParameterFamily::new(study.brake(), &study.plan().scenes[scene], &QrSolver) {
        Ok(family) => family,
        Err(EstimatorError::NotOneParameter { .. }) => return Ok(Err(DoesNotApply { evaluations: 0 })),
        Err(error) => return Err(error),
    };
    let found = match exact(&study.references()[scene], &mut family) {
        Ok(found) => found,
        // Solver errors are none of tracking: see `EstimatorError`.
        Err(EstimatorError::Tracking(_)) => {
            return Ok(Err(DoesNotApply { evaluations: family.counters().eigenvalue_solves }));
        }
        Err(error) => return Err(error),
    };
    let mut modes = BTreeMap::new();
    for (name, occurrence) in found.integral.occurrences {
        modes.insert(name, Estimated::within(occurrence, found.error));
    }
    let evaluations = found.counters.eigenvalue_solves;
    Ok(Ok(SceneOccurrences::new(Estimator::ExactIntegral, modes, found.error, evaluations, half_width)))
}

fn by_control_variate<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    half_width: f64,
    points: &FrictionPoints,
) -> Result<SceneOccurrences, EstimatorError> {
    let found = control_variate(study, scene, points, study.plan().seed, half_width)?;
    let (reached, evaluations) = (found.half_width(), found.evaluations.total());
    Ok(SceneOccurrences::new(Estimator::ControlVariate, found.modes, reached, evaluations, half_width))
}

/// The occurrences by scrambled Sobol points or plain samples; the number of the latter follows from pilot samples and the occurrence nearest to
/// one half. Half as many systems are solved at Sobol points, if the brake has samples by quantiles, before it is given up.
fn by_sampling<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    half_width: f64,
) -> Result<SceneOccurrences, EstimatorError> {
    let seed = study.plan().seed;
    let pilots = monte_carlo(study, scene, seed.wrapping_add(1), PLAIN_PILOT_SAMPLES)?;
    let samples = planned_samples(&pilots, half_width);
    let mut spent = PLAIN_PILOT_SAMPLES;
    match by_sobol(study, scene, half_width, samples)? {
        Sobol::Reached(found, evaluations) => {
            let (reached, evaluations) = (found.half_width(), spent + evaluations);
            return Ok(SceneOccurrences::new(Estimator::ScrambledSobol, found.modes, reached, evaluations, half_width));
        }
        Sobol::GivenUp(evaluations) => spent += evaluations,
    }
    let found = monte_carlo(study, scene, seed, samples)?;
    let reached = found.half_width();
    Ok(SceneOccurrences::new(Estimator::PlainSampling, found.modes, reached, spent + samples, half_width))
}

/// What came of Sobol points, with the systems solved.
enum Sobol {
    Reached(Estimates, u64),
    GivenUp(u64),
}

/// The occurrences by scrambled Sobol points, twice as many at each look, whose error probabilities sum to 5 % (Boole's inequality).
fn by_sobol<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    half_width: f64,
    plain: u64,
) -> Result<Sobol, EstimatorError> {
    let all = |points: u32| u64::from(points) * u64::from(SOBOL_SCRAMBLINGS);
    let looks: Vec<u32> = SOBOL_POINTS.map(|log| 1 << log).take_while(|&points| all(points) <= plain / 2).collect();
    let mut sobol = ScrambledSobol::new(study.plan().seed as u32, SOBOL_SCRAMBLINGS);
    let tail = 2.0 * Confidence::P95.tail() / looks.len().max(1) as f64;
    let confidence = Confidence::new(1.0 - tail).map_err(crate::Error::from)?;
    let mut spent = 0;
    for points in looks {
        match sobol.extend(study, scene, points) {
            Err(EstimatorError::NotShared) => return Ok(Sobol::GivenUp(0)),
            other => other?,
        }
        spent = all(points);
        let found = sobol.estimates(confidence);
        if found.half_width() <= half_width {
            return Ok(Sobol::Reached(found, spent));
        }
    }
    Ok(Sobol::GivenUp(spent))
}

/// Samples for a half width: what the occurrence nearest to one half needs, within the limits that pilots leave it. A mode that
/// no pilot shows is planned for as if it occurred as often as the half width says.
pub(super) fn planned_samples(pilots: &Estimates, half_width: f64) -> u64 {
    let nearest = |mode: &Estimated| 0.5_f64.clamp(mode.limits.lower, mode.limits.upper);
    let needed = |p: f64| plain_samples(p, PLANNED_WIDTH * half_width);
    pilots.modes.values().map(|mode| needed(nearest(mode))).fold(needed(half_width), f64::max).ceil() as u64
}

impl SceneOccurrences {
    fn new(
        estimator: Estimator,
        modes: BTreeMap<ModeLabel, Estimated>,
        reached: f64,
        evaluations: u64,
        half_width: f64,
    ) -> Self {
        let centres = modes.values().map(|mode| 0.5 * (mode.occurrence.lower + mode.occurrence.upper));
        let needed = centres.map(|p| plain_samples(p, half_width)).fold(plain_samples(0.0, half_width), f64::max);
        Self { estimator, modes, half_width: reached, evaluations, plain_evaluations: needed.ceil() as u64 }
    }
}

/// Samples with which plain sampling knows an occurrence to a half width at 95 %.
fn plain_samples(p: f64, half_width: f64) -> f64 {
    trials_for_half_width(p, half_width, Confidence::P95)
}
