//! Building the cells of a surrogate: the sample points at their corners, the modes there, and the leaves.

use std::collections::{BTreeSet, HashMap};

use cea::Threshold;
use linsys::{ChannelGain, Lag};
use num_complex::Complex;

use super::EstimatorError;
use super::friction_points::FrictionPoints;
use super::kd_tree::{CORNERS, Cell, CornerNames, CrossingMode, Leaf, ModeSet};
use super::response_surface::{ResponseSurface, link};
use super::sample_points::{SamplePoints, SampledMode};
use crate::{ModeLabel, Study, UncertainBrake};

/// Number of halvings of each direction before any refinement; chosen.
const FIRST_HALVINGS: u32 = 2;
/// Number of steps of the finest grid in each direction; chosen.
const GRID_STEPS: u32 = 1 << 16;
/// Number of points for each one that is left outside the cells, at each end of each direction; chosen: with fewer, more points belong to a cell that does not
/// reach them; with more, single far points make all cells larger.
const POINTS_PER_OUTLIER: usize = 4096;
/// Number of points of which the nearest gives the gain of a sample point; chosen: with more, finding it takes longer.
const TANGENT_CANDIDATES: usize = 2048;
/// Least distance from the threshold, in residuals of its polynomial, of a mode that crosses nowhere in a cell; chosen: with less, a prediction is more often
/// wrong; with more, modes are evaluated at points where they cross nothing.
const CLEAR_RESIDUALS: f64 = 10.0;
/// Number of points of a cell whose slopes are evaluated at the frequencies of its modes; chosen: with fewer, the extent of the slopes may be larger than is
/// seen.
const SLOPES_PER_CELL: usize = 32;
/// Factor on the rates of a mode at a corner: it is followed in a cell if it would reach the threshold at these. Chosen: with less, a mode that changes faster
/// elsewhere in the cell is missed; with more, modes are followed that cross nothing.
const RATE_MARGIN: f64 = 1.5;

/// A cell without a leaf yet, in steps of the finest grid.
pub(super) struct PendingCell {
    /// Index of the cell in [`CellBuilder::cells`].
    pub place: usize,
    low: [u32; 3],
    size: [u32; 3],
    /// Indices of the points in the cell.
    pub points: Vec<u32>,
}

impl PendingCell {
    /// True if the cell is not the smallest, of one step in each direction in which it has an extent.
    pub fn has_halves(&self) -> bool {
        self.size.iter().any(|&size| size > 1)
    }

    fn corner(&self, k: usize) -> [u32; 3] {
        std::array::from_fn(|d| self.low[d] + if k >> d & 1 == 1 { self.size[d] } else { 0 })
    }
}

/// The corners and points of a cell, and its extent in mu and in the complex slope H.
struct CellView<'a> {
    /// Directions in which the cell has an extent: bit d is set for direction d.
    sides: usize,
    /// Numbers of the distinct corners: in a direction without extent, the corners of its lower side.
    corners: Vec<usize>,
    /// mu and the modes at each of these corners.
    modes: Vec<(f64, &'a [SampledMode])>,
    /// Extent in mu.
    width: f64,
    /// Extent in H at the frequency of the coordinates, Ns/m.
    extent: f64,
    /// Gains at all points of the cell.
    gains: Vec<&'a ChannelGain>,
}

/// The k-d tree of a scene while it is built.
pub(super) struct CellBuilder<'a, B: UncertainBrake> {
    solver: SamplePoints<'a, B>,
    threshold: Threshold,
    points: &'a FrictionPoints,
    coordinates: Vec<[f64; 3]>,
    from: [f64; 3],
    step: [f64; 3],
    pub sample_points: HashMap<[u32; 3], Vec<SampledMode>>,
    pub cells: Vec<Cell>,
    pub names: Vec<ModeLabel>,
}

impl<'a, B: UncertainBrake> CellBuilder<'a, B> {
    pub fn new(study: &'a Study<'a, B>, scene: usize, points: &'a FrictionPoints) -> Result<Self, EstimatorError> {
        let coordinates: Vec<[f64; 3]> = points.training.iter().map(|gain| points.coordinates(gain)).collect();
        let (mut from, mut step) = ([0.0; 3], [0.0; 3]);
        for d in 0..3 {
            let mut all: Vec<f64> = coordinates.iter().map(|point| point[d]).collect();
            all.sort_by(f64::total_cmp);
            // Points farther out belong to the cell next to them.
            let outliers = all.len() / POINTS_PER_OUTLIER;
            from[d] = all[outliers];
            step[d] = (all[all.len() - 1 - outliers] - from[d]) / f64::from(GRID_STEPS);
        }
        Ok(Self {
            solver: SamplePoints::new(study, scene)?,
            threshold: study.plan().threshold,
            points,
            coordinates,
            from,
            step,
            sample_points: HashMap::new(),
            cells: vec![Cell::Empty],
            names: Vec::new(),
        })
    }

    fn at(&self, grid: [u32; 3]) -> [f64; 3] {
        std::array::from_fn(|d| self.from[d] + self.step[d] * f64::from(grid[d]))
    }

