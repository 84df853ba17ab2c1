//! The occurrences of a scene to a given half width, by the cheapest estimator that applies.

use std::collections::BTreeMap;
use std::fmt;

use cea::QrSolver;
use linsys::OperatingPoint;
use montecarlo::{Confidence, trials_for_half_width};
use serde::{Deserialize, Serialize};

use super::contradiction::{Rejected, contradiction};
use super::sampling::ScrambledSobol;
use super::{
    Estimated, Estimates, EstimatorError, FrictionPoints, OneParameterFamily, control_variate, exact, monte_carlo,
};
use crate::{ModeLabel, Scene, SceneTally, SingleParameter, Study, UncertainBrake};

/// Least number of systems that a control variate solves, by its sample points: below, plain sampling is cheaper. Measured on the
/// 3 x 3 lattice, where surrogates end between 1,000 and 8,000 sample points.
const FEWEST_BY_CONTROL_VARIATE: f64 = 2_000.0;
/// Number of pilot samples, which only determine the number of plain samples; chosen: with fewer, that number is less certain; more are lost for the result.
pub(super) const PLAIN_PILOT_SAMPLES: u64 = 400;
/// Half width that plain sampling is planned for, as a fraction of the half width asked for; chosen: with 1, the half width is missed as often as not.
const PLANNED_WIDTH: f64 = 0.95;
/// Largest half width for which the mean of a prediction is taken over [`FINEST_POINTS`]; chosen.
const FINEST_HALF_WIDTH: f64 = 1e-3;
/// Largest number of Sobol points per scrambling; chosen: with this number the standard error of the mean of a prediction is about 1e-4.
const FINEST_POINTS: f64 = 32_768.0;
/// Least number of Sobol points per scrambling; chosen.
const COARSEST_POINTS: f64 = 1_024.0;
/// Number of scramblings for the mean of a prediction; chosen: its standard error is the standard error of the means over the scramblings.
const SCRAMBLINGS: u32 = 32;
/// Number of scramblings of Sobol points that are solved; chosen.
const SOBOL_SCRAMBLINGS: u32 = 16;
/// Binary logarithms of the numbers of Sobol points that are solved in each scrambling; chosen.
const SOBOL_POINTS: std::ops::RangeInclusive<u32> = 7..=16;

/// Fewest values at which a brake is looked at for being affine in its parameter; chosen: a formula that changes between two of them is not seen.
const FEWEST_PROBES: f64 = 256.0;
/// Most values at which a brake is looked at for being affine in its parameter; chosen: they take a second or so.
const MOST_PROBES: f64 = 100_000.0;
/// Largest distance of the numbers of a system from affine ones, relative to the largest: rounding of a few operations.
const AFFINE_ROUNDING: f64 = 1e-11;

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
    /// Estimators, the cheapest first where it applies.
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
    /// Largest half width of any mode, listed or not, without the part that is due to open names.
    pub half_width: f64,
    /// Number of all systems solved.
    pub evaluations: u64,
    /// Number of systems that plain sampling would solve for the same half width of the occurrence nearest to one half.
    pub plain_evaluations: u64,
    /// Estimates of earlier estimators that the samples of the study contradict.
    #[serde(default)]
    pub rejected: Vec<Rejected>,
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
    scene_occurrences_beside(study, scene, half_width, points, None)
}

