//! How far from zero an eigenvalue can be, so that a rectangle need not be searched beyond.

use nalgebra_sparse::CscMatrix;

use crate::symmetric::{Factor, nearest_to_zero, scaled_part, scales, shifted};
use crate::{SparseError, SparseSecondOrder};

/// Parts of the smallest eigenvalue found that are tried as lower bounds; chosen.
const PARTS: [f64; 4] = [0.9, 0.5, 0.1, 0.01];
/// For the rounding of norms.
const MARGIN: f64 = 1.0 + 1e-9;

/// The largest `sqrt(K_ii / M_ii)`, rad/s: a rectangle that ends below it ends below what [`reach`] can say.
pub(super) fn least_reach(system: &SparseSecondOrder) -> f64 {
    let diagonal = |a: &CscMatrix<f64>| {
        let mut values = vec![0.0; a.nrows()];
        a.triplet_iter().filter(|(row, column, _)| row == column).for_each(|(row, _, value)| values[row] += value);
        values
    };
    let ratios = diagonal(&system.k).into_iter().zip(diagonal(&system.m)).map(|(k, m)| k.abs() / m.abs());
    ratios.filter(|ratio| ratio.is_finite()).fold(0.0, f64::max).sqrt()
}

/// R with |lambda| <= R for every eigenvalue, rad/s; `None` where the symmetric part of M is not positive definite.
///
/// With the diagonal D of M and `x^H D x = 1`, `lambda^2 x^H M x + lambda x^H C x + x^H K x = 0` for an eigenvector x, and
/// `Re x^H M x >= tau` where the symmetric part of `M - tau D` has no negative eigenvalue, by its factorisation. So
/// `|lambda|^2 tau <= |lambda| c + k` with bounds c and k of the other forms. Of an internal state, `|lambda / (lambda + a)| <= 2`
/// where `|lambda| >= 2 a`.
///
/// # Errors
/// A factorisation that does not fit into memory.
pub(super) fn reach(system: &SparseSecondOrder) -> Result<Option<f64>, SparseError> {
    let scale = scales(&system.m);
    let (rows, mass) = scaled_part(&system.m);
    if rows.len() < system.order() {
        return Ok(None);
    }
    let Ok((nearest, _)) = nearest_to_zero(&mass, &Factor::new(&mass)?, 1.min(rows.len())) else { return Ok(None) };
    let Some(least) = nearest.first().copied().filter(|least| *least > 0.0) else { return Ok(None) };
    let mut tau = None;
    for part in PARTS {
        if Factor::new(&shifted(&mass, -part * least))?.negative() == Some(0) {
            tau = Some(part * least);
            break;
        }
    }
    let Some(tau) = tau else { return Ok(None) };
    let side =
        |side: &[(usize, f64)]| side.iter().map(|&(dof, value)| (value / scale[dof]).powi(2)).sum::<f64>().sqrt();
    let states: f64 = system.states.iter().map(|state| 2.0 * side(&state.drive) * side(&state.force)).sum();
    let slowest = system.states.iter().map(|state| 2.0 * state.decay.abs()).fold(0.0, f64::max);
    let (c, k) = (form_bound(&system.c, &scale), form_bound(&system.k, &scale) + states);
    let reach = (c + (c * c + 4.0 * tau * k).sqrt()) / (2.0 * tau) * MARGIN;
    Ok(Some(reach.max(slowest)).filter(|reach| reach.is_finite()))
}

/// A bound of `|x^H A x|` for all x with `sum_i |s_i x_i|^2 = 1`: the geometric mean of the largest sums of rows and columns.
fn form_bound(a: &CscMatrix<f64>, scale: &[f64]) -> f64 {
    let (mut rows, mut columns) = (vec![0.0; a.nrows()], vec![0.0; a.nrows()]);
    for (row, column, value) in a.triplet_iter() {
        let size = value.abs() / scale[row] / scale[column];
        rows[row] += size;
        columns[column] += size;
    }
    let largest = |sums: Vec<f64>| sums.into_iter().fold(0.0, f64::max);
    (largest(rows) * largest(columns)).sqrt()
}
