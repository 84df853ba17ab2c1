//! What a reduction is asked for.

use super::Vectors;
use crate::ReductionError;

/// Goal of a reduction, and the limits of its cost.
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
    /// Vectors of the full modes that enter the basis.
    pub vectors: Vectors,
    /// Distance from the rectangle in which modes shape a basis too, because others may enter it from there, as a part of the largest |lambda| in the
    /// rectangle.
    pub margin: f64,
    /// Directions that add less than this to a residual are left out of it; what they may add is counted to the residual.
    pub residual_floor: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            tolerance: 1e-8,
            full_tolerance: 1e-11,
            most_columns: 300,
            most_enrichments: 20,
            probes: 2,
            vectors: Vectors::Right,
            margin: 0.02,
            residual_floor: 1e-10,
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
