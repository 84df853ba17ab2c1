//! Divergence of a reduced brake, as far as it is known: its samples have the modes of the band alone.

use super::FullChecks;

/// Reason why samples of a brake may miss divergence, in a sentence; `None` of one that is not reduced, and where draws were solved with
/// the full model and none diverges.
pub fn divergence_doubt(is_reduced: bool, checks: Option<FullChecks>) -> Option<String> {
    let is_without = |checks: FullChecks| checks.samples > 0 && checks.diverging + checks.divergence_open == 0;
    (is_reduced && !checks.is_some_and(is_without)).then(|| divergence_of_reduced(checks))
}

/// Divergence of a reduced brake, which its samples do not show, in a sentence: the result of draws that were solved with the full model.
pub fn divergence_of_reduced(checks: Option<FullChecks>) -> String {
    match checks.filter(|checks| checks.samples > 0) {
        None => "DIVERGENCE was not looked for: a reduced brake has the modes of its band alone, and no draw was solved with the whole \
                 one (reduction.full_checks)."
            .into(),
        Some(FullChecks { samples, diverging: 0, divergence_open: open @ 1.., .. }) => format!(
            "DIVERGENCE: whether real eigenvalues grow could not be told in {open} of {samples} draws of the whole brake, in the others \
             none does. Samples were not looked at."
        ),
        Some(FullChecks { samples, diverging: 0, .. }) => format!(
            "Divergence (real eigenvalues that grow) was looked for in {samples} draws of the whole brake and not in the samples: there is \
             none."
        ),
        Some(FullChecks { samples, diverging, divergence, .. }) => format!(
            "DIVERGENCE, instability without oscillation: in {diverging} of {samples} draws something grows faster than it oscillates, by up \
             to {divergence:.1e} 1/s or so, as single pairs of nodes do where the curve of friction falls more steeply than contact damping \
             holds. No sample counts it: what is said to be stable here may diverge."
        ),
    }
}
