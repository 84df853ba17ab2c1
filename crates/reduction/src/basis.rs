//! Real orthonormal bases from complex vectors.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use sparse::product::times;
use sparse::{Eigenpair, SparseSecondOrder};

use super::norms::NormsAt;
use super::{dense, split};
use crate::ReductionError;

/// Vectors of the full modes at the known points that span the basis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Vectors {
    /// Right vectors alone: the fewest columns for a residual.
    Right,
    /// Right and left vectors: eigenvalues, which see the error of both, gain as many digits again.
    RightAndLeft,
}

/// Real and imaginary parts of the vectors as columns, each vector of unit length; a conjugate pair has one entry.
pub(super) fn candidates(modes: &[Eigenpair], vectors: Vectors) -> DMatrix<f64> {
    let mut columns: Vec<DVector<f64>> = Vec::new();
    let mut add = |x: &DVector<Complex<f64>>| {
        let size = x.norm();
        if size > 0.0 {
            columns.push(x.map(|x| x.re / size));
            columns.push(x.map(|x| x.im / size));
        }
    };
    for mode in modes {
        add(&mode.right);
        if vectors == Vectors::RightAndLeft {
            add(&mode.left);
        }
    }
    let rows = modes.first().map_or(0, |mode| mode.right.len());
    if columns.is_empty() { DMatrix::zeros(rows, 0) } else { DMatrix::from_columns(&columns) }
}

/// The principal directions of the parts of `columns` that are orthogonal to `basis`: orthonormal, by descending singular
/// value. Those with singular values up to `floor` are left out.
pub(super) fn directions(
    basis: &DMatrix<f64>,
    mut columns: DMatrix<f64>,
    floor: f64,
) -> Result<DMatrix<f64>, ReductionError> {
    let transposed = basis.transpose();
    for _ in 0..2 {
        let inside = &transposed * &columns;
        columns.gemm(-1.0, basis, &inside, 1.0);
    }
    let (mut vectors, values) = dense::left_singular(&columns)?;
    let kept = values.iter().take_while(|&&value| value > floor).count();
    vectors = vectors.columns(0, kept).into_owned();
    let inside = &transposed * &vectors;
    vectors.gemm(-1.0, basis, &inside, 1.0);
    vectors.column_iter_mut().for_each(|mut column| {
        column.normalize_mut();
    });
    Ok(vectors)
}

/// The part of a mode's length that a basis may miss of it, whatever residual is asked for; chosen. Where stiff parts make all residuals small, one
/// that is not small says that a basis without any columns holds every mode.
pub(super) const MOST_MISSING: f64 = 0.1;
/// Singular values of vectors of unit length up to which a direction is rounding; the vectors have about ten digits.
pub(super) const ROUNDING: f64 = 1e-11;

/// The largest residual of the modes (lambda, V V^T x) of a system: what the basis makes of its right vectors.
pub(super) fn projected_residual(
    system: &SparseSecondOrder,
    size: impl Fn(Complex<f64>) -> f64,
    basis: &DMatrix<f64>,
    modes: &[Eigenpair],
) -> f64 {
    let Some(first) = modes.first() else { return 0.0 };
    let mut x = split::zeros(first.right.len(), modes.len());
    modes.iter().enumerate().for_each(|(at, mode)| split::set(&mut x, at, mode.right.iter().copied()));
    let x = basis * (basis.transpose() * x);
    let mut largest = 0.0_f64;
    for (at, (mode, residual)) in modes.iter().zip(residuals(system, modes, &x)).enumerate() {
        let norm = split::norm_squared(&x, at).sqrt();
        let is_held = norm.powi(2) >= (1.0 - MOST_MISSING.powi(2)) * mode.right.norm_squared();
        largest = largest.max(if is_held { residual.norm() / (size(mode.lambda) * norm) } else { f64::INFINITY });
    }
    largest
}

