//! Timing in rounds, each of which runs every route once, so that a disturbance affects all routes. The times are processor times
//! of the thread, on which other processes have little effect.

use cpu_time::ThreadTime;
use num_complex::Complex;
use serde::Serialize;
use squeal::montecarlo::quantile;
use validation::{Spectra, relative_errors};

use super::problems::Problem;
use super::python::Python;
use super::routes::{DGEEV_ROUTE_NAME, routes};
use super::secular::SECULAR_ROUTE_NAME;
use crate::error::TaskError;

/// A route on one size of problem.
#[derive(Debug, Clone, Serialize)]
pub struct RouteTime {
    /// The route.
    pub route: String,
    /// Degrees of freedom.
    pub n: usize,
    /// Internal states.
    pub states: usize,
    /// Median processor time of one problem, microseconds.
    pub us: f64,
    /// Quartiles of that time.
    pub us_quartiles: [f64; 2],
    /// Median over the rounds of the ratio of the time to the time of dgeev; `null` where dgeev is not built in.
    pub ratio_to_dgeev: Option<f64>,
    /// Largest relative error of a wanted eigenvalue, infinite where one is missing; `null` where no system with known
    /// eigenvalues was solved.
    pub max_error: Option<f64>,
    /// Number of problems in a round.
    pub problems: usize,
    /// Number of problems that the route did not solve.
    pub failed: usize,
}

/// The name of a route, its eigenvalues, and its times, one per round, seconds.
struct Timed {
    name: String,
    spectra: Spectra,
    seconds: Vec<f64>,
}

/// Times each route on one problem, including those of Python where it could be started.
///
/// # Errors
/// The Python process ended.
pub fn measure(problem: &Problem, python: Option<&mut Python>, rounds: usize) -> Result<Vec<RouteTime>, TaskError> {
    let routes = routes();
    // The first call of each route gives the eigenvalues, and warms up memory and caches.
    let mut timed: Vec<Timed> = routes
        .iter()
        .map(|r| Timed { name: r.name.into(), spectra: (r.solve)(&problem.systems), seconds: Vec::new() })
        .collect();
    if let Some(growing) = &problem.growing {
        timed.push(Timed { name: SECULAR_ROUTE_NAME.into(), spectra: growing.solve(), seconds: Vec::new() });
    }
    let own = timed.len();
    let mut python = python;
    if let Some(python) = &python {
        let baselines = python.routes.iter().zip(&python.spectra);
        timed.extend(baselines.map(|(name, spectra)| Timed {
            name: name.clone(),
            spectra: spectra.clone(),
            seconds: Vec::new(),
        }));
    }
    for _ in 0..rounds {
        let (own, baselines) = timed.split_at_mut(own);
        let growing = problem.growing.iter().map(|growing| Box::new(|| growing.solve()) as Box<dyn Fn() -> Spectra>);
        let solve = routes.iter().map(|route| Box::new(|| (route.solve)(&problem.systems)) as Box<dyn Fn() -> Spectra>);
        for (solve, timed) in solve.chain(growing).zip(own) {
            let start = ThreadTime::now();
            std::hint::black_box(solve());
            timed.seconds.push(start.elapsed().as_secs_f64());
        }
        if let Some(python) = &mut python {
            for (at, timed) in baselines.iter_mut().enumerate() {
                timed.seconds.push(python.time(at).map_err(TaskError::Python)?);
            }
        }
    }
    let dgeev = timed.iter().find(|t| t.name == DGEEV_ROUTE_NAME).map(|t| t.seconds.clone());
    timed.iter().map(|timed| row(problem, timed, dgeev.as_deref())).collect()
}

fn row(problem: &Problem, timed: &Timed, dgeev: Option<&[f64]>) -> Result<RouteTime, TaskError> {
    let per_problem = 1e6 / problem.systems.len() as f64;
    let us = sorted(timed.seconds.iter().map(|s| s * per_problem));
    let ratios = dgeev.map(|dgeev| sorted(timed.seconds.iter().zip(dgeev).map(|(own, dgeev)| own / dgeev)));
    Ok(RouteTime {
        route: timed.name.clone(),
        n: problem.n,
        states: problem.states,
        us: quantile(&us, 0.5)?,
        us_quartiles: [quantile(&us, 0.25)?, quantile(&us, 0.75)?],
        ratio_to_dgeev: ratios.map(|ratios| quantile(&ratios, 0.5)).transpose()?,
        max_error: max_error(&wanted(problem, timed), &timed.spectra),
        problems: problem.systems.len(),
        failed: timed.spectra.iter().filter(|spectrum| spectrum.is_none()).count(),
    })
}

/// The eigenvalues that a route is to find.
fn wanted(problem: &Problem, timed: &Timed) -> Vec<Vec<Complex<f64>>> {
    let is_wanted = |lambda: &&Complex<f64>| timed.name != SECULAR_ROUTE_NAME || lambda.re > 0.0 && lambda.im > 0.0;
    problem.references.iter().map(|all| all.iter().filter(is_wanted).copied().collect()).collect()
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The largest relative error of the eigenvalues of the systems that were solved, each compared as a set.
fn max_error(references: &[Vec<Complex<f64>>], spectra: &Spectra) -> Option<f64> {
    let solved = references.iter().zip(spectra).filter_map(|(wanted, found)| Some((wanted, found.as_ref()?)));
    solved.flat_map(|(wanted, found)| relative_errors(wanted, found)).reduce(f64::max)
}
