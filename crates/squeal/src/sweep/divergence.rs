//! Onsets of divergence: parameters at which a real eigenvalue crosses zero, where the stiffness is singular.
//!
//! At zero `Q = K`, and with M positive definite `det K < 0` where an odd number of real eigenvalues is above zero. So a sign of det K
//! that changes between two places brackets an onset, which bisection finds to the last bits. Two onsets between neighbouring places,
//! and modes that cross zero in pairs, do not change the sign and are not seen.

use cea::{Workspace, left_vector, right_vector};
use linsys::SecondOrder;
use nalgebra::DMatrix;
use num_complex::Complex;

use super::family::{DIFFERENCE, Part};
use super::onset::SweepOnset;
use super::parameter::SweptParameter;
use crate::Error;
use crate::study::UncertainBrake;

/// The name in place of that of a mode.
const DIVERGENCE: &str = "divergence";
/// Equal steps of the range at whose ends the sign is looked at, beside the places of spectra; chosen: a factorisation is cheap.
const STEPS: usize = 64;
/// Smallest pivot, as a part of the largest, of a stiffness that has a sign; chosen: a free body's has none.
const SINGULAR: f64 = 1e-12;
/// Halvings of a step: down to the last bit.
const HALVINGS: usize = 60;
/// Rounding of a product with K, in units of epsilon and its norm; chosen.
const ROUNDINGS: f64 = 8.0;

/// What is found of one sector.
#[derive(Debug, Default)]
pub(super) struct Divergences {
    /// Ascending.
    pub onsets: Vec<SweepOnset>,
    /// Whether an odd number of real eigenvalues is above zero at the lower end.
    pub at_start: bool,
}

/// The onsets of divergence of a sector between the ends of the range of the parameter; `places` of it are looked at too.
///
/// # Errors
/// Those of the brake, and of vectors at an onset.
pub(super) fn divergences<B: UncertainBrake>(
    part: &Part<'_, B>,
    parameter: &SweptParameter,
    places: &[f64],
) -> Result<Divergences, Error> {
    let mut all: Vec<f64> = (0..=STEPS).map(|step| step as f64 / STEPS as f64).chain(places.iter().copied()).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    let mut signs = Vec::with_capacity(all.len());
    for &at in &all {
        let determinant = Determinant::of(&part.system(&[at])?);
        signs.extend(determinant.filter(|it| it.smallest > SINGULAR).map(|it| (at, it.is_positive)));
    }
    let mut found = Divergences { at_start: signs.first() == Some(&(0.0, false)), ..Divergences::default() };
    for step in signs.windows(2).filter(|step| step[0].1 != step[1].1) {
        found.onsets.push(onset(part, parameter, [step[0].0, step[1].0], step[0].1)?);
    }
    Ok(found)
}

/// What a factorisation says of det K.
struct Determinant {
    is_positive: bool,
    /// The smallest pivot, as a part of the largest.
    smallest: f64,
}

impl Determinant {
    /// `None` where it vanishes.
    fn of(system: &SecondOrder) -> Option<Self> {
        let k = stiffness(system);
        let scale: Vec<f64> = k.row_iter().map(|row| row.amax().sqrt()).collect();
        if scale.contains(&0.0) {
            return None;
        }
        let lu = DMatrix::from_fn(k.nrows(), k.ncols(), |i, j| k[(i, j)] / scale[i] / scale[j]).lu();
        let (pivots, swaps) = (lu.u().diagonal(), lu.p().determinant::<f64>());
        let negative = pivots.iter().filter(|pivot| **pivot < 0.0).count();
        let smallest = pivots.abs().min() / pivots.amax();
        (smallest > 0.0).then_some(Self { is_positive: negative.is_multiple_of(2) == (swaps > 0.0), smallest })
    }
}

/// K, with what internal states leave of it at rest.
fn stiffness(system: &SecondOrder) -> DMatrix<f64> {
    system.dynamic_stiffness(Complex::default()).map(|entry| entry.re)
}

/// The onset between two places with different signs.
fn onset<B: UncertainBrake>(
    part: &Part<'_, B>,
    parameter: &SweptParameter,
    [mut low, mut high]: [f64; 2],
    is_positive: bool,
) -> Result<SweepOnset, Error> {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match Determinant::of(&part.system(&[middle])?) {
            None => [low, high] = [middle, middle],
            Some(here) if here.is_positive == is_positive => low = middle,
            Some(_) => high = middle,
        }
        if high - low <= f64::EPSILON * high {
            break;
        }
    }
    let at = 0.5 * (low + high);
    let (system, zero, mut work) = (part.system(&[at])?, Complex::default(), Workspace::default());
    let (x, y) = (right_vector(&system, zero, &mut work)?, left_vector(&system, zero, &mut work)?);
    let [below, above] = [(at - DIFFERENCE).max(0.0), (at + DIFFERENCE).min(1.0)];
    let change = part.system(&[above])?.dynamic_stiffness(zero) - part.system(&[below])?.dynamic_stiffness(zero);
    let change = y.dotc(&(change * &x)) / (above - below);
    // lambda = -change / slope beside the onset; a mode without damping is on the axis before it, and no sweep ends there.
    let slope = y.dotc(&(system.dynamic_stiffness_derivative(zero) * &x));
    let error = ROUNDINGS * f64::EPSILON * stiffness(&system).norm() / change.norm() + (high - low);
    Ok(SweepOnset {
        at: parameter.at(at),
        error: error * parameter.slope(at),
        omega: 0.0,
        starts: (-change / slope).re > 0.0,
        mode: DIVERGENCE.to_owned(),
        moved: None,
    })
}
