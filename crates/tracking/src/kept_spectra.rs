//! Spectra over one real parameter, each computed where it is asked for the first time, and kept.

use std::collections::BTreeMap;
use std::sync::Arc;

use cea::{CeaError, Counters, EigenSolver, Eigentriple, Modes, Workspace};
use linsys::SecondOrder;
use num_complex::Complex;

use crate::TrackingError;
use crate::branch::{BranchPoint, Branches, OrderedParameter, RefinedPoint};

/// Most spectra; chosen: branches that need more count as unresolvable.
const MOST_SPECTRA: usize = 20_000;
/// Largest |lambda|, as a fraction of the largest |Im lambda|, of a rigid motion, which rounding may give a frequency; chosen: a double zero becomes the
/// root of a rounding.
const RIGID: f64 = 1e-7;

/// A system at one parameter p, and how it changes with p.
#[derive(Debug, Clone)]
pub struct SystemAt {
    /// The system.
    pub system: SecondOrder,
    /// Change of the system with p, which systems may share.
    pub change: Arc<SystemChange>,
}

/// Two systems whose difference stands for the derivative by the parameter: `d Q / d p = (Q_above - Q_below) / distance`.
#[derive(Debug, Clone)]
pub struct SystemChange {
    /// System of Q_below.
    pub below: SecondOrder,
    /// System of Q_above.
    pub above: SecondOrder,
    /// Distance of the two parameters, > 0.
    pub distance: f64,
}

impl SystemChange {
    /// The change of `Q_0 + p Q_1`, from Q_1: the same at every parameter.
    pub fn linear(by_parameter: SecondOrder) -> Self {
        Self { below: SecondOrder::zeros(by_parameter.order(), 0), above: by_parameter, distance: 1.0 }
    }
}

/// [`Branches`] of systems that a function makes from a number.
pub struct KeptSpectra<'a, F> {
    make: F,
    solver: &'a dyn EigenSolver,
    spectra: BTreeMap<OrderedParameter, KeptSpectrum>,
    /// Number of modes in the band at every parameter; if not given, the number at the first parameter that is asked for. Where modes may become overdamped
    /// it binds nothing.
    modes: Option<usize>,
    allows_overdamping: bool,
    /// Least and largest Im lambda of the modes that are kept, rad/s.
    band: [f64; 2],
    work: Workspace,
}

/// Spectrum at one parameter: all modes in the band.
struct KeptSpectrum {
    at: SystemAt,
    /// Modes outside of the band that grow.
    growing_outside: usize,
    lambdas: Vec<Complex<f64>>,
    rates: Vec<Option<Complex<f64>>>,
}

impl<'a, F> KeptSpectra<'a, F> {
    /// No spectra yet. As many modes must oscillate at every parameter as at the first one asked for.
    pub fn new(make: F, solver: &'a dyn EigenSolver) -> Self {
        Self {
            make,
            solver,
            spectra: BTreeMap::new(),
            modes: None,
            allows_overdamping: false,
            band: [0.0, f64::INFINITY],
            work: Workspace::default(),
        }
    }

    /// Spectra in which `modes` modes must oscillate at every parameter.
    #[must_use]
    pub fn with_modes(self, modes: usize) -> Self {
        Self { modes: Some(modes), ..self }
    }

    /// Spectra in which modes may become overdamped and oscillate again: the number of modes may differ from parameter to parameter. Rigid motions are
    /// not counted as modes.
    #[must_use]
    pub fn with_overdamping(self) -> Self {
        Self { allows_overdamping: true, ..self }
    }

    /// Spectra of the modes with Im lambda in this band, rad/s, alone; as modes may leave it and come back, their number may differ from parameter to
    /// parameter.
    #[must_use]
    pub fn in_band(self, band: [f64; 2]) -> Self {
        Self { allows_overdamping: true, band, ..self }
    }

    /// Counts of what was computed so far.
    #[must_use]
    pub fn counters(&self) -> Counters {
        self.work.counters
    }

    /// The spectrum at a parameter, computed where it is asked for the first time.
    fn spectrum<E>(&mut self, at: f64) -> Result<&mut KeptSpectrum, E>
    where
        F: FnMut(f64) -> Result<SystemAt, E>,
        E: From<TrackingError>,
    {
        let unresolved = TrackingError::Unresolved { at, spectra: self.spectra.len() };
        if !self.spectra.contains_key(&OrderedParameter(at)) {
            if self.spectra.len() >= MOST_SPECTRA {
                return Err(unresolved.into());
            }
            let made = (self.make)(at)?;
            let mut all = oscillatory(&made.system, self.solver, &mut self.work).map_err(TrackingError::from)?;
            if self.allows_overdamping {
                let fastest = all.iter().map(|lambda| lambda.im).fold(0.0, f64::max);
                all.retain(|lambda| lambda.norm() > RIGID * fastest);
            }
            let is_inside = |lambda: &Complex<f64>| (self.band[0]..=self.band[1]).contains(&lambda.im);
            let (lambdas, outside): (Vec<_>, Vec<_>) = all.into_iter().partition(is_inside);
            let growing_outside = outside.iter().filter(|lambda| lambda.re >= 0.0).count();
            let expected = *self.modes.get_or_insert(lambdas.len());
            if lambdas.len() != expected && !self.allows_overdamping {
                return Err(TrackingError::ModeCount { at, found: lambdas.len(), expected }.into());
            }
            let rates = vec![None; lambdas.len()];
            self.spectra.insert(OrderedParameter(at), KeptSpectrum { at: made, growing_outside, lambdas, rates });
        }
        self.spectra.get_mut(&OrderedParameter(at)).ok_or(unresolved.into())
    }
}

fn oscillatory(
    system: &SecondOrder,
    solver: &dyn EigenSolver,
    work: &mut Workspace,
) -> Result<Vec<Complex<f64>>, CeaError> {
    let spectrum = solver.eigenvalues(system, work)?;
    Ok(Modes::classify(system, &spectrum, work)?.oscillatory)
}

impl SystemAt {
    /// An eigenvalue refined by its vectors, with its rate by the parameter.
    fn refined(&self, lambda: Complex<f64>, work: &mut Workspace) -> Result<RefinedPoint, CeaError> {
        let Self { system, change } = self;
        let triple = Eigentriple::new(system, lambda, work)?;
        let difference = change.above.dynamic_stiffness(lambda) - change.below.dynamic_stiffness(lambda);
        let by_parameter = triple.left.dotc(&(difference * &triple.right)) / change.distance;
        let rate = -by_parameter / triple.slope;
        Ok(RefinedPoint { lambda: triple.refined(system), rate, bound: triple.rounding() })
    }
}

impl<F, E> Branches for KeptSpectra<'_, F>
where
    F: FnMut(f64) -> Result<SystemAt, E>,
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
        let refined = self.spectrum(at).map(|spectrum| spectrum.at.refined(lambda, &mut work));
        self.work = work;
        Ok(refined?.map_err(TrackingError::from)?)
    }

    fn growing_outside(&mut self, at: f64) -> Result<usize, E> {
        Ok(self.spectrum(at)?.growing_outside)
    }

    fn known_between(&self, from: f64, to: f64) -> Vec<f64> {
        self.spectra.range(OrderedParameter(from)..=OrderedParameter(to)).map(|(at, _)| at.0).collect()
    }
}
