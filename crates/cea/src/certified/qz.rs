//! The real QZ iteration: eigenvalues of a regular pencil A - lambda B without inverting B.
//!
//! Reduction to Hessenberg-triangular form, then implicit double shifts (Moler and Stewart, SIAM J. Numer. Anal. 10,
//! 1973; Golub and Van Loan, Matrix Computations, section 7.7). Eigenvalues only: rotations act on the active window.
//! In double or, where that has too few digits, in double-double arithmetic.

use nalgebra::DMatrix;
use num_complex::Complex;

use super::dd::Dd;
use super::real::{Real, triangularise};
use crate::CeaError;

/// Double steps allowed per eigenvalue; a healthy pencil takes 1 to 2.
const MOST_QZ_STEPS: usize = 30;

/// Eigenvalues of A - lambda B, complex ones in exact conjugate pairs.
pub(crate) fn eigenvalues<T: Real>(a: DMatrix<T>, b: DMatrix<T>) -> Result<Vec<Complex<f64>>, CeaError> {
    let size = a.nrows();
    let mut pencil = HessenbergTriangular::reduced_from(a, b);
    let mut found = Vec::with_capacity(size);
    let cap = MOST_QZ_STEPS * size;
    let (mut end, mut steps, mut since) = (size, 0, 0);
    while end > 0 {
        let start = pencil.deflate(end, since > MOST_QZ_STEPS / 2);
        match end - start {
            1 => found.push(Complex::from((pencil.h[(start, start)] / pencil.t[(start, start)]).value())),
            2 => found.extend(pencil.pair(start)),
            _ => {
                if steps == cap {
                    return Err(CeaError::NoConvergence { iterations: cap, dimension: size });
                }
                (steps, since) = (steps + 1, since + 1);
                pencil.double_step(start, end, since % 10 == 0);
                continue;
            }
        }
        (end, since) = (start, 0);
    }
    Ok(found)
}

/// Start of a step whose shifts overflow (EISPACK's `qzit`).
const EXCEPTIONAL_START: [f64; 3] = [0.0, 1.0, 1.1605];

struct HessenbergTriangular<T> {
    /// Upper Hessenberg.
    h: DMatrix<T>,
    /// Upper triangular, no zero on its diagonal.
    t: DMatrix<T>,
    /// Frobenius norm of h.
    norm: f64,
}

impl<T: Real> HessenbergTriangular<T> {
    fn reduced_from(mut h: DMatrix<T>, mut t: DMatrix<T>) -> Self {
        let size = h.nrows();
        triangularise(&mut t, &mut h);
        for j in 0..size {
            t.view_mut((j + 1, j), (size - j - 1, 1)).fill(T::default());
        }
        for j in 0..size.saturating_sub(2) {
            for i in (j + 2..size).rev() {
                let (c, s) = rotation(h[(i - 1, j)], h[(i, j)]);
                if s.value() != 0.0 {
                    rotate_rows(&mut h, i - 1, j, size, c, s);
                    h[(i, j)] = T::default();
                    rotate_rows(&mut t, i - 1, i - 1, size, c, s);
                }
                // [t(i, i-1), t(i, i)] -> [0, *].
                let (c, s) = rotation(t[(i, i)], t[(i, i - 1)]);
                if s.value() != 0.0 {
                    rotate_columns(&mut t, i - 1, i + 1, c, s);
                    t[(i, i - 1)] = T::default();
                    rotate_columns(&mut h, i - 1, size, c, s);
                }
            }
        }
        // The pencil is regular and B has full rank in exact arithmetic: a zero here is a rounding error, and one of
        // its size takes its place.
        let norm = |a: &DMatrix<T>| a.iter().map(|x| x.value().powi(2)).sum::<f64>().sqrt();
        let least = T::EPSILON * norm(&t) * f64::EPSILON;
        for i in 0..size {
            if t[(i, i)].value().abs() < least {
                t[(i, i)] = T::from(least.copysign(t[(i, i)].value()));
            }
        }
        let norm = norm(&h);
        Self { h, t, norm }
    }

