//! The occurrences of a study in a few lines for people.

use std::fmt::Write as _;

use montecarlo::Sampling;

use super::Results;
use crate::Error;
use crate::study::{Study, StudyTally, UncertainBrake};

impl<'a> Results<'a> {
    /// Runs a study in memory, without a folder: all samples of its plan on all cores.
    ///
    /// # Errors
    /// A plan without samples, no worker threads.
    pub fn sampled<B: UncertainBrake>(study: &'a Study<'a, B>) -> Result<Self, Error> {
        let plan = study.plan();
        let summary = montecarlo::run(study, &Sampling::new(plan.seed, plan.samples), || StudyTally::empty(plan))?;
        Ok(Results::new(study, summary))
    }

    /// For each panel the modes that are ever unstable, with frequency at median parameters and occurrence: the median over
    /// the arrangements of the panel, where there are several.
    ///
    /// # Errors
    /// None for the results of a study.
    pub fn text(&self) -> Result<String, Error> {
        let mut text = String::new();
        if !self.plan().threshold.is_axis() {
            let _ = writeln!(text, "unstable: with {}", self.plan().threshold);
        }
        for panel in self.panels() {
            let _ = writeln!(text, "{}:", self.describe(panel));
            let occurrences = self.occurrences(panel);
            if occurrences.is_empty() {
                text += "  no mode is ever unstable\n";
            }
            for (name, of_mode) in occurrences {
                let estimate = self.median(&of_mode)?;
                let frequency = self
                    .frequency(panel.key.constraints, name)
                    .map_or(String::new(), |f| format!(" at {} Hz", hertz(f)));
                let label = self.mode_label(panel.key.constraints, name);
                let (value, limits) = (estimate.value, format!("{:.4} to {:.4}", estimate.lower, estimate.upper));
                let _ =
                    writeln!(text, "  mode {label}{frequency}: unstable in {value:.4} of the samples (95 %: {limits})");
            }
        }
        Ok(text)
    }
}

/// A frequency in Hz with three decimals, below 1 Hz with four significant digits: brakes in units of their own have such.
pub(crate) fn hertz(frequency: f64) -> String {
    let below_one = -frequency.abs().log10().floor();
    let decimals = if below_one.is_finite() { below_one.clamp(0.0, 9.0) as usize + 3 } else { 3 };
    format!("{frequency:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::hertz;

    #[test]
    fn small_frequencies_keep_four_digits() {
        for (frequency, text) in
            [(1015.9524, "1015.952"), (1.5, "1.500"), (0.2254613, "0.2255"), (1.1779e-4, "0.0001178"), (0.0, "0.000")]
        {
            assert_eq!(hertz(frequency), text);
        }
    }
}
