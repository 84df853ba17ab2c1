//! Words for what happens at an onset.

use cea::Threshold;

use super::{ChangeOf, SweepOnset};

/// Words for what a mode does at an onset.
pub fn event(starts: bool, threshold: &Threshold) -> &'static str {
    match (starts, threshold.is_axis()) {
        (true, true) => "starts to grow",
        (false, true) => "stops growing",
        (true, false) => "becomes unstable",
        (false, false) => "becomes stable",
    }
}

impl SweepOnset {
    /// Words for what happens where the parameter grows, as tables have them.
    pub fn direction(&self) -> &'static str {
        match (self.of, self.starts) {
            (ChangeOf::Exchange, true) => "flutter-to-divergence",
            (ChangeOf::Exchange, false) => "divergence-to-flutter",
            (ChangeOf::Band, true) => "enters-band",
            (ChangeOf::Band, false) => "leaves-band",
            (_, true) => "starts",
            (_, false) => "stops",
        }
    }

    /// Words for what happens at the onset.
    pub fn event(&self, threshold: &Threshold) -> &'static str {
        match (self.of, self.starts, threshold.is_axis()) {
            (ChangeOf::Exchange, true, _) => "flutter becomes divergence",
            (ChangeOf::Exchange, false, _) => "divergence becomes flutter",
            (ChangeOf::Band, true, true) => "enters the band, growing",
            (ChangeOf::Band, false, true) => "leaves the band, still growing",
            (ChangeOf::Band, true, false) => "enters the band, unstable",
            (ChangeOf::Band, false, false) => "leaves the band, still unstable",
            (ChangeOf::Divergence, true, true) => "starts to diverge",
            (ChangeOf::Divergence, false, true) => "stops diverging",
            _ => event(self.starts, threshold),
        }
    }
}
