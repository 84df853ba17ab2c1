//! A comparison of estimators of occurrences: time against error, away from coalescence and near it.

use std::collections::BTreeSet;
use std::time::Instant;

use cea::QrSolver;
use serde::Serialize;
use squeal::estimators::{Estimated, Estimates, Integral, OneParameterFamily, exact, monte_carlo, quasi_monte_carlo};
use squeal::study::{ModeLabel, Study, UncertainBrake};

use crate::ValidationError;
use crate::branch_points::near_coalescence;
use crate::perturbation::{TaylorOrder, perturbation};
use crate::time_to_tolerance::samples_to_tolerance;

/// Time and errors of one estimator with one number of samples.
#[derive(Debug, Clone, Serialize)]
pub struct EstimatorAccuracy {
    /// Name of the estimator.
    pub estimator: &'static str,
    /// Samples per scene; 0 for an estimator without samples.
    pub samples: u64,
    /// Mean time of a scene, seconds.
    pub seconds: f64,
    /// Mean number of spectra per scene.
    pub spectra: f64,
    /// Largest error of an occurrence, over the modes without a coalescence between the median and the onset.
    pub max_error_away: f64,
    /// Largest error of an occurrence, over the other modes.
    pub max_error_near: f64,
}

/// Comparison of all estimators on chosen scenes.
#[derive(Debug, Clone, Serialize)]
pub struct Estimators {
    /// Number of scenes, one for each class of arrangements chosen.
    pub scenes: usize,
    /// Numbers of occurrences compared, away from coalescence and near it.
    pub occurrences: [usize; 2],
    /// Largest error bound of the exact integral.
    pub reference_bound: f64,
    /// Number of samples with which plain Monte Carlo has each of these occurrences to 0.1 percentage points, 95 %.
    pub samples_to_tolerance: f64,
    /// Rows, one per estimator and size.
    pub rows: Vec<EstimatorAccuracy>,
}

/// An occurrence by the exact integral: scene, name, value, and whether its onset is near a coalescence.
struct Exactly {
    scene: usize,
    name: ModeLabel,
    value: f64,
    is_near: bool,
}

/// The occurrences by the exact integral, with which the estimators are compared.
#[derive(Default)]
struct ExactOccurrences {
    occurrences: Vec<Exactly>,
    /// Scene and name of each mode near a coalescence, also of modes that are never unstable.
    near: BTreeSet<(usize, ModeLabel)>,
    /// Largest error bound of these occurrences.
    bound: f64,
    seconds: f64,
    spectra: u64,
}

/// Comparison of the estimators on `scenes` of shared Coulomb friction, with these numbers of samples.
///
/// # Errors
/// Those of the estimators.
pub fn compare_estimators<B: UncertainBrake>(
    study: &Study<'_, B>,
    scenes: &[usize],
    plain: &[u64],
    quasi: &[u32],
    scramblings: u32,
) -> Result<Estimators, ValidationError> {
    let exactly = ExactOccurrences::new(study, scenes)?;
    let count = scenes.len() as f64;
    let mut rows = vec![EstimatorAccuracy {
        estimator: "exact integral",
        samples: 0,
        seconds: exactly.seconds / count,
        spectra: exactly.spectra as f64 / count,
        max_error_away: exactly.bound,
        max_error_near: exactly.bound,
    }];
    let mut measure = |estimator, samples, run: &dyn Fn(usize) -> Result<SceneEstimate, ValidationError>| {
        rows.push(exactly.measure(estimator, samples, scenes, run)?);
        Ok::<_, ValidationError>(())
    };
    measure("perturbation, first order", 0, &|scene| SceneEstimate::expanded(study, scene, TaylorOrder::First))?;
    measure("perturbation, second order", 0, &|scene| SceneEstimate::expanded(study, scene, TaylorOrder::Second))?;
    for &samples in plain {
        measure("Monte Carlo", samples, &|scene| Ok(SceneEstimate::sampled(&monte_carlo(study, scene, 1, samples)?)))?;
    }
    for &points in quasi {
        let samples = u64::from(points) * u64::from(scramblings);
        measure("quasi-Monte Carlo", samples, &|scene| {
            Ok(SceneEstimate::sampled(&quasi_monte_carlo(study, scene, 1, points, scramblings)?))
        })?;
    }
    let near = exactly.occurrences.iter().filter(|one| one.is_near).count();
    Ok(Estimators {
        scenes: scenes.len(),
        occurrences: [exactly.occurrences.len() - near, near],
        reference_bound: exactly.bound,
        samples_to_tolerance: samples_to_tolerance(exactly.occurrences.iter().map(|one| one.value)),
        rows,
    })
}

