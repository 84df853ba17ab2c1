//! The directions in which modes lie on the way from one dense system to another.

use linsys::SecondOrder;
use nalgebra::DMatrix;

use super::basis::directions;
use super::split;
use super::within::eigen;
use crate::SparseError;

/// Where on the path modes are found, both ends among them; chosen.
const POINTS: usize = 5;
/// Directions with singular values up to this, of shapes of unit length, are left out; chosen: what is then missing of an eigenvalue is far
/// below what tells modes apart.
const FLOOR: f64 = 1e-7;

/// Orthonormal directions that hold all modes with Im lambda in `band`, rad/s, at a few points of the straight path
/// `(1 - t) Q_from + t Q_to` between two systems of the same order without internal states.
///
/// # Errors
/// Systems of different orders or with internal states, a mass matrix that is singular.
pub fn path_directions(from: &SecondOrder, to: &SecondOrder, band: [f64; 2]) -> Result<DMatrix<f64>, SparseError> {
    let (found, expected) = (to.order() + to.states() + from.states(), from.order());
    if found != expected {
        return Err(
            linsys::LinsysError::Count { what: "degrees of freedom at the end of a path", found, expected }.into()
        );
    }
    let mut columns = Vec::new();
    for point in 0..POINTS {
        let t = point as f64 / (POINTS - 1) as f64;
        let mix = |a: &DMatrix<f64>, b: &DMatrix<f64>| a * (1.0 - t) + b * t;
        let here = SecondOrder::new(mix(&from.m, &to.m), mix(&from.c, &to.c), mix(&from.k, &to.k))?;
        let (all, vectors) = eigen(&here, band[1])?;
        let wanted: Vec<usize> = (0..all.len()).filter(|&at| (band[0]..=band[1]).contains(&all[at].im)).collect();
        let mut shapes = split::zeros(here.order(), wanted.len());
        for (to, &from) in wanted.iter().enumerate() {
            let shape = vectors.column(from).rows(0, here.order()).normalize();
            split::set(&mut shapes, to, shape.iter().copied());
        }
        columns.extend(shapes.column_iter().map(|column| column.into_owned()));
    }
    if columns.is_empty() {
        return Ok(DMatrix::zeros(from.order(), 0));
    }
    directions(&DMatrix::zeros(from.order(), 0), DMatrix::from_columns(&columns), FLOOR)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DVector, dmatrix};

    #[test]
    fn directions_hold_the_modes_of_the_path_and_no_others() {
        // Two coupled pairs; the second is far above the band.
        let system = |coupling: f64| {
            let k = dmatrix![
                4.0, coupling, 0.0, 0.0;
                -coupling, 5.0, 0.0, 0.0;
                0.0, 0.0, 400.0, coupling;
                0.0, 0.0, coupling, 500.0];
            SecondOrder::new(DMatrix::identity(4, 4), DMatrix::identity(4, 4) * 0.01, k).unwrap()
        };
        let found = path_directions(&system(0.0), &system(1.0), [1.0, 4.0]).unwrap();
        assert_eq!(found.ncols(), 2);
        let inside = &found * found.transpose();
        let expected = DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, 1.0, 0.0, 0.0]));
        assert!((inside - expected).norm() < 1e-12);
        assert!(path_directions(&system(0.0), &SecondOrder::zeros(3, 0), [1.0, 4.0]).is_err());
        assert_eq!(path_directions(&system(0.0), &system(1.0), [6.0, 7.0]).unwrap().ncols(), 0);
    }
}
