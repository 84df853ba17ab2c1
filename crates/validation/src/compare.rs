//! What is measured: routes and estimators, time against error, away from coalescence and near it.

use std::collections::BTreeSet;
use std::time::Instant;

use cea::QrSolver;
use linsys::SecondOrder;
use num_complex::Complex;
use serde::Serialize;
use squeal::estimators::{Estimates, monte_carlo, quasi_monte_carlo};
use squeal::estimators::{Integral, OneParameterFamily, exact};
use squeal::study::Study;

use crate::ValidationError;
use crate::near::near_coalescence;
use crate::perturbation::TaylorOrder;
use crate::perturbation::perturbation;
use crate::routes::{relative_errors, routes};
use crate::worst::HardCase;

/// Times that a route solves its systems; the median counts.
const REPEATS: usize = 5;

/// A route on one set of systems.
#[derive(Debug, Clone, Serialize)]
pub struct RouteRow {
    /// The route.
    pub route: &'static str,
    /// The systems.
    pub systems: String,
    /// Whether they are near a coalescence.
    pub near_coalescence: bool,
    /// Degrees of freedom.
    pub n: usize,
    /// Internal states.
    pub states: usize,
    /// Median time of one system, microseconds.
    pub us: f64,
    /// Systems.
    pub count: usize,
    /// Those among them that the route did not solve.
    pub failed: usize,
    /// Largest relative error of an oscillating eigenvalue of the systems solved.
    pub max_error: f64,
}

/// An estimator of occurrences.
#[derive(Debug, Clone, Serialize)]
pub struct EstimatorRow {
    /// Which, without its size.
    pub estimator: &'static str,
    /// Samples per scene; 0 where there are none.
    pub samples: u64,
    /// Mean time of a scene, seconds.
    pub seconds: f64,
    /// Mean number of spectra per scene.
    pub spectra: f64,
    /// Largest error of an occurrence of a mode whose expansion no coalescence ends before the onset.
    pub max_error_away: f64,
    /// Largest error of an occurrence of the other modes.
    pub max_error_near: f64,
}

/// All estimators on some scenes.
#[derive(Debug, Clone, Serialize)]
pub struct Estimators {
    /// Scenes, one for each class of arrangements chosen.
    pub scenes: usize,
    /// Occurrences compared away from coalescence, and near it.
    pub occurrences: [usize; 2],
    /// Largest bound of the exact integral's own error.
    pub reference_bound: f64,
    /// Samples with which plain Monte Carlo has the worst of these occurrences to 0.1 percentage points, 95 %.
    pub samples_to_a_tenth_of_a_point: f64,
    /// One row per estimator and size.
    pub rows: Vec<EstimatorRow>,
}

/// Each route on each group of systems; the eigenvalues refined are the reference.
pub fn compare_routes(groups: &[(String, bool, Vec<HardCase>)]) -> Vec<RouteRow> {
    let mut rows = Vec::new();
    for (systems, near_coalescence, cases) in groups {
        let all: Vec<SecondOrder> = cases.iter().map(|case| case.system.clone()).collect();
        let Some(first) = all.first() else { continue };
        for route in routes() {
            let mut times: Vec<f64> = Vec::with_capacity(REPEATS);
            let mut spectra = Vec::new();
            for _ in 0..REPEATS {
                let start = Instant::now();
                spectra = (route.solve)(&all);
                times.push(start.elapsed().as_secs_f64() * 1e6 / all.len() as f64);
            }
            times.sort_by(f64::total_cmp);
            let of_case = |(case, found): (&HardCase, &Option<Vec<Complex<f64>>>)| {
                let wanted: Vec<_> = case.reference.iter().map(|r| r.lambda).filter(|l| l.im > 0.0).collect();
                let errors = found.as_ref().map(|found| relative_errors(&wanted, found)).unwrap_or_default();
                errors.into_iter().fold(0.0, f64::max)
            };
            rows.push(RouteRow {
                route: route.name,
                systems: systems.clone(),
                near_coalescence: *near_coalescence,
                n: first.order(),
                states: first.states(),
                us: times[REPEATS / 2],
                count: all.len(),
                failed: spectra.iter().filter(|found| found.is_none()).count(),
                max_error: cases.iter().zip(&spectra).map(of_case).fold(0.0, f64::max),
            });
        }
    }
    rows
}

/// An occurrence of the reference: scene, name, value, and whether its onset is near a coalescence.
struct Wanted {
    scene: usize,
    name: u16,
    value: f64,
    is_near: bool,
}

