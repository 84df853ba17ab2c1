//! Internal states of the friction law on a coarse basis: one for each contact, they lie in a few directions. Internal states of what relaxes stay as they
//! are: they are few, and have other units.

use linsys::{Channel, Internal, OperatingPoint};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::directions::directions;
use super::spectra::Shapes;
use super::split;
use crate::ReductionError;

/// Largest singular value, of vectors of unit length, of directions of internal states that are left out; chosen: less than is missing of shapes.
const STATES: f64 = 1e-4;

/// Directions in which the internal states of modes lie.
#[derive(Debug, Clone, PartialEq)]
pub struct CoarseStates {
    /// Contacts that have one, by their channels, in order.
    pub channels: Vec<usize>,
    /// Z, orthonormal, a row for each of these.
    pub directions: DMatrix<f64>,
}

impl CoarseStates {
    /// The directions of the internal `states` of contacts at each of `points`, of a system with channels `of`; `None` where no point has any, or they
    /// spare nothing. They are for the contacts of the first point that has any: points where others have internal states are left out.
    pub(super) fn new(
        of: &[Channel],
        points: &[OperatingPoint],
        states: &[Shapes],
    ) -> Result<Option<Self>, ReductionError> {
        let channels_at = |point: &OperatingPoint| with_states(of, point);
        let Some(channels) = points.iter().map(channels_at).find(|channels| !channels.is_empty()) else {
            return Ok(None);
        };
        let of_these = points.iter().zip(states).filter(|(point, _)| channels_at(point) == channels);
        let columns: Shapes = of_these.flat_map(|(_, states)| states).cloned().collect();
        if columns.is_empty() {
            return Ok(None);
        }
        let columns = split::from_columns(&DMatrix::from_columns(&columns));
        let directions = directions(&DMatrix::zeros(channels.len(), 0), columns, STATES)?;
        Ok((directions.ncols() < channels.len()).then_some(Self { channels, directions }))
    }

    /// Internal states of contacts in these directions, then internal states of what relaxes: `Z^T diag(a) Z` is symmetric, and its eigenvalues are the
    /// decay rates.
    pub(super) fn of(&self, [of_contacts, relaxing]: [Internal; 2]) -> Internal {
        let Internal { decay, drive, force } = of_contacts;
        let weighted = DMatrix::from_fn(self.directions.nrows(), self.directions.ncols(), |row, column| {
            decay[row] * self.directions[(row, column)]
        });
        let rates = self.directions.tr_mul(&weighted).symmetric_eigen();
        let directions = &self.directions * rates.eigenvectors;
        let (mut decay, mut drive, mut force) = (rates.eigenvalues, directions.tr_mul(&drive), force * directions);
        let (own, others) = (decay.len(), relaxing.decay.len());
        if others > 0 {
            decay = decay.resize_vertically(own + others, 0.0);
            drive = drive.resize_vertically(own + others, 0.0);
            force = force.resize_horizontally(own + others, 0.0);
            decay.rows_mut(own, others).copy_from(&relaxing.decay);
            drive.rows_mut(own, others).copy_from(&relaxing.drive);
            force.columns_mut(own, others).copy_from(&relaxing.force);
        }
        Internal { decay, drive, force }
    }
}

/// Contacts that have an internal state at a point, by their channels.
pub(super) fn with_states(channels: &[Channel], point: &OperatingPoint) -> Vec<usize> {
    (0..channels.len()).filter(|&at| channels[at].is_contact && point.channels[at].lag.is_some()).collect()
}

/// Internal states of contacts, and internal states of what relaxes, at a point.
pub(super) fn apart(channels: &[Channel], point: &OperatingPoint, all: &Internal) -> [Internal; 2] {
    let with_lag = channels.iter().zip(&point.channels).filter(|(_, gain)| gain.lag.is_some()).enumerate();
    let (own, others): (Vec<_>, Vec<_>) = with_lag.partition(|(_, (channel, _))| channel.is_contact);
    [own, others].map(|states| {
        let states: Vec<usize> = states.into_iter().map(|(state, _)| state).collect();
        Internal {
            decay: all.decay.select_rows(&states),
            drive: all.drive.select_rows(&states),
            force: all.force.select_columns(&states),
        }
    })
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
