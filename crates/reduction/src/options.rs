//! What a reduction is asked for.

use super::Vectors;
use crate::ReductionError;

/// What a reduction is asked for, with the limits of its cost.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// The residual that each wanted mode shall not exceed.
    pub tolerance: f64,
    /// Largest backward error of a full mode.
    pub full_tolerance: f64,
    /// Most columns of the basis.
    pub most_columns: usize,
    /// Most full problems that are solved beyond those at the given points.
    pub most_enrichments: usize,
    /// Full problems in a row, each at the training point farthest from all known ones, that must show neither a missed mode
    /// nor a residual above the tolerance before the basis is taken to be complete.
    pub probes: usize,
    /// Points from where modes are followed: more make an evaluation faster and the reduction larger.
    pub anchors: usize,
    /// What of the full modes enters the basis.
    pub vectors: Vectors,
    /// Distance from the rectangle in which modes are followed too, because others may enter it on the way, as a part of the
    /// largest |lambda| in the rectangle.
    pub margin: f64,
    /// Directions that add less than this to a residual are left out of it; what they may add is counted to the residual.
    pub residual_floor: f64,
    /// Ways to the modes at a point that may be taken.
    pub ways: Ways,
}

/// The ways to the modes at a point that may be taken before the whole spectrum of the reduced system, which is always there: in this order,
/// each for what the ones before it leave open. None of them changes which modes are found; each is there for the time that it saves, and can
/// be taken away to see what that is, or to judge it by the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ways {
    /// Discs around the modes of a known friction, where all channels have one gain ([`FrictionModes`](crate::FrictionModes)).
    pub discs: bool,
    /// Guesses from the modes of a known friction, corrected one by one and counted ([`FrictionModes`](crate::FrictionModes)).
    pub guesses: bool,
    /// Following all modes from an anchor ([`Reduced`](crate::Reduced)).
    pub following: bool,
    /// Whole spectra of several points at once, in the lanes of vector registers; off, one after another.
    pub batches: bool,
}

impl Ways {
    /// Whole spectra alone.
    pub const SPECTRA: Self = Self { discs: false, guesses: false, following: false, batches: false };
}

impl Default for Ways {
    /// All that are faster, measured in docs/performance.md.
    fn default() -> Self {
        Self { discs: true, guesses: true, following: true, batches: false }
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            tolerance: 1e-8,
            full_tolerance: 1e-11,
            most_columns: 300,
            most_enrichments: 20,
            probes: 2,
            anchors: 64,
            vectors: Vectors::Right,
            margin: 0.02,
            residual_floor: 1e-10,
            ways: Ways::default(),
        }
    }
}

impl Options {
    pub(super) fn check(&self) -> Result<(), ReductionError> {
        let checks = [
            ("the tolerance of a reduction", self.tolerance, self.tolerance > 0.0 && self.tolerance < 1.0),
            ("the margin of a reduction", self.margin, self.margin > 0.0 && self.margin < 1.0),
            ("the floor of residuals", self.residual_floor, self.residual_floor >= 0.0 && self.residual_floor < 1.0),
        ];
        for (option, value, is_valid) in checks {
            if !is_valid {
                return Err(ReductionError::Option { option, value, allowed: "above 0 and below 1" });
            }
        }
        if self.most_columns == 0 {
            return Err(ReductionError::Option { option: "the number of columns", value: 0.0, allowed: "1 or more" });
        }
        Ok(())
    }
}
