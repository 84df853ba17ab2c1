//! Whole spectra and vectors of several systems.

use cea::{BatchSolver, CeaError, EigenSolver, Spectrum, WholeSpectra, Workspace, right_and_left_vectors_of_all};
use linsys::SecondOrder;
use nalgebra::DVector;
use num_complex::Complex;

/// Shapes of modes at a point.
pub(super) type Shapes = Vec<DVector<Complex<f64>>>;

/// The right vectors x of the `known` eigenvalues of each system, and left ones y with `Q(lambda)^T y = 0`.
pub(super) fn vectors(systems: &[SecondOrder], known: &[Vec<Complex<f64>>]) -> Result<Vec<[Shapes; 2]>, CeaError> {
    let of: Vec<(&SecondOrder, &[Complex<f64>])> = systems.iter().zip(known.iter().map(Vec::as_slice)).collect();
    let transposed = |[right, left]: [Shapes; 2]| [right, left.into_iter().map(|left| left.conjugate()).collect()];
    let found = right_and_left_vectors_of_all(&of, &mut Workspace::default()).into_iter();
    found.map(|found| found.map(transposed)).collect()
}

/// Whole spectra, those of systems of one shape together in the lanes of vector registers.
pub(super) fn spectra(systems: &[SecondOrder]) -> Vec<Result<Spectrum, CeaError>> {
    let shape = |at: &usize| (systems[*at].order(), systems[*at].states());
    let mut order: Vec<usize> = (0..systems.len()).collect();
    order.sort_by_key(shape);
    let (mut all, mut work) = (Vec::with_capacity(systems.len()), Workspace::default());
    for alike in order.chunk_by(|a, b| shape(a) == shape(b)) {
        let of_shape: Vec<SecondOrder> = alike.iter().map(|&at| systems[at].clone()).collect();
        let mut found = Vec::with_capacity(alike.len());
        WholeSpectra(&BatchSolver).eigenvalues_of_all(&of_shape, &mut work, &mut found);
        all.extend(alike.iter().copied().zip(found));
    }
    all.sort_by_key(|&(at, _)| at);
    all.into_iter().map(|(_, found)| found).collect()
}
