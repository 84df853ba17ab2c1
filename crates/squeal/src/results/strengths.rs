//! How strong unstable modes are: frequency, growth rate and damping ratio over the draws in which they are unstable.

use std::fmt::{self, Display, Formatter};

use montecarlo::{Interval, Merge, QuantileSketch};
use output::{Table, hertz, hertz_within};
use study::{ModeLabel, ModeNaming, Strength};

use super::Results;
use crate::Error;

/// Frequency of a mode in the draws in which it is unstable. Its text has as many digits as are known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnstableHertz {
    /// Median over these draws, Hz; the frequency at the medians of a mode that never was surely the one that was unstable.
    pub median: f64,
    /// Bound of the error of the median, Hz, from the width of its bucket.
    pub error: f64,
    /// Lowest and highest frequency, Hz, exact; `None` of a mode that never was surely the one that was unstable.
    pub range: Option<Interval>,
}

impl UnstableHertz {
    fn new(frequencies: &QuantileSketch) -> Option<Self> {
        let (range, median) = (frequencies.range()?, frequencies.median().ok()?);
        let median = median.clamp(range.lower, range.upper);
        let farthest = (median - range.lower).max(range.upper - median);
        let error = farthest.min(QuantileSketch::RELATIVE_ACCURACY * median);
        (median > 0.0).then_some(Self { median, error, range: Some(range) })
    }
}

impl Display for UnstableHertz {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&hertz_within(self.median, self.error))
    }
}

impl Results {
    /// Frequency of a mode where it is unstable; else its frequency at the medians; `None` for a mode without a frequency.
    #[must_use]
    pub fn unstable_hertz(&self, constraints: usize, name: ModeLabel) -> Option<UnstableHertz> {
        let known = self.strength(constraints, name).and_then(|strength| UnstableHertz::new(&strength.frequency_hz));
        known.or_else(|| {
            let median = self.frequency(constraints, name).filter(|hz| *hz > 0.0)?;
            Some(UnstableHertz { median, error: 0.0, range: None })
        })
    }

    /// Words for the frequency of a mode where it is unstable, with that at the medians where it is another; that at the medians alone, as such, of a
    /// mode that never was surely the one that was unstable.
    pub(super) fn hertz_in_words(&self, constraints: usize, name: ModeLabel) -> Option<String> {
        let unstable = self.unstable_hertz(constraints, name)?;
        if unstable.range.is_none() {
            return Some(format!("{unstable} Hz at the medians, where unstable not known"));
        }
        let other = self.frequency(constraints, name).filter(|hz| (hz - unstable.median).abs() > unstable.error);
        let other = other.map_or_else(String::new, |hz| format!(", at the medians {} Hz", hertz(hz)));
        Some(format!("{unstable} Hz{other}"))
    }

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
    // The median is the middle of a bucket, which may reach beyond the ends.
    Ok([range[0], median.clamp(range[0], range[1]), range[1]].map(|number| number.to_string()))
}

#[cfg(test)]
mod tests {
    use montecarlo::{QuantileSketch, quantile};

    use super::UnstableHertz;

    /// The true median is within the error, and the text has no decimal that this leaves open.
    #[test]
    fn a_frequency_has_the_digits_that_are_known() {
        for at in (0..60).map(|step| 0.02 * 1.26_f64.powi(step)) {
            for (spread, count) in [(0.0, 5), (1e-6, 1), (1e-6, 6), (1e-4, 7), (1e-3, 40), (0.1, 2), (0.1, 39)] {
                let mut hertz: Vec<f64> =
                    (1..=count).map(|i| at * (1.0 + spread * (0.618_033_988_75 * f64::from(i)).fract())).collect();
                let mut sketch = QuantileSketch::default();
                hertz.iter().for_each(|hz| sketch.record(*hz));
                hertz.sort_by(f64::total_cmp);
                let (exact, found) = (quantile(&hertz, 0.5).unwrap(), UnstableHertz::new(&sketch).unwrap());
                let error = found.error * (1.0 + 1e-9) + 1e-12 * exact;
                assert!((found.median - exact).abs() <= error, "{exact} {found:?}");
                let text = found.to_string();
                let decimals = text.split('.').nth(1).map_or(0, str::len) as i32;
                let last = 10_f64.powi(-decimals);
                assert!(decimals == 0 || 0.5 * last >= found.error * (1.0 - 1e-9), "{text} {found:?}");
                assert!((text.parse::<f64>().unwrap() - exact).abs() <= error + 0.51 * last, "{text} {exact}");
            }
        }
    }
}
