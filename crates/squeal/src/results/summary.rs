//! Results of a study run in memory, and results in a few lines for people.

use std::fmt::Write as _;

use montecarlo::{Progress, Sampling};
use output::printable;
use study::{ModeLabel, Panel, SceneTally, Study, StudyTally, UncertainBrake};

use super::findings::warnings;
use super::{ArrangementOccurrence, Estimate, Results};
use crate::Error;

impl Results {
    /// Runs a study in memory, without a folder: all samples of its plan on all cores.
    ///
    /// # Errors
    /// A plan without samples, no worker threads.
    pub fn sampled<B: UncertainBrake>(study: &Study<'_, B>) -> Result<Self, Error> {
        Self::sampled_with(study, &())
    }

    /// Results as by [`Results::sampled`], with the progress reported in evaluations; a progress that is cancelled ends it.
    ///
    /// # Errors
    /// As [`Results::sampled`]; [`Error::is_cancelled`].
    pub fn sampled_with<B: UncertainBrake>(study: &Study<'_, B>, progress: &dyn Progress) -> Result<Self, Error> {
        let plan = study.plan();
        let sampling = Sampling::new(plan.seed, plan.samples);
        let summary = montecarlo::run_with(study, &sampling, || StudyTally::empty(plan), None, progress)?;
        Ok(Results::new(study, summary))
    }

    /// Text of the unstable modes of each panel, which is named where there are several: with its frequency where it is unstable and its
    /// occurrence, the median over the arrangements of the panel where there are several; unstable modes without a name; divergence.
    /// Failures and open verdicts come first.
    ///
    /// # Errors
    /// None for the results of a study.
    pub fn text(&self) -> Result<String, Error> {
        let mut text = self.said_first();
        if !self.plan().threshold.is_axis() {
            let _ = writeln!(text, "unstable: with {}", self.plan().threshold);
        }
        let is_single = self.panels().len() == 1;
        let margin = if is_single { "" } else { "  " };
        for panel in self.panels() {
            if !is_single {
                let _ = writeln!(text, "{}:", self.describe(panel));
            }
            let (modes, others) = (self.occurrences(panel), self.other_occurrences(panel));
            if modes.is_empty() && others.is_empty() {
                let _ = writeln!(text, "{margin}{}", self.nothing_unstable(panel));
            }
            let line = |what: String, of: &[ArrangementOccurrence]| -> Result<String, Error> {
                let Estimate { value, lower, upper } = self.median(of)?;
                let open =
                    of.iter().map(|of| of.proportion.ambiguous() - of.failed.min(of.proportion.ambiguous())).max();
                let open = match open.unwrap_or(0) {
                    0 => String::new(),
                    1 => "; in one more it is open".to_owned(),
                    count => format!("; in {count} more it is open"),
                };
                Ok(format!(
                    "{margin}{what}: unstable in {value:.4} of the samples (95 %: {lower:.4} to {upper:.4}){open}\n"
                ))
            };
            // The total, where the lines of single modes do not tell it: an unstable mode without a name, divergence, a mode whose name or verdict is open, or
            // modes that alternate from draw to draw, so that more draws are surely unstable than by any one of them.
            let is_open = |of: &ArrangementOccurrence| of.proportion.ambiguous() > of.failed;
            let any = self.any_occurrence(panel);
            let mut likeliest: f64 = 0.0;
            for of_mode in modes.values() {
                likeliest = likeliest.max(self.median(of_mode)?.value);
            }
            let alternate = self.median(&any)?.lower > likeliest;
            if !others.is_empty() || modes.values().flatten().any(is_open) || alternate {
                text += &line("anything".into(), &any)?;
            }
            for (name, of_mode) in &modes {
                text += &line(self.in_words(panel.key.constraints, *name), of_mode)?;
            }
            for (name, of_label) in &others {
                text += &line(self.in_words(panel.key.constraints, *name), of_label)?;
            }
        }
        Ok(text)
    }

    /// Warnings that every number has to be read with, a line each: failures, and open verdicts.
    pub fn said_first(&self) -> String {
        warnings(self).into_iter().map(|warning| printable(&warning) + "\n").collect()
    }

    /// Text of a study of many panels in a few lines: the warnings first, then the numbers of evaluations with what no figure of modes
    /// shows.
    pub fn in_short(&self) -> String {
        let sum = |of: fn(&SceneTally) -> u64| self.summary.tally.scenes.iter().map(of).sum::<u64>();
        let (solved, any) = (sum(|tally| tally.solved), sum(|tally| tally.any_unstable));
        let mut text = self.said_first();
        let _ = writeln!(text, "anything is unstable in {any} of {solved} evaluations that were solved");
        for (what, count) in [
            ("divergence (real eigenvalues, no oscillation)", sum(|tally| tally.diverging)),
            ("modes without a name", sum(|tally| tally.unnamed().hits())),
        ] {
            if count > 0 {
                let _ = writeln!(text, "  {what}: in {count} of them");
            }
        }
        text
    }

    /// Words for a mode, with its frequency, or for another label, for people.
    pub fn in_words(&self, constraints: usize, name: ModeLabel) -> String {
        match name {
            ModeLabel::DIVERGENCE => "divergence (real eigenvalues, no oscillation)".into(),
            ModeLabel::UNNAMED => "modes without a name (none has it at median parameters)".into(),
            name => {
                let frequency = self.hertz_in_words(constraints, name);
                let frequency = frequency.map_or(String::new(), |hz| format!(" at {hz}"));
                format!("mode {}{frequency}", self.mode_label(constraints, name))
            }
        }
    }

    /// Words for a panel in which nothing is known to be unstable.
    fn nothing_unstable(&self, panel: &Panel) -> String {
        let sum = |of: &dyn Fn(usize) -> u64| -> u64 { panel.scenes.iter().map(|&scene| of(scene)).sum() };
        let tally = |of: fn(&SceneTally) -> u64| sum(&|scene| of(&self.summary.tally.scenes[scene]));
        let (failed, solved) = (sum(&|scene| self.failed(scene)), tally(|tally| tally.solved));
        let (undecided, marginal) = (tally(|tally| tally.undecided), tally(|tally| tally.marginal));
        if failed > 0 {
            return format!(
                "no mode is surely unstable in the {solved} evaluations that were solved; {failed} failed and may be unstable"
            );
        }
        if undecided > 0 {
            return format!("{undecided} verdicts are undecided; no mode is surely unstable");
        }
        match marginal {
            0 => "no mode is ever unstable".into(),
            _ => format!(
                "no mode is ever unstable; {marginal} eigenvalues lie on the imaginary axis, as without damping, and neither grow nor decay"
            ),
        }
    }
}
