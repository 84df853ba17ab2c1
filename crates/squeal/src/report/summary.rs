//! The occurrences of a study in a few lines for people.

use std::fmt::Write as _;

use montecarlo::Sampling;

use super::Results;
use crate::Error;
use crate::study::{Panel, Study, StudyTally, UncertainBrake};

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
        for panel in self.panels() {
            let _ = writeln!(text, "{}:", self.describe(panel));
            let occurrences = self.occurrences(panel);
            if occurrences.is_empty() {
                text += "  no mode is ever unstable\n";
            }
            for (name, of_mode) in occurrences {
                let estimate = self.median(&of_mode)?;
                let frequency = self.frequency(panel, name).map_or(String::new(), |hertz| format!(" at {hertz:.4} Hz"));
                let (value, limits) = (estimate.value, format!("{:.4} to {:.4}", estimate.lower, estimate.upper));
                let _ =
                    writeln!(text, "  mode {name}{frequency}: unstable in {value:.4} of the samples (95 %: {limits})");
            }
        }
        Ok(text)
    }

    /// The frequency of a tracked mode at median parameters in the first scene of a panel, Hz.
    fn frequency(&self, panel: &Panel, name: u16) -> Option<f64> {
        let reference = &self.references()[*panel.scenes.first()?];
        let at = reference.names.iter().position(|names| *names == [name])?;
        Some(cea::frequency_hz(reference.modes[at].lambda))
    }
}