    /// Zeroes negligible subdiagonals; where the unreduced block that ends before `end` starts.
    fn deflate(&mut self, end: usize, lenient: bool) -> usize {
        for i in (1..end).rev() {
            let mut neighbours = self.h[(i - 1, i - 1)].value().abs() + self.h[(i, i)].value().abs();
            if lenient || neighbours == 0.0 {
                neighbours = self.norm;
            }
            if self.h[(i, i - 1)].value().abs() <= T::EPSILON * neighbours {
                self.h[(i, i - 1)] = T::default();
                return i;
            }
        }
        0
    }

    /// The two eigenvalues of the block at `at`, from trace and determinant of H T^-1 in double-double.
    fn pair(&self, at: usize) -> [Complex<f64>; 2] {
        let (h, t) = (&self.h, &self.t);
        let dd = |x: T| -> Dd { x.into() };
        let (t1, t2, t12) = (dd(t[(at, at)]), dd(t[(at + 1, at + 1)]), dd(t[(at, at + 1)]));
        let (e11, e21) = (dd(h[(at, at)]) / t1, dd(h[(at + 1, at)]) / t1);
        let e12 = (dd(h[(at, at + 1)]) - e11 * t12) / t2;
        let e22 = (dd(h[(at + 1, at + 1)]) - e21 * t12) / t2;
        let half = (e11 - e22).times(0.5);
        let mean = (e11 + e22).times(0.5);
        let discriminant = half * half + e12 * e21;
        if discriminant.hi < 0.0 {
            let root = (-discriminant).sqrt().value();
            return [Complex::new(mean.value(), root), Complex::new(mean.value(), -root)];
        }
        // The larger root without cancellation, the smaller from their product.
        let root = discriminant.sqrt();
        let large = if mean.hi < 0.0 { mean - root } else { mean + root };
        let product = e11 * e22 - e12 * e21;
        let small = if large.hi == 0.0 { Dd::default() } else { product / large };
        [Complex::from(large.value()), Complex::from(small.value())]
    }

    /// First column of E^2 - trace E + determinant, E = H T^-1, over its second entry of E's first column.
    ///
    /// Trace and determinant are those of E's last 2 x 2 block, or of two complex shifts of the size of its
    /// subdiagonal entries (as in EISPACK's `hqr`) where these lead nowhere.
    fn start_vector(&self, start: usize, end: usize, exceptional: bool) -> [T; 3] {
        let (h, t) = (&self.h, &self.t);
        let (l, m, n) = (start, end - 2, end - 1);
        let (b11, b22, b33, b44) = (t[(l, l)], t[(l + 1, l + 1)], t[(m, m)], t[(n, n)]);
        let (a11, a21) = (h[(l, l)] / b11, h[(l + 1, l)] / b11);
        let (a12, a22, a32) = (h[(l, l + 1)] / b22, h[(l + 1, l + 1)] / b22, h[(l + 2, l + 1)] / b22);
        let (a33, a43) = (h[(m, m)] / b33, h[(n, m)] / b33);
        let (a34, a44) = (h[(m, n)] / b44, h[(n, n)] / b44);
        let (b12, b34) = (t[(l, l + 1)] / b22, t[(m, n)] / b44);
        if exceptional {
            let size = a43.value().abs() + (h[(m, m - 1)] / t[(m - 1, m - 1)]).value().abs();
            let (trace, determinant) = (T::from(1.5 * size), T::from(size) * T::from(size));
            return [(a11 * (a11 - trace) + determinant) / a21 + a12 - a11 * b12, a11 + a22 - a21 * b12 - trace, a32];
        }
        [
            ((a33 - a11) * (a44 - a11) - a34 * a43 + a43 * b34 * a11) / a21 + a12 - a11 * b12,
            (a22 - a11) - a21 * b12 - (a33 - a11) - (a44 - a11) + a43 * b34,
            a32,
        ]
    }