    /// The first cells.
    pub fn first(&mut self) -> Vec<PendingCell> {
        let size = self.step.map(|step| if step > 0.0 { GRID_STEPS } else { 0 });
        let all = (0..self.coordinates.len() as u32).collect();
        let mut open = vec![PendingCell { place: 0, low: [0; 3], size, points: all }];
        let mut found = Vec::new();
        while let Some(cell) = open.pop() {
            if cell.points.is_empty() {
                continue;
            }
            if cell.size.iter().all(|&size| size <= GRID_STEPS >> FIRST_HALVINGS) {
                found.push(cell);
            } else {
                open.extend(self.halve(cell));
            }
        }
        found
    }

    /// Halves a cell in its longest direction.
    pub fn halve(&mut self, cell: PendingCell) -> Vec<PendingCell> {
        let longest = (0..3).rev().max_by_key(|&d| cell.size[d]).unwrap_or(0);
        let mut size = cell.size;
        size[longest] /= 2;
        let mut high = cell.low;
        high[longest] += size[longest];
        let middle = self.at(high)[longest];
        let (below, above) = cell.points.iter().partition(|&&i| self.coordinates[i as usize][longest] < middle);
        let halves = [self.cells.len(), self.cells.len() + 1];
        // A half without points keeps the leaf of the whole cell.
        let whole = std::mem::replace(&mut self.cells[cell.place], Cell::Halved { direction: longest, middle, halves });
        self.cells.extend([whole.clone(), whole]);
        vec![
            PendingCell { place: halves[0], low: cell.low, size, points: below },
            PendingCell { place: halves[1], low: high, size, points: above },
        ]
    }

    /// A gain with given coordinates: the gain of the nearest point, with another slope and another drive of its lag.
    fn gain(&self, at: [f64; 3]) -> ChannelGain {
        let distance = |i: &usize| {
            let other = self.coordinates[*i];
            (other[1] - at[1]).powi(2) + (other[1] * other[2] - at[1] * at[2]).powi(2)
        };
        let count = self.coordinates.len();
        let candidates = (0..count).step_by(count.div_ceil(TANGENT_CANDIDATES).max(1));
        let nearest = candidates.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let lag = nearest.and_then(|i| self.points.training[i].lag).filter(|lag| lag.force != 0.0);
        let Some(lag) = lag else {
            return ChannelGain { mu: at[0], slope: at[1], lag: None };
        };
        let response = 1.0 / Complex::new(lag.decay, self.points.omega);
        let product = at[1] * at[2] / response.im;
        let moved = Lag { drive: product / lag.force, ..lag };
        ChannelGain { mu: at[0], slope: at[1] - product * response.re, lag: Some(moved) }
    }

    /// Solves the corners of `cells` that are no sample points yet.
    pub fn solve(&mut self, cells: &[PendingCell]) -> Result<(), EstimatorError> {
        let wanted = cells.iter().flat_map(|cell| (0..CORNERS).map(|k| cell.corner(k)));
        let wanted: BTreeSet<[u32; 3]> = wanted.filter(|grid| !self.sample_points.contains_key(grid)).collect();
        let gains: Vec<ChannelGain> = wanted.iter().map(|&grid| self.gain(self.at(grid))).collect();
        let solved = self.solver.solve(&gains)?;
        for &name in solved.iter().flatten().flat_map(|mode| &mode.names) {
            if !self.names.contains(&name) && self.names.len() < u64::BITS as usize {
                self.names.push(name);
            }
        }
        self.sample_points.extend(wanted.into_iter().zip(solved));
        Ok(())
    }

    /// The leaf of a cell, and the number of its points with an uncertain prediction.
    pub fn leaf(&self, cell: &PendingCell) -> (Leaf, usize) {
        let view = self.view(cell);
        let (low, high) = (self.at(cell.corner(0)), self.at(cell.corner(CORNERS - 1)));
        let mut leaf = Leaf {
            middle: std::array::from_fn(|d| 0.5 * (low[d] + high[d])),
            unstable: CornerNames::new([ModeSet::default(); CORNERS]),
            crossing: Vec::new(),
            is_uncertain: false,
        };
        let mut always = [ModeSet::default(); CORNERS];
        let mut uncertain = vec![false; cell.points.len()];
        let mut used: BTreeSet<(usize, usize)> = BTreeSet::new();
        for start in 0..view.corners.len() {
            for (index, mode) in view.modes[start].1.iter().enumerate() {
                if used.contains(&(start, index)) || !view.reaches(&self.threshold, mode) {
                    continue;
                }
                let path = link(&view.modes, &view.corners, start, index);
                used.extend(path.iter().flatten().copied().enumerate());
                let corners = path.map(|path| view.along(&path));
                let surface =
                    corners.and_then(|corners| Some((ResponseSurface::new(&corners, self.threshold)?, corners)));
                let Some((surface, corners)) = surface else {
                    leaf.is_uncertain = true;
                    continue;
                };
                let names = self.corner_names(&view, &corners);
                let at_points = view.margins(&surface);
                // The range of the margin over the points and the corners of the cell.
                let at_corners = corners.iter().map(|c| self.threshold.margin(c.1.lambda));
                let margins = at_points.iter().map(|point| point.0).chain(at_corners);
                let [least, most] = [f64::min, f64::max].map(|of| margins.clone().reduce(of).unwrap_or(0.0));
                // The width of this range is added to the margin, because samples may lie outside the range of the known points.
                let clear = CLEAR_RESIDUALS * surface.residual + (most - least);
                if least > clear {
                    always.iter_mut().zip(names.at).for_each(|(all, names)| *all = all.or(names));
                } else if most >= -clear {
                    let mode = CrossingMode { surface, names };
                    for (is_uncertain, (margin, is_outside)) in uncertain.iter_mut().zip(at_points) {
                        *is_uncertain |= mode.judge(margin, is_outside)[1];
                    }
                    leaf.crossing.push(mode);
                }
            }
        }
        leaf.unstable = CornerNames::new(always);
        let is_everywhere = leaf.is_uncertain || leaf.unstable.is_uncertain;
        let count = if is_everywhere { uncertain.len() } else { uncertain.into_iter().filter(|&is| is).count() };
        (leaf, count)
    }

