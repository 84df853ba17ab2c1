//! Dense decompositions of `faer`, for matrices of `nalgebra`.
//!
//! Those of nalgebra are not blocked: a basis of four hundred columns over five thousand rows would take it minutes.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use nalgebra::{ComplexField, DMatrix, DVector};
use num_complex::Complex;

use crate::ReductionError;

/// An eigenvalue decomposition: the eigenvalues, and their right vectors as columns.
pub(super) type Eigen = (Vec<Complex<f64>>, DMatrix<Complex<f64>>);

fn view<T>(matrix: &DMatrix<T>) -> MatRef<'_, T> {
    MatRef::from_column_major_slice(matrix.as_slice(), matrix.nrows(), matrix.ncols())
}

fn owned<T: nalgebra::Scalar>(matrix: MatRef<'_, T>) -> DMatrix<T> {
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |row, column| matrix[(row, column)].clone())
}

fn check<T: ComplexField<RealField = f64>>(matrix: &DMatrix<T>, what: &'static str) -> Result<(), ReductionError> {
    if matrix.iter().all(ComplexField::is_finite) { Ok(()) } else { Err(ReductionError::Decomposition { what }) }
}

/// Ends the use of wide vector registers. The kernels of `faer` leave their upper halves full, and while they are, code that is compiled for any
/// x86-64 takes several times as long.
fn end_wide() {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = pulp::x86::V3::try_new() {
        simd.avx._mm256_zeroupper();
    }
}

/// `A B`; the kernels of nalgebra take a fifth to a half longer. A column of a real product does not depend on the others, to the last bit.
pub(super) fn product<T: faer::traits::ComplexField + nalgebra::Scalar>(a: &DMatrix<T>, b: &DMatrix<T>) -> DMatrix<T> {
    let mut out = DMatrix::from_element(a.nrows(), b.ncols(), T::zero_impl());
    add_product(&mut out, T::one_impl(), a, b);
    out
}

/// `A^T B`, without a copy of A.
pub(super) fn transposed_product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(a.ncols(), b.ncols());
    let to = MatMut::from_column_major_slice_mut(out.as_mut_slice(), a.ncols(), b.ncols());
    multiply(to, Accum::Replace, 1.0, view(a).transpose(), view(b));
    out
}

/// `A x`; nalgebra has no vector registers for it.
pub(super) fn image(a: &DMatrix<Complex<f64>>, x: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
    let mut out = DVector::zeros(a.nrows());
    let to = MatMut::from_column_major_slice_mut(out.as_mut_slice(), a.nrows(), 1);
    let x = MatRef::from_column_major_slice(x.as_slice(), a.ncols(), 1);
    multiply(to, Accum::Replace, Complex::from(1.0), view(a), x);
    out
}

/// Adds `factor A B`.
pub(super) fn add_product<T: faer::traits::ComplexField + nalgebra::Scalar>(
    out: &mut DMatrix<T>,
    factor: T,
    a: &DMatrix<T>,
    b: &DMatrix<T>,
) {
    let (rows, columns) = out.shape();
    let to = MatMut::from_column_major_slice_mut(out.as_mut_slice(), rows, columns);
    multiply(to, Accum::Add, factor, view(a), view(b));
}

/// `factor A B` in the place of a matrix, or added to it, on one thread.
fn multiply<T: faer::traits::ComplexField>(
    to: MatMut<'_, T>,
    accum: Accum,
    factor: T,
    a: MatRef<'_, T>,
    b: MatRef<'_, T>,
) {
    matmul(to, accum, a, b, factor, Par::Seq);
    end_wide();
}

/// The left singular vectors, as columns, and the singular values, descending, of a matrix: as many as the smaller of its numbers of rows and columns.
pub(super) fn left_singular(a: &DMatrix<f64>) -> Result<(DMatrix<f64>, Vec<f64>), ReductionError> {
    let what = "singular values of the vectors of a basis";
    check(a, what)?;
    if a.ncols() == 0 {
        return Ok((a.clone(), Vec::new()));
    }
    let svd = view(a).thin_svd();
    end_wide();
    let svd = svd.map_err(|_| ReductionError::Decomposition { what })?;
    Ok((owned(svd.U()), svd.S().column_vector().iter().copied().collect()))
}

/// Eigenvalues and right vectors of a real matrix; complex ones in conjugate pairs, next to each other.
pub(super) fn eigen_real(a: &DMatrix<f64>) -> Result<Eigen, ReductionError> {
    let what = "eigenvalues of a reduced system";
    check(a, what)?;
    let eigen = view(a).eigen();
    end_wide();
    let eigen = eigen.map_err(|_| ReductionError::Decomposition { what })?;
    Ok((eigen.S().column_vector().iter().copied().collect(), owned(eigen.U())))
}

