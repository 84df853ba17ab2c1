//! Onsets and root locus of the systems that a function makes from one real parameter.

use std::collections::BTreeMap;

use cea::{CeaError, EigenSolver, Modes, QrSolver, Workspace};
use linsys::SecondOrder;
use num_complex::Complex;

use crate::TrackingError;
use crate::branch::{BranchPoint, Branches, OrderedParameter, RefinedPoint};
use crate::locus::{RootLocus, root_locus};
use crate::onset::{Onsets, find_onsets};

/// Most spectra computed on one interval; chosen.
const MOST_SPECTRA: usize = 20_000;
/// Step h of the central difference (Q(p + h) - Q(p - h)) / 2 h, as a part of the interval; chosen near the cube root of machine
/// epsilon, where the truncation error h^2 and the rounding error epsilon / h are about equal.
const PARAMETER_DIFFERENCE: f64 = 1e-5;
/// Shortest step, as a part of the interval; chosen: with derivatives by differences, shorter steps tell no more branches apart.
const SHORTEST_PARAMETER_STEP: f64 = 1e-9;

/// Every onset between two values of the parameter: the parameter, the frequency and the direction in which an eigenvalue of
/// `system` crosses the imaginary axis. Steps of 1e-9 of the interval in which a mode only touches the axis are listed as
/// unresolved.
///
/// All modes must oscillate in the whole interval. An eigenvalue must not stay on the imaginary axis, as those of undamped
/// systems do: it has no onset.
///
/// ```
/// use linsys::SecondOrder;
/// use nalgebra::dmatrix;
/// use tracking::{TrackingError, onsets};
///
/// // The second mass is damped less and less.
/// let system = |p: f64| -> Result<SecondOrder, TrackingError> {
///     let c = dmatrix![0.1, 0.0; 0.0, 0.3 - p];
///     Ok(SecondOrder::new(dmatrix![1.0, 0.0; 0.0, 1.0], c, dmatrix![1.0, 0.0; 0.0, 4.0])?)
/// };
/// let found = onsets(system, 0.0, 1.0)?.onsets;
/// assert!((found[0].at - 0.3).abs() < 1e-12 && (found[0].omega - 2.0).abs() < 1e-12);
/// assert!(found.len() == 1 && found[0].destabilises);
/// # Ok::<(), TrackingError>(())
/// ```
///
/// # Errors
/// Those of `system`; [`TrackingError`] for what the search, the solver or the interval cannot do.
pub fn onsets<E: From<TrackingError>>(
    system: impl FnMut(f64) -> Result<SecondOrder, E>,
    from: f64,
    to: f64,
) -> Result<Onsets, E> {
    let mut family = SystemFamily::new(system, from, to);
    find_onsets(&mut family, from, to, SHORTEST_PARAMETER_STEP * (to - from))
}

/// The root locus of `system` between two values of the parameter: branches as far as their links are clear, and the steps in
/// which branches may have been exchanged.
///
/// All modes must oscillate in the whole interval.
///
/// # Errors
/// As [`onsets`].
pub fn branches<E: From<TrackingError>>(
    system: impl FnMut(f64) -> Result<SecondOrder, E>,
    from: f64,
    to: f64,
) -> Result<RootLocus, E> {
    let mut family = SystemFamily::new(system, from, to);
    root_locus(&mut family, from, to, SHORTEST_PARAMETER_STEP * (to - from))
}

/// Systems on an interval, with the spectra computed so far.
struct SystemFamily<F> {
    system: F,
    interval: [f64; 2],
    spectra: BTreeMap<OrderedParameter, SpectrumOfFamily>,
    /// Number of oscillating modes at the first parameter asked for.
    modes: Option<usize>,
    work: Workspace,
}

/// All modes at one parameter.
struct SpectrumOfFamily {
    system: SecondOrder,
    /// The systems at the two parameters of the central difference, and the distance of these parameters.
    neighbours: ([SecondOrder; 2], f64),
    lambdas: Vec<Complex<f64>>,
    rates: Vec<Option<Complex<f64>>>,
}

