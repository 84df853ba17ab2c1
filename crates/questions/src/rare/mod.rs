//! The probability of squeal that is rare: of one scene, mode by mode, down to 1e-9, and the likeliest brake that squeals.
//!
//! The inputs of the scene become independent standard normal numbers by the quantile functions of the brake, and [`::rare`] does the rest: design
//! points, lines and points elsewhere. A small-gain certificate bounds the probability without a sample where the scene has one parameter.
//! docs/rare.md.

mod bound;
mod limit_state;
mod modes;
mod report;

use std::path::Path;

use ::rare::{DesignPoint, Estimate, Probability, estimate};
use cea::{EigenSolver, WholeSpectra};
use montecarlo::Progress;
use num_complex::Complex;
use study::{Input, ModeLabel, Scene, Study, UncertainBrake, doubts_of};

use crate::Error;
use crate::kept::{Kept, Question};
use crate::real_system::check_real;
use limit_state::SceneState;
use modes::{by_mode, named};

pub use ::rare::Options;
pub use bound::CertifiedBound;
pub use modes::ModeProbability;
pub use report::{design_points_table, rare_table};

/// Distance beyond a design point at which its mode is named, in standard deviations; chosen: it grows there, and little else has changed. Where nothing grows so far
/// beyond, as behind a narrow range of squeal, it is halved.
const BEYOND: f64 = 0.05;
/// Least distance beyond a design point, in standard deviations; chosen, above the error of the point itself.
const LEAST_BEYOND: f64 = 1e-7;

/// A brake that squeals and is likelier than all next to it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct LikelySqueal {
    /// Distance from the medians, in standard deviations.
    pub beta: f64,
    /// Probability to first order: that beyond a plane so far away.
    pub first_order: f64,
    /// Names that the modes may have which grow just beyond; of a sure one its name alone.
    pub modes: Vec<Vec<ModeLabel>>,
    /// Angular frequency of the mode at its onset, rad/s.
    pub omega: f64,
    /// Value of each of [`Rare::inputs`].
    pub values: Vec<f64>,
    /// The point itself just beyond, where its mode grows: values of the inputs.
    pub squealing: Vec<f64>,
    /// Standard deviations by which the coordinate of each input differs from its median.
    pub deviations: Vec<f64>,
    /// Part of each input in the variance of the growth rate next to the point, by its coordinate.
    pub parts: Vec<f64>,
    /// Distance by which the full model has its onset elsewhere than a reduced brake, in standard deviations to first order; `None` of a brake
    /// that is not reduced, and where it cannot be asked.
    pub moved: Option<f64>,
    /// The search for the point has come to its end.
    pub is_settled: bool,
}

/// The probability of squeal of one scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Rare {
    /// Sentences that speak against the results, as of a reduced brake that failed its checks.
    pub doubts: Vec<String>,
    /// Inputs that are drawn and matter in the scene.
    pub inputs: Vec<Input>,
    /// Median of each input.
    pub medians: Vec<f64>,
    /// Probability that any mode grows.
    pub probability: Probability,
    /// Part of its upper end that no sample says.
    pub unproven: f64,
    /// Factor by which the intervals are wider because the brake is reduced: 1 of another one, and where it was not compared.
    pub widened: f64,
    /// True if the brake is reduced, and a likely squealing brake could not be compared with the full model, because an input is not one of its parameters.
    pub is_not_compared: bool,
    /// Certified bound, where there is one.
    pub bound: Option<CertifiedBound>,
    /// Probabilities of modes, the largest first.
    pub modes: Vec<ModeProbability>,
    /// Likeliest squealing brakes, the nearest first.
    pub design_points: Vec<LikelySqueal>,
    /// Number of lines.
    pub lines: usize,
    /// Number of points elsewhere, and how many of them squeal.
    pub elsewhere: [usize; 2],
    /// Number of plain samples, none of which squeals; 0 where a design point was found.
    pub plain: usize,
    /// Widest step of the scan of the only input, in standard deviations: what squeals in a narrower range of it may be missed. `None` of several inputs.
    pub scanned: Option<f64>,
    /// Number of spectra in all, the study's names not among them.
    pub spectra: u64,
    /// The standard error that was asked for is reached.
    pub is_reached: bool,
}

