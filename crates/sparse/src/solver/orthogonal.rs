//! Orthonormal columns to which blocks are added.

use faer::Mat;
use num_complex::Complex;

use super::blocks::{dot, length};
use super::combinations::{add_times, remove};

/// Part of a vector that has to be left after orthogonalisation; a vector of which less is left lies in the basis. Chosen: far
/// enough above rounding that what is left is a direction, and so small that hardly any that is new is thrown away.
const DEPENDENT: f64 = 1e-12;
/// Part of every vector that has to be left by one pass of orthogonalisation for a second one to be left out: the basis is
/// orthonormal to ten times rounding.
const KEPT: f64 = 0.1;

type Block = Mat<Complex<f64>>;

/// Orthonormal columns, to which more come.
pub(super) struct Orthogonal {
    rows: usize,
    basis: Vec<Vec<Complex<f64>>>,
}

impl Orthogonal {
    pub(super) fn new(rows: usize) -> Self {
        Self { rows, basis: Vec::new() }
    }

    pub(super) fn columns(&self) -> usize {
        self.basis.len()
    }

    pub(super) fn basis(&self) -> &[Vec<Complex<f64>>] {
        &self.basis
    }

    /// The columns times coordinates.
    pub(super) fn times(&self, coordinates: &Block) -> Block {
        let mut product = Mat::zeros(self.rows, coordinates.ncols());
        add_times(&mut product, &self.basis, coordinates);
        product
    }

    /// Appends what is left of a block after orthogonalisation: the coordinates of the block in the columns before and after. What a
    /// first pass takes away most of goes through a second one. Rows that the block does not have are zero.
    pub(super) fn append(&mut self, mut block: Block) -> Block {
        let (k, p) = (self.basis.len(), block.ncols());
        let before: Vec<_> = (0..p).map(|j| length(block.col_as_slice(j))).collect();
        let mut coefficients = Mat::zeros(k + p, p);
        for pass in 0..2 {
            let is_kept = |j: usize| length(block.col_as_slice(j)) > KEPT * before[j];
            if k == 0 || (pass > 0 && (0..p).all(is_kept)) {
                break;
            }
            let part = remove(&self.basis, &mut block);
            let mut sum = coefficients.as_mut().subrows_mut(0, k);
            sum += part;
        }
        for j in 0..p {
            let column = block.col_as_slice_mut(j);
            for _ in 0..2 {
                let whole = length(column);
                for (i, other) in self.basis[k..].iter().enumerate() {
                    let part = dot(other, column);
                    column.iter_mut().zip(other).for_each(|(value, other)| *value -= part * other);
                    coefficients[(k + i, j)] += part;
                }
                if length(column) > KEPT * whole {
                    break;
                }
            }
            let left = length(column);
            if left > DEPENDENT * before[j] {
                coefficients[(self.basis.len(), j)] = Complex::from(left);
                let mut unit: Vec<_> = column.iter().map(|value| value / left).collect();
                unit.resize(self.rows, Complex::default());
                self.basis.push(unit);
            }
        }
        coefficients
    }
}
