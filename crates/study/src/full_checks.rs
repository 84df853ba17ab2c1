//! Checks of draws of a reduced brake against the full model.

use serde::Serialize;

/// Counts of draws of a reduced brake in the full model: the modes in the band, whether they grow or not.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct FullChecks {
    /// Draws of a scene whose full model was solved.
    pub samples: u64,
    /// Modes of the full model.
    pub modes: u64,
    /// Modes of the full model that the reduced brake does not have.
    pub missing: u64,
    /// Modes that only the reduced brake has.
    pub invented: u64,
    /// Modes that surely grow in the full model and do not count in the reduced one, or count there and do not grow.
    pub other_verdicts: u64,
    /// Modes of the reduced brake with a residual above the one asked for.
    pub residuals_above: u64,
    /// Draws in which a mode of the full model grows next to the band, where it does not count.
    pub growing_beside: u64,
    /// Lowest and highest frequency of the modes that grow next to the band, Hz.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beside_hz: Option<[f64; 2]>,
    /// Draws in which a real eigenvalue of the full model grows: divergence, which no sample of a reduced brake shows.
    pub diverging: u64,
    /// Largest real eigenvalue that grows, 1/s.
    pub divergence: f64,
    /// Draws in which the search for real eigenvalues that grow did not come to an end.
    pub divergence_open: u64,
    /// Largest distance of an eigenvalue of the full model from that of the reduced brake, relative to its absolute value.
    pub largest_distance: f64,
    /// Number of times that the reduction was trained on because such draws did not agree.
    pub trained_on: u64,
}

impl FullChecks {
    /// True if the reduced brake has other modes or verdicts than the full model.
    pub fn has_other_modes(&self) -> bool {
        self.missing + self.invented + self.other_verdicts > 0
    }

    /// Counts of both sets of draws together.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self {
            samples: self.samples + other.samples,
            modes: self.modes + other.modes,
            missing: self.missing + other.missing,
            invented: self.invented + other.invented,
            other_verdicts: self.other_verdicts + other.other_verdicts,
            residuals_above: self.residuals_above + other.residuals_above,
            growing_beside: self.growing_beside + other.growing_beside,
            diverging: self.diverging + other.diverging,
            divergence: self.divergence.max(other.divergence),
            divergence_open: self.divergence_open + other.divergence_open,
            beside_hz: self.beside_hz.into_iter().chain(other.beside_hz).reduce(wider),
            largest_distance: self.largest_distance.max(other.largest_distance),
            trained_on: self.trained_on.max(other.trained_on),
        }
    }
}

/// The least range that holds both ranges.
pub fn wider([low, high]: [f64; 2], [other_low, other_high]: [f64; 2]) -> [f64; 2] {
    [low.min(other_low), high.max(other_high)]
}
