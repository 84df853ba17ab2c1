//! The sample points of a subdivision: a position on a path, and what is known of the modes there.
//!
//! What is known is a spectrum, or what the *owner* of the path says ([`OwnedPath`](crate::OwnedPath): whoever knows the eigenvalues next to a number without a
//! spectrum, such as a reduced brake).

use std::collections::{BTreeMap, BTreeSet};

use cea::{Mode, by_frequency};
use linsys::SecondOrder;
use num_complex::Complex;

use crate::path::{Path, PathStart};

/// Number of candidates of a followed mode in a step, the eigenvalues nearest to its own; chosen: with fewer, the mode itself may not be among them; with more,
/// more shapes are computed.
const CANDIDATES_OF_STEP: usize = 3;
/// Largest move of a followed mode, as a fraction of its distance to its third nearest candidate, beyond which an owner is asked anew; chosen: with less, owners
/// are asked more often; with more, the mode may have become one that is no candidate.
const MOVED: f64 = 0.1;

/// A position on the path, 0 to 1, and the modes there.
pub(crate) struct SamplePoint {
    pub at: f64,
    pub known: Known,
}

/// Knowledge of the modes at a sample point.
pub(crate) enum Known {
    Spectrum(Box<Solved>),
    /// Answer of the owner of the path: the modes near those that are followed; `None` where it has not been asked yet.
    ByOwner(Option<Candidates>),
}

/// The modes nearest to the eigenvalues `asked_at`, ascending in frequency.
pub(crate) struct Candidates {
    asked_at: Vec<Complex<f64>>,
    modes: Vec<Mode>,
}

/// A solved system.
pub(crate) struct Solved {
    pub system: SecondOrder,
    /// Eigenvalues with Im > 0, ascending in frequency.
    pub lambdas: Vec<Complex<f64>>,
    /// The modes whose shapes have been computed, by index in `lambdas`: `find_shapes` of a subdivision computes all that are candidates before they are asked
    /// for.
    pub modes: BTreeMap<usize, Mode>,
}

impl Known {
    /// The modes that the `followed` ones may have become, ascending in frequency.
    pub fn modes_near(&self, followed: &[Mode]) -> Vec<Mode> {
        match self {
            Self::Spectrum(solved) => solved.modes_near(followed),
            Self::ByOwner(known) => known.iter().flat_map(|known| &known.modes).cloned().collect(),
        }
    }
}

impl Candidates {
    /// Modes at a position on the path that the `followed` ones may have become, as its owner finds them; `None` where it cannot tell.
    pub fn at(place: f64, path: &Path<'_>, followed: &[Mode]) -> Option<Self> {
        let PathStart::Owned(mass, owner) = path.start else { return None };
        let asked_at: Vec<Complex<f64>> = followed.iter().map(|mode| mode.lambda).collect();
        let found = owner.nearest(place, &asked_at, CANDIDATES_OF_STEP)?.into_iter();
        let mut modes: Vec<Mode> = found.map(|(lambda, shape)| Mode::normalised(mass, lambda, shape)).collect();
        modes.sort_by(|a, b| by_frequency(&a.lambda, &b.lambda));
        Some(Self { asked_at, modes })
    }

    /// True while every followed mode is still next to an eigenvalue that was asked for, so that these candidates serve it too.
    pub fn are_of(&self, followed: &[Mode]) -> bool {
        let distances = |from: Complex<f64>, to: &[Complex<f64>]| -> Vec<f64> {
            let mut distances: Vec<f64> = to.iter().map(|to| (to - from).norm()).collect();
            distances.sort_by(f64::total_cmp);
            distances
        };
        let lambdas: Vec<Complex<f64>> = self.modes.iter().map(|mode| mode.lambda).collect();
        followed.iter().all(|mode| {
            let moved = distances(mode.lambda, &self.asked_at).first().copied().unwrap_or(f64::INFINITY);
            let reach = distances(mode.lambda, &lambdas).get(CANDIDATES_OF_STEP - 1).copied().unwrap_or(0.0);
            moved <= MOVED * reach
        })
    }
}

impl Solved {
    /// Indices in `lambdas` of the modes that a followed one may have become, ascending, and so ascending in frequency.
    pub fn candidates(&self, followed: &[Mode]) -> BTreeSet<usize> {
        let mut candidates = BTreeSet::new();
        for mode in followed {
            let distance = |&i: &usize| (self.lambdas[i] - mode.lambda).norm_sqr();
            let mut order: Vec<usize> = (0..self.lambdas.len()).collect();
            order.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
            // Where more than half of the modes are followed, nearly all shapes at the sample point are needed.
            let count = if 2 * followed.len() < order.len() { CANDIDATES_OF_STEP } else { order.len() };
            candidates.extend(order.into_iter().take(count));
        }
        candidates
    }

    fn modes_near(&self, followed: &[Mode]) -> Vec<Mode> {
        self.candidates(followed).iter().filter_map(|i| self.modes.get(i).cloned()).collect()
    }
}
