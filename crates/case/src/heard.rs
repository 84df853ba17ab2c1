//! The table `[measured]` of a case file of any kind: frequencies at which the brake was heard to squeal.

use serde::Deserialize;
use study::{Measured, MeasuredFrequency};

use super::CaseError;
use super::check::Check;

/// Share of the draws, of a case that says none: a mode that is unstable in a larger one, in the arrangement where it is largest, counts as squeal. Chosen, as if draws were the stops
/// of a test, of which one in twenty is noticed.
const SHARE: f64 = 0.05;

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeasuredTable {
    frequencies: Vec<f64>,
    tolerance: ToleranceEntry,
    share: Option<f64>,
}

/// Tolerance of all frequencies, or of each.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged, expecting = "expected a number, or a list with one for each frequency")]
enum ToleranceEntry {
    OfAll(f64),
    OfEach(Vec<f64>),
}

impl Check<'_> {
    /// The measured squeal of a case; `None` for a case without measured squeal.
    pub fn measured(&self, table: Option<MeasuredTable>) -> Result<Option<Measured>, CaseError> {
        let Some(MeasuredTable { frequencies, tolerance, share }) = table else { return Ok(None) };
        if frequencies.is_empty() {
            return Err(self.value("measured.frequencies", "[]", "one frequency or more"));
        }
        let positive = |field: &str, value: f64| match value.is_finite() && value > 0.0 {
            true => Ok(value),
            false => Err(self.value(field, value, "a number of Hz, > 0")),
        };
        let tolerances = match tolerance {
            ToleranceEntry::OfAll(tolerance) => vec![tolerance; frequencies.len()],
            ToleranceEntry::OfEach(tolerances) if tolerances.len() == frequencies.len() => tolerances,
            ToleranceEntry::OfEach(tolerances) => {
                let (found, allowed) = (tolerances.len(), frequencies.len());
                return Err(self.value(
                    "measured.tolerance",
                    format!("a list of {found}"),
                    &format!("a number, or a list of {allowed}, one for each frequency"),
                ));
            }
        };
        let one = |(hz, tolerance_hz)| {
            let hz = positive("measured.frequencies", hz)?;
            let tolerance_hz = positive("measured.tolerance", tolerance_hz)?;
            if tolerance_hz >= hz {
                return Err(self.value("measured.tolerance", tolerance_hz, &format!("below its frequency, {hz} Hz")));
            }
            Ok(MeasuredFrequency { hz, tolerance_hz })
        };
        let mut frequencies =
            frequencies.into_iter().zip(tolerances).map(one).collect::<Result<Vec<_>, CaseError>>()?;
        frequencies.sort_by(|a, b| a.hz.total_cmp(&b.hz));
        self.no_repeats("measured.frequencies", frequencies.iter().map(|frequency| frequency.hz.to_string()))?;
        let share = share.unwrap_or(SHARE);
        if !(0.0..1.0).contains(&share) {
            return Err(self.value("measured.share", share, "0 or more, below 1"));
        }
        Ok(Some(Measured { frequencies, share }))
    }
}
