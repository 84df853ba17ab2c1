//! The table `[squeal]` of a case file of any kind: the threshold beyond which a growing mode counts.

use cea::Threshold;
use serde::Deserialize;

use super::CaseError;
use super::check::Check;

#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SquealTable {
    growth_above: Option<f64>,
    damping_ratio_below: Option<f64>,
}

impl Check<'_> {
    /// The threshold that a case asks for; the imaginary axis where it asks for no threshold.
    pub fn threshold(&self, table: Option<SquealTable>) -> Result<Threshold, CaseError> {
        let Some(SquealTable { growth_above, damping_ratio_below }) = table else { return Ok(Threshold::AXIS) };
        let (growth, ratio) = (growth_above.unwrap_or(0.0), damping_ratio_below.unwrap_or(0.0));
        if Threshold::new(growth, 0.0).is_none() {
            return Err(self.value("squeal.growth_above", growth, "a rate in 1/s, >= 0"));
        }
        let allowed = "a number > -1 and <= 0: a threshold lies on the unstable side";
        Threshold::new(growth, ratio).ok_or_else(|| self.value("squeal.damping_ratio_below", ratio, allowed))
    }
}
