//! A change of the number of unstable modes, and the line on which it is looked for.

use cea::{CountedSpectrum, EigenSolver, Threshold, Workspace, grows_too_fast};
use linsys::SecondOrder;
use num_complex::Complex;

use super::measure::Measure;
use crate::Error;

/// Function that makes the system at a place of a line, 0 to 1.
pub(super) type SystemAtPlace<'a> = &'a (dyn Fn(f64) -> Result<SecondOrder, Error> + Sync);

/// Frequencies of the modes that are studied, and of modes that are followed because they may come in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Band {
    /// Im lambda from and to, rad/s.
    pub studied: [f64; 2],
    /// Im lambda from and to, rad/s, around `studied`.
    pub followed: [f64; 2],
    /// True of a reduced brake: a pair that grows faster than it oscillates is no mode there, as no basis of the modes of a band contains its shape.
    pub is_of_basis: bool,
}

/// A line through the parameters, from place 0 to 1.
#[derive(Clone, Copy)]
pub(super) struct Along<'a> {
    pub system: SystemAtPlace<'a>,
    pub solver: &'a dyn EigenSolver,
    pub threshold: Threshold,
    /// Frequencies of the modes that are studied; `None` where all are.
    pub band: Option<Band>,
    /// Largest |lambda| of a rigid motion, rad/s.
    pub rigid: f64,
}

/// Kind of change: what becomes unstable or stable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ChangeOf {
    /// A mode that oscillates: a pair of eigenvalues crosses the threshold, or leaves the axis where it met another.
    Flutter,
    /// A real eigenvalue crosses zero, or the growth rate above which growth counts.
    Divergence,
    /// A growing pair becomes two real eigenvalues, or these a pair.
    Exchange,
    /// A growing mode enters the band that is studied, or leaves it, by its frequency.
    Band,
}

impl ChangeOf {
    /// True if the mode oscillates at the change.
    pub(super) fn oscillates(self) -> bool {
        matches!(self, Self::Flutter | Self::Band)
    }
}

/// Difference of the number of unstable modes beyond a change from that before it, of one that `starts` an unstable mode or ends one.
pub(super) fn by(starts: bool) -> i64 {
    if starts { 1 } else { -1 }
}

/// A change of the number of unstable modes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Change {
    /// Place on the line, 0 to 1.
    pub at: f64,
    /// Bound or estimate of the error of `at`, as a fraction of the line.
    pub error: f64,
    /// Eigenvalue at the change, rad/s: of an exchange the double one.
    pub lambda: Complex<f64>,
    pub of: ChangeOf,
    /// Start of an unstable mode: if true one more mode is unstable beyond the change, if false one less; of an exchange, it is from
    /// flutter to divergence if true.
    pub starts: bool,
    /// True if two eigenvalues meet at the change: an exchange, or flutter of two modes that meet on the axis.
    pub is_double: bool,
}

/// Eigenvalues at a place of the line.
#[derive(Debug, Clone)]
pub(super) struct Place {
    /// Place on the line, 0 to 1.
    pub at: f64,
    pub counted: CountedSpectrum,
    /// True if the place was looked at for dips; steps between such places are not looked at again.
    pub is_settled: bool,
}

impl<'a> Along<'a> {
    pub fn new(
        system: SystemAtPlace<'a>,
        solver: &'a dyn EigenSolver,
        threshold: Threshold,
        band: Option<Band>,
    ) -> Self {
        Self { system, solver, threshold, band, rigid: 0.0 }
    }

    /// True if a mode with this eigenvalue, rad/s, is studied.
    pub fn is_studied(&self, lambda: Complex<f64>) -> bool {
        self.band.is_none_or(|Band { studied: [from, to], .. }| (from..=to).contains(&lambda.im))
    }

    /// Growing modes at a place that are studied, rad/s, by ascending `value`.
    pub fn growing(&self, place: &Place, value: impl Fn(Complex<f64>) -> f64) -> Vec<Complex<f64>> {
        let mut all: Vec<_> = place.counted.flutter.iter().copied().filter(|l| self.is_studied(*l)).collect();
        all.sort_by(|a, b| value(*a).total_cmp(&value(*b)));
        all
    }