/// Occurrences as by [`scene_occurrences`], beside samples of the scene, `own`: an estimate that they contradict is rejected, and the next
/// estimator takes over, plain sampling at last.
///
/// # Errors
/// As [`scene_occurrences`].
pub fn scene_occurrences_beside<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    half_width: f64,
    points: Option<&FrictionPoints>,
    own: Option<&SceneTally>,
) -> Result<SceneOccurrences, EstimatorError> {
    let (mut rejected, mut spent) = (Vec::new(), 0);
    let mut beside = |mut found: SceneOccurrences, spent: &mut u64| match own.and_then(|own| contradiction(&found, own))
    {
        None => {
            found.evaluations += *spent;
            found.rejected = std::mem::take(&mut rejected);
            Some(found)
        }
        Some(because) => {
            *spent += found.evaluations;
            rejected.push(Rejected { estimator: found.estimator, because });
            None
        }
    };
    let mut is_rejected = false;
    match by_integral(study, scene, half_width)? {
        Ok(found) => match beside(found, &mut spent) {
            Some(found) => return Ok(found),
            None => is_rejected = true,
        },
        Err(DoesNotApply { evaluations }) => spent += evaluations,
    }
    // A scene with one parameter has no points before its integral is rejected.
    let made = match (points, is_rejected) {
        (None, true) => points_of_friction(study, scene, half_width)?,
        _ => None,
    };
    if let Some(points) = points.or(made.as_ref())
        && let Some(found) = beside(by_control_variate(study, scene, half_width, points)?, &mut spent)
    {
        return Ok(found);
    }
    // The number of plain samples follows from pilot samples and the occurrence nearest to one half.
    let pilots = monte_carlo(study, scene, study.plan().seed.wrapping_add(1), PLAIN_PILOT_SAMPLES)?;
    let samples = planned_samples(&pilots, half_width);
    spent += PLAIN_PILOT_SAMPLES;
    match by_sobol(study, scene, half_width, samples)? {
        Sobol::Reached(found, evaluations) => {
            let reached = found.half_width();
            let found = SceneOccurrences::new(Estimator::ScrambledSobol, found.modes, reached, evaluations, half_width);
            if let Some(found) = beside(found, &mut spent) {
                return Ok(found);
            }
        }
        Sobol::GivenUp(evaluations) => spent += evaluations,
    }
    // The samples of a study and plain samples are the same as far as both go.
    let found = monte_carlo(study, scene, study.plan().seed, samples)?;
    let reached = found.half_width();
    let mut found = SceneOccurrences::new(Estimator::PlainSampling, found.modes, reached, samples, half_width);
    found.evaluations += spent;
    found.rejected = rejected;
    Ok(found)
}

/// An estimator that does not apply to a scene.
struct DoesNotApply {
    /// Number of systems solved until that was known.
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
    let is_single = plan.threshold.is_axis() && single_parameter(study.brake(), &plan.scenes[scene]).is_some();
    if is_single { Ok(None) } else { points_of_friction(study, scene, half_width) }
}

