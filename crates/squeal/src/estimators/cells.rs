//! The cells of a table being made: corners, the eigenvalues there, and what they make of a cell.

use std::collections::{BTreeSet, HashMap};

use friction::{InternalTangent, Tangent};
use num_complex::Complex;

use super::EstimatorError;
use super::draws::FrictionPoints;
use super::node::{NearMode, Nodes};
use super::sheet::{Sheet, link};
use super::table::{CORNERS, Cell, Crossing, Leaf, Named, Names};
use crate::study::Study;

/// Halvings of each direction in any case.
const FIRST: u32 = 2;
/// Steps of the finest grid in each direction.
const FINEST: u32 = 1 << 16;
/// An eigenvalue is clear of the axis in a whole cell from this many times the miss of its polynomial on.
const CLEAR: f64 = 10.0;
/// Points of a cell whose slopes are looked at at other frequencies.
const SOME: usize = 32;
/// A mode matters in a cell if it could reach the axis moving this much faster than at a corner.
const FASTER: f64 = 1.5;

/// A cell being made, on the finest grid.
pub(super) struct Part {
    /// Place in [`Build::cells`].
    pub cell: usize,
    low: [u32; 3],
    size: [u32; 3],
    /// Indices of the points in it.
    pub points: Vec<u32>,
}

impl Part {
    fn corner(&self, k: usize) -> [u32; 3] {
        std::array::from_fn(|d| self.low[d] + if k >> d & 1 == 1 { self.size[d] } else { 0 })
    }
}

pub(super) struct Build<'a> {
    nodes: Nodes<'a>,
    points: &'a FrictionPoints,
    pub places: Vec<[f64; 3]>,
    from: [f64; 3],
    step: [f64; 3],
    pub corners: HashMap<[u32; 3], Vec<NearMode>>,
    pub cells: Vec<Cell>,
    pub names: Vec<u16>,
}

impl<'a> Build<'a> {
    pub fn new(study: &'a Study<'a>, scene: usize, points: &'a FrictionPoints) -> Result<Self, EstimatorError> {
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
    pub fn first(&mut self) -> Vec<Part> {
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
    pub fn halve(&mut self, part: Part) -> Vec<Part> {
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
    pub fn solve(&mut self, parts: &[Part]) -> Result<(), EstimatorError> {
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

    /// What is known in a cell, and at how many of its points that is doubtful.
    pub fn leaf(&self, part: &Part) -> (Leaf, usize) {
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
        let some: Vec<&Tangent> = part
            .points
            .iter()
            .step_by(part.points.len().div_ceil(SOME))
            .map(|&i| &self.points.own[i as usize])
            .collect();
        let reaches = |mode: &NearMode| {
            // At other frequencies than that of the places slopes differ by more.
            let away = some.iter().map(|tangent| (tangent.complex_slope(mode.lambda) - mode.slope).norm_sqr());
            let extent = away.fold(extent * extent, f64::max).sqrt();
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
        let mut doubtful = vec![false; part.points.len()];
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
                let at_points: Vec<(f64, bool)> = part
                    .points
                    .iter()
                    .map(|&i| sheet.reach(&self.points.own[i as usize]))
                    .map(|(lambda, is_outside)| (lambda.re, is_outside))
                    .collect();
                let growths = at_points.iter().map(|point| point.0).chain(corners.iter().map(|c| c.1.lambda.re));
                let [least, most] = [f64::min, f64::max].map(|of| growths.clone().reduce(of).unwrap_or(0.0));
                // Few of the points that may fall here are known.
                let clear = CLEAR * sheet.miss + (most - least);
                if least > clear {
                    always.iter_mut().zip(named.at).for_each(|(all, names)| *all = all.or(names));
                } else if most >= -clear {
                    let crossing = Crossing { sheet, named };
                    for (is_doubtful, (growth, is_outside)) in doubtful.iter_mut().zip(at_points) {
                        *is_doubtful |= crossing.judge(growth, is_outside)[1];
                    }
                    leaf.crossing.push(crossing);
                }
            }
        }
        leaf.unstable = Named::new(always);
        let everywhere = leaf.is_doubtful || leaf.unstable.is_doubtful;
        let doubts = if everywhere { doubtful.len() } else { doubtful.into_iter().filter(|&doubt| doubt).count() };
        (leaf, doubts)
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
