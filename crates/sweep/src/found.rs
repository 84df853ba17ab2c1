//! Results of a sweep over one parameter or two.

use super::{Evaluations, StabilityMap, Sweep, SweptParameter};

/// A sweep over one parameter or two.
#[derive(Debug, Clone, PartialEq)]
pub enum Found {
    /// Sweep over one parameter.
    Branches(Box<Sweep>),
    /// Stability map over two parameters.
    Map(Box<StabilityMap>),
}

impl Found {
    /// Numbers of spectra, vectors and eigenvalues computed.
    pub fn evaluations(&self) -> Evaluations {
        match self {
            Self::Branches(sweep) => sweep.evaluations,
            Self::Map(map) => map.evaluations,
        }
    }

    /// Number of spectra of a grid of equal steps that is as fine: as the shortest step of a branch, or as the cells of the map.
    pub fn fine_grid(&self) -> u64 {
        match self {
            Self::Branches(sweep) => sweep.fine_grid,
            Self::Map(map) => map.fine_grid,
        }
    }

    /// The swept parameters.
    pub fn parameters(&self) -> &[SweptParameter] {
        match self {
            Self::Branches(sweep) => std::slice::from_ref(&sweep.parameter),
            Self::Map(map) => &map.parameters,
        }
    }
}
