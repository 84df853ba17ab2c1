//! Which modes are unstable, from a table instead of a spectrum: a guess in nanoseconds.
//!
//! A tangent has a place in the space of mu, Re H and Im H / Re H (see [`FrictionPoints`]). The part of it where samples
//! fall is halved into cells. At the corners of a cell the eigenvalues near the axis are known, with derivatives and names;
//! within it each is a polynomial in mu and H, of which it is an analytic function but at coalescences. The guess is
//! *doubtful* where an eigenvalue is nearer to the axis than its polynomial is to the corners, and where the corners
//! do not agree about a name. Cells with many doubtful points are halved again.

use std::collections::{BTreeSet, HashMap};

use friction::{InternalTangent, Tangent};
use num_complex::Complex;

use super::AccuracyError;
use super::draws::{FrictionPoints, place};
use super::node::{NearMode, Nodes};
use super::sheet::{Sheet, link};
use crate::study::Study;

/// Halvings of each direction in any case.
const FIRST: u32 = 2;
/// Cells halved in one go, so that spectra fill the solver's lanes.
const TOGETHER: usize = 8;
/// Part of the points that may be doubtful.
const DOUBTFUL: f64 = 2e-3;
/// Corners after which no cell is halved.
const MOST_CORNERS: usize = 200;
/// Steps of the finest grid in each direction.
const FINEST: u32 = 1 << 16;
/// An eigenvalue is in doubt within this many times the miss of its polynomial of the axis.
const SAFETY: f64 = 2.0;
/// It is clear of the axis in a whole cell from this many times the miss on.
const CLEAR: f64 = 10.0;
/// A mode matters in a cell if it could reach the axis moving this much faster than at a corner.
const FASTER: f64 = 1.5;
/// Corners of a cell.
const CORNERS: usize = 8;

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
    fn or(self, more: Self) -> Self {
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
enum Cell {
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
struct Leaf {
    middle: [f64; 3],
    /// Modes that are unstable in the whole cell.
    unstable: Named,
    /// Modes that may cross the axis.
    crossing: Vec<(Sheet, Named)>,
    /// Whether a mode was lost between corners.
    is_doubtful: bool,
}

/// What modes are called near each corner of a cell.
#[derive(Debug, Clone)]
struct Named {
    at: [Names; CORNERS],
    is_doubtful: bool,
}

impl Named {
    fn new(at: [Names; CORNERS]) -> Self {
        Self { is_doubtful: at.iter().any(|&names| names != at[0]), at }
    }
}

impl Table {
    /// Finds the eigenvalues of a scene where `points` need them.
    ///
    /// # Errors
    /// What the model and the solver refuse.
    pub fn new(study: &Study<'_>, scene: usize, points: &FrictionPoints) -> Result<Self, AccuracyError> {
        let mut build = Build::new(study, scene, points)?;
        let mut pending = build.first();
        let mut done: Vec<(usize, Part)> = Vec::new();
        let allowed = (DOUBTFUL * points.own.len() as f64) as usize;
        while !pending.is_empty() {
            build.solve(&pending)?;
            for part in pending.drain(..) {
                let leaf = build.leaf(&part);
                let is_doubtful = |&&i: &&u32| {
                    let i = i as usize;
                    leaf.guess(&points.own[i], &build.places[i]).is_doubtful
                };
                let doubts = part.points.iter().filter(is_doubtful).count();
                build.cells[part.cell] = Cell::Leaf(leaf);
                done.push((doubts, part));
            }
            done.sort_by_key(|(doubts, _)| *doubts);
            if done.iter().map(|(doubts, _)| doubts).sum::<usize>() <= allowed || build.corners.len() >= MOST_CORNERS {
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
        for (sheet, named) in &self.crossing {
            let growth = sheet.lambda(tangent).re;
            guess.is_doubtful |= growth.abs() < SAFETY * sheet.miss;
            if growth > 0.0 {
                guess.unstable = guess.unstable.or(named.at[corner]);
                guess.is_doubtful |= named.is_doubtful;
            }
        }
        guess
    }
}

/// A cell being made, on the finest grid.
struct Part {
    cell: usize,
    low: [u32; 3],
    size: [u32; 3],
    points: Vec<u32>,
}

impl Part {
    fn corner(&self, k: usize) -> [u32; 3] {
        std::array::from_fn(|d| self.low[d] + if k >> d & 1 == 1 { self.size[d] } else { 0 })
    }
}

struct Build<'a> {
    nodes: Nodes<'a>,
    points: &'a FrictionPoints,
    places: Vec<[f64; 3]>,
    from: [f64; 3],
    step: [f64; 3],
    corners: HashMap<[u32; 3], Vec<NearMode>>,
    cells: Vec<Cell>,
    names: Vec<u16>,
}

impl<'a> Build<'a> {
    fn new(study: &'a Study<'a>, scene: usize, points: &'a FrictionPoints) -> Result<Self, AccuracyError> {
        let places: Vec<[f64; 3]> = points.own.iter().map(|tangent| points.place(tangent)).collect();
        let (mut from, mut step) = ([0.0; 3], [0.0; 3]);
        for d in 0..3 {
            let mut all: Vec<f64> = places.iter().map(|place| place[d]).collect();
            all.sort_by(f64::total_cmp);
            // What lies farther out belongs to the cell next to it.
            let aside = all.len() / 4096;
            from[d] = all[aside];
            step[d] = (all[all.len() - 1 - aside] - from[d]) / f64::from(FINEST);
        }
        let nodes = Nodes::new(study, scene)?;
        Ok(Self {
            nodes,
            points,
            places,
            from,
            step,
            corners: HashMap::new(),
            cells: vec![Cell::Empty],
            names: Vec::new(),
        })
    }

    fn at(&self, grid: [u32; 3]) -> [f64; 3] {
        std::array::from_fn(|d| self.from[d] + self.step[d] * f64::from(grid[d]))
    }

    /// The cells to begin with.
    fn first(&mut self) -> Vec<Part> {
        let size = self.step.map(|step| if step > 0.0 { FINEST } else { 0 });
        let all = (0..self.places.len() as u32).collect();
        let mut open = vec![Part { cell: 0, low: [0; 3], size, points: all }];
        let mut found = Vec::new();
        while let Some(part) = open.pop() {
            if part.points.is_empty() {
                continue;
            }
            if part.size.iter().all(|&size| size <= FINEST >> FIRST) {
                found.push(part);
            } else {
                open.extend(self.halve(part));
            }
        }
        found
    }

    /// The halves of a cell, in its longest direction.
    fn halve(&mut self, part: Part) -> Vec<Part> {
        let longest = (0..3).rev().max_by_key(|&d| part.size[d]).unwrap_or(0);
        let mut size = part.size;
        size[longest] /= 2;
        let mut high = part.low;
        high[longest] += size[longest];
        let middle = self.at(high)[longest];
        let (below, above) = part.points.iter().partition(|&&i| self.places[i as usize][longest] < middle);
        let halves = [self.cells.len(), self.cells.len() + 1];
        // A half without points goes on with what the whole says.
        let whole = std::mem::replace(&mut self.cells[part.cell], Cell::Halved { direction: longest, middle, halves });
        self.cells.extend([whole.clone(), whole]);
        vec![
            Part { cell: halves[0], low: part.low, size, points: below },
            Part { cell: halves[1], low: high, size, points: above },
        ]
    }

    /// A tangent at a place: that of a point near by, its slope and its state's drive moved.
    fn tangent(&self, place: [f64; 3]) -> Tangent {
        let distance = |i: &usize| {
            let other = self.places[*i];
            (other[1] - place[1]).powi(2) + (other[1] * other[2] - place[1] * place[2]).powi(2)
        };
        let some = (0..self.places.len()).step_by(self.places.len().div_ceil(2048).max(1));
        let nearest = some.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let internal = nearest.and_then(|i| self.points.own[i].internal).filter(|state| state.force != 0.0);
        let Some(state) = internal else {
            return Tangent { mu: place[0], slope: place[1], internal: None };
        };
        let lag = 1.0 / Complex::new(state.decay, self.points.omega);
        let product = place[1] * place[2] / lag.im;
        let internal = Some(InternalTangent { drive: product / state.force, ..state });
        Tangent { mu: place[0], slope: place[1] - product * lag.re, internal }
    }

    /// Computes the corners that some cells lack.
    fn solve(&mut self, parts: &[Part]) -> Result<(), AccuracyError> {
        let wanted = parts.iter().flat_map(|part| (0..CORNERS).map(|k| part.corner(k)));
        let wanted: BTreeSet<[u32; 3]> = wanted.filter(|grid| !self.corners.contains_key(grid)).collect();
        let tangents: Vec<Tangent> = wanted.iter().map(|&grid| self.tangent(self.at(grid))).collect();
        let solved = self.nodes.solve(&tangents)?;
        for &name in solved.iter().flatten().flat_map(|mode| &mode.names) {
            if !self.names.contains(&name) && self.names.len() < u64::BITS as usize {
                self.names.push(name);
            }
        }
        self.corners.extend(wanted.into_iter().zip(solved));
        Ok(())
    }

    /// What a mode with some names is called.
    fn bits(&self, names: &[u16]) -> Names {
        let bit = |name: &u16| self.names.iter().position(|other| other == name).map_or(0, |bit| 1 << bit);
        let perhaps = names.iter().fold(0, |bits, name| bits | bit(name));
        Names { sure: if names.len() == 1 { perhaps } else { 0 }, perhaps }
    }

    fn leaf(&self, part: &Part) -> Leaf {
        // A direction of no extent has one side.
        let sides = (0..3).filter(|&d| part.size[d] > 0).map(|d| 1 << d).sum::<usize>();
        let ks: Vec<usize> = (0..CORNERS).filter(|k| k & !sides == 0).collect();
        let places: Vec<[f64; 3]> = ks.iter().map(|&k| self.at(part.corner(k))).collect();
        let none: &[NearMode] = &[];
        let modes: Vec<(f64, &[NearMode])> = ks
            .iter()
            .zip(&places)
            .map(|(&k, place)| (place[0], self.corners.get(&part.corner(k)).map_or(none, Vec::as_slice)))
            .collect();
        let slope = |place: &[f64; 3]| Complex::new(place[1], place[1] * place[2]);
        let extent = places.iter().map(|place| (slope(place) - slope(&places[0])).norm()).fold(0.0, f64::max);
        let width = self.step[0] * f64::from(part.size[0]);
        let reaches = |mode: &NearMode| {
            mode.lambda.re + FASTER * (mode.by_mu.re.abs() * width + mode.by_slope.norm() * extent) > 0.0
        };

        let (low, high) = (self.at(part.corner(0)), self.at(part.corner(CORNERS - 1)));
        let mut leaf = Leaf {
            middle: std::array::from_fn(|d| 0.5 * (low[d] + high[d])),
            unstable: Named::new([Names::default(); CORNERS]),
            crossing: Vec::new(),
            is_doubtful: false,
        };
        let mut always = [Names::default(); CORNERS];
        let mut used: BTreeSet<(usize, usize)> = BTreeSet::new();
        for start in 0..ks.len() {
            for index in 0..modes[start].1.len() {
                if used.contains(&(start, index)) || !reaches(&modes[start].1[index]) {
                    continue;
                }
                let sheet = link(&modes, &ks, start, index).and_then(|path| {
                    let corners: Vec<(f64, &NearMode)> =
                        modes.iter().zip(&path).map(|((mu, all), &i)| (*mu, &all[i])).collect();
                    used.extend(path.iter().copied().enumerate());
                    Sheet::new(&corners).map(|sheet| (sheet, corners))
                });
                let Some((sheet, corners)) = sheet else {
                    leaf.is_doubtful = true;
                    continue;
                };
                let named = self.named(&ks, sides, &corners);
                // Far from the axis at every point of the cell and at every corner?
                let points = part.points.iter().map(|&i| sheet.lambda(&self.points.own[i as usize]).re);
                let growths: Vec<f64> = points.chain(corners.iter().map(|c| c.1.lambda.re)).collect();
                let clear = CLEAR * sheet.miss;
                if growths.iter().all(|&growth| growth > clear) {
                    always.iter_mut().zip(named.at).for_each(|(all, names)| *all = all.or(names));
                } else if !growths.iter().all(|&growth| growth < -clear) {
                    leaf.crossing.push((sheet, named));
                }
            }
        }
        leaf.unstable = Named::new(always);
        leaf
    }

    /// What a mode is called near each corner; where it is stable, as at the nearest corner where it is not.
    fn named(&self, ks: &[usize], sides: usize, corners: &[(f64, &NearMode)]) -> Named {
        let at = |k: usize| {
            let unstable = (0..ks.len()).filter(|&c| corners[c].1.lambda.re > 0.0);
            let nearest = unstable.min_by_key(|&c| ((ks[c] ^ k) & sides).count_ones());
            nearest.map_or(Names::default(), |c| self.bits(&corners[c].1.names))
        };
        let at: [Names; CORNERS] = std::array::from_fn(at);
        Named { is_doubtful: at[0].perhaps == 0 || at.iter().any(|&names| names != at[0]), at }
    }
}
