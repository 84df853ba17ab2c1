//! The seam: what fails where in standard normal space.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::Error;
use crate::vector::{norm, unit};

/// A mode of failure at a point.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Mode {
    /// Margin by which the mode fails: above zero it fails, below it does not. Any unit, continuous in u where the mode exists.
    pub margin: f64,
    /// Growth rate of the mode, 1/s; of what is no vibration any number that tells one mode from another at the same point, as `omega`.
    pub growth: f64,
    /// Angular frequency of the mode, rad/s.
    pub omega: f64,
}

impl Mode {
    /// The mode of the largest margin, the last of several such modes; where margins are NaN a mode with such a margin; `None` without modes.
    pub fn worst(modes: impl IntoIterator<Item = Self>) -> Option<Self> {
        let order = |a: &Self, b: &Self| a.margin.is_nan().cmp(&b.margin.is_nan()).then(a.margin.total_cmp(&b.margin));
        modes.into_iter().max_by(order)
    }
}

/// A system of d independent standard normal inputs u that fails where one of its modes has a margin above zero.
pub trait LimitState: Sync {
    /// Error of an evaluation, and of a search ([`Error`](crate::Error) becomes it).
    type Error: From<crate::Error> + Send;

    /// Number d of inputs, >= 1.
    fn dimensions(&self) -> usize;

    /// The modes at `u`, of length d, in any order: at least the mode of the largest margin.
    ///
    /// # Errors
    /// A point that cannot be evaluated.
    fn modes(&self, u: &[f64]) -> Result<Vec<Mode>, Self::Error>;

    /// The modes at several points, in their order. A system that evaluates several at once for less overrides it.
    ///
    /// # Errors
    /// As [`LimitState::modes`].
    fn modes_of_all(&self, points: &[Vec<f64>]) -> Result<Vec<Vec<Mode>>, Self::Error> {
        points.iter().map(|u| self.modes(u)).collect()
    }

    /// The gradient, length d, of the margin of a mode that [`LimitState::modes`] found at `u`.
    ///
    /// # Errors
    /// As [`LimitState::modes`].
    fn gradient(&self, u: &[f64], mode: &Mode) -> Result<Vec<f64>, Self::Error>;

    /// Ranges of the only input of a system, in standard deviations, in all of which it is proven that nothing fails. Default: none is.
    fn proven(&self) -> Vec<[f64; 2]> {
        Vec::new()
    }
}

/// A limit state whose evaluations are counted.
pub(crate) struct Counted<'a, L> {
    of: &'a L,
    evaluations: AtomicU64,
}

impl<'a, L: LimitState> Counted<'a, L> {
    pub fn new(of: &'a L) -> Self {
        Self { of, evaluations: AtomicU64::new(0) }
    }

    pub fn evaluations(&self) -> u64 {
        self.evaluations.load(Ordering::Relaxed)
    }

    pub fn dimensions(&self) -> usize {
        self.of.dimensions()
    }

    pub fn proven(&self) -> Vec<[f64; 2]> {
        self.of.proven()
    }

    /// The mode of the largest margin.
    pub fn worst(&self, u: &[f64]) -> Result<Mode, L::Error> {
        self.evaluations.fetch_add(1, Ordering::Relaxed);
        Ok(worst(self.of.modes(u)?)?)
    }

    /// The mode of the largest margin at each point.
    pub fn worst_of_all(&self, points: &[Vec<f64>]) -> Result<Vec<Mode>, L::Error> {
        self.evaluations.fetch_add(points.len() as u64, Ordering::Relaxed);
        let worst = self.of.modes_of_all(points)?.into_iter().map(worst).collect::<Result<_, Error>>()?;
        Ok(worst)
    }

    /// The direction in which the margin of a mode grows fastest, of length 1, and how fast; `None` where the margin has no such direction.
    pub fn steepest(&self, u: &[f64], mode: &Mode) -> Result<Option<(Vec<f64>, f64)>, L::Error> {
        if !mode.margin.is_finite() {
            return Ok(None);
        }
        let gradient = self.of.gradient(u, mode)?;
        let slope = norm(&gradient);
        Ok(unit(gradient).map(|direction| (direction, slope)))
    }
}

/// The mode of the largest margin; without modes a mode that is infinitely far from failure.
fn worst(modes: Vec<Mode>) -> Result<Mode, Error> {
    match Mode::worst(modes) {
        Some(mode) if mode.margin.is_nan() => Err(Error::NoMargin { omega: mode.omega }),
        Some(mode) => Ok(mode),
        None => Ok(Mode { margin: f64::NEG_INFINITY, growth: f64::NEG_INFINITY, omega: 0.0 }),
    }
}