    fn double_step(&mut self, start: usize, end: usize, exceptional: bool) {
        let mut v = self.start_vector(start, end, exceptional);
        if v.iter().any(|x| !x.value().is_finite()) {
            v = EXCEPTIONAL_START.map(T::from);
        }
        for k in start..end - 2 {
            let first = if k > start { k - 1 } else { start };
            if k > start {
                v = [self.h[(k, k - 1)], self.h[(k + 1, k - 1)], self.h[(k + 2, k - 1)]];
            }
            let (w, beta) = householder(v);
            reflect_rows(&mut self.h, k, first, end, w, beta);
            reflect_rows(&mut self.t, k, k, end, w, beta);
            if k > start {
                self.h[(k + 1, k - 1)] = T::default();
                self.h[(k + 2, k - 1)] = T::default();
            }
            let below = (k + 4).min(end);
            // Row k + 2 of T back to one entry, then row k + 1.
            let (w, beta) = householder([self.t[(k + 2, k + 2)], self.t[(k + 2, k + 1)], self.t[(k + 2, k)]]);
            let w = [w[2], w[1], w[0]];
            reflect_columns(&mut self.h, k, start, below, w, beta);
            reflect_columns(&mut self.t, k, start, k + 3, w, beta);
            self.t[(k + 2, k)] = T::default();
            self.t[(k + 2, k + 1)] = T::default();
            self.clear_below_diagonal(k + 1, start, below);
        }
        let k = end - 2;
        let (c, s) = rotation(self.h[(k, k - 1)], self.h[(k + 1, k - 1)]);
        rotate_rows(&mut self.h, k, k - 1, end, c, s);
        self.h[(k + 1, k - 1)] = T::default();
        rotate_rows(&mut self.t, k, k, end, c, s);
        self.clear_below_diagonal(k + 1, start, end);
    }

    /// T(i, i - 1) = 0 by a rotation of columns i - 1 and i, H's rows in `start..below` along with it.
    fn clear_below_diagonal(&mut self, i: usize, start: usize, below: usize) {
        let (c, s) = rotation(self.t[(i, i)], self.t[(i, i - 1)]);
        rotate_columns_from(&mut self.t, i - 1, start, i + 1, c, s);
        self.t[(i, i - 1)] = T::default();
        rotate_columns_from(&mut self.h, i - 1, start, below, c, s);
    }
}

/// c, s with `[c s; -s c] [a; b] = [r; 0]`.
fn rotation<T: Real>(a: T, b: T) -> (T, T) {
    let largest = a.value().abs().max(b.value().abs());
    if b.value() == 0.0 || largest.is_nan() {
        return (T::from(1.0), T::default());
    }
    let (a, b) = (a / T::from(largest), b / T::from(largest));
    let r = (a * a + b * b).root();
    (a / r, b / r)
}

/// w, beta with `(I - beta w w^T) v = [*; 0; 0]`.
fn householder<T: Real>(v: [T; 3]) -> ([T; 3], T) {
    let largest = v.iter().fold(0.0, |m: f64, x| m.max(x.value().abs()));
    if largest == 0.0 {
        return ([T::default(); 3], T::default());
    }
    let v = v.map(|x| x / T::from(largest));
    let square = |v: [T; 3]| v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    let norm = square(v).root();
    let w = [if v[0].value() < 0.0 { v[0] - norm } else { v[0] + norm }, v[1], v[2]];
    (w, T::from(2.0) / square(w))
}

fn rotate_rows<T: Real>(a: &mut DMatrix<T>, row: usize, from: usize, to: usize, c: T, s: T) {
    let rows = a.nrows();
    for column in a.as_mut_slice()[from * rows..to * rows].chunks_exact_mut(rows) {
        let (x, y) = (column[row], column[row + 1]);
        column[row] = c * x + s * y;
        column[row + 1] = c * y - s * x;
    }
}

/// Columns `column` and `column + 1` in rows `0..to`: the second takes up what the first loses.
fn rotate_columns<T: Real>(a: &mut DMatrix<T>, column: usize, to: usize, c: T, s: T) {
    rotate_columns_from(a, column, 0, to, c, s);
}

fn rotate_columns_from<T: Real>(a: &mut DMatrix<T>, column: usize, from: usize, to: usize, c: T, s: T) {
    let rows = a.nrows();
    let (left, right) = a.as_mut_slice()[column * rows..(column + 2) * rows].split_at_mut(rows);
    for (x, y) in left[from..to].iter_mut().zip(&mut right[from..to]) {
        (*x, *y) = (c * *x - s * *y, c * *y + s * *x);
    }
}

