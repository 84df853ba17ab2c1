//! How strong unstable modes are: frequency, growth rate and damping ratio over the draws in which they are unstable.

use montecarlo::{Merge, QuantileSketch};
use output::Table;
use study::{ModeLabel, ModeNaming, Strength};

use super::Results;
use crate::Error;

impl Results {
    /// Strength of a mode under a set of constraints and a law, over all arrangements and speeds; `None` where it never was surely this
    /// one that was unstable, and where modes are not named by tracking.
    #[must_use]
    pub fn strength_under(&self, constraints: usize, law: usize, name: ModeLabel) -> Option<&Strength> {
        let group = constraints * self.plan().labels.laws.len() + law;
        let strengths = self.summary.tally.strengths.get(group).filter(|_| self.labels == ModeNaming::Tracked)?;
        strengths.get(&name)
    }

    /// True if modes have strengths: under the names that tracking gives them.
    #[must_use]
    pub fn has_strengths(&self) -> bool {
        self.labels == ModeNaming::Tracked
    }

    /// Strength of a mode under a set of constraints, over all laws that the results have; as [`Results::strength_under`].
    #[must_use]
    pub fn strength(&self, constraints: usize, name: ModeLabel) -> Option<Strength> {
        let has_law = |&law: &usize| self.panels_of(constraints, law).next().is_some();
        let mut all: Option<Strength> = None;
        for law in (0..self.plan().labels.laws.len()).filter(has_law) {
            if let Some(strength) = self.strength_under(constraints, law, name) {
                all.get_or_insert_default().merge(strength.clone());
            }
        }
        all
    }
}

/// The table `growth`: a row for each mode that is ever unstable under a set of constraints and a law.
pub(super) fn growth(results: &Results) -> Result<Table, Error> {
    let labels = &results.plan().labels;
    let mut rows = Vec::new();
    for (constraints, set) in labels.constraints.iter().enumerate() {
        for (law, label) in labels.laws.iter().enumerate() {
            for (name, _) in results.modes_of_set(constraints) {
                let Some(found) = results.strength_under(constraints, law, name) else { continue };
                let mut row =
                    vec![set.clone(), label.name.clone(), name.to_string(), results.mode_label(constraints, name)];
                row.push(found.growth.count().to_string());
                for sketch in [&found.frequency_hz, &found.growth, &found.damping_ratio] {
                    row.extend(ends_and_median(sketch)?);
                }
                rows.push(row);
            }
        }
    }
    let header = [
        "constraints",
        "law",
        "mode",
        "label",
        "unstable",
        "lowest_hz",
        "median_hz",
        "highest_hz",
        "least_growth_rate",
        "median_growth_rate",
        "largest_growth_rate",
        "worst_damping_ratio",
        "median_damping_ratio",
        "best_damping_ratio",
    ];
    Ok(Table::new("growth", header, rows))
}

/// Smallest value, median and largest value.
fn ends_and_median(sketch: &QuantileSketch) -> Result<[String; 3], Error> {
    let median = sketch.median()?;
    let range = sketch.range().map_or([median; 2], |range| [range.lower, range.upper]);
    // The median is that of a bucket, which may reach beyond the ends.
    Ok([range[0], median.clamp(range[0], range[1]), range[1]].map(|number| number.to_string()))
}
