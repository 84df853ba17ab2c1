//! The sample points of a subdivision: a position on a path, and what is known of the modes there.

use std::collections::{BTreeMap, BTreeSet};

use cea::{Mode, by_frequency};
use linsys::SecondOrder;
use num_complex::Complex;

use crate::path::{Path, PathStart};

/// Number of eigenvalues nearest to a followed one that are its candidates in a step; chosen: with fewer, the mode itself may not be among them; with more,
/// more shapes are computed.
const CANDIDATES_OF_STEP: usize = 3;
/// Largest move of a mode, as a fraction of the distance of the last of its candidates, before an owner is asked for others; chosen: with less, owners are
/// asked more often; with more, the mode may have become one that is no candidate.
const MOVED: f64 = 0.1;

/// A position on the path, 0 to 1, and the modes there.
pub(crate) struct SamplePoint {
    pub at: f64,
    pub known: Known,
}

/// Knowledge of the modes at a sample point.
pub(crate) enum Known {
    Spectrum(Box<Solved>),
    /// Modes near the modes that are followed, as the owner of the path knows them; `None` where it has not been asked.
    Candidates(Option<Candidates>),
}

/// The modes nearest to the eigenvalues `asked`, ascending in frequency.
pub(crate) struct Candidates {
    asked: Vec<Complex<f64>>,
    modes: Vec<Mode>,
}

/// A solved system.
pub(crate) struct Solved {
    pub system: SecondOrder,
    pub lambdas: Vec<Complex<f64>>,
    /// The modes whose shapes have been computed, by index in `lambdas`.
    pub modes: BTreeMap<usize, Mode>,
}

impl Known {
    /// The modes that the `followed` ones may have become, ascending in frequency.
    pub fn modes_near(&self, followed: &[Mode]) -> Vec<Mode> {
        match self {
            Self::Spectrum(solved) => solved.modes_near(followed),
            Self::Candidates(known) => known.iter().flat_map(|known| &known.modes).cloned().collect(),
        }
    }
}

impl Candidates {
    /// Modes at a position on the path that the `followed` ones may have become, as its owner finds them; `None` where it cannot tell.
    pub fn at(place: f64, path: &Path<'_>, followed: &[Mode]) -> Option<Self> {
        let PathStart::Owned(mass, owner) = path.start else { return None };
        let asked: Vec<Complex<f64>> = followed.iter().map(|mode| mode.lambda).collect();
        let found = owner.nearest(place, &asked, CANDIDATES_OF_STEP)?.into_iter();
        let mut modes: Vec<Mode> = found.map(|(lambda, shape)| Mode::normalised(mass, lambda, shape)).collect();
        modes.sort_by(|a, b| by_frequency(&a.lambda, &b.lambda));
        Some(Self { asked, modes })
    }

    /// True if these are the candidates of `followed` too, which have hardly moved from the eigenvalues that were asked for.
    pub fn are_of(&self, followed: &[Mode]) -> bool {
        let distances = |from: Complex<f64>, to: &[Complex<f64>]| -> Vec<f64> {
            let mut distances: Vec<f64> = to.iter().map(|to| (to - from).norm()).collect();
            distances.sort_by(f64::total_cmp);
            distances
        };
        let lambdas: Vec<Complex<f64>> = self.modes.iter().map(|mode| mode.lambda).collect();
        followed.iter().all(|mode| {
            let moved = distances(mode.lambda, &self.asked).first().copied().unwrap_or(f64::INFINITY);
            let reach = distances(mode.lambda, &lambdas).get(CANDIDATES_OF_STEP - 1).copied().unwrap_or(0.0);
            moved <= MOVED * reach
        })
    }
}

impl Solved {
    /// Indices in `lambdas` of the modes that a followed one may have become, ascending in frequency.
    pub fn wanted(&self, followed: &[Mode]) -> BTreeSet<usize> {
        let mut wanted = BTreeSet::new();
        for mode in followed {
            let distance = |&i: &usize| (self.lambdas[i] - mode.lambda).norm_sqr();
            let mut order: Vec<usize> = (0..self.lambdas.len()).collect();
            order.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
            // Where more than half of the modes are followed, nearly all shapes at the sample point are needed.
            let few = if 2 * followed.len() < order.len() { CANDIDATES_OF_STEP } else { order.len() };
            wanted.extend(order.into_iter().take(few));
        }
        wanted
    }

    fn modes_near(&self, followed: &[Mode]) -> Vec<Mode> {
        self.wanted(followed).iter().filter_map(|i| self.modes.get(i).cloned()).collect()
    }
}
