//! A family of systems with one parameter, such as shared Coulomb friction with its coefficient mu.
//!
//! Where all matrices are affine in the parameter, `Q(lambda) = Q_0(lambda) + mu Q_1(lambda)`, the eigenvalues are analytic
//! functions of mu but where two of them coalesce.

use std::sync::Arc;

use cea::{Counters, EigenSolver};
use linsys::SecondOrder;
use montecarlo::Distribution;
use num_complex::Complex;
use tracking::{BranchPoint, Branches, KeptSpectra, Onsets, RefinedPoint, SystemAt, SystemChange, find_onsets};

use super::EstimatorError;
use crate::{Scene, UncertainBrake};

/// Shortest step in mu; chosen: one that is still open stays open, and adds the probability in it to the error of an occurrence.
pub(super) const SMALLEST_STEP: f64 = 1e-10;
/// Largest distance of matrices from affine in the parameter, relative to their largest entry: rounding of a few operations.
const AFFINE_ROUNDING: f64 = 1e-13;
/// Probabilities of the values within the distribution at which matrices are compared with affine ones; chosen: a function that
/// repeats itself over simple fractions of the distribution is seen.
const PROBES: [f64; 2] = [0.3137, 0.7291];

/// Family of systems `Q_0(lambda) + mu Q_1(lambda)`, with the spectra computed so far.
pub struct OneParameterFamily<'a> {
    distribution: Distribution,
    /// System Q_0.
    constant: Arc<SecondOrder>,
    /// System Q_1, as the change of every system.
    change: Arc<SystemChange>,
    spectra: KeptSpectra<'a, MakeSystem>,
}

/// Function that makes the system at a value of the parameter.
type MakeSystem = Box<dyn FnMut(f64) -> Result<SystemAt, EstimatorError> + Send>;

impl<'a> OneParameterFamily<'a> {
    /// The family of a scene.
    ///
    /// # Errors
    /// [`EstimatorError::NotOneParameter`] for a scene whose systems are no affine function of one parameter, have internal
    /// states, or do not exist at 0, 1, 2 or somewhere in the distribution; for a plan with a threshold beyond the axis.
    pub fn new<B: UncertainBrake>(
        brake: &B,
        scene: &Scene,
        solver: &'a dyn EigenSolver,
    ) -> Result<Self, EstimatorError> {
        let Some(single) = brake.drawn_inputs().and_then(|drawn| drawn.single_parameter(scene)) else {
            let found = format!("another dependence in {}", brake.plan().source());
            return Err(EstimatorError::NotOneParameter { needed: "one uncertain parameter", found });
        };
        let threshold = brake.plan().threshold;
        if !threshold.is_axis() {
            // Its onsets are zeros of Re lambda.
            return Err(EstimatorError::NotOneParameter { needed: "the bare sign", found: threshold.to_string() });
        }
        let of_scene = &brake.plan().brake(scene).system;
        let assembled = |value: f64| -> Result<SecondOrder, crate::Error> {
            Ok(of_scene.assemble(&brake.operating_point(scene, &single.sample(value))?)?)
        };
        // Some of the values lie outside of the distribution, where the brake need not exist.
        let at = |value: f64| {
            assembled(value).map_err(|error| EstimatorError::NotOneParameter {
                needed: "a system at every value of the parameter",
                found: format!("none at {value}: {error}"),
            })
        };
        let (constant, mut linear) = (at(0.0)?, at(1.0)?);
        linear.m -= &constant.m;
        linear.c -= &constant.c;
        linear.k -= &constant.k;
        let distribution = single.distribution;
        let (from, to) = distribution.support();
        // Not at whole numbers alone: a sine may vanish at all of them.
        for value in [2.0, from, to].into_iter().chain(PROBES.map(|u| distribution.quantile(u))) {
            let found = at(value)?;
            if constant.states() + linear.states() + found.states() > 0 {
                let found = "internal states".into();
                return Err(EstimatorError::NotOneParameter { needed: "friction without internal states", found });
            }
            if !is_affine(&constant, &linear, value, &found) {
                let found = "a nonlinear dependence".into();
                return Err(EstimatorError::NotOneParameter { needed: "matrices affine in the parameter", found });
            }
        }
        let distribution = distribution.clone();
        let (order, constant, change) = (constant.order(), Arc::new(constant), Arc::new(SystemChange::linear(linear)));
        let (of_zero, of_all) = (Arc::clone(&constant), Arc::clone(&change));
        let make: MakeSystem = Box::new(move |mu| {
            Ok(SystemAt { system: affine(&of_zero, &of_all.above, mu), change: Arc::clone(&of_all) })
        });
        // The integral is over the sets of unstable modes, which have names where all modes oscillate.
        let spectra = KeptSpectra::new(make, solver).with_modes(order);
        Ok(Self { distribution, constant, change, spectra })
    }

    /// The distribution of the parameter.
    pub fn distribution(&self) -> Distribution {
        self.distribution.clone()
    }

    /// The system at a value of the parameter.
    pub fn system(&self, mu: f64) -> SecondOrder {
        affine(&self.constant, self.linear(), mu)
    }

    /// Derivative `d Q / d mu`, as a system.
    pub fn linear(&self) -> &SecondOrder {
        &self.change.above
    }

    /// Counters of the computations so far.
    pub fn counters(&self) -> Counters {
        self.spectra.counters()
    }

    /// The onsets between two values of the parameter, all of them.
    ///
    /// # Errors
    /// Those of the spectra; [`TrackingError`](tracking::TrackingError) where branches are not resolved, modes do not oscillate
    /// or the onsets contradict the spectra.
    pub fn onsets(&mut self, from: f64, to: f64) -> Result<Onsets, EstimatorError> {
        find_onsets(&mut self.spectra, from, to, SMALLEST_STEP)
    }
}

/// True if the matrices at a value are `constant + value linear`, but for rounding: the rounding of a difference of two systems grows
/// with the value by which the difference is multiplied.
fn is_affine(constant: &SecondOrder, linear: &SecondOrder, value: f64, found: &SecondOrder) -> bool {
    let expected = affine(constant, linear, value);
    let parts =
        [(&found.m, &constant.m, expected.m), (&found.c, &constant.c, expected.c), (&found.k, &constant.k, expected.k)];
    let growth = AFFINE_ROUNDING * value.abs().max(1.0);
    parts
        .into_iter()
        .all(|(found, constant, expected)| (found - expected).amax() <= growth * found.amax().max(constant.amax()))
}

/// The system `constant + mu linear`.
fn affine(constant: &SecondOrder, linear: &SecondOrder, mu: f64) -> SecondOrder {
    let mut system = constant.clone();
    system.m.zip_apply(&linear.m, |m, linear| *m += mu * linear);
    system.c.zip_apply(&linear.c, |c, linear| *c += mu * linear);
    system.k.zip_apply(&linear.k, |k, linear| *k += mu * linear);
    system
}

impl Branches for OneParameterFamily<'_> {
    type Error = EstimatorError;

    fn lambdas(&mut self, mu: f64) -> Result<&[Complex<f64>], EstimatorError> {
        self.spectra.lambdas(mu)
    }

    fn point(&mut self, mu: f64, index: usize) -> Result<BranchPoint, EstimatorError> {
        self.spectra.point(mu, index)
    }

    fn refined(&mut self, mu: f64, lambda: Complex<f64>) -> Result<RefinedPoint, EstimatorError> {
        self.spectra.refined(mu, lambda)
    }

    fn known_between(&self, from: f64, to: f64) -> Vec<f64> {
        self.spectra.known_between(from, to)
    }
}
