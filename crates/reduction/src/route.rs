//! How the modes at a point were found, and how many were found how.

use std::iter::Sum;
use std::ops::Add;

use crate::Doubt;

/// Route by which the modes at a point were found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Route {
    /// From coarse modes.
    Coarse,
    /// From the whole spectrum of the reduced system, because of a doubt or because there is no coarse basis.
    Spectrum(Option<Doubt>),
}

/// Points whose modes were found by each [`Route`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RouteCounts {
    /// From coarse modes.
    pub coarse: u64,
    /// By whole spectra.
    pub spectra: u64,
}

impl RouteCounts {
    /// One more point.
    pub fn record(&mut self, route: Route) {
        match route {
            Route::Coarse => self.coarse += 1,
            Route::Spectrum(_) => self.spectra += 1,
        }
    }
}

impl Add for RouteCounts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { coarse: self.coarse + other.coarse, spectra: self.spectra + other.spectra }
    }
}

impl Sum for RouteCounts {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), Self::add)
    }
}
