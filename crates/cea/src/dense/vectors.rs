//! Chosen eigenvectors by inverse iteration on the n x n matrix `Q(lambda)`.
//!
//! A Schur form with vectors costs twice one without, and most analyses need few vectors. One factorisation of `Q(lambda)`,
//! internal states eliminated, gives the right or the left vector of one eigenvalue (Ipsen, SIAM Review 39, 1997).

use certified::CertifiedError;
use certified::lanes::WIDEST_LANES;
use certified::lu::{LEAST_PIVOT, Lu};
use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::null_vectors::{NullVector, by_factors, null_vectors};
use crate::{CeaError, Workspace};

/// Largest normwise backward error of an accepted pair (lambda, phi). Chosen: an eigenvalue given to nine digits passes, a
/// number that is no eigenvalue does not.
const LARGEST_BACKWARD_ERROR: f64 = 1e-9;
/// Fewest rows of a matrix whose singular vector is found by its LU factors, one matrix at a time. Chosen: reduced finite elements, of which few
/// matrices come together, are as large; a single matrix of order 80 takes 2.7 times less time, and eight of them as much more.
const LARGE: usize = 64;
/// Most solutions with one factorisation; chosen: one nearly always suffices.
const MOST_INVERSE_ITERATIONS: usize = 4;

/// Vectors of some eigenvalues, in their order.
type Vectors = Vec<DVector<Complex<f64>>>;

/// Right eigenvector phi with `Q(lambda) phi = 0`, length n, unit 2-norm, its largest component real and positive.
///
/// # Errors
/// [`CertifiedError::NoEigenvector`] where `lambda` is not an eigenvalue to working precision.
pub fn right_vector(
    system: &SecondOrder,
    lambda: Complex<f64>,
    work: &mut Workspace,
) -> Result<DVector<Complex<f64>>, CeaError> {
    let q = regular_dynamic_stiffness(system, lambda);
    null_vector(&q, lambda, size(system, lambda), &[], work)
}

/// Left eigenvector psi with `psi^H Q(lambda) = 0`, length n, normalised as [`right_vector`].
///
/// # Errors
/// As [`right_vector`].
pub fn left_vector(
    system: &SecondOrder,
    lambda: Complex<f64>,
    work: &mut Workspace,
) -> Result<DVector<Complex<f64>>, CeaError> {
    let q = regular_dynamic_stiffness(system, lambda).adjoint();
    null_vector(&q, lambda, size(system, lambda), &[], work)
}

/// The right vector of each eigenvalue, in order; the vectors of a semisimple multiple eigenvalue are independent.
///
/// # Errors
/// As [`right_vector`].
pub fn right_vectors(
    system: &SecondOrder,
    lambdas: &[Complex<f64>],
    work: &mut Workspace,
) -> Result<Vectors, CeaError> {
    right_vectors_of_all(&[(system, lambdas)], work).remove(0)
}

/// [`right_vectors`] of several systems, one result each; systems of one size share the vector registers.
///
/// A vector does not depend on other systems, to the last bit, but on earlier, nearly equal eigenvalues of its own system:
/// inverse iteration alone would find the same vector twice where an eigenvalue is multiple. Where a vector is parallel to
/// the vector of an earlier, nearly equal eigenvalue, the iteration is repeated orthogonally to the earlier vector; where this finds
/// no vector (a defective pair), the parallel one is kept.
pub fn right_vectors_of_all(
    of: &[(&SecondOrder, &[Complex<f64>])],
    work: &mut Workspace,
) -> Vec<Result<Vectors, CeaError>> {
    vectors_of_all::<1>(of, work).into_iter().map(|found| found.map(|[right]| right)).collect()
}

/// The right vectors of several systems as by [`right_vectors_of_all`], and the left ones (`psi^H Q(lambda) = 0`) of the same eigenvalues: one factorisation
/// gives both.
pub fn right_and_left_vectors_of_all(
    of: &[(&SecondOrder, &[Complex<f64>])],
    work: &mut Workspace,
) -> Vec<Result<[Vectors; 2], CeaError>> {
    vectors_of_all(of, work)
}

