//! A screening in words, for people.

use super::candidates::ChangeKind;
use super::confirm::Confirmed;
use super::criterion::{Criterion, Form};
use super::screened::{Screen, ScreenedSet};
use montecarlo::Estimate;

/// Most sets of each kind that are printed without being confirmed; more are in the table. Chosen.
const MOST_PRINTED: usize = 5;

impl Screen {
    /// Results in words, for people.
    pub fn text(&self) -> String {
        let [before, after] = self.text_around();
        before + &self.together() + &after
    }

    /// Results in words but [`Screen::together`]: what stands before it, and after it.
    pub fn text_around(&self) -> [String; 2] {
        let mut text = self.said_first()
            + &self.as_it_is().map_or_else(String::new, |now| {
                format!(
                    "{}: {} unstable modes in one analysis, any in {} %{}\n",
                    self.sets[0].places,
                    within(&now.unstable, 3, 1.0),
                    within(&now.squealing, 1, 100.0),
                    self.growth_in_words(now)
                )
            });
        let of_case: Vec<&ScreenedSet> = self.sets.iter().skip(1).take_while(|set| set.kind.is_none()).collect();
        if !of_case.is_empty() {
            text += &format!("\n{}", self.heading("the case's sets of constraints"));
            of_case.iter().for_each(|set| text += &self.line(set));
        }
        for kind in ChangeKind::shown() {
            let of_kind: Vec<&ScreenedSet> = self.sets.iter().filter(|set| set.kind == Some(kind)).collect();
            if of_kind.is_empty() {
                continue;
            }
            text += &format!("\n{}", self.heading(kind.action()));
            let (confirmed, predicted): (Vec<_>, Vec<_>) =
                of_kind.into_iter().partition(|set| set.confirmation.is_some());
            confirmed.iter().chain(predicted.iter().take(MOST_PRINTED)).for_each(|set| text += &self.line(set));
            if predicted.len() > MOST_PRINTED {
                text += &format!("{} more, of no larger predicted drop\n", predicted.len() - MOST_PRINTED);
            }
        }
        let mut after = String::from("\n");
        for set in of_case {
            after += &self.against(set);
        }
        [text, after + &self.remarks()]
    }

    /// All that was confirmed in one list, the largest effect first, with whether it surely helps or harms; empty where that is of one kind.
    pub fn together(&self) -> String {
        let confirmed = self.sets.iter().skip(1).filter_map(|set| Some((set, set.confirmed.as_ref()?)));
        let mut ranked: Vec<(&ScreenedSet, &Confirmed)> = confirmed.collect();
        let first = ranked.first().map(|(set, _)| set.kind);
        if ranked.iter().all(|(set, _)| Some(set.kind) == first) {
            return String::new();
        }
        // Of equal effects the one of fewer changes stands first.
        ranked.sort_by(|(a, of_a), (b, of_b)| {
            let effect = |found| self.criterion.effect(found);
            effect(of_b).total_cmp(&effect(of_a)).then(a.count.cmp(&b.count))
        });
        let name =
            |set: &ScreenedSet| format!("{} {}", set.kind.map_or("set of constraints", ChangeKind::name), set.name());
        let width = self.width(name);
        let Form { times, decimals, .. } = self.criterion.form();
        let mut text = format!("\n{:<width$}  {:>25}\n", "together, the largest effect first", "drop");
        for (set, found) in ranked {
            let drop = self.criterion.drop(found);
            let says = match drop {
                Estimate { lower, .. } if lower > 0.0 => "helps",
                Estimate { upper, .. } if upper < 0.0 => "harms",
                _ => "not sure",
            };
            text += &format!("{:<width$}  {:>25}  {says}\n", name(set), drop_within(&drop, decimals, times));
        }
        text
    }

    /// The growth, or loudness, of the brake as it is, where the ranking is by it.
    fn growth_in_words(&self, now: &Confirmed) -> String {
        match self.criterion {
            Criterion::GrowthQuantile => {
                format!(
                    "\ngrowth of the fastest mode of a draw at most {} 1/s in 95 % of the draws",
                    within(&now.growth_quantile, 1, 1.0)
                )
            }
            Criterion::Loudness => {
                format!(
                    "\nloudness of the loudest motion of a draw, rms velocity of all displacements together, at most {} m/s in 95 % of the draws",
                    within(&self.criterion.left(now), 3, 1.0)
                )
            }
            Criterion::Occurrence | Criterion::Probability => String::new(),
        }
    }

