//! The eigenvalues nearest to given numbers.

use std::collections::BTreeSet;

use num_complex::Complex;

/// Largest relative distance of two eigenvalues that are one; chosen.
const SAME: f64 = 1e-7;

/// Indices of the `count` values nearest to each number in `to`, each of them once, ascending.
pub(super) fn nearest(to: &[Complex<f64>], values: &[Complex<f64>], count: usize) -> BTreeSet<usize> {
    let of_number = |number: &Complex<f64>| {
        let distance = |at: &usize| (values[*at] - number).norm();
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        order.truncate(count);
        order
    };
    to.iter().flat_map(of_number).collect()
}

/// The `count` results whose eigenvalues are nearest to each number in `to`, each of them once; `None` where one was found twice.
pub(super) fn nearest_of<T: Clone>(
    to: &[Complex<f64>],
    found: Vec<T>,
    lambda: impl Fn(&T) -> Complex<f64>,
    count: usize,
) -> Option<Vec<T>> {
    let lambdas: Vec<Complex<f64>> = found.iter().map(lambda).collect();
    let are_apart = (1..found.len()).all(|next| is_apart(&lambdas[..next], lambdas[next]));
    are_apart.then(|| nearest(to, &lambdas, count).into_iter().map(|at| found[at].clone()).collect())
}

/// True if an eigenvalue is not one of `others`.
pub(super) fn is_apart(others: &[Complex<f64>], lambda: Complex<f64>) -> bool {
    others.iter().all(|other| (other - lambda).norm() > SAME * lambda.norm())
}