/// The right vectors, and of two sides the left ones after them.
fn vectors_of_all<const SIDES: usize>(
    of: &[(&SecondOrder, &[Complex<f64>])],
    work: &mut Workspace,
) -> Vec<Result<[Vectors; SIDES], CeaError>> {
    let each: Vec<_> = of.iter().flat_map(|&(system, lambdas)| lambdas.iter().map(move |&l| (system, l))).collect();
    let mut alone = Vec::with_capacity(each.len());
    // No more matrices at a time than are solved together: they are large.
    let lots = each.chunk_by(|a, b| a.0.order() == b.0.order()).flat_map(|group| group.chunks(WIDEST_LANES));
    for lot in lots {
        let matrices: Vec<_> = lot.iter().map(|&(system, l)| regular_dynamic_stiffness(system, l)).collect();
        let found = null_vectors::<SIDES>(&matrices, &start(matrices[0].nrows(), 0), &mut work.scratch);
        for ((q, found), &(system, lambda)) in matrices.iter().zip(found).zip(lot) {
            let size = size(system, lambda);
            work.counters.factorisations += u64::from(found.is_some());
            let mut found = found.into_iter().flatten();
            alone.push(std::array::from_fn(|side| {
                let found = found.next();
                let converged =
                    found.filter(|found| has_converged(found.residuals.map(|r| r / size.max(f64::MIN_POSITIVE))));
                let Some(NullVector { mut vector, .. }) = converged else {
                    return null_vector(&of_side(q.clone(), side), lambda, size, &[], work);
                };
                work.counters.eigenvectors += 1;
                fix_phase(&mut vector);
                Ok(vector)
            }));
        }
    }
    let mut alone = alone.into_iter();
    let found: Vec<Vec<[_; SIDES]>> =
        of.iter().map(|(_, lambdas)| alone.by_ref().take(lambdas.len()).collect()).collect();
    let independent = |(&(system, lambdas), found): (&(&SecondOrder, &[Complex<f64>]), Vec<[_; SIDES]>)| {
        let mut vectors: [Vectors; SIDES] = std::array::from_fn(|_| Vec::with_capacity(found.len()));
        for sides in found {
            for (vectors, side) in vectors.iter_mut().zip(sides) {
                vectors.push(side?);
            }
        }
        for (side, vectors) in vectors.iter_mut().enumerate() {
            make_independent(system, lambdas, (vectors, side), work);
        }
        Ok(vectors)
    };
    of.iter().zip(found).map(independent).collect()
}

/// The matrix whose null vector is the vector of a side: Q for the right one, side 0, and `Q^H` for the left one.
fn of_side(q: DMatrix<Complex<f64>>, side: usize) -> DMatrix<Complex<f64>> {
    if side == 0 { q } else { q.adjoint() }
}

fn make_independent(
    system: &SecondOrder,
    lambdas: &[Complex<f64>],
    (vectors, side): (&mut [DVector<Complex<f64>>], usize),
    work: &mut Workspace,
) {
    for (i, &lambda) in lambdas.iter().enumerate() {
        let near: Vec<_> = (0..i).filter(|&j| (lambdas[j] - lambda).norm() <= 1e-6 * lambda.norm()).collect();
        if near.iter().any(|&j| vectors[j].dotc(&vectors[i]).norm() > 1.0 - 1e-6) {
            let others: Vec<_> = near.iter().map(|&j| vectors[j].clone()).collect();
            let q = of_side(regular_dynamic_stiffness(system, lambda), side);
            if let Ok(independent) = null_vector(&q, lambda, size(system, lambda), &others, work) {
                vectors[i] = independent;
            }
        }
    }
}

