//! A family of systems with one parameter, such as shared Coulomb friction with its coefficient mu.
//!
//! Where all matrices are affine in the parameter, `Q(lambda) = Q_0(lambda) + mu Q_1(lambda)`, the eigenvalues are analytic
//! functions of mu except where two of them coalesce.

use std::collections::BTreeMap;

use cea::{Counters, EigenSolver, Workspace};
use linsys::SecondOrder;
use montecarlo::Distribution;
use num_complex::Complex;
use tracking::{BranchPoint, Branches, Onsets, OrderedParameter, RefinedPoint, TrackingError, find_onsets};

use super::EstimatorError;
use crate::study::{Scene, UncertainBrake};

/// Most spectra computed for one family; chosen.
const MOST_SPECTRA: usize = 20_000;
/// Shortest step in mu; chosen.
pub(super) const SMALLEST_STEP: f64 = 1e-10;
/// Largest deviation of matrices from an affine function of the parameter, relative to their largest entry; chosen: rounding
/// errors of a few operations.
const AFFINE_ROUNDING: f64 = 1e-13;

/// `Q_0(lambda) + mu Q_1(lambda)`.
pub struct OneParameterFamily<'a> {
    solver: &'a dyn EigenSolver,
    system: SecondOrder,
    distribution: Distribution,
    constant: SecondOrder,
    linear: SecondOrder,
    spectra: BTreeMap<OrderedParameter, BranchSpectrum>,
    work: Workspace,
}

/// All modes at one mu, ascending in frequency.
#[derive(Debug, Clone)]
struct BranchSpectrum {
    lambdas: Vec<Complex<f64>>,
    rates: Vec<Option<Complex<f64>>>,
}

impl<'a> OneParameterFamily<'a> {
    /// The family of a scene.
    ///
    /// # Errors
    /// [`EstimatorError::NotOneParameter`] for a scene whose operating points have internal states or are not an affine function
    /// of one parameter.
    pub fn new<B: UncertainBrake>(
        brake: &B,
        scene: &Scene,
        solver: &'a dyn EigenSolver,
    ) -> Result<Self, EstimatorError> {
        let Some(distribution) = brake.single_parameter(scene) else {
            let found = format!("another dependence in {}", brake.plan().source());
            return Err(EstimatorError::NotOneParameter { needed: "one uncertain parameter", found });
        };
        let of_scene = &brake.plan().brake(scene).system;
        let at = |value: f64| -> Result<SecondOrder, EstimatorError> {
            let point = brake.operating_point(scene, &brake.with_parameter(scene, value))?;
            Ok(of_scene.assemble(&point).map_err(crate::Error::from)?)
        };
        let (constant, mut linear) = (at(0.0)?, at(1.0)?);
        let bent = at(2.0)?;
        if constant.states() + linear.states() + bent.states() > 0 {
            let found = "internal states".into();
            return Err(EstimatorError::NotOneParameter { needed: "friction without internal states", found });
        }
        linear.m -= &constant.m;
        linear.c -= &constant.c;
        linear.k -= &constant.k;
        let pairs =
            [(&bent.m, &constant.m, &linear.m), (&bent.c, &constant.c, &linear.c), (&bent.k, &constant.k, &linear.k)];
        let is_affine = pairs.into_iter().all(|(bent, constant, linear)| {
            (bent - constant - linear * 2.0).amax() <= AFFINE_ROUNDING * bent.amax().max(constant.amax())
        });
        if !is_affine {
            let found = "a nonlinear dependence".into();
            return Err(EstimatorError::NotOneParameter { needed: "matrices affine in the parameter", found });
        }
        let (system, distribution) = (constant.clone(), distribution.clone());
        let spectra = BTreeMap::new();
        Ok(Self { solver, distribution, system, constant, linear, spectra, work: Workspace::default() })
    }

    /// The distribution of the parameter.
    pub fn distribution(&self) -> Distribution {
        self.distribution.clone()
    }

    /// The system at a value of the parameter.
    pub fn system(&mut self, mu: f64) -> &SecondOrder {
        let Self { system, constant, linear, .. } = self;
        system.m.zip_zip_apply(&constant.m, &linear.m, |m, constant, linear| *m = constant + mu * linear);
        system.c.zip_zip_apply(&constant.c, &linear.c, |c, constant, linear| *c = constant + mu * linear);
        system.k.zip_zip_apply(&constant.k, &linear.k, |k, constant, linear| *k = constant + mu * linear);
        system
    }

    /// `d Q / d mu`, as a system.
    pub fn linear(&self) -> &SecondOrder {
        &self.linear
    }

    /// Numbers of computations so far.
    pub fn counters(&self) -> Counters {
        self.work.counters
    }

    /// Every onset between two coefficients.
    ///
    /// # Errors
    /// Those of [`Branches::lambdas`], and [`TrackingError`] where the onsets contradict the spectra.
    pub fn onsets(&mut self, from: f64, to: f64) -> Result<Onsets, EstimatorError> {
        find_onsets(self, from, to, SMALLEST_STEP)
    }

    /// The spectrum at `mu`, computed when it is asked for the first time.
    fn spectrum(&mut self, mu: f64) -> Result<&mut BranchSpectrum, EstimatorError> {
        let unresolved = TrackingError::Unresolved { at: mu, spectra: self.spectra.len() };
        if !self.spectra.contains_key(&OrderedParameter(mu)) {
            if self.spectra.len() >= MOST_SPECTRA {
                return Err(unresolved.into());
            }
            self.system(mu);
            let spectrum = self.solver.eigenvalues(&self.system, &mut self.work)?;
            let lambdas: Vec<_> = spectrum.oscillatory().collect();
            if lambdas.len() != self.system.order() {
                return Err(EstimatorError::NotOscillating { mu, real: spectrum.real().count() });
            }
            let rates = vec![None; lambdas.len()];
            self.spectra.insert(OrderedParameter(mu), BranchSpectrum { lambdas, rates });
        }
        Ok(self.spectra.get_mut(&OrderedParameter(mu)).ok_or(unresolved)?)
    }
}

impl Branches for OneParameterFamily<'_> {
    type Error = EstimatorError;

    /// # Errors
    /// Those of the solver; [`EstimatorError::NotOscillating`], [`TrackingError::Unresolved`].
    fn lambdas(&mut self, mu: f64) -> Result<&[Complex<f64>], EstimatorError> {
        Ok(&self.spectrum(mu)?.lambdas)
    }

    fn point(&mut self, mu: f64, index: usize) -> Result<BranchPoint, EstimatorError> {
        let spectrum = self.spectrum(mu)?;
        let lambda = spectrum.lambdas[index];
        if let Some(rate) = spectrum.rates[index] {
            return Ok(BranchPoint { lambda, rate });
        }
        let rate = self.refined(mu, lambda)?.rate;
        self.spectrum(mu)?.rates[index] = Some(rate);
        Ok(BranchPoint { lambda, rate })
    }

    fn refined(&mut self, mu: f64, lambda: Complex<f64>) -> Result<RefinedPoint, EstimatorError> {
        self.system(mu);
        Ok(RefinedPoint::new(&self.system, &self.linear.dynamic_stiffness(lambda), lambda, &mut self.work)?)
    }

    fn known_between(&self, from: f64, to: f64) -> Vec<f64> {
        self.spectra.range(OrderedParameter(from)..=OrderedParameter(to)).map(|(mu, _)| mu.0).collect()
    }
}
