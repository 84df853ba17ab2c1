//! Doubts of a reduced brake: reasons why what is found of it may not be so of the full model, in the same words whichever question is asked.

use std::collections::BTreeMap;

use super::{FullChecks, ModeSource, Plan, UncertainBrake, divergence_doubt};

/// Sentences that speak against what samples of a brake say: the doubts of its plan, scenes of whose errors nothing is known, and what its checks against the full
/// model show. Empty where nothing does.
pub fn doubts_of<B: UncertainBrake>(brake: &B) -> Vec<String> {
    let (plan, source) = (brake.plan(), brake.mode_source());
    let mut doubts = plan.doubts.clone();
    let of_errors = source.map_or_else(Vec::new, |source| unknown_errors(plan, source));
    doubts.extend(of_errors.into_iter().filter(|doubt| !plan.doubts.contains(doubt)));
    doubts.extend(doubts_of_checks(plan, source.is_some(), source.and_then(|source| source.full_checks())));
    doubts
}

/// A sentence for each reason for which nothing is known of the errors of a scene.
pub fn unknown_errors(plan: &Plan, source: &dyn ModeSource) -> Vec<String> {
    let mut scenes: BTreeMap<&str, usize> = BTreeMap::new();
    for why in plan.scenes.iter().filter_map(|scene| source.unknown_error(scene)) {
        *scenes.entry(why).or_default() += 1;
    }
    let all = plan.scenes.len();
    let sentence = |(why, count)| format!("in {count} of {all} scenes {why}, so that nothing is known of its errors");
    scenes.into_iter().map(sentence).collect()
}

/// Sentences on what the checks of a reduced brake against the full model show: modes that it does not have, divergence, growing modes next to its band; none of a brake that
/// is not reduced.
pub fn doubts_of_checks(plan: &Plan, is_reduced: bool, checks: Option<&FullChecks>) -> Vec<String> {
    let failed = checks.and_then(failed_checks);
    let divergence = divergence_doubt(plan, is_reduced, checks);
    let beside = checks.and_then(|FullChecks { samples, growing_beside, beside_hz, .. }| {
        let [low, high] = (*beside_hz)?;
        let hz = if low == high { format!("{low:.0} Hz") } else { format!("{low:.0} to {high:.0} Hz") };
        Some(format!(
            "{growing_beside} of {samples} draws of the whole brake have a growing mode next to the ends of the band, at {hz}: it is not \
             counted. Widen reduction.frequencies."
        ))
    });
    failed.into_iter().chain(divergence).chain(beside).collect()
}

/// True of a brake whose samples are not known to be those of the full model: it has other modes, or nothing is known of its errors.
pub fn is_untrusted<B: UncertainBrake>(brake: &B) -> bool {
    brake.mode_source().is_some_and(|source| {
        let has_other_modes = source.full_checks().is_some_and(FullChecks::has_other_modes);
        has_other_modes || !unknown_errors(brake.plan(), source).is_empty()
    })
}

/// Modes of the full model that a reduced brake does not have, in words.
fn failed_checks(checks: &FullChecks) -> Option<String> {
    let FullChecks { samples, modes, missing, invented, other_verdicts, trained_on, .. } = checks;
    checks.has_other_modes().then(|| {
        format!(
            "The reduced brake FAILED its check: of {modes} modes of the whole brake in {samples} draws it misses {missing}, has {invented} \
             more, and gives {other_verdicts} another verdict, although it was trained on {trained_on} times. Do not rely on these \
             results: more reduction.training is needed."
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_check_fails_by_each_of_its_counts() {
        let good =
            FullChecks { samples: 10, modes: 120, residuals_above: 3, growing_beside: 2, ..FullChecks::default() };
        assert_eq!(failed_checks(&good), None);
        for (missing, invented, other_verdicts) in [(1, 0, 0), (0, 1, 0), (0, 0, 1)] {
            let words =
                failed_checks(&FullChecks { missing, invented, other_verdicts, ..good.clone() }).unwrap_or_default();
            assert!(
                words.contains("FAILED") && words.contains(&format!("misses {missing}, has {invented}")),
                "{words}"
            );
        }
    }
}
