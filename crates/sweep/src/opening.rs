//! Openings as a sweep lists them: where contact points open or close, and what the branches do there.

use serde::Serialize;

/// Opening: a value of the parameter at which contact points open or close, so that the systems of the brake kink or jump.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Opening {
    /// Value of the parameter.
    pub at: f64,
    /// Width of the range in which it is, in units of the parameter: what is in it is not resolved.
    pub width: f64,
    /// Points that open where the parameter grows.
    pub opens: Vec<String>,
    /// Points that close where the parameter grows.
    pub closes: Vec<String>,
    /// Number of branches that go on without a jump, and are one branch on both sides.
    pub continuous: usize,
    /// Number of branches that jump, each to one that is known to continue it.
    pub jumping: usize,
    /// The largest of these jumps.
    pub largest: Option<Jump>,
    /// Numbers of branches before and beyond that nothing joins, as a mode may be one or another beyond, or leave the band.
    pub unresolved: [usize; 2],
}

/// Jump of an eigenvalue at an opening.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Jump {
    /// Candidates for the name of the mode.
    pub mode: String,
    /// Frequency Im lambda just before and just beyond, rad/s.
    pub omega: [f64; 2],
    /// Growth rate Re lambda just before and just beyond, 1/s.
    pub growth: [f64; 2],
}

impl Jump {
    /// Length |change of lambda| of the jump, rad/s.
    #[must_use]
    pub fn size(&self) -> f64 {
        (self.omega[1] - self.omega[0]).hypot(self.growth[1] - self.growth[0])
    }
}