/// The right singular vector (unit length) of the smallest singular value of each of the n x n `matrices`, in one batch: for a
/// nearly singular `Q(lambda)` the vector of smallest backward error. `None` where the entries of a matrix are too large or too
/// small to be squared. Counts as one factorisation per matrix.
pub fn singular_vectors(
    matrices: &[DMatrix<Complex<f64>>],
    work: &mut Workspace,
) -> Vec<Option<DVector<Complex<f64>>>> {
    let Some(n) = matrices.first().map(DMatrix::nrows) else { return Vec::new() };
    let start = start(n, 0);
    let vectors: Vec<Option<NullVector>> = match n {
        LARGE.. => matrices.iter().map(|q| by_factors(q, &start)).collect(),
        _ => null_vectors(matrices, &start, &mut work.scratch)
            .into_iter()
            .map(|found| found.map(|[right]| right))
            .collect(),
    };
    work.counters.factorisations += matrices.len() as u64;
    vectors.into_iter().map(|found| Some(found?.vector)).collect()
}

/// Normwise backward error of (lambda, phi): `|Q(lambda) phi| / ((sum |lambda|^j |A_j|) |phi|)`, Frobenius norms
/// (Tisseur, Linear Algebra Appl. 309, 2000).
#[must_use]
pub fn backward_error(system: &SecondOrder, lambda: Complex<f64>, phi: &DVector<Complex<f64>>) -> f64 {
    (system.dynamic_stiffness(lambda) * phi).norm() / (size(system, lambda) * phi.norm())
}

/// `|lambda|^2 |M| + |lambda| |C| + |K|` and the terms of the internal states: the norm that backward errors are relative to.
pub(crate) fn size(system: &SecondOrder, lambda: Complex<f64>) -> f64 {
    let l = lambda.norm();
    let states = (0..system.states()).map(|s| {
        let gain = (lambda / (lambda + system.internal.decay[s])).norm();
        gain.min(1.0 / f64::EPSILON) * system.internal.drive.row(s).norm() * system.internal.force.column(s).norm()
    });
    l * l * system.m.norm() + l * system.c.norm() + system.k.norm() + states.sum::<f64>()
}

/// `Q(lambda)`, moved by a rounding error where lambda sits exactly on the pole of an internal state.
fn regular_dynamic_stiffness(system: &SecondOrder, lambda: Complex<f64>) -> DMatrix<Complex<f64>> {
    let on_pole = system.internal.decay.iter().any(|&a| lambda == Complex::from(-a));
    system.dynamic_stiffness(if on_pole { lambda * (1.0 + 4.0 * f64::EPSILON) } else { lambda })
}

fn null_vector(
    q: &DMatrix<Complex<f64>>,
    lambda: Complex<f64>,
    size: f64,
    orthogonal_to: &[DVector<Complex<f64>>],
    work: &mut Workspace,
) -> Result<DVector<Complex<f64>>, CeaError> {
    work.counters.factorisations += 1;
    work.counters.eigenvectors += 1;
    let project = |x: &mut DVector<Complex<f64>>| {
        for other in orthogonal_to {
            let overlap = other.dotc(x);
            x.axpy(-overlap, other, Complex::from(1.0));
        }
    };
    // A pivot that vanishes becomes less than a rounding error, which leaves the null vector as it is.
    let lu = Lu::new(q, (f64::EPSILON * f64::EPSILON * size).max(LEAST_PIVOT));
    let mut x = start(q.nrows(), orthogonal_to.len());
    let mut residual = f64::INFINITY;
    for _ in 0..MOST_INVERSE_ITERATIONS {
        project(&mut x);
        lu.solve(&mut x);
        project(&mut x);
        let norm = x.norm();
        if !(norm.is_finite() && norm > 0.0) {
            break;
        }
        x.unscale_mut(norm);
        let before = std::mem::replace(&mut residual, (q * &x).norm() / size.max(f64::MIN_POSITIVE));
        if has_converged([before, residual]) {
            break;
        }
    }
    if residual.is_nan() || residual > LARGEST_BACKWARD_ERROR {
        return Err(CertifiedError::NoEigenvector { lambda, residual }.into());
    }
    fix_phase(&mut x);
    Ok(x)
}

/// The start of an inverse iteration: a vector without the symmetries by which it could be orthogonal to an eigenvector. It
/// depends on the number of vectors to avoid, so that it differs from the starts that found those.
pub(crate) fn start(n: usize, to_avoid: usize) -> DVector<Complex<f64>> {
    DVector::from_fn(n, |i, _| {
        let angle = 2.399_963_229_728_653 * (i as f64 + 1.0) * (i + 2 + to_avoid) as f64;
        Complex::from_polar(1.0 + 0.1 * (i % 3) as f64, angle)
    })
}

