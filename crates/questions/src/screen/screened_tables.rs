//! Tables and JSON of a screening, for machines.

use montecarlo::Estimate;
use output::Table;
use serde_json::{Value, json};

use super::candidates::ChangeKind;
use super::confirm::Confirmed;
use super::criterion::Criterion;
use super::screened::{Screen, ScreenedSet};

/// Columns of a screen by loudness.
const LOUDNESS_COLUMNS: [&str; 8] = [
    "predicted_loudness_quantile",
    "loudness_quantile",
    "loudness_quantile_lower",
    "loudness_quantile_upper",
    "loudness_quantile_drop",
    "loudness_quantile_drop_lower",
    "loudness_quantile_drop_upper",
    "not_followed",
];

impl Screen {
    /// Tables of a screening: `screen`, all sets of changes, and `screen_differences`, by how much each confirmed one differs from
    /// each other.
    pub fn tables(&self) -> Vec<Table> {
        let mut header = vec![
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
            "predicted_squealing",
            "predicted_growth_quantile",
            "growth_quantile",
            "growth_quantile_lower",
            "growth_quantile_upper",
            "growth_quantile_drop",
            "growth_quantile_drop_lower",
            "growth_quantile_drop_upper",
        ];
        if self.criterion == Criterion::Loudness {
            header.extend(LOUDNESS_COLUMNS);
        }
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
            text(set.predicted_drop(&self.unchanged, Criterion::Occurrence)),
            text(set.prediction.map(|prediction| prediction.growth)),
        ];
        let confirmed = set.confirmed.as_ref();
        let estimate = |of: fn(&Confirmed) -> Estimate| {
            let estimate = confirmed.map(of);
            [estimate.map(|e| e.value), estimate.map(|e| e.lower), estimate.map(|e| e.upper)].map(text)
        };
        row.extend(estimate(|c| c.unstable));
        row.extend(estimate(|c| c.drop));
        row.extend(estimate(|c| c.squealing));
        row.extend(estimate(|c| c.squealing_drop));
        let counts: [fn(&Confirmed) -> u64; 3] = [|c| c.undecided, |c| c.divergent, |c| c.samples];
        row.extend(counts.map(|of| confirmed.map_or_else(String::new, |c| of(c).to_string())));
        row.push(if set.prediction.is_some() { self.analyses_per_set.to_string() } else { String::new() });
        row.push(text(set.prediction.map(|prediction| prediction.squealing)));
        row.push(text(set.prediction.map(|prediction| prediction.growth_quantile)));
        row.extend(estimate(|c| c.growth_quantile));
        row.extend(estimate(|c| c.growth_quantile_drop));
        if self.criterion == Criterion::Loudness {
            row.push(text(set.prediction.and_then(|prediction| prediction.loudness_quantile)));
            for estimate in
                [confirmed.and_then(|c| c.loudness_quantile), confirmed.and_then(|c| c.loudness_quantile_drop)]
            {
                row.extend([estimate.map(|e| e.value), estimate.map(|e| e.lower), estimate.map(|e| e.upper)].map(text));
            }
            row.push(confirmed.and_then(|c| c.not_followed).map_or_else(String::new, |count| count.to_string()));
        }
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
                    "predicted_drop": set.predicted_drop(&self.unchanged, self.criterion),
                    "confirmed": set.confirmed,
                })
            })
            .collect();
        json!({ "criterion": self.criterion, "warnings": self.doubts, "sets": sets, "failed": self.failed, "counts": self.counts() })
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
}
