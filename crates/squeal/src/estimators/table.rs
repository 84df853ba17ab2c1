//! Which modes are unstable, from a table instead of a spectrum: a guess in nanoseconds.
//!
//! A tangent has a place in the space of mu, Re H and Im H / Re H (see [`FrictionPoints`]). The part of it where samples
//! fall is halved into cells. At the corners of a cell the eigenvalues near the axis are known, with derivatives and names;
//! within it each is a polynomial in mu and H, of which it is an analytic function but at coalescences. The guess is
//! *doubtful* where an eigenvalue is nearer to the axis than its polynomial is to the corners, and where the corners
//! do not agree about a name. Cells with many doubtful points are halved again.

use std::collections::BTreeMap;

use friction::Tangent;

use super::EstimatorError;
use super::cells::{Build, Part};
use super::draws::{FrictionPoints, place};
use super::sheet::Sheet;
use crate::study::Study;

/// Cells halved in one go, so that spectra fill the solver's lanes.
const TOGETHER: usize = 32;
/// Part of the points that may be doubtful.
const DOUBTFUL: f64 = 4e-4;
/// Corners until which no cell is left as it is for being cheaper to sample, and after which none is halved.
const CORNERS_ANYWAY: usize = 1_000;
const MOST_CORNERS: usize = 8_000;
/// A corner is worth this many doubtful samples less: it costs twice as much as one, and doubtful samples fall with the
/// second power of the number of corners.
const WORTH: f64 = 1.5;
/// Corners of a cell.
pub(super) const CORNERS: usize = 8;

/// The guess of one scene.
#[derive(Debug, Clone)]
pub struct Table {
    names: Vec<u16>,
    omega: f64,
    cells: Vec<Cell>,
    corners: usize,
}

/// Sets of names, as bits by place in [`Table::names`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Names {
    /// Those of a mode that has no other.
    pub sure: u64,
    /// These, and those that a mode with an open name may have.
    pub perhaps: u64,
}

impl Names {
    pub fn or(self, more: Self) -> Self {
        Self { sure: self.sure | more.sure, perhaps: self.perhaps | more.perhaps }
    }
}

/// What a table says of a tangent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Guess {
    /// Names of the unstable modes.
    pub unstable: Names,
    /// Whether it may well be wrong.
    pub is_doubtful: bool,
}

#[derive(Debug, Clone)]
pub(super) enum Cell {
    /// Below `middle` in a direction, and not below.
    Halved {
        direction: usize,
        middle: f64,
        halves: [usize; 2],
    },
    Leaf(Leaf),
    /// Without any point.
    Empty,
}

/// A cell that is not halved. Corner k of eight is on the upper side in direction d where bit d of k is set.
#[derive(Debug, Clone)]
pub(super) struct Leaf {
    /// Where its halves would meet.
    pub middle: [f64; 3],
    /// Modes that are unstable in the whole cell.
    pub unstable: Named,
    /// Modes that may cross the axis.
    pub crossing: Vec<Crossing>,
    /// Whether a mode was lost between corners.
    pub is_doubtful: bool,
}

/// A mode that may cross the axis in a cell.
#[derive(Debug, Clone)]
pub(super) struct Crossing {
    pub sheet: Sheet,
    pub named: Named,
}

impl Crossing {
    /// Whether the mode grows under a tangent, and whether that and its name are in doubt.
    pub fn guess(&self, tangent: &Tangent) -> [bool; 2] {
        let (lambda, is_outside) = self.sheet.reach(tangent);
        self.judge(lambda.re, is_outside)
    }

    /// [`Crossing::guess`] from what the sheet says.
    pub fn judge(&self, growth: f64, is_outside: bool) -> [bool; 2] {
        let grows = growth > 0.0;
        [grows, growth.abs() < self.sheet.doubt() || is_outside || grows && self.named.is_doubtful]
    }
}

/// What modes are called near each corner of a cell.
#[derive(Debug, Clone)]
pub(super) struct Named {
    pub at: [Names; CORNERS],
    /// Whether the corners disagree, or none knows.
    pub is_doubtful: bool,
}

impl Named {
    pub fn new(at: [Names; CORNERS]) -> Self {
        Self { is_doubtful: at.iter().any(|&names| names != at[0]), at }
    }
}

impl Table {
    /// Finds the eigenvalues of a scene where `points` need them. `samples` says how many samples have to be solved if a part
    /// of all is doubtful.
    ///
    /// # Errors
    /// What the model and the solver refuse.
    pub fn new(
        study: &Study<'_>,
        scene: usize,
        points: &FrictionPoints,
        samples: impl Fn(f64) -> f64,
    ) -> Result<Self, EstimatorError> {
        let mut build = Build::new(study, scene, points)?;
        let mut pending = build.first();
        let mut done: Vec<(usize, Part)> = Vec::new();
        while !pending.is_empty() {
            build.solve(&pending)?;
            for part in pending.drain(..) {
                let (leaf, doubts) = build.leaf(&part);
                build.cells[part.cell] = Cell::Leaf(leaf);
                done.push((doubts, part));
            }
            done.sort_by_key(|(doubts, _)| *doubts);
            let doubtful = done.iter().map(|(doubts, _)| doubts).sum::<usize>() as f64 / points.own.len() as f64;
            let corners = build.corners.len();
            let is_cheaper = corners >= CORNERS_ANYWAY && WORTH * corners as f64 >= samples(doubtful);
            if doubtful <= DOUBTFUL || is_cheaper || corners >= MOST_CORNERS {
                break;
            }
            for _ in 0..TOGETHER {
                if let Some((_, part)) = done.pop().filter(|(doubts, _)| *doubts > 0) {
                    pending.extend(build.halve(part).into_iter().filter(|half| !half.points.is_empty()));
                }
            }
        }
        Ok(Self { names: build.names, omega: points.omega, cells: build.cells, corners: build.corners.len() })
    }

    /// The modes that may be unstable.
    pub fn names(&self) -> &[u16] {
        &self.names
    }

    /// By name, those that are unstable, and whether surely.
    pub(super) fn named(&self, unstable: Names) -> BTreeMap<u16, bool> {
        let perhaps = self.names.iter().enumerate().filter(|(bit, _)| unstable.perhaps >> bit & 1 == 1);
        perhaps.map(|(bit, &name)| (name, unstable.sure >> bit & 1 == 1)).collect()
    }

    /// Number of corners, for each of which one system was solved.
    pub fn corners(&self) -> usize {
        self.corners
    }

    /// What is unstable under a tangent, as far as can be guessed.
    pub(super) fn guess(&self, tangent: &Tangent) -> Guess {
        let place = place(tangent, self.omega);
        let mut at = 0;
        loop {
            match &self.cells[at] {
                Cell::Halved { direction, middle, halves } => at = halves[usize::from(place[*direction] >= *middle)],
                Cell::Leaf(leaf) => return leaf.guess(tangent, &place),
                Cell::Empty => return Guess { unstable: Names::default(), is_doubtful: true },
            }
        }
    }
}

impl Leaf {
    fn guess(&self, tangent: &Tangent, place: &[f64; 3]) -> Guess {
        let corner = (0..3).map(|d| usize::from(place[d] >= self.middle[d]) << d).sum::<usize>();
        let mut guess =
            Guess { unstable: self.unstable.at[corner], is_doubtful: self.is_doubtful || self.unstable.is_doubtful };
        for crossing in &self.crossing {
            let [grows, is_doubtful] = crossing.guess(tangent);
            guess.is_doubtful |= is_doubtful;
            if grows {
                guess.unstable = guess.unstable.or(crossing.named.at[corner]);
            }
        }
        guess
    }
}
