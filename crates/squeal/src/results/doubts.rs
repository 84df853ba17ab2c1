//! Doubts that stand before everything else: reasons why the results of a study on a reduced brake may be wrong.

use study::{SceneTally, divergence_of_reduced, doubts_of_checks};

use super::Results;

impl Results {
    /// Reasons why the results may differ from results of the full model, in sentences; empty where nothing speaks against them.
    pub fn doubts(&self) -> Vec<String> {
        let mut doubts = self.plan().doubts.clone();
        doubts.extend(doubts_of_checks(self.plan(), self.has_band_modes, self.full_checks.as_ref()));
        let sum = |of: fn(&SceneTally) -> u64| self.summary.tally.scenes.iter().map(of).sum::<u64>();
        let (residuals, above) = (sum(|tally| tally.residuals), sum(|tally| tally.residuals_above));
        if above > 0 {
            let largest = self.summary.tally.scenes.iter().map(|tally| tally.largest_residual).fold(0.0, f64::max);
            doubts.push(format!(
                "{above} of {residuals} unstable modes have a residual in the whole brake above reduction.residual and above those of draws whose \
                 error is known, up to {largest:.1e}: their growth may be less sure than is assumed. More reduction.full_checks tell."
            ));
        }
        doubts
    }

    /// Divergence of a reduced brake, whose samples show none, as far as it is known, in a sentence; `None` of another brake.
    pub fn divergence_in_words(&self) -> Option<String> {
        self.has_band_modes.then(|| divergence_of_reduced(self.plan(), self.full_checks.as_ref()))
    }
}
