//! Single eigenvalues of the whole brake.

use cea::{CeaError, CertifiedError, ROUNDED_DATA, Workspace, singular_vectors};
use linsys::OperatingPoint;
use nalgebra::DVector;
use num_complex::Complex;
use sparse::{Problem, SparseError};
use study::WholeEigenvalue;

use super::{Part, ReducedSet};

/// Largest backward error of an eigenvalue that is taken; chosen: its bound says what it is good to.
const TAKEN: f64 = 1e-8;

/// The eigenvalue of the whole brake next to one of the reduced brake, from the shape that leaves least of Q there.
pub(super) fn eigenvalue(
    part: &Part,
    sets: &[ReducedSet],
    at: &OperatingPoint,
    near: Complex<f64>,
) -> Result<WholeEigenvalue, study::Error> {
    let not_found = |error: SparseError| study::Error::WholeEigenvalue(Box::new(error));
    let q = part.reduced.system().assemble(at)?.dynamic_stiffness(near);
    let shape = singular_vectors(&[q], &mut Workspace::default()).into_iter().flatten().next();
    let shape =
        shape.ok_or(CertifiedError::NoEigenvector { lambda: near, residual: f64::INFINITY }).map_err(CeaError::from)?;
    let shape = part.reduced.lift(&shape);
    let whole = sets[part.set].system.assemble(at).and_then(|whole| Problem::new(&whole)).map_err(not_found)?;
    next_to(&whole, near, &shape).map_err(not_found)
}

/// The eigenvalue of the whole brake next to `near`, rad/s, from the shape of a mode there.
pub(super) fn next_to(
    whole: &Problem,
    near: Complex<f64>,
    shape: &DVector<Complex<f64>>,
) -> Result<WholeEigenvalue, SparseError> {
    let pair = whole.eigenpair_near(near, shape, TAKEN)?;
    Ok(WholeEigenvalue { lambda: pair.lambda, bound: ROUNDED_DATA * pair.bound })
}
