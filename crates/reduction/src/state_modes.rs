//! All eigenvalues of a small system without internal states, with right and left vectors.

use cea::Workspace;
use cea::certified::enclosures::unions;
use linsys::SecondOrder;
use nalgebra::DMatrix;
use num_complex::Complex;

use super::dense;
use crate::ReductionError;

/// Largest relative distance of two eigenvalues whose vectors are taken for any of a common space; chosen: farther apart, two vectors
/// have at most some millionths of each other.
const TOGETHER: f64 = 1e-10;

/// All eigenvalues and vectors of a system of order k. With `z = [y; lambda y / gamma]` it is `A z = lambda B z`, `A = [0, gamma I; -K / gamma, -C]`,
/// `B = [I, 0; 0, M]`; the right vectors are the columns of Z, the left ones those of W, scaled so that `W^H B Z = I`. From these
///
/// ```text
/// Q(lambda)^-1 = sum_j y_j v_j^H / (gamma (lambda - lambda_j))      v: lower parts of left vectors
/// ```
pub(super) struct StateModes {
    /// All 2 k eigenvalues, rad/s; complex ones in conjugate pairs, next to each other.
    pub lambdas: Vec<Complex<f64>>,
    /// The upper parts of right vectors, k x 2 k.
    pub y: DMatrix<Complex<f64>>,
    /// The lower parts of left vectors as rows, 2 k x k.
    pub lower: DMatrix<Complex<f64>>,
}

impl StateModes {
    /// The modes of a system, whose internal states are left out; gamma, rad/s, scales velocities.
    ///
    /// # Errors
    /// A mass matrix that is singular, vectors that are not independent.
    pub fn new(system: &SecondOrder, gamma: f64) -> Result<Self, ReductionError> {
        let SecondOrder { m, c, k, .. } = system;
        let order = m.nrows();
        let mut state = DMatrix::zeros(2 * order, 2 * order);
        state.view_mut((0, order), (order, order)).fill_diagonal(gamma);
        state.view_mut((order, 0), (order, order)).copy_from(&(dense::solve_real(m, k)? / -gamma));
        state.view_mut((order, order), (order, order)).copy_from(&-dense::solve_real(m, c)?);
        let (lambdas, mut z) = dense::eigen_real(&state)?;
        make_independent(system, gamma, &lambdas, &mut z);
        let inverse = dense::solve(&z, &DMatrix::identity(2 * order, 2 * order))?;
        // W^H = Z^-1 B^-1: the lower part times M^-1 from the right.
        let mass = m.map(Complex::from).transpose();
        let lower = dense::solve(&mass, &inverse.columns(order, order).transpose())?.transpose();
        Ok(Self { lambdas, y: z.rows(0, order).into_owned(), lower })
    }
}

/// Gives eigenvalues that rounding hardly tells apart, those of a ring that is alike all around, say, vectors that are independent: those of
/// an eigenvalue decomposition may be parallel but for rounding, and the inverse of all then is no number.
fn make_independent(system: &SecondOrder, gamma: f64, lambdas: &[Complex<f64>], z: &mut DMatrix<Complex<f64>>) {
    let order = system.order();
    let is_upper = |at: usize| lambdas[at].im > 0.0;
    let meet = |a: usize, b: usize| is_upper(b) && (lambdas[a] - lambdas[b]).norm() <= TOGETHER * lambdas[a].norm();
    for group in unions(lambdas.len(), is_upper, meet).into_iter().filter(|group| group.len() > 1) {
        let of_group: Vec<Complex<f64>> = group.iter().map(|&at| lambdas[at]).collect();
        let Ok(vectors) = cea::right_vectors(system, &of_group, &mut Workspace::default()) else { continue };
        for (&at, y) in group.iter().zip(vectors) {
            let velocity = &y * (lambdas[at] / gamma);
            let before = z.column(at).conjugate();
            z.view_mut((0, at), (order, 1)).copy_from(&y);
            z.view_mut((order, at), (order, 1)).copy_from(&velocity);
            let beside = [at.wrapping_sub(1), at + 1].into_iter();
            let mut beside = beside.filter(|&other| lambdas.get(other) == Some(&lambdas[at].conj()));
            if let Some(pair) = beside.find(|&other| z.column(other) == before) {
                let conjugate = z.column(at).conjugate();
                z.set_column(pair, &conjugate);
            }
        }
    }
}