/// `Q(lambda_j) x_j` of a system at the eigenvalues of some modes, x n x m split.
pub(super) fn residuals(
    system: &SparseSecondOrder,
    modes: &[Eigenpair],
    x: &DMatrix<f64>,
) -> Vec<DVector<Complex<f64>>> {
    let [m, c, k] = [&system.m, &system.c, &system.k].map(|matrix| times(matrix, x));
    let residual = |(at, mode): (usize, &Eigenpair)| {
        let lambda = mode.lambda;
        let mut residual =
            split::vector(&m, at) * (lambda * lambda) + split::vector(&c, at) * lambda + split::vector(&k, at);
        for state in &system.states {
            let drive: Complex<f64> = state
                .drive
                .iter()
                .map(|&(dof, value)| Complex::new(x[(dof, at)], x[(dof, modes.len() + at)]) * value)
                .sum();
            let pull = drive * lambda / (lambda + state.decay);
            state.force.iter().for_each(|&(dof, value)| residual[dof] -= pull * value);
        }
        residual
    };
    modes.iter().enumerate().map(residual).collect()
}

/// The fewest leading columns of `directions` that, with `basis`, make `error` at most `wanted`; at most `most`. By bisection:
/// more columns are taken to be better.
pub(super) fn fewest(
    basis: &DMatrix<f64>,
    directions: &DMatrix<f64>,
    most: usize,
    wanted: f64,
    error: impl Fn(&DMatrix<f64>) -> f64,
) -> DMatrix<f64> {
    let with = |count: usize| {
        let mut columns = basis.clone().resize_horizontally(basis.ncols() + count, 0.0);
        columns.columns_mut(basis.ncols(), count).copy_from(&directions.columns(0, count));
        columns
    };
    let (mut low, mut high) = (0, most.min(directions.ncols()));
    while low < high {
        let middle = low.midpoint(high);
        if error(&with(middle)) <= wanted { high = middle } else { low = middle + 1 }
    }
    with(high)
}

/// Modes of a full system at a point.
pub(super) struct ModesAt<'a> {
    /// The full system there.
    pub system: &'a SparseSecondOrder,
    /// Norms of the system.
    pub norms: &'a NormsAt,
    pub modes: &'a [Eigenpair],
}

/// The fewest principal directions of the vectors of known modes, n x k with k at most `most`, that leave no right vector a residual above `wanted`.
pub(super) fn of_modes(
    order: usize,
    known: &[ModesAt<'_>],
    vectors: Vectors,
    (most, wanted): (usize, f64),
) -> Result<DMatrix<f64>, ReductionError> {
    let empty = DMatrix::zeros(order, 0);
    let all: Vec<Eigenpair> = known.iter().flat_map(|at| at.modes).cloned().collect();
    let found = directions(&empty, candidates(&all, vectors), ROUNDING)?;
    if found.ncols() == 0 {
        return Err(ReductionError::NoModes);
    }
    let error = |basis: &DMatrix<f64>| {
        let of_point = |ModesAt { system, norms, modes }: &ModesAt<'_>| {
            projected_residual(system, |lambda| norms.size(lambda), basis, modes)
        };
        known.iter().map(of_point).fold(0.0, f64::max)
    };
    Ok(fewest(&empty, &found, most, wanted, error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_orthonormal_and_span_what_is_new() {
        let basis = DMatrix::identity(6, 2);
        let columns = DMatrix::from_fn(6, 3, |i, j| ((2 * i + 3 * j * j + i * j) % 7) as f64 - 2.0);
        let found = directions(&basis, columns.clone(), ROUNDING).unwrap();
        assert_eq!(found.ncols(), 3);
        assert!((found.tr_mul(&found) - DMatrix::identity(3, 3)).amax() < 1e-14);
        assert!(basis.tr_mul(&found).amax() < 1e-15);
        let rest = &columns - &basis * basis.tr_mul(&columns);
        assert!((&found * found.tr_mul(&rest) - rest).amax() < 1e-13);
        // A column that the basis holds adds none.
        assert_eq!(directions(&basis, basis.clone(), ROUNDING).unwrap().ncols(), 0);
        assert_eq!(fewest(&basis, &found, 9, 3.0, |columns| 7.0 - columns.ncols() as f64).ncols(), 4);
        assert_eq!(fewest(&basis, &found, 1, 0.0, |_| 1.0).ncols(), 3);
    }
}
