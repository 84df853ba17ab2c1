//! Shared Coulomb friction as what it is, a family of systems with one parameter.
//!
//! With one draw for all contacts and Amontons-Coulomb friction, `K(mu) = K_0 + mu K_1` and M and C do not change: the
//! eigenvalues are analytic functions of mu but where two of them coalesce. The
//! derivative of an eigenvalue, `lambda' = -(psi^H K_1 phi) / (psi^H Q'(lambda) phi)` (Lancaster, Numer. Math. 6, 1964),
//! is computed where it is asked for.

use std::collections::BTreeMap;

use cea::{Counters, EigenSolver, Workspace, left_vector, right_vector};
use linsys::SecondOrder;
use nalgebra::DMatrix;
use num_complex::Complex;
use osc_model::{Lateral, Preload};
use tracking::{BranchPoint, Branches, Onsets, RefinedPoint, find_onsets};

use super::EstimatorError;
use crate::case::{Draws, Law};
use crate::study::{FrictionDraw, Plan, Sample, Scene};

/// Spectra after which branches count as unresolvable; chosen.
const MOST_SPECTRA: usize = 20_000;
/// Shortest step in mu: what is still open there stays open; chosen.
pub(super) const SMALLEST_STEP: f64 = 1e-10;
/// Rounding errors in one evaluation of `Q(lambda) phi`, in units of epsilon times the size of its terms; chosen.
const ROUNDINGS: f64 = 8.0;

/// `lambda^2 M + lambda C + K_0 + mu K_1`.
pub struct OneParameterFamily<'a> {
    solver: &'a dyn EigenSolver,
    system: SecondOrder,
    constant: DMatrix<f64>,
    linear: DMatrix<f64>,
    spectra: BTreeMap<Coefficient, BranchSpectrum>,
    work: Workspace,
}

/// All modes at one mu, ascending in frequency.
#[derive(Debug, Clone)]
struct BranchSpectrum {
    lambdas: Vec<Complex<f64>>,
    rates: Vec<Option<Complex<f64>>>,
}

/// Friction coefficients, which are never NaN, in their order.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Coefficient(f64);

impl Eq for Coefficient {}

impl PartialOrd for Coefficient {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Coefficient {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl<'a> OneParameterFamily<'a> {
    /// The family of a scene.
    ///
    /// # Errors
    /// [`EstimatorError::NotOneParameter`] for a law with a speed in it, separate draws, lateral friction that depends on
    /// speed, or a preload that follows friction.
    pub fn new(plan: &Plan, scene: &Scene, solver: &'a dyn EigenSolver) -> Result<Self, EstimatorError> {
        let refuse = |needed, found: String| Err(EstimatorError::NotOneParameter { needed, found });
        if scene.key.law != Law::AmontonsCoulomb {
            return refuse("Amontons-Coulomb friction", format!("{:?}", scene.key.law));
        }
        if plan.case.readings.draws != Draws::Shared {
            return refuse("one draw shared by all contacts", "a draw for each".into());
        }
        if plan.case.readings.lateral == Lateral::Vector {
            return refuse("lateral friction without a speed in it", "the dashpot mu N0 / v".into());
        }
        if matches!(plan.case.readings.preload, Preload::Equilibrium(_)) {
            return refuse("a preload that no sample can lose", "the static equilibrium".into());
        }
        let at = |mu: f64| {
            let mut system = SecondOrder::zeros(1, 0);
            plan.linearise(scene, &with_mu(plan, mu), &mut system).map(|()| system)
        };
        let (system, one) = (at(0.0)?, at(1.0)?);
        let constant = system.k.clone();
        let linear = one.k - &constant;
        Ok(Self { solver, system, constant, linear, spectra: BTreeMap::new(), work: Workspace::default() })
    }

    /// The system at `mu`.
    pub fn system(&mut self, mu: f64) -> &SecondOrder {
        self.system.k.zip_zip_apply(&self.constant, &self.linear, |k, constant, linear| *k = constant + mu * linear);
        &self.system
    }

    /// K_1.
    pub fn linear(&self) -> &DMatrix<f64> {
        &self.linear
    }

    /// What was computed so far.
    pub fn counters(&self) -> Counters {
        self.work.counters
    }

    /// Every onset between two coefficients.
    ///
    /// # Errors
    /// Those of the spectra; [`EstimatorError::Unresolved`], and [`TrackingError`](tracking::TrackingError) where the onsets
    /// contradict the spectra.
    pub fn onsets(&mut self, from: f64, to: f64) -> Result<Onsets, EstimatorError> {
        find_onsets(self, from, to, SMALLEST_STEP)
    }

    /// The spectrum at `mu`, computed where it is asked for the first time.
    fn spectrum(&mut self, mu: f64) -> Result<&BranchSpectrum, EstimatorError> {
        if !self.spectra.contains_key(&Coefficient(mu)) {
            if self.spectra.len() >= MOST_SPECTRA {
                return Err(EstimatorError::Unresolved { mu, spectra: self.spectra.len() });
            }
            self.system(mu);
            let spectrum = self.solver.eigenvalues(&self.system, &mut self.work)?;
            let lambdas: Vec<_> = spectrum.oscillatory().collect();
            if lambdas.len() != self.system.order() {
                return Err(EstimatorError::NotOscillating { mu, real: spectrum.real().count() });
            }
            let rates = vec![None; lambdas.len()];
            self.spectra.insert(Coefficient(mu), BranchSpectrum { lambdas, rates });
        }
        self.spectra.get(&Coefficient(mu)).ok_or(EstimatorError::Unresolved { mu, spectra: self.spectra.len() })
    }
}

impl Branches for OneParameterFamily<'_> {
    type Error = EstimatorError;

    /// # Errors
    /// Those of the solver; [`EstimatorError::NotOscillating`], [`EstimatorError::Unresolved`].
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
        if let Some(spectrum) = self.spectra.get_mut(&Coefficient(mu)) {
            spectrum.rates[index] = Some(rate);
        }
        Ok(BranchPoint { lambda, rate })
    }

    fn refined(&mut self, mu: f64, lambda: Complex<f64>) -> Result<RefinedPoint, EstimatorError> {
        self.system(mu);
        let right = right_vector(&self.system, lambda, &mut self.work)?;
        let left = left_vector(&self.system, lambda, &mut self.work)?;
        let slope = left.dotc(&(self.system.dynamic_stiffness_derivative(lambda) * &right));
        let by_mu = left.dotc(&(self.linear.map(Complex::from) * &right));
        let residual = left.dotc(&(self.system.dynamic_stiffness(lambda) * &right));
        let l = lambda.norm();
        let size = l * l * self.system.m.norm() + l * self.system.c.norm() + self.system.k.norm();
        Ok(RefinedPoint {
            lambda: lambda - residual / slope,
            rate: -by_mu / slope,
            bound: ROUNDINGS * f64::EPSILON * size / slope.norm(),
        })
    }

    fn known_between(&self, from: f64, to: f64) -> Vec<f64> {
        self.spectra.range(Coefficient(from)..=Coefficient(to)).map(|(mu, _)| mu.0).collect()
    }
}

/// The median draw but for its coefficient.
fn with_mu(plan: &Plan, mu: f64) -> Sample {
    let median = Sample::median(&plan.case);
    Sample::shared(FrictionDraw { mu, lateral_mu: mu, ..*median.contact(0) }, median.speed_quantile)
}
