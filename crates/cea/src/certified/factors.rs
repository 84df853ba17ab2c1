//! A strongly damped problem as two eigenproblems of its own order, in double-double precision.
//!
//! Where the damping outweighs mass and stiffness, n eigenvalues are slow, n are fast, and
//!
//! ```text
//! lambda^2 M + lambda C + K = (lambda M + B) (lambda - S),     B = M S + C,     S = -B^-1 K.
//! ```
//!
//! S has the slow eigenvalues, `F = -B^-1 M` the reciprocals of the fast ones. S is the limit of Bernoulli's iteration
//! `S_i+1 = -(M S_i + C)^-1 K` (Higham and Kim, IMA J. Numer. Anal. 20, 2000), of which each step multiplies the error by
//! F from the left and by S from the right:
//!
//! ```text
//! |S_i+1 - S| <= 2 q |S_i+1 - S_i|     with  q = |F| |S| < 1/4.
//! ```
//!
//! q is of the size of a slow eigenvalue over a fast one, 1e-10 where the damping outweighs the others 1e5 times. After two
//! steps in double precision a single one in double-double is enough.

use nalgebra::DMatrix;
use num_complex::Complex;

use super::dd::Dd;
use super::planar::Planar;
use super::scaled::Scaled;
use super::standard::{Quotients, of_matrix, quotients};

/// Largest q with which the iteration is known to converge.
const LARGEST_CONTRACTION: f64 = 0.25;
/// Steps in double precision: the first one's error is q, the second's that of rounding.
const STEPS_IN_DOUBLE: usize = 2;

/// The eigenvalues, complex ones in exact conjugate pairs; none where slow and fast ones are not far enough apart, C is too
/// nearly singular or the iteration fails.
pub(super) fn eigenvalues(s: &Scaled) -> Option<Vec<Complex<f64>>> {
    let mut before = DMatrix::zeros(s.order(), s.order());
    for _ in 0..STEPS_IN_DOUBLE {
        before = -(&s.m * before + &s.c).lu().solve(&s.k)?;
    }
    let mut b = Planar::<Dd>::from(&s.c);
    b.add_product(&Planar::from(&s.m), &Planar::from(&before));
    // -S and -F.
    let Quotients { of: [slow, fast], error } = quotients([&Planar::from(&s.k), &Planar::from(&s.m)], &b)?;
    let contraction = slow.norm() * fast.norm();
    if contraction.is_nan() || contraction > LARGEST_CONTRACTION {
        return None;
    }
    let change = DMatrix::from_fn(s.order(), s.order(), |i, j| slow.get(i, j).value() + before[(i, j)]);
    let error = error + 2.0 * contraction * change.norm() / slow.norm();
    let mut found = of_matrix(slow, error)?;
    found.extend(of_matrix(fast, error)?.into_iter().map(|mu| mu.inv()));
    Some(found.into_iter().map(|sigma| -sigma).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certified::pencil::{Pencil, companion};
    use crate::sort;
    use linsys::SecondOrder;
    use nalgebra::dmatrix;
    use proptest::prelude::*;

    #[test]
    fn what_has_no_gap_between_slow_and_fast_is_left_to_others() {
        let split = |c: DMatrix<f64>| {
            let system = SecondOrder::new(DMatrix::identity(2, 2), c, dmatrix![2.0, 1.0; 1.0, 3.0]).unwrap();
            eigenvalues(&Scaled::new(&system))
        };
        assert_eq!(split(DMatrix::identity(2, 2) * 1e8).unwrap().len(), 4);
        // No damping at all of one direction, or as much as of a mass on a spring.
        assert_eq!(split(dmatrix![1e8, 0.0; 0.0, 0.0]), None);
        assert_eq!(split(dmatrix![1e8, 0.0; 0.0, 1.0]), None);
        assert_eq!(split(DMatrix::zeros(2, 2)), None);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(96))]

        /// Fast and slow eigenvalues eight to twenty-six powers of ten apart have those of QZ, which inverts nothing and splits
        /// nothing.
        #[test]
        fn strongly_damped_problems_have_the_eigenvalues_of_qz(
            entries in prop::collection::vec(-1.0..1.0f64, 3 * 49),
            exponent in 4..14i32,
        ) {
            let part = |k: usize| DMatrix::from_column_slice(7, 7, &entries[49 * k..49 * (k + 1)]);
            let definite = |k: usize| part(k) * part(k).transpose() + DMatrix::identity(7, 7) * 0.3;
            // Of any sign and without symmetry, so that some are complex and some grow.
            let stiffness = part(2) + DMatrix::identity(7, 7) * 0.3;
            let damping = (definite(1) + part(0) - part(0).transpose()) * 10f64.powi(exponent);
            let scaled = Scaled::new(&SecondOrder::new(definite(0), damping, stiffness).unwrap());
            let mut found = eigenvalues(&scaled).unwrap();
            let mut expected = Pencil::<Dd>::new(&companion(&scaled)).eigenvalues(false).unwrap();
            sort(&mut found);
            sort(&mut expected);
            for e in &expected {
                let nearest = found.iter().map(|l| (l - e).norm()).fold(f64::INFINITY, f64::min);
                prop_assert!(nearest < 1e-14 * e.norm(), "{} {}", nearest / e.norm(), e);
            }
        }
    }
}
