//! Results of a screening, for people and for machines.

use output::Table;
use serde_json::{Value, json};

use super::candidates::ChangeKind;
use super::confirm::Confirmed;
use super::growing::GrowingMode;
use super::modified::ChangeSet;
use super::predict::Prediction;
use crate::results::Estimate;

/// Most sets of each kind that are printed without being confirmed; more are in the table. Chosen.
const MOST_PRINTED: usize = 5;

/// Changes of a brake together, with their predicted and their confirmed effect.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct ScreenedSet {
    /// Kind of the changes; `None` of the brake as it is, and of its other sets of constraints.
    pub kind: Option<ChangeKind>,
    /// Names of the places, or the name of a set of constraints.
    pub places: String,
    /// Number of single changes; of a set of constraints the number of degrees of freedom that it holds beyond those of the brake as it is, 0 where it holds fewer.
    pub count: usize,
    /// Sizes with their units; consecutive equal ones are given once, so not one for each place. A unit is empty where the brake does not say which it is.
    pub sizes: Vec<(f64, &'static str)>,
    /// Predicted mean number of unstable modes per analysis and sum of their growth rates, 1/s; `None` of the case's other sets of constraints.
    pub prediction: Option<Prediction>,
    /// Changes of the set.
    pub changes: ChangeSet,
    /// Index of the set among those that are confirmed.
    pub confirmation: Option<usize>,
    /// Results of the study of all scenes.
    pub confirmed: Option<Confirmed>,
}

/// Results of a screening.
#[derive(serde::Serialize)]
pub struct Screen {
    /// Sets: the brake as it is, its other sets of constraints, then kind by kind: the largest sets first, then single changes, the best
    /// first.
    pub sets: Vec<ScreenedSet>,
    /// Differences `[i][j]`: mean number of unstable modes per analysis of confirmed set i minus that of set j, on the same draws, with 95 % limits.
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
    /// Reason why divergence may be missing in the results, as it is of a reduced brake.
    pub divergence_doubt: Option<String>,
}

impl ScreenedSet {
    /// Predicted drop: mean number of unstable modes per analysis of the unchanged brake minus that of this set.
    pub fn predicted_drop(&self, unchanged: &Prediction) -> Option<f64> {
        Some(unchanged.unstable - self.prediction?.unstable)
    }

