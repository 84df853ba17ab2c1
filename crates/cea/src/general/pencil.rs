//! The companion pencil A - sigma B, and the removal of its infinite and zero eigenvalues.
//!
//! Each step takes a null space of B out by orthogonal transformations from both sides (the staircase of Van Dooren,
//! Linear Algebra Appl. 27, 1979; its first step is that of quadeig, Hammarling, Munro, Tisseur, ACM TOMS 39, 2013).
//! The dimensions are known from [`Structure`](super::structure::Structure), so no tolerance decides a rank, and the
//! long Jordan chains that constraints have at infinity leave with the rest.

use nalgebra::DMatrix;

use super::scaled::Scaled;

/// `A - sigma B` with `A = [0 I; -K -C]`, `B = [I 0; 0 M]`.
#[derive(Debug, Clone)]
pub(crate) struct Pencil {
    pub(crate) a: DMatrix<f64>,
    pub(crate) b: DMatrix<f64>,
}

impl Pencil {
    pub(crate) fn companion(s: &Scaled) -> Self {
        let n = s.order();
        let (mut a, mut b) = (DMatrix::zeros(2 * n, 2 * n), DMatrix::identity(2 * n, 2 * n));
        a.view_mut((0, n), (n, n)).fill_with_identity();
        a.view_mut((n, 0), (n, n)).copy_from(&-&s.k);
        a.view_mut((n, n), (n, n)).copy_from(&-&s.c);
        b.view_mut((n, n), (n, n)).copy_from(&s.m);
        Self { a, b }
    }

    /// Without its infinite eigenvalues, whose chains come off with these widths.
    pub(crate) fn without_infinite(mut self, widths: &[usize]) -> Self {
        for &width in widths {
            let (b, a) = remove_null_space(&self.b, &self.a, width);
            self = Self { a, b };
        }
        self
    }

    /// Without its zero eigenvalues.
    pub(crate) fn without_zero(self, widths: &[usize]) -> Self {
        let Self { a, b } = Self { a: self.b, b: self.a }.without_infinite(widths);
        Self { a: b, b: a }
    }
}

/// `first` has a null space of dimension `width`; both matrices on its complement, in the rows that the image of the
/// null space under `second` leaves free.
fn remove_null_space(first: &DMatrix<f64>, second: &DMatrix<f64>, width: usize) -> (DMatrix<f64>, DMatrix<f64>) {
    let size = first.nrows();
    let rest = size - width;
    // first^T P = Q R: the last `width` columns of first Q vanish.
    let z = first.transpose().col_piv_qr().q();
    let (first, second) = (first * &z, second * &z);
    let rows = second.columns(rest, width).into_owned().qr();
    let cut = |matrix: DMatrix<f64>| {
        let mut kept = matrix.columns(0, rest).into_owned();
        rows.q_tr_mul(&mut kept);
        kept.rows(width, rest).into_owned()
    };
    (cut(first), cut(second))
}