/// The probability of squeal of a scene of a study. What is found of points is kept in the file `kept`, and taken from there where an earlier run of this
/// program has come so far: the results are the same. A file of another brake, scene, program or kind of processor is begun anew.
///
/// # Errors
/// A scene without inputs, or with a discrete input; errors of [`::rare::estimate`]; a certificate that says otherwise; a file that cannot be read or
/// written.
pub fn rare<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    options: &Options,
    solver: &dyn EigenSolver,
    kept: Option<&Path>,
    progress: &dyn Progress,
) -> Result<Rare, Error> {
    options.check()?;
    let (brake, plan) = (study.brake(), study.plan());
    let of_scene = &plan.scenes[scene];
    let capability = Error::NotGiven { capability: "drawn_inputs()", needed_by: "the probability of rare squeal" };
    let drawn = brake.drawn_inputs().ok_or(capability)?;
    check_real(brake, "the probability of rare squeal")?;
    if let Some(why) = brake.mode_source().and_then(|source| source.unknown_error(of_scene)) {
        return Err(Error::UnknownError { study: plan.source(), scene: plan.describe(of_scene), why });
    }
    let inputs = drawn.inputs(of_scene);
    if inputs.is_empty() {
        return Err(Error::NoInputs { study: plan.source(), scene: plan.describe(of_scene) });
    }
    // Measured values that repeat are flat places of a continuous quantile function, which lines go over.
    if let Some(discrete) = inputs.iter().find(|input| input.jumps) {
        let (value, allowed) =
            ("discrete, or has a range without width".into(), "distributions that are continuous".into());
        return Err(Error::Input { input: discrete.name.clone(), value, allowed });
    }
    let solver = WholeSpectra(solver);
    let kept = Kept::open(kept, brake, format!("rare squeal of scene {scene}"))?;
    let mut state = SceneState::new(study, of_scene, drawn, &solver, (progress, &kept));
    progress.begin(options.budget, kept.spectra());
    let bound = bound::certified(brake, of_scene, drawn, &study.certificates()[of_scene.configuration]);
    let single = drawn.single_parameter(of_scene);
    if let (Some(bound), Some(single), 1) = (&bound, single, state.coordinates.len()) {
        state.proven = bound.deviations(|value| single.distribution.cumulative(value));
    }
    let of_study = |error| match error {
        Error::Rare(source) => Error::RareOf { study: plan.source(), source },
        other => other,
    };
    let found = estimate(&state, options).map_err(of_study)?;
    let design_points = found.design_points.iter().map(|point| likely_squeal(&state, &inputs, point));
    let design_points = design_points.collect::<Result<Vec<_>, Error>>()?;
    let points: Vec<&[f64]> = found.witnesses.iter().map(|witness| &witness.point[..]).collect();
    let names = named(&state, &points)?;
    progress.end();
    // To first order in the distance of the onset of the full model.
    let widening = |point: &LikelySqueal| Some((point.moved? * point.beta.max(1.0)).abs());
    let widened = design_points.iter().filter_map(widening).fold(0.0, f64::max).exp();
    let is_not_compared = brake.mode_source().is_some() && design_points.iter().any(|point| point.moved.is_none());
    let Estimate {
        probability, unproven, witnesses, lines, elsewhere, plain, scanned, evaluations, is_reached, ..
    } = found;
    let modes = by_mode(&witnesses, &names, unproven, lines).into_iter();
    let modes = modes.map(|mode| ModeProbability { probability: wider(mode.probability, widened), ..mode }).collect();
    let mut probability = wider(probability, widened);
    if let Some(CertifiedBound { probability: bound, .. }) = bound {
        if probability.lower > bound {
            return Err(Error::BoundContradicted { lower: probability.lower, bound });
        }
        probability.upper = probability.upper.min(bound);
    }
    Ok(Rare {
        doubts: doubts_of(brake),
        medians: drawn.input_values(of_scene, &brake.median()),
        inputs,
        probability,
        unproven,
        widened,
        is_not_compared,
        bound,
        modes,
        design_points,
        lines,
        elsewhere,
        plain,
        scanned,
        spectra: evaluations,
        is_reached,
    })
}

