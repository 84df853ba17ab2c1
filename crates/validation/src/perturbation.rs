//! Occurrences from a Taylor expansion of each eigenvalue about the median friction coefficient.
//!
//! With `Q(lambda(mu), mu) x(mu) = 0` and x normalised by a constant vector, one bordered matrix gives both orders
//! (Andrew, Chu and Lancaster, SIAM J. Matrix Anal. Appl. 14, 1993):
//!
//! ```text
//! [ Q    Q' x ] [x' ]     [ K_1 x ]     [ Q    Q' x ] [x''  ]     [ 2 (lambda' Q' + K_1) x' + 2 lambda'^2 M x ]
//! [ x^H   0   ] [l' ] = - [   0   ]     [ x^H   0   ] [l''  ] = - [                    0                    ]
//! ```
//!
//! The series converges up to the nearest coalescence in the complex plane of mu.

use cea::Workspace;
use nalgebra::{DMatrix, DVector, Schur};
use num_complex::Complex;
use squeal::estimators::{Integral, OneParameterFamily, integrate};
use squeal::study::Reference;
use squeal::tracking::Branches;

use crate::ValidationError;

/// Largest relative distance of two eigenvalues that are expanded as one double eigenvalue; chosen.
const DOUBLE_DISTANCE: f64 = 1e-9;

/// The last term of a Taylor series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TaylorOrder {
    /// The slope.
    First,
    /// The curvature.
    Second,
}

/// `lambda + first d + second d^2 / 2` at the distance d from the median.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expansion {
    /// Eigenvalue lambda, rad/s.
    pub lambda: Complex<f64>,
    /// First derivative d lambda / d mu.
    pub first: Complex<f64>,
    /// Second derivative d^2 lambda / d mu^2.
    pub second: Complex<f64>,
}

/// Expands the eigenvalue `lambda` at `mu`.
///
/// # Errors
/// `lambda` is no eigenvalue, or is defective.
pub fn expand(
    family: &mut OneParameterFamily<'_>,
    mu: f64,
    lambda: Complex<f64>,
) -> Result<Expansion, ValidationError> {
    let linear = family.linear().dynamic_stiffness(lambda);
    let linear_derivative = family.linear().dynamic_stiffness_derivative(lambda);
    let system = &family.system(mu);
    let n = system.order();
    let x = cea::right_vector(system, lambda, &mut Workspace::default())?;
    let q = system.dynamic_stiffness(lambda);
    let derivative = system.dynamic_stiffness_derivative(lambda);
    let mass = system.m.map(Complex::from);
    // The border is scaled to the size of Q, so that the pivots lose no digits.
    let slope = &derivative * &x;
    let (size, weight) = (q.norm(), q.norm() / slope.norm());
    let mut bordered = DMatrix::zeros(n + 1, n + 1);
    bordered.view_mut((0, 0), (n, n)).copy_from(&q);
    bordered.view_mut((0, n), (n, 1)).copy_from(&(slope * Complex::from(weight)));
    bordered.view_mut((n, 0), (1, n)).copy_from(&(x.adjoint() * Complex::from(size)));
    let factor = bordered.lu();
    let solve = |right: DVector<Complex<f64>>| {
        let solution = factor.solve(&-right.insert_row(n, Complex::default()));
        let solution = solution.ok_or(ValidationError::Defective { lambda })?;
        let change = solution[n] * weight;
        Ok::<_, ValidationError>((solution.remove_row(n), change))
    };
    let (dx, first) = solve(&linear * &x)?;
    let two = Complex::from(2.0);
    let right = (&derivative * &dx) * (two * first)
        + (&linear * &dx) * two
        + (linear_derivative * &x) * (two * first)
        + (mass * &x) * (two * first * first);
    let (_, second) = solve(right)?;
    Ok(Expansion { lambda, first, second })
}

