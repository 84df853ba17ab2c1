//! Probabilities of sets of unstable modes over one uncertain parameter.

use std::collections::BTreeMap;

use montecarlo::Distribution;

use super::EstimatorError;
use crate::study::{ModeLabel, unstable_names};

/// An occurrence: a probability, between two limits where a coalescence leaves the name of a mode open.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct OccurrenceBounds {
    /// Of the mode unstable for sure.
    pub lower: f64,
    /// Of the mode perhaps unstable.
    pub upper: f64,
}

/// An interval of the parameter in which the same modes are unstable.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// The names of each unstable mode, several where they are open.
    pub unstable: Vec<Vec<ModeLabel>>,
}

/// What follows from the pieces.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Integral {
    /// By name of the tracked mode; modes that are never unstable are not listed.
    pub occurrences: BTreeMap<ModeLabel, OccurrenceBounds>,
    /// Probability of any unstable mode.
    pub any: f64,
    /// Expected number of unstable modes.
    pub expected_modes: f64,
    /// The pieces, ascending.
    pub pieces: Vec<Piece>,
}

/// Sums the probabilities of the pieces between `ends`, ascending; `unstable` says what each piece is like inside. An unstable
/// mode without a name may be any of `all_names`.
///
/// # Errors
/// Those of `unstable`.
pub fn integrate(
    distribution: &Distribution,
    ends: &[f64],
    all_names: &[ModeLabel],
    mut unstable: impl FnMut(f64) -> Result<Vec<Vec<ModeLabel>>, EstimatorError>,
) -> Result<Integral, EstimatorError> {
    let mut integral = Integral::default();
    for step in ends.windows(2) {
        let names = unstable(0.5 * (step[0] + step[1]))?;
        let part = distribution.cumulative(step[1]) - distribution.cumulative(step[0]);
        for (name, is_sure) in unstable_names(&names, all_names) {
            let occurrence = integral.occurrences.entry(name).or_default();
            occurrence.upper += part;
            occurrence.lower += if is_sure { part } else { 0.0 };
        }
        integral.any += if names.is_empty() { 0.0 } else { part };
        integral.expected_modes += part * names.len() as f64;
        integral.pieces.push(Piece { from: step[0], to: step[1], unstable: names });
    }
    Ok(integral)
}
