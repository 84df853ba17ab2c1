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
    // Nothing lies below the first end; a discrete distribution may have a value on it, which belongs to the first piece.
    let mut below = 0.0;
    for step in ends.windows(2) {
        let names = unstable(0.5 * (step[0] + step[1]))?;
        let up_to = distribution.cumulative(step[1]);
        let part = up_to - below;
        below = up_to;
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

#[cfg(test)]
mod tests {
    use montecarlo::Distribution;

    use super::integrate;
    use crate::ModeLabel;

    #[test]
    fn values_on_the_ends_count() {
        let discrete = Distribution::Discrete { values: vec![0.2, 0.5, 0.9], weights: vec![1.0, 2.0, 1.0] };
        let values = vec![0.2, 0.2, 0.5, 0.9];
        let empirical = Distribution::Empirical { values, file: None, column: None };
        for (distribution, expected) in [(discrete, 0.5), (empirical, 5.0 / 9.0 + 1.0 / 6.0)] {
            let (from, to) = distribution.support();
            // Unstable below 0.4, and beyond 0.7.
            let growing =
                |mu: f64| Ok(if (0.4..0.7).contains(&mu) { Vec::new() } else { vec![vec![ModeLabel::new(1)]] });
            let found = integrate(&distribution, &[from, 0.4, 0.7, to], &[], growing).unwrap();
            assert!((found.any - expected).abs() < 1e-12, "{distribution:?}: {}", found.any);
        }
    }
}
