//! Sets of changes that were screened, with what was predicted and confirmed of them.

use super::candidates::ChangeKind;
use super::confirm::Confirmed;
use super::criterion::Criterion;
use super::growing::GrowingMode;
use super::modified::ChangeSet;
use super::predict::Prediction;
use montecarlo::Estimate;

/// Changes of a brake together, with their predicted and their confirmed effect.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct ScreenedSet {
    /// Kind of the changes; `None` of the brake as it is, and of its other sets of constraints.
    pub kind: Option<ChangeKind>,
    /// Names of the places, or the name of a set of constraints.
    pub places: String,
    /// Number of single changes; for a set of constraints, by how many more degrees of freedom it holds than the brake as it is, 0 where it holds fewer.
    pub count: usize,
    /// Sizes with their units, one size where all are equal, else a size for each place in their order. A unit is empty where the brake does not say which it
    /// is.
    pub sizes: Vec<(f64, &'static str)>,
    /// Prediction for the brake with the changes; `None` of the case's other sets of constraints.
    pub prediction: Option<Prediction>,
    /// Changes of the set.
    pub changes: ChangeSet,
    /// Index of the set among the sets that are confirmed.
    pub confirmation: Option<usize>,
    /// Results of the study of all scenes.
    pub confirmed: Option<Confirmed>,
}

/// Results of a screening.
#[derive(serde::Serialize)]
pub struct Screen {
    /// Criterion of the ranking.
    pub criterion: Criterion,
    /// Sets: the brake as it is, its other sets of constraints, its variants, those with the largest effect first, then kind by kind: the largest sets first,
    /// then single changes, the best first.
    pub sets: Vec<ScreenedSet>,
    /// Differences `[i][j]`: mean number of unstable modes per analysis of confirmed set i minus the number of set j, on the same draws, with 95 % limits.
    pub differences: Vec<Vec<Option<Estimate>>>,
    /// Prediction for the brake without changes.
    pub unchanged: Prediction,
    /// Sets that could not be analysed, with the reason.
    pub failed: Vec<(String, String)>,
    /// Number of sets of changes that were predicted.
    pub predicted_sets: u64,
    /// Number of combinations of changes that these sets are; some make the same set.
    pub combinations: u64,
    /// Number of spectra for each of these sets.
    pub analyses_per_set: u64,
    /// Number of draws of the prediction.
    pub prediction_draws: u64,
    /// Number of draws of the confirmation.
    pub samples: u64,
    /// Number of scenes of the confirmation, all sets together.
    pub scenes: u64,
    /// Number of evaluations of the confirmation that failed.
    pub failures: u64,
    /// Modes that are unstable at the medians without changes.
    pub growing: Vec<GrowingMode>,
    /// Sentences that speak against the results: the doubts of the brake and of its variants, and why divergence may be missing, as for a reduced brake.
    pub doubts: Vec<String>,
}

impl ScreenedSet {
    /// Predicted drop by a criterion: the value of the unchanged brake minus the value of this set.
    pub fn predicted_drop(&self, unchanged: &Prediction, criterion: Criterion) -> Option<f64> {
        Some(criterion.predicted(unchanged) - criterion.predicted(&self.prediction?))
    }

    /// Words for the changes, for people.
    pub fn name(&self) -> String {
        let with_unit = |number: String, unit: &str| if unit.is_empty() { number } else { format!("{number} {unit}") };
        let units = self.units();
        let sizes = match (self.kind, self.sizes.as_slice()) {
            // A factor stands in the name of the place.
            (Some(ChangeKind::Scale), _) => String::new(),
            (Some(_), [(size, unit)]) => with_unit(format!(", {size:.3e}"), unit),
            (Some(_), [_, ..]) if units.len() == 1 => {
                let sizes = self.sizes.iter().map(|(size, _)| *size);
                let (least, most) = sizes.fold((f64::INFINITY, 0.0), |(a, b), s| (s.min(a), s.max(b)));
                with_unit(format!(", {least:.3e} to {most:.3e}"), units[0])
            }
            (Some(_), [_, ..]) => {
                let sizes = self.sizes.iter().map(|(size, unit)| with_unit(format!("{size:.3e}"), unit));
                format!(", {}", sizes.collect::<Vec<_>>().join(" and "))
            }
            _ => String::new(),
        };
        format!("{}{sizes}", self.places)
    }

    /// True if it is a variant of the brake.
    pub fn is_variant(&self) -> bool {
        self.kind == Some(ChangeKind::Variant)
    }

    /// Units of its sizes, each once.
    fn units(&self) -> Vec<&'static str> {
        let mut units: Vec<&'static str> = Vec::new();
        for (_, unit) in &self.sizes {
            if !units.contains(unit) {
                units.push(unit);
            }
        }
        units
    }

    /// Unit of its sizes, or of each of them where they differ, for tables.
    pub(super) fn unit(&self) -> String {
        match self.units().as_slice() {
            &[unit] => unit.to_owned(),
            _ => self.sizes.iter().map(|(_, unit)| *unit).collect::<Vec<_>>().join(" "),
        }
    }

    /// True if it has a size whose unit the brake does not say.
    pub(super) fn lacks_unit(&self) -> bool {
        self.sizes.iter().any(|(_, unit)| unit.is_empty())
    }
}

impl Screen {
    /// Results on the brake without changes, where they are confirmed.
    pub fn as_it_is(&self) -> Option<&Confirmed> {
        self.sets.first()?.confirmed.as_ref()
    }

    /// Difference of two confirmed sets: how many more unstable modes `more` has than `less`.
    pub fn difference(&self, more: &ScreenedSet, less: &ScreenedSet) -> Option<Estimate> {
        self.differences.get(more.confirmation?)?.get(less.confirmation?).copied().flatten()
    }
}