fn reflect_rows<T: Real>(a: &mut DMatrix<T>, row: usize, from: usize, to: usize, w: [T; 3], beta: T) {
    let rows = a.nrows();
    for column in a.as_mut_slice()[from * rows..to * rows].chunks_exact_mut(rows) {
        let x = &mut column[row..row + 3];
        let sum = beta * (w[0] * x[0] + w[1] * x[1] + w[2] * x[2]);
        x[0] = x[0] - sum * w[0];
        x[1] = x[1] - sum * w[1];
        x[2] = x[2] - sum * w[2];
    }
}

fn reflect_columns<T: Real>(a: &mut DMatrix<T>, column: usize, from: usize, to: usize, w: [T; 3], beta: T) {
    let rows = a.nrows();
    let (first, rest) = a.as_mut_slice()[column * rows..(column + 3) * rows].split_at_mut(rows);
    let (second, third) = rest.split_at_mut(rows);
    let both = second[from..to].iter_mut().zip(&mut third[from..to]);
    for (x, (y, z)) in first[from..to].iter_mut().zip(both) {
        let sum = beta * (w[0] * *x + w[1] * *y + w[2] * *z);
        *x = *x - sum * w[0];
        *y = *y - sum * w[1];
        *z = *z - sum * w[2];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sort;
    use nalgebra::dmatrix;
    use proptest::prelude::*;

    #[test]
    fn a_diagonal_pencil_gives_its_quotients() {
        let a = DMatrix::from_diagonal(&nalgebra::dvector![1.0, -6.0, 10.0, 0.25]);
        let b = DMatrix::from_diagonal(&nalgebra::dvector![2.0, 3.0, 4.0, 1e-30]);
        let mut found = eigenvalues(a, b).unwrap();
        sort(&mut found);
        let expected = [-2.0, 0.5, 2.5];
        assert!(found.iter().zip(expected).all(|(l, e)| (l - e).norm() < 1e-14));
        assert!(found[3].norm() > 1e14);
    }

    #[test]
    fn a_cyclic_shift_converges_through_its_exceptional_steps() {
        let n = 8;
        let shift = DMatrix::from_fn(n, n, |i, j| if i == (j + 1) % n { 1.0 } else { 0.0 });
        let found = eigenvalues(shift, DMatrix::identity(n, n)).unwrap();
        assert!(found.iter().all(|l| (l.powu(8) - 1.0).norm() < 1e-12));
    }

    #[test]
    fn what_is_not_finite_is_no_convergence() {
        let bad = dmatrix![f64::NAN, 1.0, 2.0; 1.0, f64::NAN, 1.0; 1.0, 1.0, f64::NAN];
        assert!(matches!(eigenvalues(bad, DMatrix::identity(3, 3)), Err(CeaError::NoConvergence { .. })));
    }

    proptest! {
        /// The pencil Q (D - lambda I) Z with random Q and Z has the eigenvalues of D.
        #[test]
        fn a_pencil_keeps_its_eigenvalues_under_equivalence(
            entries in prop::collection::vec(-1.0..1.0f64, 2 * 36),
            angle in 0.1..3.0f64,
        ) {
            let q = DMatrix::from_column_slice(6, 6, &entries[..36]) + DMatrix::identity(6, 6) * 5.0;
            let z = DMatrix::from_column_slice(6, 6, &entries[36..]) + DMatrix::identity(6, 6) * 5.0;
            let mut d = DMatrix::from_diagonal(&nalgebra::dvector![0.0, 0.0, 1e-3, 2.0, -3.0, 50.0]);
            let (sin, cos) = angle.sin_cos();
            d.view_mut((0, 0), (2, 2)).copy_from(&dmatrix![cos, sin; -sin, cos]);
            let mut found = eigenvalues(&q * &d * &z, &q * &z).unwrap();
            sort(&mut found);
            let mut expected = vec![1e-3, 2.0, -3.0, 50.0].into_iter().map(Complex::from).collect::<Vec<_>>();
            expected.extend([Complex::new(cos, sin), Complex::new(cos, -sin)]);
            sort(&mut expected);
            for (l, e) in found.iter().zip(&expected) {
                prop_assert!((l - e).norm() < 1e-11 * (1.0 + e.norm()), "{} {}", l, e);
            }
        }
    }
}
