//! The companion pencil A - sigma B, and the removal of its infinite and zero eigenvalues.
//!
//! Each step takes a null space of B out by orthogonal transformations from both sides (the staircase of Van Dooren,
//! Linear Algebra Appl. 27, 1979; its first step is the one of quadeig, Hammarling, Munro, Tisseur, ACM TOMS 39, 2013).
//! The dimensions are known from [`Structure`](super::structure::Structure), so no tolerance decides a rank, and the
//! long Jordan chains that constraints have at infinity leave with the rest.

use nalgebra::DMatrix;
use num_complex::Complex;

use super::lane::Lane;
use super::planar::{Planar, reveal_rank, triangularise};
use super::scaled::Scaled;
use super::standard::finite_reciprocal;
use super::{qz, standard};
use crate::CertifiedError;

/// `A - sigma B` with `A = [-C, -K / d; d I, 0]`, `B = [M 0; 0 I]`; its vectors are (sigma x, d x).
///
/// d = 1 where the damping is no stronger than stiffness and mass allow in the scaled problem; where it is, by a factor
/// tau, d = 1 / tau. Then the eigenvalues of size tau live in the large upper rows and those of size 1 / tau in the small
/// lower ones. Householder reductions and QR steps keep rows that are graded downwards so, and both kinds come out with
/// small backward errors. (Tropical scaling, Gaubert and Sharify 2009, needs a solve for each kind.)
#[derive(Debug, Clone)]
pub(crate) struct Pencil<T> {
    a: Planar<T>,
    b: Planar<T>,
    /// Norms of A and B before anything was removed: rounding errors are of their size.
    norms: (f64, f64),
}

/// A and B of the scaled problem.
pub(crate) fn companion(s: &Scaled) -> (DMatrix<f64>, DMatrix<f64>) {
    let n = s.order();
    let d = s.grading();
    let (mut a, mut b) = (DMatrix::zeros(2 * n, 2 * n), DMatrix::identity(2 * n, 2 * n));
    a.view_mut((0, 0), (n, n)).copy_from(&-&s.c);
    a.view_mut((0, n), (n, n)).copy_from(&(&s.k / -d));
    a.view_mut((n, 0), (n, n)).fill_diagonal(d);
    b.view_mut((0, 0), (n, n)).copy_from(&s.m);
    (a, b)
}

impl<T: Lane> Pencil<T> {
    pub(crate) fn new((a, b): &(DMatrix<f64>, DMatrix<f64>)) -> Self {
        Self { a: Planar::from(a), b: Planar::from(b), norms: (a.norm(), b.norm()) }
    }

    /// The pencil without its infinite eigenvalues, whose chains come off with these widths.
    pub(crate) fn without_infinite(mut self, widths: &[usize]) -> Self {
        for &width in widths {
            (self.b, self.a) = remove_null_space(self.b, self.a, width);
        }
        self
    }

    /// The pencil without its zero eigenvalues, whose chains come off with these widths.
    pub(crate) fn without_zero(mut self, widths: &[usize]) -> Self {
        for &width in widths {
            (self.a, self.b) = remove_null_space(self.a, self.b, width);
        }
        self
    }

    /// Last pivots of A and B in units of the norms they started from: how nearly singular they are.
    pub(crate) fn depths(&self) -> (f64, f64) {
        (last_pivot(&self.a) / self.norms.0, last_pivot(&self.b) / self.norms.1)
    }

    /// Eigenvalues of the pencil by the QZ iteration, on the reversed pencil where that is asked for: A should be better conditioned
    /// than B then.
    ///
    /// All of them are finite and not zero; an infinite or zero one is a rounding error, replaced by one of its size.
    pub(crate) fn eigenvalues(self, reversed: bool) -> Result<Vec<Complex<f64>>, CertifiedError> {
        if !reversed {
            return qz::eigenvalues(self.a, self.b);
        }
        Ok(qz::eigenvalues(self.b, self.a)?.into_iter().map(finite_reciprocal::<T>).collect())
    }

    /// Eigenvalues of the pencil by the QR iteration on B^-1 A, or A^-1 B of the reversed pencil; none where that would cost digits.
    pub(crate) fn standard_eigenvalues(&self, reversed: bool) -> Option<Vec<Complex<f64>>> {
        if !reversed {
            return standard::eigenvalues(&self.a, &self.b);
        }
        let found = standard::eigenvalues(&self.b, &self.a)?;
        Some(found.into_iter().map(finite_reciprocal::<T>).collect())
    }
}

/// Last pivots of K and M in units of their norms: how nearly singular they are.
pub(crate) fn depths_of_quadratic(s: &Scaled) -> (f64, f64) {
    let depth = |a: &DMatrix<f64>, norm: f64| last_pivot(&Planar::<f64>::from(a)) / norm;
    (depth(&s.k, s.norms.k), depth(&s.m, s.norms.m))
}

/// The smallest diagonal entry of the pivoted QR factor.
fn last_pivot<T: Lane>(a: &Planar<T>) -> f64 {
    let sizes = reveal_rank(&mut a.clone(), &mut Planar::from_fn(a.rows(), 0, |_, _| T::default()), a.rows());
    sizes.iter().copied().fold(f64::INFINITY, f64::min)
}

/// `first` has a null space of dimension `width`; both matrices on its complement, in the rows that the image of the
/// null space under `second` leaves free.
fn remove_null_space<T: Lane>(first: Planar<T>, second: Planar<T>, width: usize) -> (Planar<T>, Planar<T>) {
    let size = first.rows();
    let rest = size - width;
    // From the right: the last `width` columns of `first` vanish.
    let (mut first, mut second) = (first.transpose(), second.transpose());
    reveal_rank(&mut first, &mut second, rest);
    // From the left: those columns of `second` go into the first `width` rows.
    let mut image = second.block(rest..size, 0..size).transpose();
    let (mut first, mut second) =
        (first.block(0..rest, 0..size).transpose(), second.block(0..rest, 0..size).transpose());
    triangularise(&mut image, [&mut first, &mut second]);
    (first.block(width..size, 0..rest), second.block(width..size, 0..rest))
}
