//! The exact integral: occurrences without sampling, exact up to crossings of the axis that a rule excludes.
//!
//! Between two onsets the set of unstable modes does not change, so that the probability that a mode is unstable is the
//! probability that mu lies in certain intervals: a sum of differences of its distribution function. The error bound is the
//! probability of the error intervals of the onsets, of the steps that the search could not resolve, and of the tails that were
//! cut off. It does not cover a branch that crosses the axis twice within one step: [`tracking::find_onsets`] excludes that by
//! a rule.

use cea::{Counters, EigenSolver, QrSolver, Verdict, Workspace, verdicts};
use linsys::SecondOrder;
use num_complex::Complex;
use tracking::{Branches, Onsets, follow_branch};

use super::integral::{Integral, integrate};
use super::one_parameter_family::SMALLEST_STEP;
use super::{EstimatorError, OneParameterFamily};
use crate::{ModeLabel, Reference};

/// Largest relative distance between two solvers' results for the same eigenvalue; chosen, far above rounding and far below the
/// distance of modes.
const SAME_EIGENVALUE: f64 = 1e-6;
/// Probability cut off at both ends of the support together: [`montecarlo::Distribution::support`] leaves out 1e-12 at each.
const CUT_OFF: f64 = 2e-12;

/// The result of the exact integral for one scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Exact {
    /// Occurrences, with the pieces of the interval that they are summed over.
    pub integral: Integral,
    /// Bound of the error of each probability, if no pair of onsets was overlooked within one step.
    pub error: f64,
    /// Onsets of the unstable modes.
    pub onsets: Onsets,
    /// Numbers of computations, without the computations of the reference.
    pub counters: Counters,
}

/// Integrates over the family of a scene; `reference` has its modes at median parameters.
///
/// # Errors
/// Those of [`OneParameterFamily::onsets`].
pub fn exact(reference: &Reference, family: &mut OneParameterFamily<'_>) -> Result<Exact, EstimatorError> {
    let distribution = family.distribution();
    let (from, to) = distribution.support();
    let median = distribution.median();
    family.lambdas(median)?;
    let onsets = family.onsets(from, to)?;
    let mut ends = vec![from];
    ends.extend(onsets.onsets.iter().map(|onset| onset.at));
    ends.push(to);
    let integral = integrate(&distribution, &ends, &reference.all_names(), |mu| named(family, mu, median, reference))?;
    let probability = |a: f64, b: f64| distribution.cumulative(b) - distribution.cumulative(a);
    let roots = onsets.onsets.iter().map(|onset| probability(onset.at - onset.error, onset.at + onset.error));
    let unresolved = onsets.unresolved.iter().map(|&(a, b)| probability(a, b));
    let error = CUT_OFF + roots.chain(unresolved).sum::<f64>();
    Ok(Exact { integral, error, onsets, counters: family.counters() })
}

/// The names of the unstable modes at `mu`, by continuation to the reference at `median`.
fn named(
    family: &mut OneParameterFamily<'_>,
    mu: f64,
    median: f64,
    reference: &Reference,
) -> Result<Vec<Vec<ModeLabel>>, EstimatorError> {
    let at_median = family.lambdas(median)?.to_vec();
    let lambdas = family.lambdas(mu)?.to_vec();
    let growing: Vec<usize> = (0..lambdas.len()).filter(|&i| lambdas[i].re > 0.0).collect();
    let unstable = surely_unstable(growing, &lambdas, &family.system(mu), mu)?;
    let name = |index: usize| {
        let ends = follow_branch(family, mu, index, median, SMALLEST_STEP)?;
        Ok(reference.names_of(ends.into_iter().map(|end| place(reference, end, at_median[end]))))
    };
    unstable.into_iter().map(name).collect()
}

/// Indices of the eigenvalues right of the axis that surely are unstable, by their bounds; a marginal one neither grows nor decays.
///
/// # Errors
/// [`EstimatorError::NotOneParameter`] where a verdict is open.
fn surely_unstable(
    mut growing: Vec<usize>,
    lambdas: &[Complex<f64>],
    system: &SecondOrder,
    mu: f64,
) -> Result<Vec<usize>, EstimatorError> {
    if growing.is_empty() {
        return Ok(growing);
    }
    let mut work = Workspace::default();
    let spectrum = QrSolver.eigenvalues(system, &mut work)?;
    let of: Vec<Complex<f64>> = growing.iter().map(|&i| lambdas[i]).collect();
    let verdicts = verdicts(system, &of, &spectrum, &mut work)?;
    if verdicts.iter().any(|verdict| matches!(verdict, Verdict::Undecided { .. })) {
        let found = format!("an undecided one at {mu}");
        return Err(EstimatorError::NotOneParameter { needed: "a sure verdict on every mode", found });
    }
    let mut verdicts = verdicts.into_iter();
    growing.retain(|_| verdicts.next() == Some(Verdict::Unstable));
    Ok(growing)
}

/// The index among the reference modes of an eigenvalue with `index` in the spectrum of the family. The two indices may differ
/// for modes of equal frequency, whose order depends on rounding errors of the two solvers.
fn place(reference: &Reference, index: usize, lambda: Complex<f64>) -> usize {
    let distance = |at: usize| (reference.modes[at].lambda - lambda).norm();
    if index < reference.modes.len() && distance(index) <= SAME_EIGENVALUE * lambda.norm() {
        return index;
    }
    (0..reference.modes.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap_or(index)
}
