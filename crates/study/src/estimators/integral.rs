//! Probabilities of sets of unstable modes over one uncertain parameter.

use std::collections::BTreeMap;

use montecarlo::Distribution;

use super::EstimatorError;
use crate::{ModeLabel, unstable_names};

/// An occurrence: the probability that a mode is unstable, between two limits where a coalescence leaves its name open.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct OccurrenceBounds {
    /// Probability that the mode is certainly unstable.
    pub lower: f64,
    /// Probability that the mode is certainly or possibly unstable.
    pub upper: f64,
}

/// An interval of the parameter in which the same modes are unstable.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// Candidate names of each unstable mode, one where the name is certain.
    pub unstable: Vec<Vec<ModeLabel>>,
}

/// Occurrences from the pieces of the parameter's interval.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Integral {
    /// Occurrence of each tracked mode, by name; modes that are never unstable are not listed.
    pub occurrences: BTreeMap<ModeLabel, OccurrenceBounds>,
    /// Probability of any unstable mode.
    pub any: f64,
    /// Expected number of unstable modes.
    pub expected_modes: f64,
    /// The pieces, ascending.
    pub pieces: Vec<Piece>,
}

/// Sums the probabilities of the pieces between `ends`, ascending; `unstable` gives the names of the unstable modes at a point
/// of a piece. An unstable mode without a name may be any of `all_names`.
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
