//! Divergence: a real eigenvalue crosses zero where the stiffness is singular.
//!
//! At zero `Q = K`, and with M positive definite `det K < 0` where an odd number of real eigenvalues is above zero. So a sign of det K
//! that changes between two places brackets an onset, which bisection finds to the last bits. Two onsets between neighbouring places,
//! and modes that cross zero in pairs, do not change the sign and are not seen. Where growth counts from a rate g on, the same holds
//! of `Q(g) = g^2 M + g C + K` and the real eigenvalues above g.

use cea::{Workspace, left_vector, right_vector};
use linsys::SecondOrder;
use nalgebra::DMatrix;
use num_complex::Complex;

use super::family::{DIFFERENCE, Part};
use super::onset::SweepOnset;
use super::parameter::SweptParameter;
use crate::Error;
use crate::study::UncertainBrake;

/// The name in place of that of a mode where a real eigenvalue crosses zero.
pub const DIVERGENCE: &str = "divergence";
/// Equal steps of the range at whose ends the sign is looked at, beside the places of spectra; chosen: a factorisation is cheap.
const STEPS: usize = 64;
/// Smallest pivot, as a part of the largest, of a stiffness that has a sign; chosen: a free body's has none.
const SINGULAR: f64 = 1e-12;
/// Halvings of a step: down to the last bit.
const HALVINGS: usize = 60;
/// Rounding of a product with K, in units of epsilon and its norm; chosen.
const ROUNDINGS: f64 = 8.0;

/// A change of the sign of det K along a line.
#[derive(Debug, Clone, Copy)]
pub(super) struct SignChange {
    /// Where on the line, and how wide the step is that holds it.
    pub at: f64,
    pub width: f64,
    /// Whether det K becomes negative.
    pub to_negative: bool,
}

/// Those along a line from 0 to 1.
#[derive(Debug, Default)]
pub(super) struct SignChanges {
    /// Ascending.
    pub found: Vec<SignChange>,
    /// Whether det K is negative at 0: an odd number of real eigenvalues is above zero.
    pub negative_at_start: bool,
}

/// Where the sign of det Q(growth) changes; `places` of the line are looked at too.
///
/// # Errors
/// Those of the brake.
pub(super) fn sign_changes(
    system: &dyn Fn(f64) -> Result<SecondOrder, Error>,
    growth: f64,
    places: &[f64],
) -> Result<SignChanges, Error> {
    let mut all: Vec<f64> = (0..=STEPS).map(|step| step as f64 / STEPS as f64).chain(places.iter().copied()).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    let mut signs = Vec::with_capacity(all.len());
    for &at in &all {
        signs.extend(sign(&system(at)?, growth).map(|is_positive| (at, is_positive)));
    }
    let mut found = Vec::new();
    for step in signs.windows(2).filter(|step| step[0].1 != step[1].1) {
        found.push(bisected(system, growth, [step[0].0, step[1].0], step[0].1)?);
    }
    Ok(SignChanges { found, negative_at_start: signs.first() == Some(&(0.0, false)) })
}

/// Whether det Q(growth) is positive; `None` where Q is singular there, or nearly.
pub(super) fn sign(system: &SecondOrder, growth: f64) -> Option<bool> {
    Determinant::of(&stiffness(system, growth)).filter(|it| it.smallest > SINGULAR).map(|it| it.is_positive)
}

/// The onsets of divergence of a sector between the ends of the range of the parameter, ascending, and whether an odd number of real
/// eigenvalues is beyond the threshold at the lower end; `places` of the range are looked at too.
///
/// # Errors
/// Those of the brake, and of vectors at an onset.
pub(super) fn divergences<B: UncertainBrake>(
    part: &Part<'_, B>,
    parameter: &SweptParameter,
    places: &[f64],
) -> Result<(Vec<SweepOnset>, bool), Error> {
    let SignChanges { found, negative_at_start } = sign_changes(&|at| part.system(&[at]), part.real_onset(), places)?;
    let onsets = found.iter().map(|change| onset(part, parameter, change)).collect::<Result<_, _>>()?;
    Ok((onsets, negative_at_start))
}

/// What a factorisation says of a determinant.
pub(super) struct Determinant {
    pub is_positive: bool,
    /// The smallest pivot, as a part of the largest.
    smallest: f64,
}

impl Determinant {
    /// `None` where it vanishes.
    pub fn of(k: &DMatrix<f64>) -> Option<Self> {
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

/// Q at a real growth rate, 1/s: at zero K, with what internal states leave of it at rest.
pub(super) fn stiffness(system: &SecondOrder, growth: f64) -> DMatrix<f64> {
    system.dynamic_stiffness(Complex::from(growth)).map(|entry| entry.re)
}

/// The change of sign between two places with different signs.
fn bisected(
    system: &dyn Fn(f64) -> Result<SecondOrder, Error>,
    growth: f64,
    [mut low, mut high]: [f64; 2],
    is_positive: bool,
) -> Result<SignChange, Error> {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match Determinant::of(&stiffness(&system(middle)?, growth)) {
            None => [low, high] = [middle, middle],
            Some(here) if here.is_positive == is_positive => low = middle,
            Some(_) => high = middle,
        }
        if high - low <= f64::EPSILON * high {
            break;
        }
    }
    Ok(SignChange { at: 0.5 * (low + high), width: high - low, to_negative: is_positive })
}

/// The onset at a change of sign.
fn onset<B: UncertainBrake>(
    part: &Part<'_, B>,
    parameter: &SweptParameter,
    &SignChange { at, width, .. }: &SignChange,
) -> Result<SweepOnset, Error> {
    let (system, growth, mut work) = (part.system(&[at])?, part.real_onset(), Workspace::default());
    let lambda = Complex::from(growth);
    let (x, y) = (right_vector(&system, lambda, &mut work)?, left_vector(&system, lambda, &mut work)?);
    let [below, above] = [(at - DIFFERENCE).max(0.0), (at + DIFFERENCE).min(1.0)];
    let change = part.system(&[above])?.dynamic_stiffness(lambda) - part.system(&[below])?.dynamic_stiffness(lambda);
    let change = y.dotc(&(change * &x)) / (above - below);
    // lambda moves by -change / slope beside the onset; a mode without damping is on the axis before it, and no sweep ends there.
    let slope = y.dotc(&(system.dynamic_stiffness_derivative(lambda) * &x));
    let error = ROUNDINGS * f64::EPSILON * stiffness(&system, growth).norm() / change.norm() + width;
    Ok(SweepOnset {
        at: parameter.at(at),
        error: error * parameter.slope(at),
        omega: 0.0,
        starts: (-change / slope).re > 0.0,
        mode: DIVERGENCE.to_owned(),
        moved: None,
        is_reduced: false,
    })
}
