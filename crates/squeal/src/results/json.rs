//! The occurrences of a study for machines.

use serde_json::{Value, json};
use study::{ModeLabel, Panel};

use super::findings::warnings;
use super::{ArrangementOccurrence, Estimate, Results};
use crate::Error;

impl Results {
    /// The answer of a study as JSON: its warnings, then by panel how often anything and each mode is unstable, every
    /// probability with its limits at 95 %; the median over the arrangements of the panel, and each of them.
    ///
    /// # Errors
    /// None for the results of a study.
    pub fn json(&self) -> Result<Value, Error> {
        let plan = self.plan();
        let panels = self.panels().iter().map(|panel| self.panel(panel)).collect::<Result<Vec<_>, _>>()?;
        Ok(json!({
            "study": plan.name,
            "seed": plan.seed,
            "samples": self.summary.samples,
            "confidence": 0.95,
            "unstable": if plan.threshold.is_axis() { "Re lambda > 0".into() } else { plan.threshold.to_string() },
            "doubts": self.doubts(),
            "warnings": warnings(self),
            "panels": panels,
        }))
    }

    fn panel(&self, panel: &Panel) -> Result<Value, Error> {
        let labels = &self.plan().labels;
        let [constraints, law, speed] = labels.key_columns(panel.key);
        let of_label = labels.panels[panel.key.panel].arrangements.as_slice();
        let by_arrangement = |of: &[ArrangementOccurrence]| {
            let one = |occurrence: &ArrangementOccurrence| {
                let Estimate { value, lower, upper } = occurrence.estimate();
                let (arrangement, failed) = (&of_label[occurrence.arrangement], occurrence.failed);
                json!({ "arrangement": arrangement, "value": value, "lower": lower, "upper": upper, "failed": failed })
            };
            of.iter().map(one).collect::<Vec<_>>()
        };
        let mode = |name: ModeLabel, of: &[ArrangementOccurrence]| -> Result<Value, Error> {
            let frequency_hz = self.frequency(panel.key.constraints, name);
            let unstable_hz =
                self.unstable_hertz(panel.key.constraints, name).and_then(|hz| hz.range.map(|_| hz.median));
            let (occurrence, arrangements) = (self.median(of)?, by_arrangement(of));
            let name = name.to_string();
            Ok(json!({
                "mode": name,
                "frequency_hz": frequency_hz,
                "unstable_frequency_hz": unstable_hz,
                "occurrence": occurrence,
                "arrangements": arrangements,
            }))
        };
        let all = self.every_occurrence(panel);
        Ok(json!({
            "constraints": constraints,
            "law": law,
            "speed": speed,
            "in_contact": labels.panels[panel.key.panel].in_contact,
            "anything": self.median(&self.any_occurrence(panel))?,
            "mean_unstable": self.mean_unstable(panel),
            "modes": all.iter().map(|(name, of)| mode(*name, of)).collect::<Result<Vec<_>, _>>()?,
        }))
    }
}