impl<F> SystemFamily<F> {
    fn new(system: F, from: f64, to: f64) -> Self {
        Self { system, interval: [from, to], spectra: BTreeMap::new(), modes: None, work: Workspace::default() }
    }

    /// The spectrum at a parameter, computed when it is asked for the first time.
    fn spectrum<E>(&mut self, at: f64) -> Result<&mut SpectrumOfFamily, E>
    where
        F: FnMut(f64) -> Result<SecondOrder, E>,
        E: From<TrackingError>,
    {
        let unresolved = TrackingError::Unresolved { at, spectra: self.spectra.len() };
        if !self.spectra.contains_key(&OrderedParameter(at)) {
            if self.spectra.len() >= MOST_SPECTRA {
                return Err(unresolved.into());
            }
            let system = (self.system)(at)?;
            let lambdas = oscillatory(&system, &mut self.work).map_err(TrackingError::from)?;
            let expected = *self.modes.get_or_insert(lambdas.len());
            if lambdas.len() != expected {
                return Err(TrackingError::ModeCount { at, found: lambdas.len(), expected }.into());
            }
            // The function need not be defined outside the interval.
            let [from, to] = self.interval;
            let step = PARAMETER_DIFFERENCE * (to - from);
            let (below, above) = ((at - step).max(from), (at + step).min(to));
            let neighbours = ([(self.system)(below)?, (self.system)(above)?], above - below);
            let rates = vec![None; lambdas.len()];
            self.spectra.insert(OrderedParameter(at), SpectrumOfFamily { system, neighbours, lambdas, rates });
        }
        self.spectra.get_mut(&OrderedParameter(at)).ok_or(unresolved.into())
    }
}

fn oscillatory(system: &SecondOrder, work: &mut Workspace) -> Result<Vec<Complex<f64>>, CeaError> {
    let spectrum = QrSolver.eigenvalues(system, work)?;
    Ok(Modes::classify(system, &spectrum, work)?.oscillatory)
}

impl SpectrumOfFamily {
    fn refined(&self, lambda: Complex<f64>, work: &mut Workspace) -> Result<RefinedPoint, CeaError> {
        let ([below, above], distance) = &self.neighbours;
        let change = above.dynamic_stiffness(lambda) - below.dynamic_stiffness(lambda);
        RefinedPoint::new(&self.system, &change.unscale(*distance), lambda, work)
    }
}

impl<F, E> Branches for SystemFamily<F>
where
    F: FnMut(f64) -> Result<SecondOrder, E>,
    E: From<TrackingError>,
{
    type Error = E;

    fn lambdas(&mut self, at: f64) -> Result<&[Complex<f64>], E> {
        Ok(&self.spectrum(at)?.lambdas)
    }

    fn point(&mut self, at: f64, index: usize) -> Result<BranchPoint, E> {
        let spectrum = self.spectrum(at)?;
        let lambda = spectrum.lambdas[index];
        if let Some(rate) = spectrum.rates[index] {
            return Ok(BranchPoint { lambda, rate });
        }
        let rate = self.refined(at, lambda)?.rate;
        self.spectrum(at)?.rates[index] = Some(rate);
        Ok(BranchPoint { lambda, rate })
    }

    fn refined(&mut self, at: f64, lambda: Complex<f64>) -> Result<RefinedPoint, E> {
        let mut work = std::mem::take(&mut self.work);
        let refined = self.spectrum(at)?.refined(lambda, &mut work).map_err(TrackingError::from);
        self.work = work;
        Ok(refined?)
    }

    fn known_between(&self, from: f64, to: f64) -> Vec<f64> {
        self.spectra.range(OrderedParameter(from)..=OrderedParameter(to)).map(|(at, _)| at.0).collect()
    }
}

#[cfg(test)]
mod tests;
