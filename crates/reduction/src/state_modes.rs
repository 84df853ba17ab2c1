//! All eigenvalues of a small system without internal states, with right and left vectors.

use linsys::SecondOrder;
use nalgebra::DMatrix;
use num_complex::Complex;

use super::dense;
use crate::ReductionError;

/// With `z = [y; lambda y / gamma]` the system is `A z = lambda B z`, `A = [0, gamma I; -K / gamma, -C]`, `B = [I, 0; 0, M]`, and left
/// vectors are scaled so that `W^H B Z = I`. From these
///
/// ```text
/// Q(lambda)^-1 = sum_j y_j v_j^H / (gamma (lambda - lambda_j))      v: lower parts of left vectors
/// ```
pub(super) struct StateModes {
    /// All 2 k eigenvalues, rad/s; complex ones in conjugate pairs, next to each other.
    pub lambdas: Vec<Complex<f64>>,
    /// The parts of right vectors, k x 2 k.
    pub y: DMatrix<Complex<f64>>,
    pub velocity: DMatrix<Complex<f64>>,
    /// The lower parts of left vectors as rows, 2 k x k.
    pub lower: DMatrix<Complex<f64>>,
}

impl StateModes {
    /// # Errors
    /// A mass matrix that is singular.
    pub fn new(SecondOrder { m, c, k, .. }: &SecondOrder, gamma: f64) -> Result<Self, ReductionError> {
        let order = m.nrows();
        let mut state = DMatrix::zeros(2 * order, 2 * order);
        state.view_mut((0, order), (order, order)).fill_diagonal(gamma);
        state.view_mut((order, 0), (order, order)).copy_from(&(dense::solve_real(m, k)? / -gamma));
        state.view_mut((order, order), (order, order)).copy_from(&-dense::solve_real(m, c)?);
        let (lambdas, z) = dense::eigen_real(&state)?;
        let inverse = dense::solve(&z, &DMatrix::identity(2 * order, 2 * order))?;
        // W^H = Z^-1 B^-1: the lower part times M^-1 from the right.
        let mass = m.map(Complex::from).transpose();
        let lower = dense::solve(&mass, &inverse.columns(order, order).transpose())?.transpose();
        Ok(Self { lambdas, y: z.rows(0, order).into_owned(), velocity: z.rows(order, order).into_owned(), lower })
    }
}
