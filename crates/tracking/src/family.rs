//! Systems over one real parameter that a function makes: their onsets and their root locus.

use std::sync::Arc;

use cea::QrSolver;
use linsys::SecondOrder;

use crate::TrackingError;
use crate::kept_spectra::{KeptSpectra, SystemAt, SystemChange};
use crate::locus::{RootLocus, root_locus};
use crate::onset_search::{Onsets, find_onsets};

/// Half of the step of the central differences that derivatives by the parameter are computed by, as a fraction of the interval; chosen: the error of the
/// differences, of the order of its square, is then about the rounding, machine epsilon over it.
const PARAMETER_DIFFERENCE: f64 = 1e-5;
/// Shortest step, as a fraction of the interval; chosen: derivatives by differences tell branches apart down to there.
const SHORTEST_PARAMETER_STEP: f64 = 1e-9;

/// Every onset from one parameter to another: where, how fast and which way an eigenvalue of `system` crosses the imaginary
/// axis. Steps of 1e-9 of the interval in which a mode only touches the axis are listed as unresolved.
///
/// All modes must oscillate in all of the interval, and modes that do not grow must decay: modes that stay on the imaginary axis, as in undamped
/// systems, have no onset to find.
///
/// ```
/// use linsys::SecondOrder;
/// use nalgebra::dmatrix;
/// use tracking::{TrackingError, onsets};
///
/// // The second mass is damped less and less.
/// let system = |p: f64| -> Result<SecondOrder, TrackingError> {
///     let c = dmatrix![0.1, 0.0; 0.0, 0.3 - p];
///     Ok(SecondOrder::new(dmatrix![1.0, 0.0; 0.0, 1.0], c, dmatrix![1.0, 0.0; 0.0, 4.0])?)
/// };
/// let found = onsets(system, 0.0, 1.0)?.onsets;
/// assert!((found[0].at - 0.3).abs() < 1e-12 && (found[0].omega - 2.0).abs() < 1e-12);
/// assert!(found.len() == 1 && found[0].destabilises);
/// # Ok::<(), TrackingError>(())
/// ```
///
/// # Errors
/// Those of `system`; [`TrackingError`] for what the search, the solver or the interval cannot do.
pub fn onsets<E: From<TrackingError>>(
    system: impl FnMut(f64) -> Result<SecondOrder, E>,
    from: f64,
    to: f64,
) -> Result<Onsets, E> {
    let mut family = KeptSpectra::new(with_change(system, from, to), &QrSolver);
    find_onsets(&mut family, from, to, SHORTEST_PARAMETER_STEP * (to - from))
}

/// The root locus of `system` from one parameter to another: each branch as far as it is known to be one, and where branches
/// may have been exchanged.
///
/// All modes must oscillate in all of the interval.
///
/// # Errors
/// As [`onsets`].
pub fn branches<E: From<TrackingError>>(
    system: impl FnMut(f64) -> Result<SecondOrder, E>,
    from: f64,
    to: f64,
) -> Result<RootLocus, E> {
    let mut family = KeptSpectra::new(with_change(system, from, to), &QrSolver);
    root_locus(&mut family, from, to, SHORTEST_PARAMETER_STEP * (to - from))
}

/// Makes systems on an interval, with their change from two systems a little below and above.
fn with_change<E>(
    mut system: impl FnMut(f64) -> Result<SecondOrder, E>,
    from: f64,
    to: f64,
) -> impl FnMut(f64) -> Result<SystemAt, E> {
    let step = PARAMETER_DIFFERENCE * (to - from);
    move |at| {
        // The function need not be defined outside of the interval: at its ends the difference is one-sided.
        let (below, above) = ((at - step).max(from), (at + step).min(to));
        let change = SystemChange { below: system(below)?, above: system(above)?, distance: above - below };
        Ok(SystemAt { system: system(at)?, change: Arc::new(change) })
    }
}

#[cfg(test)]
mod tests;