/// Each estimator on some scenes of shared Coulomb friction, with these numbers of samples.
///
/// # Errors
/// Those of the estimators.
pub fn compare_estimators(
    study: &Study<'_>,
    scenes: &[usize],
    plain: &[u64],
    quasi: &[u32],
    scramblings: u32,
) -> Result<Estimators, ValidationError> {
    let plan = study.plan();
    let mut result = Estimators {
        scenes: scenes.len(),
        occurrences: [0, 0],
        reference_bound: 0.0,
        samples_to_a_tenth_of_a_point: 0.0,
        rows: Vec::new(),
    };
    let mut wanted: Vec<Wanted> = Vec::new();
    let mut all_near: BTreeSet<(usize, u16)> = BTreeSet::new();
    let (mut seconds, mut spectra) = (0.0, 0);
    for &scene in scenes {
        let start = Instant::now();
        let mut family = OneParameterFamily::new(plan, &plan.scenes[scene], &QrSolver)?;
        let found = exact(plan, &study.references()[scene], &mut family)?;
        seconds += start.elapsed().as_secs_f64();
        spectra += found.counters.eigenvalue_solves;
        result.reference_bound = result.reference_bound.max(found.error);
        let near = near_coalescence(plan, &study.references()[scene], &found, &mut family)?;
        for (&name, occurrence) in &found.integral.occurrences {
            let value = 0.5 * (occurrence.lower + occurrence.upper);
            let is_near = near.contains(&name);
            result.occurrences[usize::from(is_near)] += 1;
            let needed = value * (1.0 - value) * (1.96_f64 / 1e-3).powi(2);
            result.samples_to_a_tenth_of_a_point = result.samples_to_a_tenth_of_a_point.max(needed);
            wanted.push(Wanted { scene, name, value, is_near });
        }
        all_near.extend(near.into_iter().map(|name| (scene, name)));
    }
    let count = scenes.len() as f64;
    result.rows.push(EstimatorRow {
        estimator: "exact integral",
        samples: 0,
        seconds: seconds / count,
        spectra: spectra as f64 / count,
        max_error_away: result.reference_bound,
        max_error_near: result.reference_bound,
    });

    let mut measure = |estimator, samples, run: &dyn Fn(usize) -> Result<Found, ValidationError>| {
        let start = Instant::now();
        let found =
            scenes.iter().map(|&scene| Ok((scene, run(scene)?))).collect::<Result<Vec<_>, ValidationError>>()?;
        let seconds = start.elapsed().as_secs_f64() / count;
        let error = |is_near: bool| {
            let of = |w: &Wanted| {
                let (_, found) = found.iter().find(|(scene, _)| *scene == w.scene)?;
                let [lower, upper] = found.of(w.name);
                Some((lower - w.value).abs().max((upper - w.value).abs()))
            };
            let missed = wanted.iter().filter(|w| w.is_near == is_near).filter_map(of).fold(0.0, f64::max);
            // A mode that is never unstable and was said to be.
            let is_known = |scene: usize, name: u16| wanted.iter().any(|w| w.scene == scene && w.name == name);
            let is_invented =
                |scene: usize, name: u16| !is_known(scene, name) && all_near.contains(&(scene, name)) == is_near;
            let invented = found.iter().flat_map(|(scene, f)| {
                f.occurrences.iter().filter(|(name, _)| is_invented(*scene, *name)).map(|(_, [_, upper])| *upper)
            });
            invented.fold(missed, f64::max)
        };
        let spectra = found.iter().map(|(_, f)| f.spectra).sum::<u64>() as f64 / count;
        let (max_error_away, max_error_near) = (error(false), error(true));
        result.rows.push(EstimatorRow { estimator, samples, seconds, spectra, max_error_away, max_error_near });
        Ok::<_, ValidationError>(())
    };
    for (estimator, order) in
        [("perturbation, first order", TaylorOrder::First), ("perturbation, second order", TaylorOrder::Second)]
    {
        measure(estimator, 0, &|scene| {
            let mut family = OneParameterFamily::new(plan, &plan.scenes[scene], &QrSolver)?;
            let integral = perturbation(plan, &study.references()[scene], &mut family, order)?;
            Ok(Found::integral(&integral, family.counters().eigenvalue_solves))
        })?;
    }
    for &samples in plain {
        measure("Monte Carlo", samples, &|scene| Ok(Found::sampled(&monte_carlo(study, scene, 1, samples)?)))?;
    }
    for &points in quasi {
        let samples = u64::from(points) * u64::from(scramblings);
        measure("quasi-Monte Carlo", samples, &|scene| {
            Ok(Found::sampled(&quasi_monte_carlo(study, scene, 1, points, scramblings)?))
        })?;
    }
    Ok(result)
}

/// What an estimator says of one scene.
struct Found {
    occurrences: Vec<(u16, [f64; 2])>,
    spectra: u64,
}

impl Found {
    fn integral(integral: &Integral, spectra: u64) -> Self {
        let occurrences = integral.occurrences.iter().map(|(&name, o)| (name, [o.lower, o.upper])).collect();
        Self { occurrences, spectra }
    }

    fn sampled(estimates: &Estimates) -> Self {
        let of = |(&name, e): (&u16, &squeal::estimators::Estimated)| (name, [e.occurrence.lower, e.occurrence.upper]);
        let spectra = estimates.counters.eigenvalue_solves;
        Self { occurrences: estimates.modes.iter().map(of).collect(), spectra }
    }

    fn of(&self, name: u16) -> [f64; 2] {
        self.occurrences.iter().find(|(n, _)| *n == name).map_or([0.0; 2], |(_, limits)| *limits)
    }
}
