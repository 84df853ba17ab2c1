//! Real numbers of working or double precision, and the orthogonal reductions that need no more than them.

use std::ops::{Add, Div, Mul, Neg, Sub};

use nalgebra::{DMatrix, Scalar};

use super::dd::Dd;

/// `f64` or [`Dd`].
pub(crate) trait Real:
    Scalar
    + Copy
    + Default
    + From<f64>
    + Into<Dd>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Distance from 1 to the next number.
    const EPSILON: f64;
    /// Rounded to a double.
    fn value(self) -> f64;
    /// The square root of a number that is not negative.
    fn root(self) -> Self;
}

impl Real for f64 {
    const EPSILON: f64 = f64::EPSILON;
    fn value(self) -> f64 {
        self
    }
    fn root(self) -> Self {
        self.sqrt()
    }
}

impl Real for Dd {
    const EPSILON: f64 = f64::EPSILON * f64::EPSILON;
    fn value(self) -> f64 {
        Dd::value(self)
    }
    fn root(self) -> Self {
        self.sqrt()
    }
}

/// `I - beta w w^T`, which takes the vector that it was made of to a multiple of the first unit vector.
pub(crate) struct Reflector<T> {
    w: Vec<T>,
    beta: T,
}

impl<T: Real> Reflector<T> {
    /// None of a vector that is zero.
    pub(crate) fn of(x: &[T]) -> Option<Self> {
        let largest = x.iter().fold(0.0, |m: f64, v| m.max(v.value().abs()));
        if largest.is_nan() || largest <= 0.0 {
            return None;
        }
        let scale = T::from(1.0) / T::from(largest);
        let mut w: Vec<T> = x.iter().map(|&v| v * scale).collect();
        let square = w.iter().fold(T::default(), |s, &v| s + v * v);
        let norm = square.root();
        let first = w.first().copied().unwrap_or_default();
        let head = if first.value() < 0.0 { first - norm } else { first + norm };
        // |w|^2 with the new head, without another pass.
        let length = square - first * first + head * head;
        if let Some(w) = w.first_mut() {
            *w = head;
        }
        Some(Self { w, beta: T::from(2.0) / length })
    }

    /// Applied to a vector of the same length.
    pub(crate) fn apply(&self, x: &mut [T]) {
        let sum = self.w.iter().zip(&*x).fold(T::default(), |s, (&w, &v)| s + w * v) * self.beta;
        for (v, &w) in x.iter_mut().zip(&self.w) {
            *v = *v - sum * w;
        }
    }

    /// Applied to the rows from `row` on, in the columns from `column` on.
    pub(crate) fn apply_to_rows(&self, a: &mut DMatrix<T>, row: usize, column: usize) {
        let rows = a.nrows();
        for x in a.as_mut_slice()[column * rows..].chunks_exact_mut(rows) {
            self.apply(&mut x[row..row + self.w.len()]);
        }
    }
}

/// `a` made upper triangular from the left, `other` along with it.
pub(crate) fn triangularise<T: Real>(a: &mut DMatrix<T>, other: &mut DMatrix<T>) {
    for k in 0..a.ncols().min(a.nrows().saturating_sub(1)) {
        if let Some(reflector) = Reflector::of(&a.column(k).as_slice()[k..]) {
            reflector.apply_to_rows(a, k, k);
            reflector.apply_to_rows(other, k, 0);
        }
    }
}

/// Reflects `a` from the left so that its rows after the first `rank` vanish if that is its rank, `other` along with
/// it; the largest column that is left takes its turn. Returns what each turn found, descending but for rounding.
pub(crate) fn reveal_rank<T: Real>(a: &mut DMatrix<T>, other: &mut DMatrix<T>, rank: usize) -> Vec<f64> {
    let mut left: Vec<usize> = (0..a.ncols()).collect();
    let mut sizes = Vec::with_capacity(rank);
    for k in 0..rank.min(a.nrows()) {
        let size = |j: usize| a.column(j).as_slice()[k..].iter().map(|v| v.value().powi(2)).sum::<f64>();
        let Some((at, square)) = left.iter().map(|&j| size(j)).enumerate().max_by(|x, y| x.1.total_cmp(&y.1)) else {
            break;
        };
        sizes.push(square.sqrt());
        let column = left.swap_remove(at);
        if let Some(reflector) = Reflector::of(&a.column(column).as_slice()[k..]) {
            reflector.apply_to_rows(a, k, 0);
            reflector.apply_to_rows(other, k, 0);
        }
    }
    sizes
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    #[test]
    fn a_matrix_of_rank_one_keeps_one_row() {
        let mut a = dmatrix![1.0, 2.0, 3.0; 2.0, 4.0, 6.0; -1.0, -2.0, -3.0];
        let mut turned = DMatrix::identity(3, 3);
        let original = a.clone();
        let sizes = reveal_rank(&mut a, &mut turned, 3);
        assert!((sizes[0] - 54f64.sqrt()).abs() < 1e-14 && sizes[1] < 1e-14);
        assert!(a.rows(1, 2).norm() < 1e-14);
        assert!((turned * original - a).norm() < 1e-14);
    }

    #[test]
    fn double_double_triangularises_to_thirty_digits() {
        let hilbert = DMatrix::from_fn(5, 5, |i, j| Dd::from(1.0) / Dd::from((i + j + 1) as f64));
        let (mut r, mut q) = (hilbert.clone(), DMatrix::from_fn(5, 5, |i, j| Dd::from(f64::from(i == j))));
        triangularise(&mut r, &mut q);
        for i in 0..5 {
            for j in 0..5 {
                let product = (0..5).fold(Dd::default(), |s, k| s + q[(i, k)] * hilbert[(k, j)]);
                assert!((product - r[(i, j)]).value().abs() < 1e-30);
                assert!(i <= j || r[(i, j)].value().abs() < 1e-30);
            }
        }
    }
}
