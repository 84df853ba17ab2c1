//! The real QZ iteration: eigenvalues of a regular pencil A - lambda B without inverting B.
//!
//! Reduction to Hessenberg-triangular form, then implicit double shifts (Moler and Stewart, SIAM J. Numer. Anal. 10,
//! 1973; Golub and Van Loan, Matrix Computations, section 7.7). Eigenvalues only: rotations act on the active window.
//! In double or, where that has too few digits, in double-double arithmetic.

use num_complex::Complex;

use super::dd::Dd;
use super::eliminate::{householder, rotation};
use super::lane::Lane;
use super::planar::{Planar, triangularise};
use crate::CertifiedError;

/// Most double steps per eigenvalue; chosen, as LAPACK has it: a healthy pencil takes 1 to 2, and more are for one that does not
/// converge.
const MOST_QZ_STEPS: usize = 30;
/// Number of reflections of rows that are put off together; chosen: few columns are near them, and a register's detour to gather rows
/// pays.
const CHUNK: usize = 32;

/// Eigenvalues of A - lambda B, complex ones in exact conjugate pairs.
pub(crate) fn eigenvalues<T: Lane>(a: Planar<T>, b: Planar<T>) -> Result<Vec<Complex<f64>>, CertifiedError> {
    let size = a.rows();
    let mut pencil = HessenbergTriangular::reduced_from(a, b);
    let mut found = Vec::with_capacity(size);
    let cap = MOST_QZ_STEPS * size;
    let (mut end, mut steps, mut since) = (size, 0, 0);
    while end > 0 {
        let start = pencil.deflate(end, since > MOST_QZ_STEPS / 2);
        match end - start {
            1 => found.push(Complex::from((pencil.h.get(start, start) / pencil.t.get(start, start)).value())),
            2 => found.extend(pencil.pair(start)),
            _ => {
                if steps == cap {
                    return Err(CertifiedError::NoConvergence { iterations: cap, dimension: size });
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
    /// H, upper Hessenberg.
    h: Planar<T>,
    /// T, upper triangular, no zero on its diagonal.
    t: Planar<T>,
    /// Frobenius norm of h.
    norm: f64,
}

impl<T: Lane> HessenbergTriangular<T> {
    fn reduced_from(mut h: Planar<T>, mut t: Planar<T>) -> Self {
        let size = h.rows();
        triangularise(&mut t, [&mut h]);
        for j in 0..size {
            (j + 1..size).for_each(|i| t.set(i, j, T::default()));
        }
        for j in 0..size.saturating_sub(2) {
            clear_below_subdiagonal(&mut h, &mut t, j);
        }
        // The pencil is regular and B has full rank in exact arithmetic: a zero here is a rounding error, and one of
        // its size takes its place.
        let least = T::EPSILON * t.norm() * f64::EPSILON;
        for i in 0..size {
            let pivot = t.get(i, i).value();
            if pivot.abs() < least {
                t.set(i, i, T::from(least.copysign(pivot)));
            }
        }
        let norm = h.norm();
        Self { h, t, norm }
    }

    /// Zeroes negligible subdiagonals; where the unreduced block that ends before `end` starts.
    fn deflate(&mut self, end: usize, lenient: bool) -> usize {
        for i in (1..end).rev() {
            let mut neighbours = self.h.get(i - 1, i - 1).value().abs() + self.h.get(i, i).value().abs();
            if lenient || neighbours == 0.0 {
                neighbours = self.norm;
            }
            if self.h.get(i, i - 1).value().abs() <= T::EPSILON * neighbours {
                self.h.set(i, i - 1, T::default());
                return i;
            }
        }
        0
    }

    /// The two eigenvalues of the block at `at`, from trace and determinant of H T^-1 in double-double.
    fn pair(&self, at: usize) -> [Complex<f64>; 2] {
        let (h, t) = (&self.h, &self.t);
        let dd = |x: T| -> Dd { x.into() };
        let (t1, t2, t12) = (dd(t.get(at, at)), dd(t.get(at + 1, at + 1)), dd(t.get(at, at + 1)));
        let (e11, e21) = (dd(h.get(at, at)) / t1, dd(h.get(at + 1, at)) / t1);
        let e12 = (dd(h.get(at, at + 1)) - e11 * t12) / t2;
        let e22 = (dd(h.get(at + 1, at + 1)) - e21 * t12) / t2;
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
        let (b11, b22, b33, b44) = (t.get(l, l), t.get(l + 1, l + 1), t.get(m, m), t.get(n, n));
        let (a11, a21) = (h.get(l, l) / b11, h.get(l + 1, l) / b11);
        let (a12, a22, a32) = (h.get(l, l + 1) / b22, h.get(l + 1, l + 1) / b22, h.get(l + 2, l + 1) / b22);
        let (a33, a43) = (h.get(m, m) / b33, h.get(n, m) / b33);
        let (a34, a44) = (h.get(m, n) / b44, h.get(n, n) / b44);
        let (b12, b34) = (t.get(l, l + 1) / b22, t.get(m, n) / b44);
        if exceptional {
            let size = a43.value().abs() + (h.get(m, m - 1) / t.get(m - 1, m - 1)).value().abs();
            let (trace, determinant) = (T::from(1.5 * size), T::from(size) * T::from(size));
            return [(a11 * (a11 - trace) + determinant) / a21 + a12 - a11 * b12, a11 + a22 - a21 * b12 - trace, a32];
        }
        [
            ((a33 - a11) * (a44 - a11) - a34 * a43 + a43 * b34 * a11) / a21 + a12 - a11 * b12,
            (a22 - a11) - a21 * b12 - (a33 - a11) - (a44 - a11) + a43 * b34,
            a32,
        ]
    }

    /// Makes an implicit double shift on the unreduced block `start..end`.
    ///
    /// What a reflection of rows does to columns that the next [`CHUNK`] reflections of columns leave alone waits until
    /// these are through.
    fn double_step(&mut self, start: usize, end: usize, exceptional: bool) {
        let mut v = self.start_vector(start, end, exceptional);
        if v.iter().any(|x| !x.value().is_finite()) {
            v = EXCEPTIONAL_START.map(T::from);
        }
        for chunk in (start..end - 2).step_by(CHUNK) {
            let last = (end - 2).min(chunk + CHUNK);
            let near = end.min(last + 3);
            let mut reflections = Vec::with_capacity(CHUNK);
            for k in chunk..last {
                if k > start {
                    v = [self.h.get(k, k - 1), self.h.get(k + 1, k - 1), self.h.get(k + 2, k - 1)];
                }
                let reflection = householder(v);
                self.h.reflect_rows_downwards(k, k.max(start + 1) - 1..near, &[reflection]);
                self.t.reflect_rows_downwards(k, k..near, &[reflection]);
                reflections.push(reflection);
                if k > start {
                    self.h.set(k + 1, k - 1, T::default());
                    self.h.set(k + 2, k - 1, T::default());
                }
                self.restore_triangle(k, start, (k + 4).min(end));
            }
            self.h.reflect_rows_downwards(chunk, near..end, &reflections);
            self.t.reflect_rows_downwards(chunk, near..end, &reflections);
        }
        let k = end - 2;
        let rotation = rotation(self.h.get(k, k - 1), self.h.get(k + 1, k - 1));
        self.h.rotate_rows_upwards(k + 1, k - 1..end, &[rotation]);
        self.h.set(k + 1, k - 1, T::default());
        self.t.rotate_rows_upwards(k + 1, k..end, &[rotation]);
        self.clear_below_diagonal(k + 1, start, end);
    }

    /// T's rows k + 2 and k + 1 back to their triangle by columns k to k + 2; H's rows in `start..below` along with it.
    fn restore_triangle(&mut self, k: usize, start: usize, below: usize) {
        let reflection = householder([self.t.get(k + 2, k + 2), self.t.get(k + 2, k + 1), self.t.get(k + 2, k)]);
        self.h.reflect_columns_backwards(k, start..below, reflection);
        self.t.reflect_columns_backwards(k, start..k + 3, reflection);
        self.t.set(k + 2, k, T::default());
        self.t.set(k + 2, k + 1, T::default());
        self.clear_below_diagonal(k + 1, start, below);
    }

    /// T(i, i - 1) = 0 by a rotation of columns i - 1 and i, H's rows in `start..below` along with it.
    fn clear_below_diagonal(&mut self, i: usize, start: usize, below: usize) {
        let rotation = rotation(self.t.get(i, i), self.t.get(i, i - 1));
        self.t.rotate_columns(i - 1, start..i + 1, rotation);
        self.t.set(i, i - 1, T::default());
        self.h.rotate_columns(i - 1, start..below, rotation);
    }
}

/// H's column j made zero below its second entry from below, by rotations of neighbouring rows; these fill T's
/// subdiagonal, which rotations of columns clear again (Golub and Van Loan, section 7.7.4). All rotations of rows come
/// first: rotations of columns leave column j of H alone, which they are made of.
fn clear_below_subdiagonal<T: Lane>(h: &mut Planar<T>, t: &mut Planar<T>, j: usize) {
    let size = h.rows();
    let mut rotations = Vec::with_capacity(size - j);
    let mut below = h.get(size - 1, j);
    for i in (j + 2..size).rev() {
        let above = h.get(i - 1, j);
        let (c, s) = rotation(above, below);
        below = c * above + s * below;
        h.set(i, j, T::default());
        rotations.push((c, s));
    }
    h.set(j + 1, j, below);
    h.rotate_rows_upwards(size - 1, j + 1..size, &rotations);
    t.rotate_rows_upwards(size - 1, j + 1..size, &rotations);
    for i in (j + 2..size).rev() {
        let rotation = rotation(t.get(i, i), t.get(i, i - 1));
        t.rotate_columns(i - 1, 0..i + 1, rotation);
        t.set(i, i - 1, T::default());
        h.rotate_columns(i - 1, 0..size, rotation);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{Known, long_pencil};
    use crate::sort;
    use nalgebra::{DMatrix, dmatrix};
    use proptest::prelude::*;

    fn in_double(a: &DMatrix<f64>, b: &DMatrix<f64>) -> Result<Vec<Complex<f64>>, CertifiedError> {
        eigenvalues::<f64>(Planar::from(a), Planar::from(b))
    }

    #[test]
    fn a_diagonal_pencil_gives_its_quotients() {
        let a = DMatrix::from_diagonal(&nalgebra::dvector![1.0, -6.0, 10.0, 0.25]);
        let b = DMatrix::from_diagonal(&nalgebra::dvector![2.0, 3.0, 4.0, 1e-30]);
        let mut found = in_double(&a, &b).unwrap();
        sort(&mut found);
        let expected = [-2.0, 0.5, 2.5];
        assert!(found.iter().zip(expected).all(|(l, e)| (l - e).norm() < 1e-14));
        assert!(found[3].norm() > 1e14);
    }

    #[test]
    fn a_cyclic_shift_converges_through_its_exceptional_steps() {
        let n = 8;
        let shift = DMatrix::from_fn(n, n, |i, j| if i == (j + 1) % n { 1.0 } else { 0.0 });
        let found = in_double(&shift, &DMatrix::identity(n, n)).unwrap();
        assert!(found.iter().all(|l| (l.powu(8) - 1.0).norm() < 1e-12));
    }

    #[test]
    fn what_is_not_finite_is_no_convergence() {
        let bad = dmatrix![f64::NAN, 1.0, 2.0; 1.0, f64::NAN, 1.0; 1.0, 1.0, f64::NAN];
        assert!(matches!(in_double(&bad, &DMatrix::identity(3, 3)), Err(CertifiedError::NoConvergence { .. })));
    }

    /// A long pencil goes through several chunks of every step and several registers of every row: by vectors of many
    /// lanes it has the eigenvalues that one lane gives it, which is Householder's and QR's on the small test above.
    #[test]
    fn eigenvalues_of_a_long_pencil_are_those_of_its_blocks() {
        let n = 90;
        let (a, b, expected) = long_pencil(n);
        for (found, tolerance) in [
            (in_double(&a, &b).unwrap(), 1e-10),
            (eigenvalues::<Dd>(Planar::from(&a), Planar::from(&b)).unwrap(), 1e-12),
        ] {
            assert_eq!(found.len(), n);
            for e in &expected {
                let nearest = found.iter().map(|x| (x - e).norm()).fold(f64::INFINITY, f64::min);
                assert!(nearest < tolerance * e.norm(), "{nearest:e} {e}");
            }
        }
    }

    proptest! {
        /// The pencil Q (D - lambda I) Z with random Q and Z has the eigenvalues of D.
        #[test]
        fn a_pencil_keeps_its_eigenvalues_under_equivalence(
            entries in prop::collection::vec(-1.0..1.0f64, 2 * 36),
            angle in 0.1..3.0f64,
        ) {
            let Known { q, d, z, mut expected } = Known::new(&entries, angle);
            let mut found = in_double(&(&q * &d * &z), &(&q * &z)).unwrap();
            sort(&mut found);
            let extended = eigenvalues::<Dd>(Planar::from(&(&q * &d * &z)), Planar::from(&(&q * &z))).unwrap();
            sort(&mut expected);
            for (l, e) in found.iter().zip(&expected) {
                prop_assert!((l - e).norm() < 1e-11 * (1.0 + e.norm()), "{} {}", l, e);
                // Q D Z and Q Z are rounded, which moves them by the condition of Q and Z, ten or so.
                let nearest = extended.iter().map(|x| (x - e).norm()).fold(f64::INFINITY, f64::min);
                prop_assert!(nearest < 1e-12 * (1.0 + e.norm()), "{} {}", nearest, e);
            }
        }
    }
}