/// True if the last backward error is at rounding, or small and hardly less than the one before.
fn has_converged([before, now]: [f64; 2]) -> bool {
    now <= 1e-14 || (now <= LARGEST_BACKWARD_ERROR && now >= 0.5 * before)
}

/// Multiplies by a phase that makes the largest component real and positive: the first of those that are as large but for 1e-9. A zero vector stays as it is.
pub fn fix_phase(x: &mut DVector<Complex<f64>>) {
    let larger = |m: Complex<f64>, &v: &Complex<f64>| if v.norm_sqr() > m.norm_sqr() * (1.0 + 2e-9) { v } else { m };
    let largest = x.iter().fold(Complex::from(0.0), larger);
    if largest != Complex::from(0.0) {
        let turn = largest.conj() / largest.norm();
        x.apply(|v| *v *= turn);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EigenSolver, QrSolver};
    use nalgebra::dmatrix;

    fn flutter() -> SecondOrder {
        SecondOrder::new(dmatrix![2.0, 0.0; 0.0, 3.0], dmatrix![0.3, 0.1; 0.0, 0.2], dmatrix![40.0, -30.0; 30.0, 70.0])
            .unwrap()
    }

    #[test]
    fn right_and_left_vectors_annihilate_q() {
        let (system, mut work) = (flutter(), Workspace::default());
        for lambda in QrSolver.eigenvalues(&system, &mut work).unwrap().eigenvalues {
            let phi = right_vector(&system, lambda, &mut work).unwrap();
            let psi = left_vector(&system, lambda, &mut work).unwrap();
            let q = system.dynamic_stiffness(lambda);
            assert!((&q * &phi).norm() < 1e-12);
            assert!((psi.adjoint() * &q).norm() < 1e-12);
            assert!(backward_error(&system, lambda, &phi) < 1e-14);
        }
        assert_eq!((work.counters.eigenvalue_solves, work.counters.eigenvectors), (1, 8));
    }

    #[test]
    fn a_double_eigenvalue_gets_two_independent_vectors() {
        let system =
            SecondOrder::new(DMatrix::identity(3, 3), DMatrix::zeros(3, 3), DMatrix::identity(3, 3) * 4.0).unwrap();
        let two_i = Complex::new(0.0, 2.0);
        let vectors = right_vectors(&system, &[two_i; 3], &mut Workspace::default()).unwrap();
        let gram = DMatrix::from_fn(3, 3, |i, j| vectors[i].dotc(&vectors[j]).norm());
        assert!((gram - DMatrix::identity(3, 3)).norm() < 1e-10);
    }

    #[test]
    fn a_defective_pair_keeps_its_one_vector() {
        // K is a Jordan block: lambda = 2i twice, one eigenvector.
        let system =
            SecondOrder::new(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), dmatrix![4.0, 1.0; 0.0, 4.0]).unwrap();
        let vectors = right_vectors(&system, &[Complex::new(0.0, 2.0); 2], &mut Workspace::default()).unwrap();
        assert!(vectors.iter().all(|v| (v[0].re - 1.0).abs() < 1e-7));
    }

    #[test]
    fn a_phase_is_fixed_by_the_largest_component_and_zero_stays_zero() {
        let mut x = DVector::from_vec(vec![Complex::new(0.0, 1.0), Complex::new(0.0, -2.0)]);
        fix_phase(&mut x);
        assert!((x - DVector::from_vec(vec![Complex::from(-1.0), Complex::from(2.0)])).norm() < 1e-15);
        let mut zero = DVector::<Complex<f64>>::zeros(2);
        fix_phase(&mut zero);
        assert_eq!(zero.norm(), 0.0);
    }

    #[test]
    fn what_is_no_eigenvalue_has_no_eigenvector() {
        let wrong = right_vector(&flutter(), Complex::new(0.0, 1.0), &mut Workspace::default());
        assert!(matches!(wrong, Err(CeaError::Certified(CertifiedError::NoEigenvector { .. }))));
    }
}
