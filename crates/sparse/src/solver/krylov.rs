//! Block Arnoldi iteration with `(A - sigma B)^-1 B`, the linearised problem shifted and inverted.
//!
//! With v = lambda u and z = (lambda + a)^-1 E^T v the problem is `A w = lambda B w`, w = (u, v, z), and one step from (u, v, z) to
//! (u', v', z') solves with Q(sigma) alone:
//!
//! `u' = -Q(sigma)^-1 (M v + (C + sigma M) u - F (a + sigma)^-1 (E^T u - z))`, `v' = sigma u' + u`,
//! `z' = (a + sigma)^-1 (E^T v' - z)`.
//!
//! So all u and v are in one space, which grows by u' alone. Its orthonormal basis S has vectors of n entries; the vectors of the Krylov
//! space, `w = (S a, S b, z)`, are kept by their coordinates (a, b, z), orthonormal themselves: the two-level Arnoldi method of Lu, Su
//! and Bai, SIAM J. Matrix Anal. Appl. 37 (2016).

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat};
use num_complex::Complex;

use super::blocks::PAR;
use super::factor::Factor;
use super::orthogonal::Orthogonal;
use super::pencil::Pencil;
use super::products::Side;
use crate::SparseError;

type Block = Mat<Complex<f64>>;

/// An orthonormal basis V and the band matrix H with `(A - sigma B)^-1 B V_m = V H`.
pub(crate) struct Krylov<'a> {
    factor: &'a Factor<'a>,
    side: Side,
    /// v is kept in units of `scale * u`.
    scale: f64,
    /// S.
    space: Orthogonal,
    /// V: z in the first rows, and below it a and b by turns.
    vectors: Orthogonal,
    /// Columns of V that have not been multiplied, as u and `v + sigma u`: M and C are multiplied with these, which are real.
    pending: [Block; 2],
    projected: Block,
    multiplied: usize,
}

impl<'a> Krylov<'a> {
    /// An iteration for at most `capacity` columns and blocks of `widest` columns in all. It starts with the image of the block `start` of extended vectors
    /// (u, v / scale, z), as the image has no part in the null space of a singular M.
    pub(crate) fn new(
        factor: &'a Factor<'a>,
        side: Side,
        scale: f64,
        start: &Block,
        capacity: usize,
        widest: usize,
    ) -> Result<Self, SparseError> {
        let pencil = factor.pencil();
        let (most, rank) = (capacity + widest, capacity + 3 * widest);
        let none = || Mat::zeros(pencil.order(), 0);
        let mut krylov = Self {
            factor,
            side,
            scale,
            space: Orthogonal::new(pencil.order()),
            vectors: Orthogonal::new(pencil.states().len() + 2 * rank),
            pending: [none(), none()],
            projected: Mat::zeros(most, capacity),
            multiplied: 0,
        };
        krylov.widen(start)?;
        Ok(krylov)
    }

    /// Appends the image of another block of extended vectors; what is appended from then on is wider by its columns.
    ///
    /// # Errors
    /// A solution with Q(sigma) that is not accurate.
    pub(crate) fn widen(&mut self, start: &Block) -> Result<(), SparseError> {
        let (n, width, shift) = (self.pencil().order(), start.ncols(), self.factor.shift());
        let states = self.pencil().states().len();
        let u = start.subrows(0, n).to_owned();
        let v = Mat::from_fn(n, width, |i, j| self.scale * start[(n + i, j)] + shift * start[(i, j)]);
        let before = self.space.append(u.clone());
        let earlier = std::mem::replace(&mut self.pending, [u, v]);
        self.extend(&before, start.subrows(2 * n, states).to_owned())?;
        let joined = |earlier: &Block, new: &Block| {
            let count = earlier.ncols();
            Mat::from_fn(n, count + new.ncols(), |i, j| if j < count { earlier[(i, j)] } else { new[(i, j - count)] })
        };
        let [u, v] = &self.pending;
        self.pending = [joined(&earlier[0], u), joined(&earlier[1], v)];
        Ok(())
    }

    pub(crate) fn pencil(&self) -> &Pencil {
        self.factor.pencil()
    }

    pub(crate) fn side(&self) -> Side {
        self.side
    }

    /// Columns that have been multiplied: the order of the projected problem.
    pub(crate) fn dimension(&self) -> usize {
        self.multiplied
    }

    /// Columns that a step would multiply.
    pub(crate) fn pending(&self) -> usize {
        self.vectors.columns() - self.multiplied
    }

    /// True if the basis spans an invariant subspace.
    pub(crate) fn is_complete(&self) -> bool {
        self.pending() == 0
    }

