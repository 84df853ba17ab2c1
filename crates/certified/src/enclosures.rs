//! Counts of eigenvalues by discs: one function for each theorem, with its statement and source.
//!
//! All of them say that zeros move continuously: as a known problem is turned into the given one, none crosses a circle on which
//! the problem stays regular, so that as many are inside at the end as at the beginning. Rounding is in none of them: who
//! asks adds what a number may be wrong by, to a radius or to a size, and says how that is known.
//!
//! | function | what is known | used by |
//! | --- | --- | --- |
//! | [`smith_share`] | values of a polynomial at guesses of all its zeros | `cea::Secular` |
//! | [`block_rouche`], [`pellet`] | a Taylor series of matrices and a bound of its rest | [`certify`](crate::certify) |
//! | [`unions`] | discs that meet | all that count with discs, and groups of eigenvalues that rounding does not tell apart |
//!
//! The bound of first order of one simple eigenvalue (`Measure::second_order_is_small`) stays where it is: its four terms are
//! bounded by norms of the pencil that nothing else knows.

use std::f64::consts::TAU;

use nalgebra::DMatrix;
use num_complex::Complex;

/// Share `|w| / r` of the disc of radius r around a guess z of a zero, w its Weierstrass correction.
///
/// A monic polynomial of degree N with distinct guesses z_i of its zeros is
///
/// ```text
/// p(z) = prod_i (z - z_i) (1 + sum_i w_i / (z - z_i)),    w_i = p(z_i) / prod_{j != i} (z_i - z_j)
/// ```
///
/// (Lagrange; Weierstrass 1891), which does not vanish where `sum |w_i| / |z - z_i| < 1`. So with radii such that the shares of all
/// guesses sum up to less than 1, all zeros are in the discs, and in a union of discs that meets no other as many as it has discs
/// (Smith, J. ACM 17, 1970, for equal shares). With all radii multiplied by their sum, the shares sum up to 1.
#[must_use]
pub fn smith_share(correction: f64, radius: f64) -> f64 {
    correction / radius
}

/// True if `det S(d)` has q zeros with `|d| < radius`, as many as `det (d S_1)`, for every q x q S that differs there from
/// `S_0 + d S_1 + d^2 S_2 + ...` by `error` at most.
///
/// This holds where `|S_1^-1 (S(d) - d S_1)| < |d|` on the circle (Rouché's theorem for matrices: Gohberg and Sigal, Math. USSR Sb. 13,
/// 1971). Norms are Frobenius norms.
#[must_use]
pub fn block_rouche(series: &[DMatrix<Complex<f64>>], radius: f64, error: f64) -> bool {
    let Some(inverse) = series.get(1).and_then(|slope| slope.clone().try_inverse()) else { return false };
    let others = series.iter().enumerate().filter(|(k, _)| *k != 1);
    let others: f64 = others.map(|(k, s)| (&inverse * s).norm() * radius.powi(k as i32)).sum();
    others + inverse.norm() * error < radius
}

/// True if `det S(d)` has `count` zeros with `|d| < radius`, for every q x q S that differs there from `S_0 + d S_1 + ...` by `error`
/// at most: the coefficient of `d^count` in the determinant of the series outweighs the others and what the error changes.
///
/// For a scalar S and no error this is Pellet's theorem (Bull. Sci. Math. 5, 1881). A determinant of q rows of length s changes by
/// `(s + error)^q - s^q` at most.
#[must_use]
pub fn pellet(series: &[DMatrix<Complex<f64>>], count: usize, radius: f64, error: f64) -> bool {
    let Some(first) = series.first() else { return false };
    let size: f64 = series.iter().enumerate().map(|(k, s)| s.norm() * radius.powi(k as i32)).sum();
    let q = first.nrows() as i32;
    let changed = (size + error).powi(q) - size.powi(q);
    let coefficients = determinant(series, radius);
    2.0 * coefficients.get(count).unwrap_or(&0.0) > coefficients.iter().sum::<f64>() + changed
}

/// The absolute coefficients of det S, each times its power of the radius.
fn determinant(series: &[DMatrix<Complex<f64>>], radius: f64) -> Vec<f64> {
    let q = series[0].nrows();
    let scaled = series.iter().enumerate().map(|(k, s)| s * Complex::from(radius.powi(k as i32)));
    if q == 1 {
        return scaled.map(|s| s[(0, 0)].norm()).collect();
    }
    let terms: Vec<_> = scaled.collect();
    // Points enough on the circle for every coefficient.
    let points = (terms.len() - 1) * q + 1;
    let turns: Vec<_> = (0..points).map(|p| Complex::from_polar(1.0, TAU * p as f64 / points as f64)).collect();
    let value = |p: usize| {
        let add = |sum, (k, s): (usize, &DMatrix<Complex<f64>>)| sum + s * turns[k * p % points];
        terms.iter().enumerate().fold(DMatrix::zeros(q, q), add).determinant()
    };
    let values: Vec<_> = (0..points).map(value).collect();
    let coefficient = |k: usize| {
        let sum: Complex<f64> = values.iter().enumerate().map(|(p, f)| f * turns[k * p % points].conj()).sum();
        sum.norm() / points as f64
    };
    (0..points).map(coefficient).collect()
}

/// Positions of the members of each union of discs that meet, directly or by way of others; unions without a member that `is_asked`
/// are left out. The first member of a union is the first that is asked for, in the order of positions, then come the members that it meets.
pub fn unions(count: usize, is_asked: impl Fn(usize) -> bool, meet: impl Fn(usize, usize) -> bool) -> Vec<Vec<usize>> {
    let mut is_taken = vec![false; count];
    let mut unions = Vec::new();
    for first in 0..count {
        if is_taken[first] || !is_asked(first) {
            continue;
        }
        is_taken[first] = true;
        let (mut union, mut next) = (vec![first], 0);
        while next < union.len() {
            for (other, is_taken) in is_taken.iter_mut().enumerate() {
                if !*is_taken && meet(union[next], other) {
                    *is_taken = true;
                    union.push(other);
                }
            }
            next += 1;
        }
        unions.push(union);
    }
    unions
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
