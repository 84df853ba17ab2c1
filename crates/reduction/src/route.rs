//! How the modes at a point were found, and how many were found how.

use std::iter::Sum;
use std::ops::{Add, Sub};

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

    fn with(self, other: Self, of: fn(u64, u64) -> u64) -> Self {
        Self {
            discs: of(self.discs, other.discs),
            guesses: of(self.guesses, other.guesses),
            followed: of(self.followed, other.followed),
            spectra: of(self.spectra, other.spectra),
        }
    }
}

impl Add for RouteCounts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.with(other, u64::add)
    }
}

impl Sub for RouteCounts {
    type Output = Self;

    /// What was counted since `other` was.
    fn sub(self, other: Self) -> Self {
        self.with(other, u64::sub)
    }
}

impl Sum for RouteCounts {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), Self::add)
    }
}
