//! How the modes at a point were found, and how many were found how.

use std::ops::AddAssign;

use crate::Doubt;

/// How the modes at a point were found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Route {
    /// By discs around the modes of a known friction.
    Discs {
        /// Corrections, summed over modes.
        corrections: u64,
    },
    /// By guesses from the modes of a known friction, corrected and counted.
    Guesses {
        /// Corrections, summed over modes.
        corrections: u64,
    },
    /// From an anchor.
    Followed {
        /// Corrections, summed over modes.
        corrections: u64,
    },
    /// From the whole spectrum of the reduced system, because of a doubt or because it was asked for.
    Spectrum(Option<Doubt>),
}

/// Points whose modes were found by each [`Route`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RouteCounts {
    /// By discs.
    pub discs: u64,
    /// By guesses.
    pub guesses: u64,
    /// By following.
    pub followed: u64,
    /// By whole spectra.
    pub spectra: u64,
}

impl RouteCounts {
    /// One more point.
    pub fn record(&mut self, route: Route) {
        let of_route = match route {
            Route::Discs { .. } => &mut self.discs,
            Route::Guesses { .. } => &mut self.guesses,
            Route::Followed { .. } => &mut self.followed,
            Route::Spectrum(_) => &mut self.spectra,
        };
        *of_route += 1;
    }
}

impl AddAssign for RouteCounts {
    fn add_assign(&mut self, other: Self) {
        let Self { discs, guesses, followed, spectra } = other;
        self.discs += discs;
        self.guesses += guesses;
        self.followed += followed;
        self.spectra += spectra;
    }
}
