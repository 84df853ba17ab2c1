//! The eigenvalues in a rectangle of a system that is small enough for its whole spectrum.

use cea::CeaError;
use cea::certified::{self, Certified, CertifiedEigenvalue, CertifiedError, certify, solve};
use linsys::{Internal, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::argument::{Around, Counting};
use super::disc::Problem;
use super::scaling::Scaled;
use super::types::{Counters, Eigenpair, Found, Known, Rectangle};
use crate::{SparseError, SparseSecondOrder};

/// Steps outwards from the circle around the rectangle at which a circle is tried, as fractions of its radius; chosen: near circles have few further
/// eigenvalues inside, and one of those that are far is clear of all.
const OUTWARDS: [f64; 10] = [0.0, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0];
/// Radius of the circle about zero that stands for one around the rectangle, if this goes farther from zero, as a multiple of the largest eigenvalue;
/// chosen: any number well above 1, as nothing lies beyond.
const BEYOND: f64 = 2.0;

/// Eigenpairs of a system in a rectangle that the dense solver certifies, counted once more by the argument principle; `None` where it does not
/// find the spectrum: it is to be searched then.
///
/// # Errors
/// Q singular at every lambda; another count than the list has.
pub(super) fn certified_in(system: &SparseSecondOrder, rectangle: &Rectangle) -> Result<Option<Found>, SparseError> {
    let dense = dense(system)?;
    let mut computed = certified::Counters::default();
    let found = solve(&dense, &mut computed).and_then(|spectrum| certify(&dense, &spectrum, &mut computed));
    let Certified { eigenvalues, .. } = match found {
        Err(
            CertifiedError::NoConvergence { .. } | CertifiedError::Range { .. } | CertifiedError::NoEigenvector { .. },
        ) => {
            return Ok(None);
        }
        found => found.map_err(CeaError::from)?,
    };
    let scaled = Scaled::new(system);
    let reach_of = |e: &CertifiedEigenvalue| reach(e.lambda, e.bound, scaled.gamma);
    let known: Vec<_> = eigenvalues.iter().map(|e| Known { lambda: e.lambda, bound: reach_of(e) }).collect();
    let problem = Problem::new(&scaled.system)?;
    let mut counting = Counting::new(&problem, scaled.gamma, true);
    let largest = known.iter().map(|k| k.lambda.norm()).fold(0.0, f64::max);
    let end = BEYOND * if largest > 0.0 { largest } else { scaled.gamma };
    let (centre, radius) = match rectangle.reach() < end {
        true => (rectangle.centre(), rectangle.half_diagonal()),
        false => (Complex::default(), end),
    };
    let radii = OUTWARDS.map(|t| radius * (1.0 + t));
    counting.add(&Around { centre, radii: &radii, known: &known, is_all: true })?;
    let count = counting.done();
    let inside = eigenvalues.into_iter().filter(|e| rectangle.contains(e.lambda, reach_of(e)));
    let n = system.order();
    let pair = |e: CertifiedEigenvalue| {
        let on_border = rectangle.border_distance(e.lambda) <= reach_of(&e);
        let [right, left] = [e.right, e.left].map(|vector| shape(vector, n));
        let CertifiedEigenvalue { lambda, backward_error, condition, bound, verdict, .. } = e;
        Eigenpair { lambda, right, left, backward_error, condition, bound, verdict, on_border }
    };
    let mut pairs: Vec<_> = inside.map(pair).collect();
    pairs.sort_by(|a, b| cea::by_frequency(&a.lambda, &b.lambda));
    Ok(Some(Found { pairs, discs: Vec::new(), reach: None, is_certified: true, count, counters: Counters::default() }))
}

/// Distance of an eigenvalue from the exact one, at most: its bound, or where nothing encloses it what rounding moves a double one by.
pub(super) fn reach(lambda: Complex<f64>, bound: f64, gamma: f64) -> f64 {
    if bound.is_finite() { bound } else { f64::EPSILON.sqrt() * lambda.norm().max(gamma) }
}

/// The displacements of a vector that may have internal states too, unit 2-norm.
fn shape(vector: DVector<Complex<f64>>, n: usize) -> DVector<Complex<f64>> {
    if vector.len() == n {
        return vector;
    }
    let mut shape = vector.rows(0, n).into_owned();
    let norm = shape.norm();
    if norm > 0.0 {
        shape.unscale_mut(norm);
    }
    cea::fix_phase(&mut shape);
    shape
}

fn dense(system: &SparseSecondOrder) -> Result<SecondOrder, SparseError> {
    let mut internal = Internal::zeros(system.order(), system.states.len());
    for (i, state) in system.states.iter().enumerate() {
        internal.decay[i] = state.decay;
        state.drive.iter().for_each(|&(dof, value)| internal.drive[(i, dof)] += value);
        state.force.iter().for_each(|&(dof, value)| internal.force[(dof, i)] += value);
    }
    let [m, c, k] = [&system.m, &system.c, &system.k].map(DMatrix::from);
    Ok(SecondOrder::with_internal(m, c, k, internal)?)
}
