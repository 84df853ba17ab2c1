//! A pencil A - lambda B as the standard eigenproblem of B^-1 A, in double-double precision.
//!
//! QR on one matrix takes a third of the operations of QZ on two (Golub and Van Loan, Matrix Computations, sections 7.5
//! and 7.7), and what the inverse costs in digits double-double precision has to spare. B's condition number is taken
//! after its rows are scaled, which changes nothing in B^-1 A.

use linsys::reciprocal;
use nalgebra::DMatrix;
use num_complex::Complex;

use super::balance::{Balanced, balanced};
use super::dd::Dd;
use super::hessenberg::reduce_to_hessenberg;
use super::lane::Lane;
use super::planar::{Planar, triangularise};
use super::scaled::{Scaled, power_of_two};
use crate::francis;

/// QR steps allowed per eigenvalue before QZ takes over. A healthy matrix takes 2 to 4, but of hundreds of small eigenvalues of one size
/// the first may take a hundred.
const MOST_QR_STEPS: usize = 300;
/// Largest relative error of the smallest eigenvalue, if nothing but norms is known: the error of B^-1 A is at most
/// `eps cond(B) |B^-1 A|`.
pub(super) const LARGEST_ERROR: f64 = 1e-10;

/// The eigenvalues, complex ones in exact conjugate pairs; none where rounding may have cost more than
/// [`LARGEST_ERROR`] or the iteration fails.
pub(super) fn eigenvalues<T: Lane>(a: &Planar<T>, b: &Planar<T>) -> Option<Vec<Complex<f64>>> {
    let Quotients { of: [state], error } = quotients([a], b);
    of_quotient(state, error)
}

/// The eigenvalues of a quotient with this relative error of its columns.
fn of_quotient<T: Lane>(state: Planar<T>, error: f64) -> Option<Vec<Complex<f64>>> {
    if error.is_nan() || error > LARGEST_ERROR {
        return None;
    }
    // The columns of the quotient are wrong by as much of each, and QR by as much of the whole.
    let whole = state.norm();
    let Balanced { matrix, columns } = balanced(state);
    let error = (error * whole).min(error * columns + T::EPSILON * matrix.norm());
    iterate(matrix, error)
}

/// Eigenvalues of a regular quadratic problem, by the inverse of M or, reversed, by the inverse of K: a quotient of n rows in place of one of 2 n.
/// With d as in [`Pencil`](super::pencil::Pencil) the reciprocals are the eigenvalues of `[0, I / d; -d K^-1 M, -K^-1 C]`.
pub(super) fn of_quadratic(s: &Scaled, reversed: bool) -> Option<Vec<Complex<f64>>> {
    let (n, d) = (s.order(), Dd::from(s.grading()));
    let [m, c, k] = [&s.m, &s.c, &s.k].map(Planar::<Dd>::from);
    let (zero, inverse) = (Dd::default(), Dd::from(1.0) / d);
    let unit = |i: usize, j: usize, value: Dd| if i == j { value } else { zero };
    if !reversed {
        let Quotients { of: [damping, stiffness], error } = quotients([&c, &k], &m);
        let state = Planar::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
            (true, true) => zero - damping.get(i, j),
            (true, false) => zero - stiffness.get(i, j - n) * inverse,
            (false, true) => unit(i - n, j, d),
            (false, false) => zero,
        });
        return of_quotient(state, error);
    }
    let Quotients { of: [damping, mass], error } = quotients([&c, &m], &k);
    let state = Planar::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
        (true, true) => zero,
        (true, false) => unit(i, j - n, inverse),
        (false, true) => zero - mass.get(i - n, j) * d,
        (false, false) => zero - damping.get(i - n, j - n),
    });
    Some(of_quotient(state, error)?.into_iter().map(finite_reciprocal::<Dd>).collect())
}

/// `B^-1 A` for each of N matrices A, and the relative error of each by norms: not finite where B is singular.
pub(super) struct Quotients<T, const N: usize> {
    pub(super) of: [Planar<T>; N],
    pub(super) error: f64,
}

/// `B^-1 A` for each A.
pub(super) fn quotients<T: Lane, const N: usize>(of: [&Planar<T>; N], b: &Planar<T>) -> Quotients<T, N> {
    let size = b.rows();
    let largest = |i: usize| (0..size).map(|j| b.get(i, j).value().abs()).fold(0.0, f64::max);
    let scale: Vec<T> = (0..size).map(|i| T::from(power_of_two(1.0 / largest(i)))).collect();
    let scaled = |x: &Planar<T>| Planar::from_fn(size, x.columns(), |i, j| x.get(i, j) * scale[i]);
    let (mut of, mut r) = (of.map(scaled), scaled(b));
    triangularise(&mut r, of.each_mut());
    of.iter_mut().for_each(|a| r.solve_triangle(a));
    Quotients { of, error: T::EPSILON * condition(&r) }
}

/// The eigenvalues of a matrix with this relative error, by the QR iteration; none where the least of them may be wrong by more
/// than [`LARGEST_ERROR`], relative to it, or the iteration fails.
pub(super) fn of_matrix<T: Lane>(matrix: Planar<T>, error: f64) -> Option<Vec<Complex<f64>>> {
    if error.is_nan() || error > LARGEST_ERROR {
        return None;
    }
    let error = error * matrix.norm();
    iterate(balanced(matrix).matrix, error)
}

/// Eigenvalues of a matrix with this absolute error; none where an eigenvalue is too small beside it, or the iteration fails.
fn iterate<T: Lane>(mut matrix: Planar<T>, error: f64) -> Option<Vec<Complex<f64>>> {
    reduce_to_hessenberg(&mut matrix);
    let found = francis::of_hessenberg(matrix, MOST_QR_STEPS)?;
    let least = found.iter().map(|l| l.norm()).fold(f64::INFINITY, f64::min);
    (error <= LARGEST_ERROR * least).then_some(found)
}