    /// Growing modes at a place that are studied, rad/s, nearest to the threshold first.
    pub fn nearest_to_threshold(&self, place: &Place) -> Vec<Complex<f64>> {
        self.growing(place, |lambda| self.threshold.margin(lambda))
    }

    /// The distance of a growing mode from the end of the band that is nearest to its frequency; `None` without a band.
    pub fn nearest_end(&self, lambda: Complex<f64>) -> Option<Measure> {
        self.band.map(|Band { studied: [from, to], .. }| match (lambda.im - from).abs() < (lambda.im - to).abs() {
            true => Measure::Above(from),
            false => Measure::Below(to),
        })
    }

    /// The function of an oscillating mode that is zero at a change, with the eigenvalue there; `None` where it does not oscillate.
    pub fn crossed(&self, &Change { of, lambda, .. }: &Change) -> Option<(Measure, Complex<f64>)> {
        match of {
            ChangeOf::Flutter => Some((Measure::Margin(self.threshold), self.threshold.at_margin(0.0, lambda.im))),
            ChangeOf::Band => self.nearest_end(lambda).map(|end| (end, lambda)),
            ChangeOf::Divergence | ChangeOf::Exchange => None,
        }
    }

    /// Differences between the second place and the first: in the number of modes that flutter and are studied, of modes that flutter beside the
    /// band, and of real eigenvalues that diverge.
    pub fn difference(&self, [a, b]: [&Place; 2]) -> [i64; 3] {
        let counts = |place: &Place| {
            let CountedSpectrum { flutter, divergence, .. } = &place.counted;
            let studied = flutter.iter().filter(|lambda| self.is_studied(**lambda)).count();
            [studied, flutter.len() - studied, divergence.len()].map(|count| count as i64)
        };
        let (before, beyond) = (counts(a), counts(b));
        [0, 1, 2].map(|of| beyond[of] - before[of])
    }

    /// The eigenvalues at a place, counted.
    ///
    /// # Errors
    /// Those of the brake and of the solver.
    pub fn place(&self, at: f64) -> Result<Place, Error> {
        let (system, mut work) = ((self.system)(at)?, Workspace::default());
        let spectrum = self.solver.eigenvalues(&system, &mut work)?;
        let counted = CountedSpectrum::new(&self.threshold, &system, &spectrum, &mut work)?;
        let mut place = Place { at, counted, is_settled: false };
        place.put_rigid_motions_on_the_axis(self.rigid);
        if self.band.is_some_and(|band| band.is_of_basis) {
            place.counted.flutter.retain(|lambda| !grows_too_fast(*lambda));
        }
        Ok(place)
    }
}

impl Place {
    /// Counts eigenvalues as on the axis that are as small as a rigid motion, |lambda| up to `rigid`, rad/s.
    pub fn put_rigid_motions_on_the_axis(&mut self, rigid: f64) {
        let CountedSpectrum { flutter, divergence, marginal, below, .. } = &mut self.counted;
        marginal.extend(flutter.extract_if(.., |lambda| lambda.norm() <= rigid));
        marginal.extend(below.extract_if(.., |lambda| lambda.norm() <= rigid));
        marginal.extend(divergence.extract_if(.., |growth| *growth <= rigid).map(Complex::from));
    }

    /// Eigenvalues at the place, each with true if it is beyond the threshold, false if below; `None` on it.
    pub fn sides(&self) -> Vec<(Complex<f64>, Option<bool>)> {
        let CountedSpectrum { flutter, divergence, marginal, below, .. } = &self.counted;
        let beyond = flutter.iter().copied().chain(divergence.iter().map(|&re| Complex::from(re)));
        let beyond = beyond.map(|lambda| (lambda, Some(true)));
        let below = below.iter().map(|&lambda| (lambda, Some(false)));
        beyond.chain(below).chain(marginal.iter().map(|&lambda| (lambda, None))).collect()
    }
}
