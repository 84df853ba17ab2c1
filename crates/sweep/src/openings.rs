//! Openings: places of a parameter at which contact points open or close, so that the systems of a brake kink or jump.
//!
//! Which points are closed is asked at equal steps of the range, and between two places that differ the step is halved to the last bits. That
//! takes equilibria of the contacts and no spectra.

use rayon::prelude::*;

use crate::Error;

/// Number of steps of the range, equal ones or of one ratio, at whose ends the state of the contact points is asked for; chosen: a point that opens and closes again within a step is not
/// seen.
pub(super) const OPENING_STEPS: usize = 1024;
/// Width of an opening, as a fraction of the range, that is not halved any more; chosen: the last bits.
const NARROWEST: f64 = 1e-14;
/// Largest distance, as a fraction of the range, of openings that are taken for one; chosen: between them no derivative can be computed.
pub(super) const TOGETHER: f64 = 1e-7;

/// A place at which contact points open or close.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct OpeningAt {
    /// Places next to it, as fractions of the range: the state is the old one at the first, the new one at the second.
    pub between: [f64; 2],
    /// Points that are open beyond it and not before.
    pub opens: Vec<usize>,
    /// Points that are closed beyond it and not before.
    pub closes: Vec<usize>,
}

/// State of the contact points at a place, a fraction of the range.
#[derive(Debug, Clone)]
struct StateAt {
    at: f64,
    closed: Vec<bool>,
}

/// Function that tells which contact points are closed at a place, a fraction of the range.
pub(super) type ClosedAt<'a> = &'a (dyn Fn(f64) -> Result<Vec<bool>, Error> + Sync);

/// The openings between two places, ascending; `value` gives the value of the parameter at a place.
///
/// # Errors
/// Those of the brake.
pub(super) fn openings(
    closed: ClosedAt<'_>,
    value: &(dyn Fn(f64) -> f64 + Sync),
    [from, to]: [f64; 2],
) -> Result<Vec<OpeningAt>, Error> {
    let state = |at: f64| Ok(StateAt { at, closed: closed(at)? });
    let steps = (OPENING_STEPS as f64 * (to - from)).ceil() as usize;
    let place = |step: usize| if step == steps { to } else { from + (to - from) * step as f64 / steps as f64 };
    let states = (0..=steps).into_par_iter().map(|step| state(place(step)));
    let states = states.collect::<Result<Vec<StateAt>, Error>>()?;
    let in_step = |step: &[StateAt]| {
        let mut found = Vec::new();
        halve(&state, value, [&step[0], &step[1]], &mut found)?;
        Ok(found)
    };
    let found = states.par_windows(2).map(in_step).collect::<Result<Vec<_>, Error>>()?;
    let mut together: Vec<[StateAt; 2]> = Vec::new();
    for [before, beyond] in found.into_iter().flatten() {
        match together.last_mut() {
            Some(last) if before.at - last[1].at <= TOGETHER => last[1] = beyond,
            _ => together.push([before, beyond]),
        }
    }
    Ok(together.iter().map(OpeningAt::new).collect())
}

/// Enters the steps as short as they can be between two places at which the state changes.
fn halve(
    state: &impl Fn(f64) -> Result<StateAt, Error>,
    value: &dyn Fn(f64) -> f64,
    [a, b]: [&StateAt; 2],
    found: &mut Vec<[StateAt; 2]>,
) -> Result<(), Error> {
    if a.closed == b.closed {
        return Ok(());
    }
    let at = 0.5 * (a.at + b.at);
    let is_end = [a, b].iter().any(|end| value(at) == value(end.at));
    if is_end || b.at - a.at <= NARROWEST {
        found.push([a.clone(), b.clone()]);
        return Ok(());
    }
    let middle = state(at)?;
    halve(state, value, [a, &middle], found)?;
    halve(state, value, [&middle, b], found)
}

impl OpeningAt {
    fn new([before, beyond]: &[StateAt; 2]) -> Self {
        let changed = |from: &StateAt, to: &StateAt| {
            let both = from.closed.iter().zip(&to.closed).enumerate();
            both.filter(|(_, (from, to))| **from && !**to).map(|(point, _)| point).collect()
        };
        Self { between: [before.at, beyond.at], opens: changed(before, beyond), closes: changed(beyond, before) }
    }
}