/// The condition number of an upper triangular matrix, by Frobenius norms and in double precision.
fn condition<T: Lane>(r: &Planar<T>) -> f64 {
    let size = r.rows();
    let upper = |i: usize, j: usize| if i <= j { r.get(i, j).value() } else { 0.0 };
    let r = Planar::<f64>::from_fn(size, size, upper);
    let mut inverse = Planar::<f64>::from(&DMatrix::identity(size, size));
    r.solve_triangle(&mut inverse);
    r.norm() * inverse.norm() / size as f64
}

/// 1 / mu; an infinite one is a rounding error, replaced by one of its size.
pub(super) fn finite_reciprocal<T: Lane>(mu: Complex<f64>) -> Complex<f64> {
    if mu.norm() < T::EPSILON { T::EPSILON.copysign(mu.re).recip().into() } else { reciprocal(mu) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{Known, long_pencil};
    use crate::pencil::{Pencil, companion};
    use crate::sort;
    use linsys::SecondOrder;
    use nalgebra::dmatrix;
    use proptest::prelude::*;

    fn extended(a: &DMatrix<f64>, b: &DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
        let mut found = eigenvalues::<Dd>(&Planar::from(a), &Planar::from(b))?;
        sort(&mut found);
        Some(found)
    }

    #[test]
    fn a_cyclic_shift_converges_through_its_exceptional_steps() {
        let n = 8;
        let shift = DMatrix::from_fn(n, n, |i, j| if i == (j + 1) % n { 1.0 } else { 0.0 });
        let found = extended(&shift, &DMatrix::identity(n, n)).unwrap();
        // To the last bit but one: double-double is exact to a double.
        assert!(found.iter().all(|l| (l.powu(8) - 1.0).norm() < 1e-14));
    }

    #[test]
    fn what_is_not_finite_or_cannot_be_inverted_is_left_to_others() {
        let good = dmatrix![1.0, 2.0; 3.0, 5.0];
        assert_eq!(extended(&dmatrix![f64::NAN, 1.0; 1.0, 1.0], &good), None);
        assert_eq!(extended(&good, &dmatrix![f64::NAN, 1.0; 1.0, 1.0]), None);
        assert_eq!(extended(&good, &dmatrix![1.0, 1.0; 1.0, 1.0]), None);
        // Eigenvalues of 1 and 1e-30: the small one would be a rounding error.
        assert_eq!(extended(&dmatrix![1.0, 0.0; 0.0, 1e-30], &DMatrix::identity(2, 2)), None);
        assert_eq!(extended(&good, &DMatrix::identity(2, 2)).unwrap().len(), 2);
    }

    /// Rows longer than a register and steps longer than a chunk.
    #[test]
    fn eigenvalues_of_a_long_pencil_are_those_of_its_blocks() {
        let n = 70;
        let (a, b, expected) = long_pencil(n);
        let found = extended(&a, &b).unwrap();
        for e in &expected {
            let nearest = found.iter().map(|x| (x - e).norm()).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-12 * e.norm(), "{nearest:e} {e}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// T D T^-1 and a random pencil with the same eigenvalues; the products are rounded, which moves these by the
        /// condition of the factors, ten or so.
        #[test]
        fn a_similar_matrix_keeps_its_eigenvalues(
            entries in prop::collection::vec(-1.0..1.0f64, 2 * 36),
            angle in 0.1..3.0f64,
        ) {
            let Known { q, d, z, expected } = Known::new(&entries, angle);
            let inverse = q.clone().try_inverse().unwrap();
            for (a, b) in [(&q * &d * inverse, DMatrix::identity(6, 6)), (&q * &d * &z, &q * &z)] {
                let found = extended(&a, &b).unwrap();
                for e in &expected {
                    let nearest = found.iter().map(|x| (x - e).norm()).fold(f64::INFINITY, f64::min);
                    prop_assert!(nearest < 1e-12 * (1.0 + e.norm()), "{} {}", nearest, e);
                }
            }
        }

        /// Eigenvalues of overdamped problems, fast and slow ones ten to sixteen powers of ten apart, are those of QZ, which inverts
        /// nothing: by M's inverse, whose rows are graded downwards, to the digits of a double, by K's as norms promise.
        #[test]
        fn overdamped_problems_have_the_eigenvalues_of_qz(
            entries in prop::collection::vec(-1.0..1.0f64, 3 * 49),
            exponent in 5..9i32,
        ) {
            let part = |k: usize| {
                let x = DMatrix::from_column_slice(7, 7, &entries[49 * k..49 * (k + 1)]);
                &x * x.transpose() + DMatrix::identity(7, 7) * 0.3
            };
            let system = SecondOrder::new(part(0), part(1) * 10f64.powi(exponent), part(2)).unwrap();
            let scaled = Scaled::new(&system);
            let pencil = Pencil::<Dd>::new(&companion(&scaled));
            let mut found = of_quadratic(&scaled, false).unwrap();
            let mut reversed = of_quadratic(&scaled, true).unwrap();
            let mut expected = pencil.eigenvalues(false).unwrap();
            for list in [&mut found, &mut reversed, &mut expected] {
                sort(list);
            }
            for ((l, r), e) in found.iter().zip(&reversed).zip(&expected) {
                prop_assert!((l - e).norm() < 1e-14 * e.norm(), "{} {}", l, e);
                prop_assert!((r - e).norm() < LARGEST_ERROR * e.norm(), "{} {}", r, e);
            }
        }
    }
}