fn wider(probability: Probability, factor: f64) -> Probability {
    let (lower, upper) = (probability.lower / factor, (probability.upper * factor).min(1.0));
    Probability { lower, upper, ..probability }
}

/// A design point as a brake.
fn likely_squeal<B: UncertainBrake>(
    state: &SceneState<'_, B>,
    inputs: &[Input],
    point: &DesignPoint,
) -> Result<LikelySqueal, Error> {
    let values = |u: &[f64]| state.drawn.input_values(state.scene, &state.sample(u));
    let named_beyond = |distance: f64| -> Result<_, Error> {
        let beyond: Vec<f64> = point.point.iter().zip(&point.direction).map(|(u, a)| u + distance * a).collect();
        let names = named(state, &[&beyond])?.into_iter().next().unwrap_or_default();
        Ok((beyond, names))
    };
    let mut distance = BEYOND;
    let (mut beyond, mut names) = named_beyond(distance)?;
    while names.is_empty() && distance > LEAST_BEYOND {
        distance *= 0.5;
        (beyond, names) = named_beyond(distance)?;
    }
    let of_input = |numbers: &[f64], input: &Input| {
        state.coordinates.binary_search(&input.coordinate).map_or(0.0, |place| numbers[place])
    };
    Ok(LikelySqueal {
        beta: point.beta,
        first_order: ::rare::tail(point.beta),
        modes: names,
        omega: point.mode.omega,
        squealing: values(&beyond),
        deviations: inputs.iter().map(|input| of_input(&point.point, input)).collect(),
        parts: inputs.iter().map(|input| of_input(&point.direction, input).powi(2)).collect(),
        moved: kept_moved(state, inputs, &values(&point.point), point)?,
        values: values(&point.point),
        is_settled: point.is_settled,
    })
}

/// [`moved`], which is known of a point that an earlier run has come to.
fn kept_moved<B: UncertainBrake>(
    state: &SceneState<'_, B>,
    inputs: &[Input],
    values: &[f64],
    point: &DesignPoint,
) -> Result<Option<f64>, Error> {
    let asked = [&point.point[..], &[point.slope, point.mode.growth, point.mode.omega]].concat();
    state.kept.answer(Question::Moved, &asked, || moved(state, state.scene, inputs, values, point))
}

/// Distance of the onset of the full model from the onset of a reduced brake, in standard deviations to first order.
fn moved<B: UncertainBrake>(
    state: &SceneState<'_, B>,
    scene: &Scene,
    inputs: &[Input],
    values: &[f64],
    point: &DesignPoint,
) -> Result<Option<f64>, Error> {
    let brake = state.study.brake();
    let (Some(source), Some(parametrised)) = (brake.mode_source(), brake.parametrised()) else { return Ok(None) };
    let parameters = parametrised.parameters(scene);
    let place = |input: &Input| parameters.iter().position(|parameter| parameter.name == input.name);
    let placed = inputs.iter().zip(values).map(|(input, value)| Some((place(input)?, *value)));
    let Some(placed) = placed.collect::<Option<Vec<(usize, f64)>>>() else { return Ok(None) };
    let lambda = Complex::new(point.mode.growth, point.mode.omega);
    let whole = source.whole_eigenvalue(scene, &placed, lambda)?;
    let threshold = state.study.plan().threshold;
    Ok(Some((threshold.margin(lambda) - threshold.margin(whole.lambda)) / point.slope))
}
