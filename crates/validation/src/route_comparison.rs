//! A comparison of solver routes: time against error, away from coalescence and near it.

use std::time::Instant;

use linsys::SecondOrder;
use num_complex::Complex;
use serde::Serialize;

use crate::problem::ReferenceProblem;
use crate::routes::{relative_errors, routes};

/// Number of times that a route solves its systems, of which the median time is reported; chosen.
const SOLVES_TIMED: usize = 5;

/// A route on one set of systems.
#[derive(Debug, Clone, Serialize)]
pub struct RouteAccuracy {
    /// The route.
    pub route: &'static str,
    /// The systems.
    pub systems: String,
    /// The systems are near a coalescence.
    pub near_coalescence: bool,
    /// Degrees of freedom.
    pub n: usize,
    /// Internal states.
    pub states: usize,
    /// Median time of one system, microseconds.
    pub us: f64,
    /// Number of systems.
    pub count: usize,
    /// Number of systems that the route did not solve.
    pub failed: usize,
    /// Largest relative error of an oscillating eigenvalue of the systems solved.
    pub max_error: f64,
}

/// Systems that routes are compared on, with their reference eigenvalues.
pub struct SystemGroup {
    /// Description of the systems.
    pub systems: String,
    /// The systems are near a coalescence.
    pub near_coalescence: bool,
    /// The systems, of one shape.
    pub problems: Vec<ReferenceProblem>,
}

/// Measures each route on each group of systems against their refined eigenvalues.
pub fn compare_routes(groups: &[SystemGroup]) -> Vec<RouteAccuracy> {
    let mut rows = Vec::new();
    for SystemGroup { systems, near_coalescence, problems } in groups {
        let all: Vec<SecondOrder> = problems.iter().map(|problem| problem.system.clone()).collect();
        let Some(first) = all.first() else { continue };
        for route in routes() {
            let mut times: Vec<f64> = Vec::with_capacity(SOLVES_TIMED);
            let mut spectra = Vec::new();
            for _ in 0..SOLVES_TIMED {
                let start = Instant::now();
                spectra = (route.solve)(&all);
                times.push(start.elapsed().as_secs_f64() * 1e6 / all.len() as f64);
            }
            times.sort_by(f64::total_cmp);
            let errors = problems.iter().zip(&spectra).map(|(problem, found)| largest_error(problem, found.as_deref()));
            rows.push(RouteAccuracy {
                route: route.name,
                systems: systems.clone(),
                near_coalescence: *near_coalescence,
                n: first.order(),
                states: first.states(),
                us: times[SOLVES_TIMED / 2],
                count: all.len(),
                failed: spectra.iter().filter(|found| found.is_none()).count(),
                max_error: errors.fold(0.0, f64::max),
            });
        }
    }
    rows
}

/// The largest relative error of an oscillating eigenvalue; 0 where none was found.
fn largest_error(problem: &ReferenceProblem, found: Option<&[Complex<f64>]>) -> f64 {
    let wanted: Vec<_> = problem.reference.iter().map(|refined| refined.lambda).filter(|l| l.im > 0.0).collect();
    let errors = found.map(|found| relative_errors(&wanted, found)).unwrap_or_default();
    errors.into_iter().fold(0.0, f64::max)
}
