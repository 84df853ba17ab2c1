//! LAPACK as an oracle and a peer to measure against, behind the feature `lapack` (system OpenBLAS).

use linsys::SecondOrder;
use nalgebra_lapack::Eigen;
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
        let failed = CeaError::NoConvergence { iterations: 30 * dimension.max(10), dimension };
        let found = Eigen::new(state, false, false).ok_or(failed)?;
        let parts = found.eigenvalues_re.iter().zip(&found.eigenvalues_im);
        let mut eigenvalues: Vec<_> = parts.map(|(&re, &im)| Complex::new(re, im) * gamma).collect();
        sort(&mut eigenvalues);
        Ok(Spectrum { eigenvalues, scale })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BatchSolver, QrSolver};
    use nalgebra::DMatrix;

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
}
