//! What an estimate costs: the systems solved for it.

use std::ops::Add;

/// Systems solved for the occurrences of a scene by a control variate, each once. What the study solves beforehand to follow
/// modes at all is not among them: plain sampling needs it as well.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub struct Evaluations {
    /// Sample points of the surrogate.
    pub sample_points: u64,
    /// Uncertain samples that only say how many others are needed.
    pub pilots: u64,
    /// Samples whose prediction is clear.
    pub clear: u64,
    /// Samples whose prediction is uncertain.
    pub uncertain: u64,
}

impl Evaluations {
    /// All of them.
    pub fn total(&self) -> u64 {
        self.sample_points + self.pilots + self.clear + self.uncertain
    }
}

impl Add for Evaluations {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            sample_points: self.sample_points + other.sample_points,
            pilots: self.pilots + other.pilots,
            clear: self.clear + other.clear,
            uncertain: self.uncertain + other.uncertain,
        }
    }
}