    fn view(&self, cell: &PendingCell) -> CellView<'_> {
        let sides = (0..3).filter(|&d| cell.size[d] > 0).map(|d| 1 << d).sum::<usize>();
        let corners: Vec<usize> = (0..CORNERS).filter(|k| k & !sides == 0).collect();
        let coordinates: Vec<[f64; 3]> = corners.iter().map(|&k| self.at(cell.corner(k))).collect();
        let modes_at = |k: usize| self.sample_points.get(&cell.corner(k)).map_or(&[][..], Vec::as_slice);
        let slope = |at: &[f64; 3]| Complex::new(at[1], at[1] * at[2]);
        CellView {
            sides,
            modes: corners.iter().zip(&coordinates).map(|(&k, at)| (at[0], modes_at(k))).collect(),
            width: self.step[0] * f64::from(cell.size[0]),
            extent: coordinates.iter().map(|at| (slope(at) - slope(&coordinates[0])).norm()).fold(0.0, f64::max),
            gains: cell.points.iter().map(|&i| &self.points.training[i as usize]).collect(),
            corners,
        }
    }

    /// Bits of the names of a mode, as a [`ModeSet`].
    fn bits(&self, names: &[ModeLabel]) -> ModeSet {
        let bit = |name: &ModeLabel| self.names.iter().position(|other| other == name).map_or(0, |bit| 1 << bit);
        let perhaps = names.iter().fold(0, |bits, name| bits | bit(name));
        ModeSet { sure: if names.len() == 1 { perhaps } else { 0 }, perhaps }
    }

    /// The names of a mode near each corner. A corner where the mode is stable takes the names of the nearest corner where it is
    /// unstable.
    fn corner_names(&self, view: &CellView<'_>, modes: &[(f64, &SampledMode)]) -> CornerNames {
        let near = |k: usize| {
            let unstable = (0..view.corners.len()).filter(|&c| self.threshold.margin(modes[c].1.lambda) > 0.0);
            let nearest = unstable.min_by_key(|&c| ((view.corners[c] ^ k) & view.sides).count_ones());
            nearest.map_or(ModeSet::default(), |c| self.bits(&modes[c].1.names))
        };
        let at: [ModeSet; CORNERS] = std::array::from_fn(near);
        CornerNames { is_uncertain: at[0].perhaps == 0 || at.iter().any(|&names| names != at[0]), at }
    }
}

impl<'a> CellView<'a> {
    /// True if a mode at a corner could reach the threshold somewhere in the cell.
    fn reaches(&self, threshold: &Threshold, mode: &SampledMode) -> bool {
        // At other frequencies than the frequency of the coordinates the slopes in the cell may differ more.
        let some = self.gains.iter().step_by(self.gains.len().div_ceil(SLOPES_PER_CELL));
        let away = some.map(|gain| (gain.complex_slope(mode.lambda) - mode.slope).norm_sqr());
        let extent = away.fold(self.extent * self.extent, f64::max).sqrt();
        let by_mu = threshold.margin_rate(mode.lambda, mode.by_mu).abs();
        threshold.margin(mode.lambda) + RATE_MARGIN * (by_mu * self.width + mode.by_slope.norm() * extent) > 0.0
    }

    /// mu and the mode at each corner, where the mode has the index `path[c]`.
    fn along(&self, path: &[usize]) -> Vec<(f64, &'a SampledMode)> {
        self.modes.iter().zip(path).map(|((mu, all), &i)| (*mu, &all[i])).collect()
    }

    /// The margin at each point of the cell, and true where the slope there is outside the range of the surface.
    fn margins(&self, surface: &ResponseSurface) -> Vec<(f64, bool)> {
        self.gains.iter().map(|gain| surface.margin(gain)).collect()
    }
}
