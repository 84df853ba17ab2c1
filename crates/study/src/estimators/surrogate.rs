//! The prediction of the unstable modes from response surfaces instead of a spectrum.
//!
//! A gain has the coordinates mu, Re H and Im H / Re H (see [`FrictionPoints`]). The region of these coordinates in which samples
//! lie is halved into cells, the leaves of a k-d tree. The corners of a cell are sample points, at which the eigenvalues near
//! the axis are solved, with derivatives and names. Within the cell each eigenvalue is approximated by a polynomial in mu and
//! H. A prediction is *uncertain* where the distance of an eigenvalue from the axis is not clearly larger than the error of the
//! polynomial, and where the sample points give a mode different names. Cells with many uncertain points are halved again.

use std::collections::BTreeMap;

use linsys::ChannelGain;

use super::EstimatorError;
use super::cell_builder::{CellBuilder, PendingCell};
use super::friction_points::{FrictionPoints, coordinates};
use super::kd_tree::{Cell, ModeSet, Prediction, predict};
use crate::{ModeLabel, Study, UncertainBrake};

/// Number of cells that are halved before their sample points are solved together; chosen, so that the batched solver is filled.
const CELLS_PER_ROUND: usize = 32;
/// Largest share of points with an uncertain prediction with which refinement ends; chosen: with less, more sample points are solved; with more, more uncertain
/// samples.
const UNCERTAIN_PART: f64 = 4e-4;
/// Fewest sample points with which the cost rule ends refinement; chosen.
const FEWEST_SAMPLE_POINTS: usize = 1_000;
/// Number of sample points with which refinement ends in any case; chosen: the samples that are then uncertain are solved.
const MOST_SAMPLE_POINTS: usize = 8_000;
/// Cost rule: refinement ends where this many times the number of sample points exceeds the number of uncertain samples to be
/// solved. Estimated: a sample point costs as much as two uncertain samples, whose number falls with the second power of the
/// number of sample points.
const SAMPLES_PER_SAMPLE_POINT: f64 = 1.5;

/// The prediction of the unstable modes of one scene.
#[derive(Debug, Clone)]
pub struct Surrogate {
    names: Vec<ModeLabel>,
    omega: f64,
    cells: Vec<Cell>,
    sample_points: u64,
}

impl Surrogate {
    /// Solves the sample points of a scene and builds the cells for its friction `points`. `samples` gives the number of uncertain samples that have to be
    /// solved, as a function of their share of all samples.
    ///
    /// # Errors
    /// Those of the model and the solver.
    pub fn new<B: UncertainBrake>(
        study: &Study<'_, B>,
        scene: usize,
        points: &FrictionPoints,
        samples: impl Fn(f64) -> f64,
    ) -> Result<Self, EstimatorError> {
        let mut builder = CellBuilder::new(study, scene, points)?;
        let mut pending = builder.first();
        let mut done: Vec<(usize, PendingCell)> = Vec::new();
        while !pending.is_empty() {
            builder.solve(&pending)?;
            for cell in pending.drain(..) {
                let (leaf, uncertain) = builder.leaf(&cell);
                builder.cells[cell.place] = Cell::Leaf(leaf);
                done.push((uncertain, cell));
            }
            done.sort_by_key(|(uncertain, _)| *uncertain);
            let uncertain = done.iter().map(|(uncertain, _)| uncertain).sum::<usize>() as f64;
            let uncertain = uncertain / points.training.len() as f64;
            let solved = builder.sample_points.len();
            let is_cheaper =
                solved >= FEWEST_SAMPLE_POINTS && SAMPLES_PER_SAMPLE_POINT * solved as f64 >= samples(uncertain);
            if uncertain <= UNCERTAIN_PART || is_cheaper || solved >= MOST_SAMPLE_POINTS {
                break;
            }
            for _ in 0..CELLS_PER_ROUND {
                // Points of the smallest cells stay uncertain: they are solved.
                if let Some(at) = done.iter().rposition(|(uncertain, cell)| *uncertain > 0 && cell.has_halves()) {
                    let (_, cell) = done.remove(at);
                    pending.extend(builder.halve(cell).into_iter().filter(|half| !half.points.is_empty()));
                }
            }
        }
        let sample_points = builder.sample_points.len() as u64;
        Ok(Self { names: builder.names, omega: points.omega, cells: builder.cells, sample_points })
    }

    /// The modes that may be unstable.
    pub fn names(&self) -> &[ModeLabel] {
        &self.names
    }

    /// Number of sample points, for each of which one system was solved.
    pub fn sample_points(&self) -> u64 {
        self.sample_points
    }

    /// The names of a set of unstable modes, each with whether it is certain.
    pub(super) fn named(&self, unstable: ModeSet) -> BTreeMap<ModeLabel, bool> {
        let perhaps = self.names.iter().enumerate().filter(|(bit, _)| unstable.perhaps >> bit & 1 == 1);
        perhaps.map(|(bit, &name)| (name, unstable.sure >> bit & 1 == 1)).collect()
    }

    /// The prediction for a gain.
    pub(super) fn predict(&self, gain: &ChannelGain) -> Prediction {
        predict(&self.cells, gain, coordinates(gain, self.omega))
    }
}