/// Eigenvalues and right vectors of a complex matrix.
pub(super) fn eigen_complex(a: &DMatrix<Complex<f64>>) -> Result<Eigen, ReductionError> {
    let what = "eigenvalues of a projected system";
    check(a, what)?;
    let eigen = view(a).eigen();
    end_wide();
    let eigen = eigen.map_err(|_| ReductionError::Decomposition { what })?;
    Ok((eigen.S().column_vector().iter().copied().collect(), owned(eigen.U())))
}

/// A complex matrix, factored.
pub(super) struct Factored(faer::linalg::solvers::PartialPivLu<Complex<f64>>);

impl Factored {
    pub fn new(a: &DMatrix<Complex<f64>>) -> Self {
        let factors = view(a).partial_piv_lu();
        end_wide();
        Self(factors)
    }

    /// `A^-1 b`.
    pub fn solve(&self, b: &DVector<Complex<f64>>) -> Result<DVector<Complex<f64>>, ReductionError> {
        use faer::prelude::Solve;
        let b = MatRef::from_column_major_slice(b.as_slice(), b.len(), 1);
        let solution = self.0.solve(b);
        end_wide();
        let solution = owned(solution.as_ref());
        check(&solution, "vectors of a reduced system")?;
        Ok(solution.column(0).into_owned())
    }

    /// `A^-T b`.
    pub fn solve_transposed(&self, b: &DVector<Complex<f64>>) -> Result<DVector<Complex<f64>>, ReductionError> {
        Ok(self.solve_adjoint(&b.conjugate())?.conjugate())
    }

    /// `A^-H b`.
    pub fn solve_adjoint(&self, b: &DVector<Complex<f64>>) -> Result<DVector<Complex<f64>>, ReductionError> {
        use faer::prelude::Solve;
        let b = MatRef::from_column_major_slice(b.as_slice(), b.len(), 1);
        let solution = self.0.solve_adjoint(b);
        end_wide();
        let solution = owned(solution.as_ref());
        check(&solution, "vectors of a reduced system")?;
        Ok(solution.column(0).into_owned())
    }
}

/// `A^-1 B` of real matrices.
pub(super) fn solve_real(a: &DMatrix<f64>, b: &DMatrix<f64>) -> Result<DMatrix<f64>, ReductionError> {
    use faer::prelude::Solve;
    let solution = view(a).partial_piv_lu().solve(view(b));
    end_wide();
    let solution = owned(solution.as_ref());
    check(&solution, "mass matrix of a reduced system, inverted,")?;
    Ok(solution)
}

/// `A^-1 B`.
pub(super) fn solve(
    a: &DMatrix<Complex<f64>>,
    b: &DMatrix<Complex<f64>>,
) -> Result<DMatrix<Complex<f64>>, ReductionError> {
    use faer::prelude::Solve;
    let solution = view(a).partial_piv_lu().solve(view(b));
    end_wide();
    let solution = owned(solution.as_ref());
    check(&solution, "vectors of a reduced system")?;
    Ok(solution)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decompositions_are_those_of_the_textbook() {
        let a = DMatrix::from_fn(7, 4, |i, j| ((i * i + 3 * j * i + 2 * j) % 11) as f64 - 4.0);
        let (u, s) = left_singular(&a).unwrap();
        assert!((u.tr_mul(&u) - DMatrix::identity(4, 4)).amax() < 1e-14);
        assert!((a.norm_squared() - s.iter().map(|s| s * s).sum::<f64>()).abs() < 1e-11);

        let square = DMatrix::from_fn(5, 5, |i, j| ((7 * i + 3 * j * j + i * j) % 13) as f64);
        let (lambdas, vectors) = eigen_real(&square).unwrap();
        let wide = square.map(Complex::from);
        for (lambda, x) in lambdas.iter().zip(vectors.column_iter()) {
            assert!((&wide * x - x * *lambda).norm() < 1e-12 * wide.norm());
        }
        let inverse = solve(&vectors, &DMatrix::identity(5, 5)).unwrap();
        let again = &vectors * DMatrix::from_diagonal(&lambdas.clone().into()) * inverse;
        assert!((again - &wide).norm() < 1e-11 * wide.norm());
        assert_eq!(eigen_complex(&wide).unwrap().0.len(), 5);
        assert!(eigen_real(&(square * f64::NAN)).is_err());
    }

    #[test]
    fn a_column_of_a_product_does_not_depend_on_the_others() {
        for (rows, inner) in [(3, 5), (27, 61), (90, 90), (128, 57), (128, 90), (57, 180)] {
            let a = DMatrix::from_fn(rows, inner, |i, j| ((i * i + 3 * j * i + 2 * j) as f64).sin());
            let b = DMatrix::from_fn(inner, 500, |i, j| ((j * j + 5 * j * i + i) as f64).cos());
            let all = product(&a, &b);
            for (first, count) in [(0, 2), (1, 2), (3, 4), (100, 6), (101, 10), (37, 30), (7, 256), (200, 300)] {
                let some = product(&a, &b.columns(first, count).into_owned());
                assert_eq!(some, all.columns(first, count), "{rows} {inner} {first} {count}");
            }
        }
    }
}
