//! Eigenvalues and vectors of a projected problem, with the residual of each.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, evd_cplx, evd_scratch};
use faer::{Mat, Spec};
use linsys::reciprocal;
use num_complex::Complex;

use super::blocks::{PAR, length};
use super::krylov::Krylov;
use crate::SparseError;

/// Number of vectors whose errors stand for the errors of all: as many as a product takes at once.
const JUDGED: usize = 4;

/// The Ritz values of a Krylov space, nearest to the shift first.
pub(crate) struct Ritz {
    /// lambda = sigma + 1 / mu.
    pub(crate) lambdas: Vec<Complex<f64>>,
    /// Residual of `(A - sigma B)^-1 B` relative to |mu|.
    pub(crate) residuals: Vec<f64>,
    /// mu, and the coordinates of the images of the vectors in the basis and in what comes after it, in columns.
    mus: Vec<Complex<f64>>,
    images: Mat<Complex<f64>>,
}

impl Ritz {
    pub(crate) fn of(krylov: &Krylov<'_>, sigma: Complex<f64>) -> Result<Self, SparseError> {
        let (h, below) = krylov.projected();
        let m = h.nrows();
        let (mut values, mut vectors) = (Mat::<Complex<f64>>::zeros(m, 1), Mat::<Complex<f64>>::zeros(m, m));
        let (none, wanted) = (ComputeEigenvectors::No, ComputeEigenvectors::Yes);
        let request = evd_scratch::<Complex<f64>>(m, none, wanted, PAR, Spec::default());
        let mut buffer = MemBuffer::new(request);
        let stack = MemStack::new(&mut buffer);
        let diagonal = values.as_mut().col_mut(0).as_diagonal_mut();
        evd_cplx(h.as_ref(), diagonal, None, Some(vectors.as_mut()), PAR, stack, Spec::default())
            .map_err(|_| SparseError::Projected { shift: sigma, order: m })?;
        let mut order: Vec<usize> = (0..m).collect();
        order.sort_by(|&a, &b| values[(b, 0)].norm().total_cmp(&values[(a, 0)].norm()));
        let outside = &below * &vectors;
        let residual = |&j: &usize| {
            let (mu, size) = (values[(j, 0)].norm(), length(vectors.col_as_slice(j)));
            if mu == 0.0 { f64::INFINITY } else { length(outside.col_as_slice(j)) / (size * mu) }
        };
        let image = |i: usize, j: usize| {
            let mu = values[(order[j], 0)];
            if i < m { vectors[(i, order[j])] * mu } else { outside[(i - m, order[j])] }
        };
        Ok(Self {
            lambdas: order.iter().map(|&j| sigma + reciprocal(values[(j, 0)])).collect(),
            residuals: order.iter().map(residual).collect(),
            mus: order.iter().map(|&j| values[(j, 0)]).collect(),
            images: Mat::from_fn(m + outside.nrows(), m, image),
        })
    }

    /// The coordinates of the vectors `wanted`, by their indices, each multiplied once more than the basis was: the image is known anyway, and what is
    /// far from the shift is less in it.
    pub(crate) fn vectors_of(&self, wanted: &[usize]) -> Mat<Complex<f64>> {
        Mat::from_fn(self.images.nrows(), wanted.len(), |i, j| self.images[(i, wanted[j])] / self.mus[wanted[j]])
    }

    /// Indices, among `wanted`, of the vectors whose residuals are largest: as many as are multiplied at once.
    pub(crate) fn worst(&self, wanted: &[usize]) -> Vec<usize> {
        let mut all = wanted.to_vec();
        all.sort_by(|&a, &b| self.residuals[b].total_cmp(&self.residuals[a]));
        all.truncate(JUDGED);
        all
    }
}
