//! Block Arnoldi iteration with `(A - sigma B)^-1 B`, the linearised problem shifted and inverted.
//!
//! With v = lambda u and z = (lambda + a)^-1 E^T v the problem is `A w = lambda B w`, w = (u, v, z), and one step from (u, v, z) to
//! (u', v', z') solves with Q(sigma) alone:
//!
//! `u' = -Q(sigma)^-1 (M v + (C + sigma M) u - F (a + sigma)^-1 (E^T u - z))`, `v' = sigma u' + u`,
//! `z' = (a + sigma)^-1 (E^T v' - z)`.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat};
use num_complex::Complex;

use super::factor::{Factor, PAR, length};
use super::pencil::{Side, Weights};
use crate::SparseError;

/// Part of a vector that has to be left after orthogonalisation; a vector of which less is left lies in the basis.
const DEPENDENT: f64 = 1e-12;

/// Part of every vector that has to be left by one pass of orthogonalisation for a second one to be left out: the basis is
/// orthonormal to ten times rounding.
const KEPT: f64 = 0.1;

type Block = Mat<Complex<f64>>;

/// An orthonormal basis V and the band matrix H with `(A - sigma B)^-1 B V_m = V H`.
pub(crate) struct Krylov<'a> {
    factor: &'a Factor<'a>,
    side: Side,
    /// v is kept in units of `scale * u`.
    scale: f64,
    /// `scale * M` and `C + sigma M`.
    mass: Vec<Complex<f64>>,
    damping: Vec<Complex<f64>>,
    basis: Block,
    projected: Block,
    /// Columns of the basis, and how many of them have been multiplied.
    columns: usize,
    multiplied: usize,
}

impl<'a> Krylov<'a> {
    /// An iteration for at most `capacity` columns, started with the image of the block `start` of extended vectors: it has no
    /// part in the null space of a singular M.
    pub(crate) fn new(
        factor: &'a Factor<'a>,
        side: Side,
        scale: f64,
        start: Block,
        capacity: usize,
    ) -> Result<Self, SparseError> {
        let pencil = factor.pencil();
        let states = vec![Complex::default(); pencil.states().len()];
        let zero = Complex::default();
        let mass = Weights { mass: Complex::from(scale), damping: zero, stiffness: zero, states: states.clone() };
        let damping = Weights { mass: factor.shift(), damping: Complex::from(1.0), stiffness: zero, states };
        let values = |weights| pencil.by_rows(&pencil.values(weights), side);
        let rows = start.nrows();
        let mut krylov = Self {
            factor,
            side,
            scale,
            mass: values(&mass),
            damping: values(&damping),
            basis: Mat::zeros(rows, capacity + start.ncols()),
            projected: Mat::zeros(capacity + start.ncols(), capacity),
            columns: 0,
            multiplied: 0,
        };
        let start = krylov.apply(&start)?;
        krylov.append(start, None);
        Ok(krylov)
    }

    /// Columns that have been multiplied: the order of the projected problem.
    pub(crate) fn dimension(&self) -> usize {
        self.multiplied
    }

    /// Columns that a step would multiply.
    pub(crate) fn pending(&self) -> usize {
        self.columns - self.multiplied
    }

    /// Whether the basis spans an invariant subspace.
    pub(crate) fn is_complete(&self) -> bool {
        self.columns == self.multiplied
    }

    /// H, and below it the rows by which the subspace is not invariant.
    pub(crate) fn projected(&self) -> (Block, Block) {
        let (m, k) = (self.multiplied, self.columns);
        let block = self.projected.as_ref();
        (block.submatrix(0, 0, m, m).to_owned(), block.submatrix(m, 0, k - m, m).to_owned())
    }

    /// The parts u of `V s` for the columns of s.
    pub(crate) fn displacements(&self, s: &Block) -> Block {
        let n = self.factor.pencil().order();
        let mut out = Mat::zeros(n, s.ncols());
        let basis = self.basis.submatrix(0, 0, n, self.multiplied);
        matmul(out.as_mut(), Accum::Replace, basis, s.as_ref(), Complex::from(1.0), PAR);
        out
    }

    /// Multiplies the columns that have not been and appends the result.
    ///
    /// # Errors
    /// A solution with Q(sigma) that is not accurate.
    pub(crate) fn step(&mut self) -> Result<(), SparseError> {
        let (from, to) = (self.multiplied, self.columns);
        let block = self.basis.as_ref().subcols(from, to - from).to_owned();
        let image = self.apply(&block)?;
        self.multiplied = to;
        self.append(image, Some(from));
        Ok(())
    }

    /// `(A - sigma B)^-1 B x`.
    pub(crate) fn apply(&self, x: &Block) -> Result<Block, SparseError> {
        let (pencil, sigma) = (self.factor.pencil(), self.factor.shift());
        let (n, p) = (pencil.order(), x.ncols());
        let (u, v, z) = (x.subrows(0, n), x.subrows(n, n), x.subrows(2 * n, pencil.states().len()));
        let mut b = pencil.gathered([(&self.mass, v), (&self.damping, u)]);
        for (i, state) in pencil.states().iter().enumerate() {
            let (drive, force) = state.sides(self.side);
            for j in 0..p {
                let driven: Complex<f64> = drive.iter().map(|&(dof, e)| u[(dof, j)] * e).sum();
                let change = (driven - z[(i, j)]) / (sigma + state.decay);
                force.iter().for_each(|&(dof, f)| b[(dof, j)] -= change * f);
            }
        }
        let solved = self.factor.solve(self.side, &b)?;
        let mut out = Mat::zeros(x.nrows(), p);
        for j in 0..p {
            for i in 0..n {
                out[(i, j)] = -solved[(i, j)];
                out[(n + i, j)] = (u[(i, j)] - sigma * solved[(i, j)]) / self.scale;
            }
            for (i, state) in pencil.states().iter().enumerate() {
                let (drive, _) = state.sides(self.side);
                let driven: Complex<f64> = drive.iter().map(|&(dof, e)| out[(n + dof, j)] * (e * self.scale)).sum();
                out[(2 * n + i, j)] = (driven - z[(i, j)]) / (sigma + state.decay);
            }
        }
        Ok(out)
    }

    /// Orthogonalises a block and appends what is left of it. What a first pass takes away most of goes through a second one. `multiplied` is the first of the columns whose image it is.
    fn append(&mut self, mut block: Block, multiplied: Option<usize>) {
        let (k, p) = (self.columns, block.ncols());
        let before: Vec<_> = (0..p).map(|j| length(block.col_as_slice(j))).collect();
        let mut coefficients = Mat::zeros(k + p, p);
        for pass in 0..2 {
            let is_kept = |j: usize| length(block.col_as_slice(j)) > KEPT * before[j];
            if pass > 0 && (0..p).all(is_kept) {
                break;
            }
            let basis = self.basis.as_ref().subcols(0, k);
            let mut part = Mat::zeros(k, p);
            matmul(part.as_mut(), Accum::Replace, basis.adjoint(), block.as_ref(), Complex::from(1.0), PAR);
            matmul(block.as_mut(), Accum::Add, basis, part.as_ref(), Complex::from(-1.0), PAR);
            let mut sum = coefficients.as_mut().subrows_mut(0, k);
            sum += part;
        }
        for j in 0..p {
            let added = self.columns - k;
            for _ in 0..2 {
                let others = self.basis.as_ref().subcols(k, added);
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
        if let Some(first) = multiplied {
            self.projected.as_mut().submatrix_mut(0, first, k + p, p).copy_from(&coefficients);
        }
    }
}
