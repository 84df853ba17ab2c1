//! Divergence of a reduced brake, as far as it is known: its samples have the modes of the band alone.

use montecarlo::Confidence;

use super::{DivergenceCounts, FullChecks, Plan};

/// Reason why samples of a brake may miss divergence, in a sentence; `None` of one that is not reduced, and where draws were solved with
/// the full model and none diverges.
pub fn divergence_doubt(plan: &Plan, is_reduced: bool, checks: Option<&FullChecks>) -> Option<String> {
    let is_without = |checks: &FullChecks| {
        let found = checks.divergence_where(|_| true);
        found.draws > 0 && found.diverging + found.open == 0
    };
    (is_reduced && !checks.is_some_and(is_without)).then(|| divergence_of_reduced(plan, checks))
}

/// Divergence of a reduced brake, which its samples do not show, in a sentence: the proportion of the draws that were solved with the full
/// model, of all and by law.
pub fn divergence_of_reduced(plan: &Plan, checks: Option<&FullChecks>) -> String {
    let Some(checks) = checks.filter(|checks| checks.samples > 0) else {
        return "DIVERGENCE was not looked for: a reduced brake has the modes of its band alone, and no draw was solved with the whole \
                one (reduction.full_checks)."
            .into();
    };
    match checks.divergence_where(|_| true) {
        DivergenceCounts { draws, diverging: 0, open: open @ 1.., .. } => format!(
            "DIVERGENCE: whether something grows faster than it oscillates could not be told in {open} of {draws} draws of the whole brake, in \
             the others nothing does. Samples were not looked at."
        ),
        DivergenceCounts { draws, diverging: 0, .. } => format!(
            "Divergence (something that grows faster than it oscillates) was looked for in {draws} draws of the whole brake and not in the \
             samples: there is none."
        ),
        all => {
            let of_law = |law: usize| checks.divergence_where(|scene| plan.scenes[scene].key.law == law);
            let laws: Vec<String> = (plan.labels.laws.iter().enumerate())
                .map(|(law, label)| format!("{} {}", label.name, in_words(&of_law(law))))
                .collect();
            let by_law = if laws.len() > 1 { format!("; {}", laws.join(", ")) } else { String::new() };
            format!(
                "DIVERGENCE, instability without oscillation: something grows faster than it oscillates in {} of the draws of the whole \
                 brake{by_law}; {}, as single pairs of nodes do where the curve of friction falls more steeply than contact \
                 damping holds. Samples do not count it: what is said to be stable here may diverge.",
                in_words(&all),
                all.growth_in_words()
            )
        }
    }
}

/// Words for a proportion of draws, with its limits.
fn in_words(counts: &DivergenceCounts) -> String {
    let proportion = counts.proportion();
    let Some(part) = proportion.estimate() else { return "of no draw".into() };
    let limits = proportion.interval(Confidence::P95);
    format!("{:.4} (95 %: {:.4} to {:.4})", part.lower, limits.lower, limits.upper)
}
