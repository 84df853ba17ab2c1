//! Divergence: a real eigenvalue crosses zero where the stiffness is singular.
//!
//! At zero `Q = K`, and with M positive definite `det K < 0` where an odd number of real eigenvalues is above zero. So a sign of det K
//! that changes between two places brackets an onset, which bisection finds to the last bits. Where growth counts above a rate g, the
//! same holds of `Q(g) = g^2 M + g C + K` and the real eigenvalues above g.

use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::family::DIFFERENCE;
use crate::Error;

/// Name of a crossing of zero by a real eigenvalue, in place of the name of a mode.
pub const DIVERGENCE: &str = "divergence";
/// Name of the change of a growing pair into two real eigenvalues, of curves of a map, in place of the name of a mode.
pub const EXCHANGE: &str = "flutter to divergence";

/// Words for a mode in a sentence: "mode 16", or the name that stands in its place.
pub fn named(mode: &str) -> String {
    if mode == DIVERGENCE || mode == EXCHANGE { mode.to_owned() } else { format!("mode {mode}") }
}
/// Smallest pivot, as a fraction of the largest, of a stiffness whose determinant has a sign; chosen: the stiffness of a free body has none.
const SINGULAR: f64 = 1e-12;
/// Largest singular value of a stiffness that counts as zero, as a fraction of the size of stiffnesses next to it; chosen: with a larger singular value a
/// change of the sign is taken for rounding.
const NULL: f64 = 1e-10;
/// Distance from a place without a sign at which the sign is looked for, as a fraction of the line; chosen.
pub(super) const BESIDE: f64 = 1e-7;
/// Number of halvings of a step: down to the last bit.
const HALVINGS: usize = 60;
/// Rounding of a product with K, in units of epsilon and its norm; chosen.
const ROUNDINGS: f64 = 8.0;

/// A change of the sign of det K along a line.
#[derive(Debug, Clone, Copy)]
pub(super) struct SignChange {
    /// Place on the line, 0 to 1.
    pub at: f64,
    /// Bound of the error of the place by rounding.
    pub error: f64,
}

/// The change of the sign of det Q(growth) between two places of a line; `None` where the sign is the same at both, or Q is singular there, as it is everywhere
/// for a body that is free to move.
///
/// # Errors
/// Those of the brake.
pub(super) fn sign_change(
    system: &dyn Fn(f64) -> Result<SecondOrder, Error>,
    growth: f64,
    ends: [f64; 2],
) -> Result<Option<SignChange>, Error> {
    let mut signs = [None; 2];
    let mut ends = ends;
    for (end, outward) in [(0, -BESIDE), (1, BESIDE)] {
        signs[end] = sign(&system(ends[end])?, growth);
        // An end that is the very place has no sign.
        let beside = ends[end] + outward;
        if signs[end].is_none() && (0.0..=1.0).contains(&beside) {
            (ends[end], signs[end]) = (beside, sign(&system(beside)?, growth));
        }
    }
    let [Some(from), Some(to)] = signs else { return Ok(None) };
    if from == to {
        return Ok(None);
    }
    let (at, width) = bisected(system, growth, ends, from)?;
    let k = |at: f64| Ok::<_, Error>(stiffness(&system(at)?, growth));
    let (there, [first, last]) = (k(at)?, [k(ends[0])?, k(ends[1])?]);
    // The stiffness of a single degree of freedom vanishes as a whole: it is compared with what it is beside.
    let size = there.norm().max(first.norm()).max(last.norm());
    // A sign that rounding gave is no change.
    let Some([x, y]) = null_vectors(there, NULL * size) else { return Ok(None) };
    let [below, above] = [(at - DIFFERENCE).max(0.0), (at + DIFFERENCE).min(1.0)];
    let change = y.dot(&((k(above)? - k(below)?) * &x)) / (above - below);
    let error = ROUNDINGS * f64::EPSILON * size / change.abs() + width;
    Ok(Some(SignChange { at, error }))
}

/// The right and the left singular vector, of unit length, of the smallest singular value of a matrix; `None` where that is above `most`, and of what is no
/// number.
pub(super) fn null_vectors(k: DMatrix<f64>, most: f64) -> Option<[DVector<f64>; 2]> {
    let svd = k.try_svd(true, true, f64::EPSILON, 0)?;
    let least = svd.singular_values.imin();
    let [right, left] = [svd.v_t?.row(least).transpose(), svd.u?.column(least).into_owned()];
    (svd.singular_values[least] <= most).then_some([right, left])
}

/// True if det Q(growth) is positive; `None` where Q is singular there, or nearly.
fn sign(system: &SecondOrder, growth: f64) -> Option<bool> {
    Determinant::of(&stiffness(system, growth)).filter(|it| it.smallest > SINGULAR).map(|it| it.is_positive)
}

/// Sign of a determinant, from a factorisation.
struct Determinant {
    is_positive: bool,
    /// Smallest pivot, as a fraction of the largest.
    smallest: f64,
}

impl Determinant {
    /// The sign of the determinant of k; `None` where it vanishes.
    fn of(k: &DMatrix<f64>) -> Option<Self> {
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

/// Matrix Q at a real growth rate, 1/s: at zero the stiffness K, as internal states at rest leave it.
pub(super) fn stiffness(system: &SecondOrder, growth: f64) -> DMatrix<f64> {
    system.dynamic_stiffness(Complex::from(growth)).map(|entry| entry.re)
}

/// The change of sign between two places with different signs, and the width that is left.
fn bisected(
    system: &dyn Fn(f64) -> Result<SecondOrder, Error>,
    growth: f64,
    [mut low, mut high]: [f64; 2],
    is_positive: bool,
) -> Result<(f64, f64), Error> {
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
    Ok((0.5 * (low + high), high - low))
}
