//! The systems of a brake along a straight line in the space of its swept parameters.

use std::sync::Arc;

use cea::{Counters, EigenSolver};
use linsys::SecondOrder;
use serde::Serialize;
use tracking::{KeptSpectra, SystemAt, SystemChange};

use super::SweptParameter;
use crate::Error;
use crate::study::{Scene, UncertainBrake};

/// Half of the difference from which derivatives by a parameter are taken, as a part of its range: squared it is near machine
/// epsilon over itself.
pub(super) const DIFFERENCE: f64 = 1e-5;
/// Shortest step, as a part of the range; chosen: derivatives by differences tell branches apart down to there.
pub(super) const SHORTEST_STEP: f64 = 1e-9;

/// What a sweep computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Evaluations {
    /// Whole spectra.
    pub spectra: u64,
    /// Left and right eigenvectors.
    pub eigenvectors: u64,
    /// Single eigenvalues found from a neighbouring one, without a spectrum.
    pub continued: u64,
}

impl Evaluations {
    /// What counters say of spectra and vectors.
    pub(super) fn of(counters: Counters) -> Self {
        Self { spectra: counters.eigenvalue_solves, eigenvectors: counters.eigenvectors, continued: 0 }
    }
}

impl std::ops::AddAssign for Evaluations {
    fn add_assign(&mut self, Self { spectra, eigenvectors, continued }: Self) {
        self.spectra += spectra;
        self.eigenvectors += eigenvectors;
        self.continued += continued;
    }
}

/// A scene of a brake with some of its parameters swept.
pub(super) struct Family<'a, B> {
    pub brake: &'a B,
    pub scene: &'a Scene,
    pub solver: &'a dyn EigenSolver,
    pub parameters: Vec<SweptParameter>,
}

/// A straight line: the values of the swept parameters at `t` are `start + t direction`.
#[derive(Debug, Clone)]
pub(super) struct Line {
    pub start: Vec<f64>,
    pub direction: Vec<f64>,
    /// Between which `t` the brake may be asked for its systems.
    pub bounds: [f64; 2],
    /// Half of the difference in `t` from which derivatives are taken.
    pub difference: f64,
}

/// Makes the system at a place of a line.
pub(super) type MakeSystem<'a> = Box<dyn FnMut(f64) -> Result<SystemAt, Error> + 'a>;

impl<'a, B: UncertainBrake> Family<'a, B> {
    /// The system at values of the swept parameters.
    pub fn system(&self, values: &[f64]) -> Result<SecondOrder, Error> {
        let placed: Vec<(usize, f64)> = self.parameters.iter().map(|p| p.place).zip(values.iter().copied()).collect();
        self.brake.system_with(self.scene, &placed).map_err(|source| {
            let named: Vec<String> =
                self.parameters.iter().zip(values).map(|(p, value)| format!("{} = {value}", p.name)).collect();
            Error::Sweep { at: named.join(", "), source: source.into() }
        })
    }

    /// The spectra along a line.
    pub fn along(&'a self, line: Line) -> KeptSpectra<'a, MakeSystem<'a>> {
        let make: MakeSystem<'a> = Box::new(move |t| {
            let at = |t: f64| {
                let values = line.start.iter().zip(&line.direction).map(|(from, by)| from + t * by);
                self.system(&values.collect::<Vec<_>>())
            };
            let (below, above) = ((t - line.difference).max(line.bounds[0]), (t + line.difference).min(line.bounds[1]));
            let change = SystemChange { below: at(below)?, above: at(above)?, distance: above - below };
            Ok(SystemAt { system: at(t)?, change: Arc::new(change) })
        });
        KeptSpectra::new(make, self.solver)
    }
}