/// Friction points as by [`friction_points`], of a scene whether it has a single parameter or not.
fn points_of_friction<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    half_width: f64,
) -> Result<Option<FrictionPoints>, EstimatorError> {
    let plan = study.plan();
    // A prediction would have the modes of all frequencies, and of dashpots in the place of loss factors.
    if plan.band.is_some() || plain_samples(0.5, half_width) < FEWEST_BY_CONTROL_VARIATE {
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

/// The occurrences by the exact integral; it does not apply where the scene has no single parameter, or its branches are not resolved.
fn by_integral<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    half_width: f64,
) -> Result<Result<SceneOccurrences, DoesNotApply>, EstimatorError> {
    let of_scene = &study.plan().scenes[scene];
    let does_not_apply = || Ok(Err(DoesNotApply { evaluations: 0 }));
    // Onsets of a real system are not the onsets of the brake where it has loss factors.
    if study.brake().source_with_losses(of_scene).is_some() {
        return does_not_apply();
    }
    if let Some(single) = single_parameter(study.brake(), of_scene)
        && !is_affine_throughout(study.brake(), of_scene, &single, half_width)
    {
        return does_not_apply();
    }
    let mut family = match OneParameterFamily::new(study.brake(), of_scene, &QrSolver) {
        Ok(family) => family,
        Err(EstimatorError::NotOneParameter { .. }) => return does_not_apply(),
        Err(error) => return Err(error),
    };
    let found = match exact(&study.references()[scene], &mut family) {
        Ok(found) => found,
        // Solver errors are not errors of tracking: see `EstimatorError`.
        Err(EstimatorError::Tracking(_) | EstimatorError::NotOneParameter { .. }) => {
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

/// The one parameter of a scene, of a brake that says which numbers are drawn.
fn single_parameter<'a, B: UncertainBrake>(brake: &'a B, scene: &Scene) -> Option<SingleParameter<'a, B::Sample>> {
    brake.drawn_inputs()?.single_parameter(scene)
}

/// True if the coefficients and gains of a scene are affine in its one parameter at values between each two of which the probability is a quarter of the
/// half width, within [`FEWEST_PROBES`] and [`MOST_PROBES`] values: a formula that changes within an interval as probable as the half width is seen. A
/// brake that does not exist at one of these values is not affine.
fn is_affine_throughout<B: UncertainBrake>(
    brake: &B,
    scene: &Scene,
    single: &SingleParameter<'_, B::Sample>,
    half_width: f64,
) -> bool {
    let count = (4.0 / half_width).clamp(FEWEST_PROBES, MOST_PROBES) as u64;
    let at = |value: f64| brake.operating_point(scene, &single.sample(value)).map(numbers).ok();
    let quantile = |i: u64| single.distribution.quantile((i as f64 + 0.5) / count as f64);
    let [from, to] = [quantile(0), quantile(count - 1)];
    let (Some(first), Some(last)) = (at(from), at(to)) else { return false };
    let is_affine = |i: u64| {
        let value = quantile(i);
        let part = if to > from { (value - from) / (to - from) } else { 0.0 };
        at(value).is_some_and(|found| {
            found.len() == first.len()
                && found.iter().zip(first.iter().zip(&last)).all(|(found, (first, last))| {
                    let scale = first.abs().max(last.abs()).max(found.abs());
                    (found - (first + part * (last - first))).abs() <= AFFINE_ROUNDING * scale
                })
        })
    };
    (1..count).all(is_affine)
}

/// Numbers of an operating point: coefficients, and gains of all channels.
fn numbers(at: OperatingPoint) -> Vec<f64> {
    let of_channel = |gain: &linsys::ChannelGain| {
        let lag = gain.lag.map_or([0.0; 3], |lag| [lag.decay, lag.drive, lag.force]);
        [gain.mu, gain.slope].into_iter().chain(lag)
    };
    at.coefficients.iter().copied().chain(at.channels.iter().flat_map(of_channel)).collect()
}

/// Outcome of Sobol points, with the number of systems solved.
enum Sobol {
    Reached(Estimates, u64),
    GivenUp(u64),
}

/// The occurrences by scrambled Sobol points, looked at again and again with twice as many points, until the half width is reached; the error probabilities
/// of the looks sum to 5 % (Boole's inequality). Given up where the brake has no samples by quantiles, or the half width is not reached with half as many
/// systems as plain sampling takes, `plain`.
fn by_sobol<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    half_width: f64,
    plain: u64,
) -> Result<Sobol, EstimatorError> {
    let all = |points: u32| u64::from(points) * u64::from(SOBOL_SCRAMBLINGS);
    let looks: Vec<u32> = SOBOL_POINTS.map(|log| 1 << log).take_while(|&points| all(points) <= plain / 2).collect();
    let mut sobol = ScrambledSobol::new(study.plan().seed, SOBOL_SCRAMBLINGS);
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

/// Number of samples for a half width: the number that the occurrence nearest to one half needs, within the limits that pilots leave it.
/// A mode that no pilot shows is planned for as if it occurred as often as the half width says.
pub(super) fn planned_samples(pilots: &Estimates, half_width: f64) -> u64 {
    let nearest = |mode: &Estimated| 0.5_f64.clamp(mode.limits.lower, mode.limits.upper);
    let needed = |p: f64| plain_samples(p, PLANNED_WIDTH * half_width);
    pilots.modes.values().map(|mode| needed(nearest(mode))).fold(needed(half_width), f64::max).ceil() as u64
}

impl SceneOccurrences {
    /// True if nothing in the samples of the scene contradicts these occurrences.
    #[must_use]
    pub fn agrees_with(&self, own: &SceneTally) -> bool {
        contradiction(self, own).is_none()
    }

    fn new(
        estimator: Estimator,
        modes: BTreeMap<ModeLabel, Estimated>,
        reached: f64,
        evaluations: u64,
        half_width: f64,
    ) -> Self {
        let centres = modes.values().map(|mode| 0.5 * (mode.occurrence.lower + mode.occurrence.upper));
        let needed = centres.map(|p| plain_samples(p, half_width)).fold(plain_samples(0.0, half_width), f64::max);
        let plain_evaluations = needed.ceil() as u64;
        Self { estimator, modes, half_width: reached, evaluations, plain_evaluations, rejected: Vec::new() }
    }
}

/// Number of samples with which plain sampling knows an occurrence p to a half width at 95 %.
fn plain_samples(p: f64, half_width: f64) -> f64 {
    trials_for_half_width(p, half_width, Confidence::P95)
}
