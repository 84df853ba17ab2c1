//! The exact integral: occurrences without sampling.
//!
//! Between two critical coefficients the set of unstable modes does not change, so the probability that a mode is unstable
//! is the probability of mu lying in certain intervals: differences of its distribution function at the critical
//! coefficients. The error is the probability of what the root search leaves open, of the steps it could not resolve
//! and of the tails that were cut off.

use std::collections::BTreeMap;

use cea::Counters;

use super::distribution::{cumulative, support};
use super::{AccuracyError, Crossings, Family};
use crate::study::{Plan, Reference, Sample, Scene, UnstableMode, unstable_names};

/// Probability cut off at both ends of the support.
const CUT_OFF: f64 = 2e-12;

/// An occurrence: a probability, between two limits where a coalescence leaves the name of a mode open.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct Occurrence {
    /// Of the mode unstable for sure.
    pub lower: f64,
    /// Of the mode perhaps unstable.
    pub upper: f64,
}

/// What the integral over mu says of one scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Exact {
    /// By name of the tracked mode; modes that are never unstable are not listed.
    pub occurrences: BTreeMap<u16, Occurrence>,
    /// Bound of the error of each occurrence.
    pub error: f64,
    /// Probability of any unstable mode.
    pub any: f64,
    /// Expected number of unstable modes.
    pub expected_modes: f64,
    /// Where eigenvalues cross the axis.
    pub crossings: Crossings,
    /// Intervals of mu that share a set of unstable modes, each with the names of these modes.
    pub pieces: Vec<Piece>,
    /// What was computed.
    pub counters: Counters,
}

/// An interval of mu in which the same modes are unstable.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// The names of each unstable mode, several where they are open; ascending in frequency.
    pub unstable: Vec<Vec<u16>>,
}

/// Integrates over the family of `scene`, whose modes at median parameters are `reference`.
///
/// # Errors
/// Those of [`Family::new`] and [`Family::crossings`].
pub fn exact(
    plan: &Plan,
    scene: &Scene,
    reference: &Reference,
    family: &mut Family<'_>,
) -> Result<Exact, AccuracyError> {
    let distribution = plan.case.friction.mu;
    let (from, to) = support(distribution);
    let median = Sample::median(&plan.case).contact(0).mu;
    debug_assert_eq!(family.system(median), &reference.system, "{:?}", scene.key);
    family.node(median)?;
    let crossings = family.crossings(from, to)?;
    let mut ends = vec![from];
    ends.extend(crossings.crossings.iter().map(|c| c.mu));
    ends.push(to);

    let mut exact = Exact {
        occurrences: BTreeMap::new(),
        error: CUT_OFF,
        any: 0.0,
        expected_modes: 0.0,
        pieces: Vec::new(),
        counters: family.counters(),
        crossings,
    };
    let probability = |a: f64, b: f64| cumulative(distribution, b) - cumulative(distribution, a);
    for step in ends.windows(2) {
        let unstable = named(family, 0.5 * (step[0] + step[1]), median, reference)?;
        let part = probability(step[0], step[1]);
        let modes: Vec<UnstableMode> =
            unstable.iter().map(|names| UnstableMode { rank: 0, names: names.clone(), net_work: None }).collect();
        for (name, is_sure) in unstable_names(&modes) {
            let occurrence = exact.occurrences.entry(name).or_default();
            occurrence.upper += part;
            occurrence.lower += if is_sure { part } else { 0.0 };
        }
        exact.any += if modes.is_empty() { 0.0 } else { part };
        exact.expected_modes += part * modes.len() as f64;
        exact.pieces.push(Piece { from: step[0], to: step[1], unstable });
    }
    exact.error += exact.crossings.crossings.iter().map(|c| probability(c.mu - c.error, c.mu + c.error)).sum::<f64>();
    exact.error += exact.crossings.unresolved.iter().map(|&(a, b)| probability(a, b)).sum::<f64>();
    exact.counters = family.counters();
    Ok(exact)
}

/// The names of the unstable modes at `mu`, by continuation to the reference at `median`.
fn named(family: &mut Family<'_>, mu: f64, median: f64, reference: &Reference) -> Result<Vec<Vec<u16>>, AccuracyError> {
    let lambdas = family.lambdas(mu)?;
    let unstable: Vec<usize> = (0..lambdas.len()).filter(|&i| lambdas[i].re > 0.0).collect();
    let name = |index: usize| {
        let ends = family.follow(mu, index, median)?;
        let mut names: Vec<u16> = ends.into_iter().flat_map(|i| reference.names[i].iter().copied()).collect();
        names.sort_unstable();
        names.dedup();
        Ok(names)
    };
    unstable.into_iter().map(name).collect()
}
