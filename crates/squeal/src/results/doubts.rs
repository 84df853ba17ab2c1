//! Doubts that stand before everything else: reasons why the results of a study on a reduced brake may be wrong.

use study::{FullChecks, SceneTally, divergence_doubt, divergence_of_reduced};

use super::Results;

impl Results {
    /// Reasons why the results may differ from results of the full model, in sentences; empty where nothing speaks against them.
    pub fn doubts(&self) -> Vec<String> {
        let mut doubts = self.plan().doubts.clone();
        if let Some(checks) = &self.full_checks {
            doubts.extend(failed_checks(checks));
        }
        doubts.extend(divergence_doubt(self.plan(), self.has_band_modes, self.full_checks.as_ref()));
        let sum = |of: fn(&SceneTally) -> u64| self.summary.tally.scenes.iter().map(of).sum::<u64>();
        let (residuals, above) = (sum(|tally| tally.residuals), sum(|tally| tally.residuals_above));
        if above > 0 {
            let largest = self.summary.tally.scenes.iter().map(|tally| tally.largest_residual).fold(0.0, f64::max);
            doubts.push(format!(
                "{above} of {residuals} unstable modes have a residual in the whole brake above reduction.residual and above those of draws whose \
                 error is known, up to {largest:.1e}: their growth may be less sure than is assumed. More reduction.full_checks tell."
            ));
        }
        if let Some(FullChecks { samples, growing_beside, beside_hz: Some([low, high]), .. }) = &self.full_checks {
            let hz = if low == high { format!("{low:.0} Hz") } else { format!("{low:.0} to {high:.0} Hz") };
            doubts.push(format!(
                "{growing_beside} of {samples} draws of the whole brake have a growing mode next to the ends of the band, at {hz}: it is not \
                 counted. Widen reduction.frequencies."
            ));
        }
        doubts
    }

    /// Divergence of a reduced brake, whose samples show none, as far as it is known, in a sentence; `None` of another brake.
    pub fn divergence_in_words(&self) -> Option<String> {
        self.has_band_modes.then(|| divergence_of_reduced(self.plan(), self.full_checks.as_ref()))
    }
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