/// Expands a semisimple double eigenvalue, to first order: the slopes are the eigenvalues of
/// `-(Psi^H Q' Phi)^-1 Psi^H K_1 Phi` (Lancaster, Numer. Math. 6, 1964).
fn expand_double(
    family: &mut OneParameterFamily<'_>,
    mu: f64,
    pair: [Complex<f64>; 2],
) -> Result<[Expansion; 2], ValidationError> {
    let lambda = 0.5 * (pair[0] + pair[1]);
    let linear = family.linear().dynamic_stiffness(lambda);
    let system = &family.system(mu);
    let mut work = Workspace::default();
    let right = cea::right_vectors(system, &pair, &mut work)?;
    let left = cea::right_vectors(&system.transposed(), &pair, &mut work)?;
    let between = |matrix: &DMatrix<Complex<f64>>| DMatrix::from_fn(2, 2, |i, j| left[i].dot(&(matrix * &right[j])));
    let slopes = between(&system.dynamic_stiffness_derivative(lambda))
        .lu()
        .solve(&between(&linear))
        .and_then(|small| Schur::try_new(-small, f64::EPSILON, 100))
        .ok_or(ValidationError::Defective { lambda })?
        .unpack()
        .1;
    Ok([0, 1].map(|i| Expansion { lambda: pair[i], first: slopes[(i, i)], second: Complex::default() }))
}

/// Occurrences of a scene from the expansions about the median.
///
/// # Errors
/// Those of [`expand`] and of the solver.
pub fn perturbation(
    reference: &Reference,
    family: &mut OneParameterFamily<'_>,
    order: TaylorOrder,
) -> Result<Integral, ValidationError> {
    let distribution = family.distribution();
    let (from, to) = distribution.support();
    let median = distribution.median();
    let lambdas = family.lambdas(median)?.to_vec();
    let curvature = if order == TaylorOrder::First { 0.0 } else { 0.5 };
    let expand = |i: usize| {
        let near = |&j: &usize| j != i && (lambdas[j] - lambdas[i]).norm() <= DOUBLE_DISTANCE * lambdas[i].norm();
        let e = match (0..lambdas.len()).find(near) {
            Some(j) => {
                let (low, high) = (i.min(j), i.max(j));
                expand_double(family, median, [lambdas[low], lambdas[high]])?[usize::from(i == high)]
            }
            None => expand(family, median, lambdas[i])?,
        };
        Ok([e.lambda.re, e.first.re, curvature * e.second.re])
    };
    let parts: Vec<[f64; 3]> = (0..lambdas.len()).map(expand).collect::<Result<_, ValidationError>>()?;
    let mut ends: Vec<f64> = parts.iter().flat_map(|p| roots(*p)).map(|d| median + d).collect();
    ends.retain(|&mu| from < mu && mu < to);
    ends.extend([from, to]);
    ends.sort_by(f64::total_cmp);
    Ok(integrate(&distribution, &ends, &reference.all_names(), |mu| {
        let d = mu - median;
        let is_unstable = |p: &[f64; 3]| p[0] + d * (p[1] + d * p[2]) > 0.0;
        Ok((0..parts.len()).filter(|&i| is_unstable(&parts[i])).map(|i| reference.names[i].clone()).collect())
    })?)
}

/// Real roots of `c + b x + a x^2`, without cancellation.
fn roots([c, b, a]: [f64; 3]) -> Vec<f64> {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return Vec::new();
    }
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    [q / a, c / q].into_iter().filter(|x| x.is_finite()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_of_lines_and_parabolas() {
        assert_eq!(roots([6.0, -3.0, 0.0]), [2.0]);
        let mut two = roots([6.0, -5.0, 1.0]);
        two.sort_by(f64::total_cmp);
        assert_eq!(two, [2.0, 3.0]);
        assert!(roots([1.0, 0.0, 1.0]).is_empty());
        assert!(roots([1.0, 0.0, 0.0]).is_empty());
    }
}
