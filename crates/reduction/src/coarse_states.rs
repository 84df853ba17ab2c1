//! Internal states of the friction law on a coarse basis: one for each contact, they lie in a few directions.

use linsys::{Internal, OperatingPoint};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::basis::directions;
use super::spectra::Shapes;
use super::split;
use crate::ReductionError;

/// Singular values, of vectors of unit length, up to which directions of internal states are left out; chosen: less than is missing of shapes.
const STATES: f64 = 1e-4;

/// Directions in which the internal states of modes lie.
#[derive(Debug, Clone, PartialEq)]
pub struct CoarseStates {
    /// Channels that have one, in order.
    pub channels: Vec<usize>,
    /// Z, orthonormal, a row for each of these.
    pub directions: DMatrix<f64>,
}

impl CoarseStates {
    /// The directions of some internal states at each of some points; `None` where no point has any, or they spare nothing.
    pub(super) fn new(points: &[OperatingPoint], states: &[Shapes]) -> Result<Option<Self>, ReductionError> {
        let Some(channels) = points.iter().map(with_states).find(|channels| !channels.is_empty()) else {
            return Ok(None);
        };
        let of_these = points.iter().zip(states).filter(|(point, _)| with_states(point) == channels);
        let columns: Shapes = of_these.flat_map(|(_, states)| states).cloned().collect();
        if columns.is_empty() {
            return Ok(None);
        }
        let columns = split::from_columns(&DMatrix::from_columns(&columns));
        let directions = directions(&DMatrix::zeros(channels.len(), 0), columns, STATES)?;
        Ok((directions.ncols() < channels.len()).then_some(Self { channels, directions }))
    }

    /// Internal states in these directions: `Z^T diag(a) Z` is symmetric, and its eigenvalues are the decay rates.
    pub(super) fn of(&self, Internal { decay, drive, force }: &Internal) -> Internal {
        let weighted = DMatrix::from_fn(self.directions.nrows(), self.directions.ncols(), |row, column| {
            decay[row] * self.directions[(row, column)]
        });
        let rates = self.directions.tr_mul(&weighted).symmetric_eigen();
        let directions = &self.directions * rates.eigenvectors;
        Internal { decay: rates.eigenvalues, drive: directions.tr_mul(drive), force: force * directions }
    }
}

/// Channels that have an internal state at a point.
pub(super) fn with_states(point: &OperatingPoint) -> Vec<usize> {
    (0..point.channels.len()).filter(|&channel| point.channels[channel].lag.is_some()).collect()
}

/// The internal states of a mode, of unit length, `s = lambda E x / (lambda + a)`; `None` where they are all zero.
pub(super) fn of_mode(
    internal: &Internal,
    lambda: Complex<f64>,
    shape: &DVector<Complex<f64>>,
) -> Option<DVector<Complex<f64>>> {
    let mut states = linsys::real_times_complex(&internal.drive, shape);
    states.iter_mut().zip(&internal.decay).for_each(|(state, decay)| *state /= lambda + decay);
    let size = states.norm();
    (size > 0.0 && size.is_finite()).then(|| states.unscale(size))
}
