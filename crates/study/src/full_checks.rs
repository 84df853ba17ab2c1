//! Checks of draws of a reduced brake against the full model.

use std::collections::BTreeMap;

use montecarlo::Proportion;
use serde::{Serialize, Serializer};

/// Counts of draws of a reduced brake in the full model, the brake that is not reduced: the modes in the band, whether they grow or not.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct FullChecks {
    /// Draws of a scene whose full model was solved.
    pub samples: u64,
    /// Draws among them that have no operating point, as samples that fail: nothing of them is counted, and whether they diverge is open.
    pub failed: u64,
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
    /// Divergence of the full model by the index of the scene, which no sample of a reduced brake shows.
    #[serde(serialize_with = "of_all_scenes")]
    pub divergence: BTreeMap<usize, DivergenceCounts>,
    /// Largest distance of an eigenvalue of the full model from the eigenvalue of the reduced brake, relative to its absolute value.
    pub largest_distance: f64,
    /// Number of times that the reduction was trained further because such draws did not agree. The counts are of the last draws, which it was not trained on.
    pub trained_on: u64,
}

/// Counts of draws in which something grows faster than it oscillates: divergence.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct DivergenceCounts {
    /// Draws that were looked at.
    pub draws: u64,
    /// Draws that diverge.
    pub diverging: u64,
    /// Draws among the diverging ones in which something in the full model grows faster than the eigenvalues that were searched for one by one; how fast is
    /// not known.
    pub beyond: u64,
    /// Draws of which it could not be told.
    pub open: u64,
    /// Largest growth rate of what was found to diverge in the full model, 1/s; 0 where nothing was.
    pub fastest: f64,
}

impl DivergenceCounts {
    /// How fast it is that diverges, in words: the largest growth rate that is known, and in how many draws something diverges faster.
    #[must_use]
    pub fn growth_in_words(&self) -> String {
        let known = (self.fastest > 0.0).then(|| format!("by up to {:.1e} 1/s", self.fastest));
        let faster = if known.is_some() { "something faster" } else { "something fast" };
        let beyond = (self.beyond > 0).then(|| format!("in {} of them {faster}, how fast is not known", self.beyond));
        known.into_iter().chain(beyond).collect::<Vec<_>>().join(", ")
    }

    /// Proportion of the draws that diverge; a draw of which this could not be told may diverge.
    #[must_use]
    pub fn proportion(&self) -> Proportion {
        Proportion::of_counts(self.diverging, self.open, self.draws)
    }

    /// Counts of both sets of draws together.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self {
            draws: self.draws + other.draws,
            diverging: self.diverging + other.diverging,
            beyond: self.beyond + other.beyond,
            open: self.open + other.open,
            fastest: self.fastest.max(other.fastest),
        }
    }
}

impl FullChecks {
    /// Divergence in all scenes together for whose index `is_of` is true. Each draw is of a scene chosen at random, all equally probable, so that the
    /// proportion of the draws that diverge is the proportion of the analyses of these scenes.
    pub fn divergence_where(&self, is_of: impl Fn(usize) -> bool) -> DivergenceCounts {
        let of_scenes = self.divergence.iter().filter(|(scene, _)| is_of(**scene)).map(|(_, counts)| *counts);
        of_scenes.fold(DivergenceCounts::default(), DivergenceCounts::with)
    }

    /// True if the reduced brake has other modes or verdicts than the full model.
    pub fn has_other_modes(&self) -> bool {
        self.missing + self.invented + self.other_verdicts > 0
    }

    /// Counts of both sets of draws together.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        let mut divergence = self.divergence;
        for (scene, counts) in other.divergence {
            let of_scene = divergence.entry(scene).or_default();
            *of_scene = of_scene.with(counts);
        }
        Self {
            samples: self.samples + other.samples,
            failed: self.failed + other.failed,
            modes: self.modes + other.modes,
            missing: self.missing + other.missing,
            invented: self.invented + other.invented,
            other_verdicts: self.other_verdicts + other.other_verdicts,
            residuals_above: self.residuals_above + other.residuals_above,
            growing_beside: self.growing_beside + other.growing_beside,
            divergence,
            beside_hz: self.beside_hz.into_iter().chain(other.beside_hz).reduce(wider),
            largest_distance: self.largest_distance.max(other.largest_distance),
            trained_on: self.trained_on.max(other.trained_on),
        }
    }
}

fn of_all_scenes<S: Serializer>(divergence: &BTreeMap<usize, DivergenceCounts>, to: S) -> Result<S::Ok, S::Error> {
    divergence.values().copied().fold(DivergenceCounts::default(), DivergenceCounts::with).serialize(to)
}

/// The least range that contains both ranges.
pub fn wider([low, high]: [f64; 2], [other_low, other_high]: [f64; 2]) -> [f64; 2] {
    [low.min(other_low), high.max(other_high)]
}
