//! LAPACK as a reference for results and times, behind the feature `lapack` (system OpenBLAS).

use certified::CertifiedError;
use linsys::SecondOrder;
use nalgebra::DMatrix;
use nalgebra_lapack::{Eigen, GeneralizedEigen};
use num_complex::Complex;

use crate::{CeaError, EigenSolver, Spectrum, StandardForm, Workspace, sort};

/// LAPACK's `dgeev`, eigenvalues only, on the [`StandardForm`].
#[derive(Debug, Clone, Copy, Default)]
pub struct LapackSolver;

impl EigenSolver for LapackSolver {
    fn eigenvalues(&self, system: &SecondOrder, work: &mut Workspace) -> Result<Spectrum, CeaError> {
        let StandardForm { state, gamma, .. } = StandardForm::new(system)?;
        let (dimension, scale) = (state.nrows(), gamma * state.norm());
        work.counters.eigenvalue_solves += 1;
        let failed = CertifiedError::NoConvergence { iterations: 30 * dimension.max(10), dimension };
        let mut eigenvalues = dgeev(state).ok_or(failed)?;
        eigenvalues.iter_mut().for_each(|sigma| *sigma *= gamma);
        sort(&mut eigenvalues);
        Ok(Spectrum { eigenvalues, scale })
    }
}

/// Eigenvalues of a square matrix by `dgeev`, which balances the matrix first; `None` where it fails.
pub fn dgeev(matrix: DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    let found = Eigen::new(matrix, false, false)?;
    Some(found.eigenvalues_re.iter().zip(&found.eigenvalues_im).map(|(&re, &im)| Complex::new(re, im)).collect())
}

/// Eigenvalues of the pencil `a - lambda b` by `dggev`, which does not balance; `None` where it fails. Eigenvalues with
/// `beta = 0` are infinite and left out.
pub fn dggev(a: DMatrix<f64>, b: DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    let found = GeneralizedEigen::try_new(a, b)?;
    let ratios = found.raw_eigenvalues();
    Some(ratios.iter().filter(|(_, beta)| *beta != 0.0).map(|(alpha, beta)| alpha / beta).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BatchSolver, QrSolver};
    use nalgebra::dmatrix;

    #[test]
    fn lapack_agrees_with_our_own_iterations() {
        let n = 30;
        let entry = |i: usize, j: usize, seed: usize| ((7 * i + 13 * j + 29 * seed) % 17) as f64 / 17.0 - 0.5;
        let k = DMatrix::from_fn(n, n, |i, j| if i == j { 4e7 * (1.0 + i as f64) } else { 2e7 * entry(i, j, 1) });
        let c = DMatrix::from_fn(n, n, |i, j| if i == j { 200.0 } else { 30.0 * entry(i, j, 2) });
        let system = SecondOrder::new(DMatrix::identity(n, n) * 0.4, c, k).unwrap();
        let spectrum = |solver: &dyn EigenSolver| solver.eigenvalues(&system, &mut Workspace::default()).unwrap();
        let lapack = spectrum(&LapackSolver);
        for other in [spectrum(&QrSolver), spectrum(&BatchSolver)] {
            for a in &lapack.eigenvalues {
                let nearest = other.eigenvalues.iter().map(|b| (a - b).norm()).fold(f64::INFINITY, f64::min);
                assert!(nearest < 1e-12 * lapack.scale, "{a}: {nearest}");
            }
        }
    }

    #[test]
    fn a_pencil_with_a_singular_b_has_an_infinite_eigenvalue() {
        let found = dggev(dmatrix![6.0, 0.0; 0.0, 1.0], dmatrix![2.0, 0.0; 0.0, 0.0]).unwrap();
        assert_eq!(found, [Complex::from(3.0)]);
    }
}
