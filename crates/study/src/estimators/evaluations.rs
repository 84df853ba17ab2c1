//! The cost of an estimate: the number of systems solved.

use std::ops::Add;

/// Numbers of systems solved for the occurrences of a scene by a control variate. They do not include the references of the
/// study, which plain sampling needs too.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub struct Evaluations {
    /// Sample points of the surrogate.
    pub sample_points: u64,
    /// Uncertain samples that only determine how many others are needed.
    pub pilots: u64,
    /// Samples whose prediction is clear.
    pub clear: u64,
    /// Samples whose prediction is uncertain.
    pub uncertain: u64,
}

impl Evaluations {
    /// The sum of all.
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