impl ExactOccurrences {
    fn new<B: UncertainBrake>(study: &Study<'_, B>, scenes: &[usize]) -> Result<Self, ValidationError> {
        let plan = study.plan();
        let mut result = Self::default();
        for &scene in scenes {
            let start = Instant::now();
            let mut family = OneParameterFamily::new(study.brake(), &plan.scenes[scene], &QrSolver)?;
            let found = exact(&study.references()[scene], &mut family)?;
            result.seconds += start.elapsed().as_secs_f64();
            result.spectra += found.counters.eigenvalue_solves;
            result.bound = result.bound.max(found.error);
            let near = near_coalescence(&study.references()[scene], &found, &mut family)?;
            for (&name, occurrence) in &found.integral.occurrences {
                let value = 0.5 * (occurrence.lower + occurrence.upper);
                result.occurrences.push(Exactly { scene, name, value, is_near: near.contains(&name) });
            }
            result.near.extend(near.into_iter().map(|name| (scene, name)));
        }
        Ok(result)
    }

    /// Time and largest errors of an estimator that is `run` on each scene.
    fn measure(
        &self,
        estimator: &'static str,
        samples: u64,
        scenes: &[usize],
        run: &dyn Fn(usize) -> Result<SceneEstimate, ValidationError>,
    ) -> Result<EstimatorAccuracy, ValidationError> {
        let count = scenes.len() as f64;
        let start = Instant::now();
        let found =
            scenes.iter().map(|&scene| Ok((scene, run(scene)?))).collect::<Result<Vec<_>, ValidationError>>()?;
        Ok(EstimatorAccuracy {
            estimator,
            samples,
            seconds: start.elapsed().as_secs_f64() / count,
            spectra: found.iter().map(|(_, one)| one.spectra).sum::<u64>() as f64 / count,
            max_error_away: self.largest_error(&found, false),
            max_error_near: self.largest_error(&found, true),
        })
    }

    /// The largest error among the modes near a coalescence, or among the others.
    fn largest_error(&self, found: &[(usize, SceneEstimate)], is_near: bool) -> f64 {
        let mut largest: f64 = 0.0;
        for one in self.occurrences.iter().filter(|one| one.is_near == is_near) {
            if let Some((_, estimate)) = found.iter().find(|(scene, _)| *scene == one.scene) {
                let [lower, upper] = estimate.of(one.name);
                largest = largest.max((lower - one.value).abs()).max((upper - one.value).abs());
            }
        }
        // Modes that are never unstable, for which the estimator gives an occurrence.
        for (scene, estimate) in found {
            for &(name, [_, upper]) in &estimate.occurrences {
                let is_known = self.occurrences.iter().any(|one| one.scene == *scene && one.name == name);
                if !is_known && self.near.contains(&(*scene, name)) == is_near {
                    largest = largest.max(upper);
                }
            }
        }
        largest
    }
}

/// The result of an estimator for one scene.
struct SceneEstimate {
    occurrences: Vec<(ModeLabel, [f64; 2])>,
    spectra: u64,
}

impl SceneEstimate {
    fn expanded<B: UncertainBrake>(
        study: &Study<'_, B>,
        scene: usize,
        order: TaylorOrder,
    ) -> Result<Self, ValidationError> {
        let plan = study.plan();
        let mut family = OneParameterFamily::new(study.brake(), &plan.scenes[scene], &QrSolver)?;
        let Integral { occurrences, .. } = perturbation(&study.references()[scene], &mut family, order)?;
        let occurrences = occurrences.into_iter().map(|(name, o)| (name, [o.lower, o.upper])).collect();
        Ok(Self { occurrences, spectra: family.counters().eigenvalue_solves })
    }

    fn sampled(estimates: &Estimates) -> Self {
        let of = |(&name, e): (&ModeLabel, &Estimated)| (name, [e.occurrence.lower, e.occurrence.upper]);
        let spectra = estimates.counters.eigenvalue_solves;
        Self { occurrences: estimates.modes.iter().map(of).collect(), spectra }
    }

    fn of(&self, name: ModeLabel) -> [f64; 2] {
        self.occurrences.iter().find(|(n, _)| *n == name).map_or([0.0; 2], |(_, limits)| *limits)
    }
}