    /// H, and below it the rows by which the subspace is not invariant.
    pub(crate) fn projected(&self) -> (Block, Block) {
        let (m, k) = (self.multiplied, self.vectors.columns());
        let block = self.projected.as_ref();
        (block.submatrix(0, 0, m, m).to_owned(), block.submatrix(m, 0, k - m, m).to_owned())
    }

    /// The parts u of `V s` for the columns of s, which may have rows for the columns that have not been multiplied.
    pub(crate) fn displacements(&self, s: &Block) -> Block {
        let coordinates = self.coordinates(0, 0, s.nrows());
        let mut combined = Mat::zeros(coordinates.nrows(), s.ncols());
        matmul(combined.as_mut(), Accum::Replace, coordinates.as_ref(), s.as_ref(), Complex::from(1.0), PAR);
        self.space.times(&combined)
    }

    /// The coordinates a, with `part` 0, or b, with 1, of the columns `from` to `to` (without it) of V.
    fn coordinates(&self, part: usize, from: usize, to: usize) -> Block {
        let (vectors, states) = (self.vectors.basis(), self.factor.pencil().states().len());
        Mat::from_fn(self.space.columns(), to - from, |i, j| vectors[from + j][states + 2 * i + part])
    }

    /// Multiplies the columns that have not been and appends the result.
    ///
    /// # Errors
    /// A solution with Q(sigma) that is not accurate.
    pub(crate) fn step(&mut self) -> Result<(), SparseError> {
        let (from, to) = (self.multiplied, self.vectors.columns());
        let before = self.coordinates(0, from, to);
        let vectors = self.vectors.basis();
        let states = Mat::from_fn(self.factor.pencil().states().len(), to - from, |i, j| vectors[from + j][i]);
        let coefficients = self.extend(&before, states)?;
        self.projected.as_mut().submatrix_mut(0, from, coefficients.nrows(), to - from).copy_from(&coefficients);
        self.multiplied = to;
        Ok(())
    }

    /// Appends the image of the pending columns, whose u have the coordinates `before`. The coordinates of the image in the vectors V.
    fn extend(&mut self, before: &Block, mut states: Block) -> Result<Block, SparseError> {
        let (sigma, scale) = (self.factor.shift(), self.scale);
        let image = self.apply(&mut states)?;
        let a = self.space.append(image);
        let z = states.nrows();
        let mut coordinates = Mat::zeros(z + 2 * self.space.columns(), a.ncols());
        coordinates.as_mut().subrows_mut(0, z).copy_from(&states);
        for j in 0..a.ncols() {
            for i in 0..self.space.columns() {
                let u = if i < before.nrows() { before[(i, j)] } else { Complex::default() };
                coordinates[(z + 2 * i, j)] = a[(i, j)];
                coordinates[(z + 2 * i + 1, j)] = (sigma * a[(i, j)] + u) / scale;
            }
        }
        let from = self.vectors.columns();
        let coefficients = self.vectors.append(coordinates);
        let to = self.vectors.columns();
        // Both in one product.
        let [a, b] = [0, 1].map(|part| self.coordinates(part, from, to));
        let count = to - from;
        let both = Mat::from_fn(a.nrows(), 2 * count, |i, j| match j.checked_sub(count) {
            None => a[(i, j)],
            Some(j) => scale * b[(i, j)] + sigma * a[(i, j)],
        });
        let both = self.space.times(&both);
        self.pending = [0, count].map(|at| both.subcols(at, count).to_owned());
        Ok(coefficients)
    }

    /// u' of the pending columns and, in place, their z'.
    fn apply(&self, states: &mut Block) -> Result<Block, SparseError> {
        let (pencil, sigma) = (self.factor.pencil(), self.factor.shift());
        let [u, v] = &self.pending;
        let mut b = pencil.inertial_sum(self.side, v, u);
        let driven = |drive: &[(usize, f64)], x: &Block, j: usize| -> Complex<f64> {
            drive.iter().map(|&(dof, e)| x[(dof, j)] * e).sum()
        };
        for (i, state) in pencil.states().iter().enumerate() {
            let (drive, force) = state.sides(self.side);
            for j in 0..u.ncols() {
                let change = (driven(drive, u, j) - states[(i, j)]) / (sigma + state.decay);
                force.iter().for_each(|&(dof, f)| b[(dof, j)] -= change * f);
            }
        }
        let mut image = self.factor.solve(self.side, &b)?;
        image *= faer::Scale(Complex::from(-1.0));
        for (i, state) in pencil.states().iter().enumerate() {
            let (drive, _) = state.sides(self.side);
            for j in 0..u.ncols() {
                let velocity = sigma * driven(drive, &image, j) + driven(drive, u, j);
                states[(i, j)] = (velocity - states[(i, j)]) / (sigma + state.decay);
            }
        }
        Ok(image)
    }
}