    /// Warnings that every number has to be read with: failures, open verdicts, divergence.
    fn said_first(&self) -> String {
        let sum =
            |of: fn(&Confirmed) -> u64| self.sets.iter().filter_map(|set| set.confirmed.as_ref()).map(of).sum::<u64>();
        let mut text = self.doubts.iter().map(|doubt| format!("WARNING: {doubt}\n")).collect::<String>();
        if self.failures > 0 {
            text += &format!(
                "{} evaluations of the confirmation FAILED; they may be unstable, and widen the limits\n",
                self.failures
            );
        }
        let (undecided, divergent) = (sum(|set| set.undecided), sum(|set| set.divergent));
        if undecided > 0 {
            text += &format!("{undecided} verdicts are UNDECIDED: stable in the values, and either in the limits\n");
        }
        let followed = self.sets.iter().filter_map(|set| Some((set, set.confirmed.as_ref()?.not_followed?)));
        for (set, not_followed) in followed.filter(|(_, count)| *count > 0) {
            text += &format!(
                "{}: motions of {not_followed} of {} draws could NOT BE FOLLOWED; they count as louder than any, and its loudness has no limits\n",
                set.name(),
                self.samples
            );
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
        if self.predicted_sets == 0 && !self.sets.iter().any(ScreenedSet::is_variant) {
            text += "no change of the kinds that are asked for has a place in this brake; the sets of constraints of the case alone are compared\n";
        }
        let has_no_limits = |set: &ScreenedSet| {
            set.confirmed.as_ref().is_some_and(|found| self.criterion.left(found).upper.is_infinite())
        };
        if self.sets.iter().any(has_no_limits) {
            text += "limits of a quantile are not known from fewer than 72 draws, or where some failed: inf\n";
        }
        if self.sets.iter().any(ScreenedSet::lacks_unit) {
            text += "sizes without a unit are in those of the case's matrices: it does not say which degrees of freedom turn\n";
        }
        text + &self.rests_on().join("\n") + "\n"
    }

    /// Meaning of the numbers, and how many analyses they rest on.
    pub fn rests_on(&self) -> [String; 2] {
        let Form { fewer, over, .. } = self.criterion.form();
        let meaning = format!("drop: {fewer}, {over}; 95 % limits");
        let confirmed = |other| format!("confirmed with {}{other} draws in {} scenes", self.samples, self.scenes);
        let counts = match self.predicted_sets {
            0 => confirmed(""),
            sets => format!(
                "predicted by {} spectra for each of {sets} sets of changes, of {} combinations; {} draws; {}",
                self.analyses_per_set,
                self.combinations,
                self.prediction_draws,
                confirmed(" other")
            ),
        };
        [meaning, counts]
    }

    fn line(&self, set: &ScreenedSet) -> String {
        let Form { times, decimals, .. } = self.criterion.form();
        let number = |value: f64| format!("{:.decimals$}", times * value);
        let predicted = match set.predicted_drop(&self.unchanged, self.criterion) {
            None => "-".into(),
            Some(drop) if drop.is_finite() => number(drop),
            Some(_) => NOT_KNOWN.into(),
        };
        let confirmed = set.confirmed.as_ref().map_or_else(String::new, |confirmed| {
            format!(
                "  {:>25}  {:>7}  {:>7.1} %",
                drop_within(&self.criterion.drop(confirmed), decimals, times),
                number(self.criterion.left(confirmed).value),
                100.0 * confirmed.squealing.value
            )
        });
        format!("{:<width$}{predicted:>9}{confirmed}\n", set.name(), width = self.width(ScreenedSet::name))
    }

    fn heading(&self, what: &str) -> String {
        let width = self.width(ScreenedSet::name);
        format!("{what:<width$}{:>9}  {:>25}  {:>7}  {:>9}\n", "predicted", "drop", "left", "any")
    }

    /// Width of the column of names, of those that are confirmed at least.
    fn width(&self, name: impl Fn(&ScreenedSet) -> String) -> usize {
        let confirmed = self.sets.iter().filter(|set| set.confirmed.is_some());
        confirmed.map(|set| name(set).chars().count()).max().unwrap_or(0).max(38)
    }
}

/// Word for a drop where the motions of the value before or after it could not be followed.
const NOT_KNOWN: &str = "not known";

/// A drop times `times` with its 95 % limits.
fn drop_within(drop: &Estimate, decimals: usize, times: f64) -> String {
    if drop.value.is_finite() { within(drop, decimals, times) } else { NOT_KNOWN.into() }
}

/// A value times `times` with its 95 % limits, to `decimals` digits after the point.
fn within(estimate: &Estimate, decimals: usize, times: f64) -> String {
    let [value, lower, upper] =
        [estimate.value, estimate.lower, estimate.upper].map(|x| format!("{:.decimals$}", times * x));
    format!("{value} ({lower} to {upper})")
}
