//! The directions in which shapes of modes lie.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::directions::directions;
use super::split;
use crate::ReductionError;

/// Largest singular value, of shapes of unit length, of directions that are left out; chosen: what is then missing of an eigenvalue is far
/// below what tells modes apart. With 1e-6 and 1e-4 one and five of the 260 bridges of cases/disc-pad gave other names.
const FLOOR: f64 = 1e-7;

/// Orthonormal directions, principal ones first, that hold `shapes`, all of one length, up to a part of 1e-7; no columns where there are no
/// shapes.
///
/// # Errors
/// A shape with an entry that is not finite.
pub fn shape_directions(shapes: &[DVector<Complex<f64>>]) -> Result<DMatrix<f64>, ReductionError> {
    let rows = shapes.first().map_or(0, DVector::len);
    let mut columns = split::zeros(rows, shapes.len());
    for (at, shape) in shapes.iter().enumerate() {
        split::set(&mut columns, at, shape.normalize().iter().copied());
    }
    directions(&DMatrix::zeros(rows, 0), columns, FLOOR)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_hold_the_shapes_and_no_more() {
        let shape = |entries: [[f64; 2]; 4]| DVector::from_iterator(4, entries.map(|[re, im]| Complex::new(re, im)));
        let first = shape([[2.0, 0.0], [0.0, 1.0], [0.0, 0.0], [0.0, 0.0]]);
        let turned = &first * Complex::new(0.6, 0.8);
        let nearly = shape([[1.0, 0.0], [1.0, 0.0], [1e-9, 0.0], [0.0, 0.0]]);
        let found = shape_directions(&[first, turned, nearly]).unwrap();
        assert_eq!(found.ncols(), 2);
        let expected = DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, 1.0, 0.0, 0.0]));
        assert!((&found * found.transpose() - expected).amax() < 2e-9);
        assert_eq!(shape_directions(&[]).unwrap().ncols(), 0);
        assert!(shape_directions(&[shape([[f64::NAN; 2]; 4])]).is_err());
    }
}