    /// Words for the changes, for people.
    pub fn name(&self) -> String {
        let with_unit = |number: String, unit: &str| if unit.is_empty() { number } else { format!("{number} {unit}") };
        let units = self.units();
        let sizes = match (self.kind, self.sizes.as_slice()) {
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
    fn unit(&self) -> String {
        match self.units().as_slice() {
            &[unit] => unit.to_owned(),
            _ => self.sizes.iter().map(|(_, unit)| *unit).collect::<Vec<_>>().join(" "),
        }
    }

    /// True if it has a size whose unit the brake does not say.
    fn lacks_unit(&self) -> bool {
        self.sizes.iter().any(|(_, unit)| unit.is_empty())
    }
}

impl Screen {
    /// Results on the brake without changes, where they are confirmed.
    pub fn as_it_is(&self) -> Option<&Confirmed> {
        self.sets.first()?.confirmed.as_ref()
    }

    /// Tables of a screening: `screen`, all sets of changes, and `screen_differences`, by how much each confirmed one differs from
    /// each other.
    pub fn tables(&self) -> Vec<Table> {
        let header = [
            "kind",
            "places",
            "count",
            "size",
            "unit",
            "predicted_unstable_modes",
            "predicted_drop",
            "predicted_growth",
            "unstable_modes",
            "unstable_modes_lower",
            "unstable_modes_upper",
            "drop",
            "drop_lower",
            "drop_upper",
            "squealing",
            "squealing_lower",
            "squealing_upper",
            "squealing_drop",
            "squealing_drop_lower",
            "squealing_drop_upper",
            "undecided",
            "divergent",
            "samples",
            "predicted_analyses",
        ];
        let screen = Table::new("screen", header, self.sets.iter().map(|set| self.row(set)));
        let confirmed: Vec<&ScreenedSet> = self.sets.iter().filter(|set| set.confirmation.is_some()).collect();
        let mut rows = Vec::new();
        for more in &confirmed {
            for less in &confirmed {
                if let Some(Estimate { value, lower, upper }) =
                    self.difference(more, less).filter(|_| more.confirmation != less.confirmation)
                {
                    let numbers = [value, lower, upper].map(|x| x.to_string());
                    rows.push(
                        [more.changes.name.clone(), less.changes.name.clone()].into_iter().chain(numbers).collect(),
                    );
                }
            }
        }
        let header = ["changes", "other_changes", "difference", "lower", "upper"];
        vec![screen, Table::new("screen_differences", header, rows)]
    }

    /// Difference of two confirmed sets: how many more unstable modes `more` has than `less`.
    pub fn difference(&self, more: &ScreenedSet, less: &ScreenedSet) -> Option<Estimate> {
        self.differences.get(more.confirmation?)?.get(less.confirmation?).copied().flatten()
    }

    fn row(&self, set: &ScreenedSet) -> Vec<String> {
        let text = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
        let sizes: Vec<String> = set.sizes.iter().map(|(size, _)| size.to_string()).collect();
        let mut row = vec![
            set.kind.map_or("set of constraints", ChangeKind::name).to_owned(),
            set.places.clone(),
            set.count.to_string(),
            sizes.join(" "),
            set.unit(),
            text(set.prediction.map(|prediction| prediction.unstable)),
            text(set.predicted_drop(&self.unchanged)),
            text(set.prediction.map(|prediction| prediction.growth)),
        ];
        let confirmed = set.confirmed.as_ref();
        let estimates: [fn(&Confirmed) -> Estimate; 4] =
            [|c| c.unstable, |c| c.drop, |c| c.squealing, |c| c.squealing_drop];
        for of in estimates {
            let estimate = confirmed.map(of);
            row.extend([estimate.map(|e| e.value), estimate.map(|e| e.lower), estimate.map(|e| e.upper)].map(text));
        }
        let counts: [fn(&Confirmed) -> u64; 3] = [|c| c.undecided, |c| c.divergent, |c| c.samples];
        row.extend(counts.map(|of| confirmed.map_or_else(String::new, |c| of(c).to_string())));
        row.push(if set.prediction.is_some() { self.analyses_per_set.to_string() } else { String::new() });
        row
    }

    /// Results as JSON, for machines.
    pub fn json(&self) -> Value {
        let sets: Vec<Value> = self
            .sets
            .iter()
            .map(|set| {
                json!({
                    "kind": set.kind,
                    "places": set.places,
                    "count": set.count,
                    "sizes": set.sizes.iter().map(|(size, _)| size).collect::<Vec<_>>(),
                    "unit": set.kind.map(|_| set.unit()),
                    "predicted": set.prediction,
                    "predicted_drop": set.predicted_drop(&self.unchanged),
                    "confirmed": set.confirmed,
                })
            })
            .collect();
        json!({ "warnings": self.divergence_doubt.iter().collect::<Vec<_>>(), "sets": sets, "failed": self.failed, "counts": self.counts() })
    }

    /// Numbers of sets, analyses, draws and scenes, as JSON.
    pub fn counts(&self) -> Value {
        json!({
            "predicted_sets": self.predicted_sets,
            "analyses_per_set": self.analyses_per_set,
            "prediction_draws": self.prediction_draws,
            "samples": self.samples,
            "scenes": self.scenes,
            "failures": self.failures,
        })
    }

    /// Results in words, for people.
    pub fn text(&self) -> String {
        let mut text = self.said_first()
            + &self.as_it_is().map_or_else(String::new, |now| {
                format!(
                    "{}: {} unstable modes in one analysis, any in {} %\n",
                    self.sets[0].places,
                    within(&now.unstable, 3, 1.0),
                    within(&now.squealing, 1, 100.0)
                )
            });
        let of_case: Vec<&ScreenedSet> = self.sets.iter().skip(1).take_while(|set| set.kind.is_none()).collect();
        if !of_case.is_empty() {
            text += &format!("\n{}", heading("the case's sets of constraints"));
            of_case.iter().for_each(|set| text += &self.line(set));
        }
        for kind in ChangeKind::ALL {
            let of_kind: Vec<&ScreenedSet> = self.sets.iter().filter(|set| set.kind == Some(kind)).collect();
            if of_kind.is_empty() {
                continue;
            }
            text += &format!("\n{}", heading(kind.action()));
            let (confirmed, predicted): (Vec<_>, Vec<_>) =
                of_kind.into_iter().partition(|set| set.confirmation.is_some());
            confirmed.iter().chain(predicted.iter().take(MOST_PRINTED)).for_each(|set| text += &self.line(set));
            if predicted.len() > MOST_PRINTED {
                text += &format!("{} more, of no larger predicted drop\n", predicted.len() - MOST_PRINTED);
            }
        }
        text += "\n";
        for set in of_case {
            text += &self.against(set);
        }
        text + &self.remarks()
    }

    /// Warnings that every number has to be read with: failures, open verdicts, divergence.
    fn said_first(&self) -> String {
        let sum =
            |of: fn(&Confirmed) -> u64| self.sets.iter().filter_map(|set| set.confirmed.as_ref()).map(of).sum::<u64>();
        let mut text = self.divergence_doubt.as_ref().map_or_else(String::new, |doubt| format!("WARNING: {doubt}\n"));
        if self.failures > 0 {
            text += &format!(
                "{} evaluations of the confirmation FAILED; they may be unstable, and widen the limits\n",
                self.failures
            );
        }
        let (undecided, divergent) = (sum(|set| set.undecided), sum(|set| set.divergent));
        if undecided > 0 {
            text += &format!("{undecided} verdicts are UNDECIDED and count as stable\n");
        }
        if divergent > 0 {
            let of_unchanged = self.as_it_is().map_or(0, |now| now.divergent);
            text += &format!(
                "divergence: {divergent} real eigenvalues grow, {of_unchanged} of them without changes; each counts as an unstable mode\n"
            );
        }
        text
    }

    /// A line for each set of constraints found that holds as many degrees of freedom more as `set` of the case: which of the two leaves fewer unstable modes.
    fn against(&self, set: &ScreenedSet) -> String {
        let is_alike = |other: &&ScreenedSet| other.kind == Some(ChangeKind::Constraint) && other.count == set.count;
        let line = |other: &ScreenedSet| {
            let Estimate { value, lower, upper } = self.difference(set, other)?;
            let (than, size) = match value < 0.0 {
                true => ("more", Estimate { value: -value, lower: -upper, upper: -lower }),
                false => ("fewer", Estimate { value, lower, upper }),
            };
            let (size, places) = (within(&size, 3, 1.0), &set.places);
            Some(format!(
                "holding {} leaves {size} unstable modes {than} than \"{places}\", which holds as many\n",
                other.places
            ))
        };
        self.sets.iter().filter(is_alike).filter_map(line).collect()
    }

    /// Remarks on the basis of the numbers: sets that failed, and how many analyses were made.
    fn remarks(&self) -> String {
        let mut text = String::new();
        for (set, error) in &self.failed {
            text += &format!("{set}: not analysed: {error}\n");
        }
        if self.predicted_sets == 0 {
            text += "no change of the kinds that are asked for has a place in this brake; the sets of constraints of the case alone are compared\n";
        }
        if self.sets.iter().any(ScreenedSet::lacks_unit) {
            text += "sizes without a unit are in those of the case's matrices: it does not say which degrees of freedom turn\n";
        }
        text + &self.rests_on().join("\n") + "\n"
    }

    /// Meaning of the numbers, and how many analyses they rest on.
    pub fn rests_on(&self) -> [String; 2] {
        let meaning = "drop: unstable modes fewer in one analysis, on average over all arrangements, laws and speed ranges; 95 % limits";
        let counts = format!(
            "predicted by {} spectra for each of {} sets of changes, of {} combinations; {} draws; confirmed with {} other draws in {} scenes",
            self.analyses_per_set,
            self.predicted_sets,
            self.combinations,
            self.prediction_draws,
            self.samples,
            self.scenes
        );
        [meaning.into(), counts]
    }

    fn line(&self, set: &ScreenedSet) -> String {
        let predicted = set.predicted_drop(&self.unchanged).map_or_else(|| "-".into(), |drop| format!("{drop:.3}"));
        let confirmed = set.confirmed.as_ref().map_or_else(String::new, |confirmed| {
            format!(
                "  {:>25}  {:>7.3}  {:>7.1} %",
                within(&confirmed.drop, 3, 1.0),
                confirmed.unstable.value,
                100.0 * confirmed.squealing.value
            )
        });
        format!("{:<38}{predicted:>9}{confirmed}\n", set.name())
    }
}

fn heading(what: &str) -> String {
    format!("{what:<38}{:>9}  {:>25}  {:>7}  {:>9}\n", "predicted", "drop", "left", "any")
}

/// A value times `times` with its 95 % limits, to `decimals` digits after the point.
fn within(estimate: &Estimate, decimals: usize, times: f64) -> String {
    let [value, lower, upper] =
        [estimate.value, estimate.lower, estimate.upper].map(|x| format!("{:.decimals$}", times * x));
    format!("{value} ({lower} to {upper})")
}
