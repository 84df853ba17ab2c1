//! Orthonormal columns to which blocks are added.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef};
use num_complex::Complex;

use super::blocks::{PAR, length};
use super::combinations::{add_times, adjoint_times};

/// Part of a vector that has to be left after orthogonalisation; a vector of which less is left lies in the basis.
const DEPENDENT: f64 = 1e-12;
/// Part of every vector that has to be left by one pass of orthogonalisation for a second one to be left out: the basis is
/// orthonormal to ten times rounding.
const KEPT: f64 = 0.1;

type Block = Mat<Complex<f64>>;

/// Orthonormal columns, with room for more.
pub(super) struct Orthogonal {
    basis: Block,
    columns: usize,
}

impl Orthogonal {
    pub(super) fn new(rows: usize, most: usize) -> Self {
        Self { basis: Mat::zeros(rows, most), columns: 0 }
    }

    pub(super) fn columns(&self) -> usize {
        self.columns
    }

    /// The columns and, zero, those that there is room for.
    pub(super) fn basis(&self) -> MatRef<'_, Complex<f64>> {
        self.basis.as_ref()
    }

    /// The columns times coordinates.
    pub(super) fn times(&self, coordinates: &Block) -> Block {
        let mut product = Mat::zeros(self.basis.nrows(), coordinates.ncols());
        add_times(&mut product, &self.basis, coordinates);
        product
    }

    /// Appends what is left of a block after orthogonalisation: the coordinates of the block in the columns before and after. What a
    /// first pass takes away most of goes through a second one. Rows that the block does not have are zero.
    pub(super) fn append(&mut self, mut block: Block) -> Block {
        let (k, p) = (self.columns, block.ncols());
        let before: Vec<_> = (0..p).map(|j| length(block.col_as_slice(j))).collect();
        let mut coefficients = Mat::zeros(k + p, p);
        for pass in 0..2 {
            let is_kept = |j: usize| length(block.col_as_slice(j)) > KEPT * before[j];
            if k == 0 || (pass > 0 && (0..p).all(is_kept)) {
                break;
            }
            let part = adjoint_times(&self.basis, k, &block);
            add_times(&mut block, &self.basis, &-&part);
            let mut sum = coefficients.as_mut().subrows_mut(0, k);
            sum += part;
        }
        for j in 0..p {
            let added = self.columns - k;
            for _ in 0..2 {
                let others = self.basis.submatrix(0, k, block.nrows(), added);
                let mut part = Mat::zeros(added, 1);
                let column = block.as_mut().subcols_mut(j, 1);
                matmul(part.as_mut(), Accum::Replace, others.adjoint(), column.as_ref(), Complex::from(1.0), PAR);
                matmul(column, Accum::Add, others, part.as_ref(), Complex::from(-1.0), PAR);
                let mut sum = coefficients.as_mut().submatrix_mut(k, j, added, 1);
                sum += part;
            }
            let column = block.col_as_slice(j);
            let left = length(column);
            if left > DEPENDENT * before[j] {
                coefficients[(self.columns, j)] = Complex::from(left);
                let target = self.basis.col_as_slice_mut(self.columns);
                target.iter_mut().zip(column).for_each(|(t, c)| *t = c / left);
                self.columns += 1;
            }
        }
        coefficients
    }
}
