//! A problem with reference eigenvalues, with which the eigenvalues and verdicts of a route are compared.

use cea::{CeaError, EigenSolver, Modes, QrSolver, Spectrum, Verdict, Workspace};
use linsys::SecondOrder;
use num_complex::Complex;
use serde::Serialize;

use crate::ValidationError;
use crate::conditioning::least_backward_error;
use crate::refine::{RefinedEigenvalue, refine, refine_all};
use crate::routes::nearest_pairs;

/// Largest |Re lambda| / |lambda| of a refined eigenvalue that counts as exactly neutral; equal to the accuracy of refinement.
const NEUTRAL_RATIO: f64 = 1e-18;
/// Largest |Im lambda| / |lambda| of a complex pair that may be a double real eigenvalue split by rounding; chosen.
const NEARLY_REAL_RATIO: f64 = 1e-7;

/// A system with reference eigenvalues.
pub struct ReferenceProblem {
    /// Name, which tells the difficulty.
    pub name: String,
    /// The system.
    pub system: SecondOrder,
    /// Refined eigenvalues of the structure with Im lambda >= 0; those that could not be refined are left out.
    pub reference: Vec<RefinedEigenvalue>,
}

/// The result of a route for a problem.
#[derive(Debug, Clone, Serialize)]
#[serde(untagged)]
pub enum RouteOutcome {
    /// The eigenvalues were judged.
    Judged(Judgement),
    /// The route could not solve the problem.
    Refused {
        /// The case.
        case: String,
        /// The route.
        route: &'static str,
        /// The reason.
        reason: String,
    },
}

/// Errors and verdicts of a route for a problem.
#[derive(Debug, Clone, Serialize)]
pub struct Judgement {
    /// The case.
    pub case: String,
    /// The route.
    pub route: &'static str,
    /// Number of eigenvalues judged.
    pub modes: usize,
    /// Largest relative error of an eigenvalue.
    pub max_error: f64,
    /// Largest relative error in units of condition number times machine epsilon.
    pub max_error_in_condition_epsilon: f64,
    /// Largest backward error: of each eigenvalue the least with which it is exact.
    pub max_backward_error: f64,
    /// Number of wrong verdicts among the decided ones.
    pub wrong_signs: usize,
    /// Number of stable or neutral modes with the verdict unstable.
    pub false_instabilities: usize,
    /// Number of modes with the verdict marginal.
    pub marginal: usize,
    /// Number of modes with the verdict undecided.
    pub undecided: usize,
    /// Number of modes whose stability the test `Re lambda > 0` gets wrong.
    pub wrong_by_bare_sign: usize,
}

impl RouteOutcome {
    /// The case.
    pub fn case(&self) -> &str {
        let (Self::Judged(Judgement { case, .. }) | Self::Refused { case, .. }) = self;
        case
    }

    /// The route.
    pub fn route(&self) -> &'static str {
        let (Self::Judged(Judgement { route, .. }) | Self::Refused { route, .. }) = self;
        route
    }
}

impl ReferenceProblem {
    /// A problem whose reference is refined from the eigenvalues of QrSolver, without the eigenvalues of internal states.
    ///
    /// # Errors
    /// Those of the solver and of [`Modes::classify`].
    pub fn new(name: String, system: SecondOrder) -> Result<Self, ValidationError> {
        let (lambdas, _) = structural_eigenvalues(&system)?;
        let reference = refine_all(&system, &lambdas)
            .unwrap_or_else(|_| lambdas.iter().filter_map(|&lambda| refine(&system, lambda).ok()).collect());
        Ok(Self { name, system, reference })
    }

    /// Compares eigenvalues with verdicts with the reference.
    pub(crate) fn compare(&self, route: &'static str, found: &[(Complex<f64>, Verdict)]) -> Judgement {
        let wanted: Vec<_> = self.reference.iter().map(|r| r.lambda).collect();
        let lambdas: Vec<_> = found.iter().map(|f| f.0).collect();
        let mut judged = Judgement {
            case: self.name.clone(),
            route,
            modes: wanted.len(),
            max_error: 0.0,
            max_error_in_condition_epsilon: 0.0,
            max_backward_error: 0.0,
            wrong_signs: 0,
            false_instabilities: 0,
            marginal: 0,
            undecided: 0,
            wrong_by_bare_sign: 0,
        };
        let places = nearest_pairs(&wanted, &lambdas);
        for (refined, at) in self.reference.iter().zip(places) {
            let Some((lambda, verdict)) = at.map(|at| found[at]) else {
                (judged.max_error, judged.max_error_in_condition_epsilon) = (f64::INFINITY, f64::INFINITY);
                continue;
            };
            let exact = refined.lambda;
            if exact == Complex::default() {
                // The relative error of an exactly zero eigenvalue is 0 where it is found as zero, and infinite otherwise.
                judged.max_error = if lambda == exact { judged.max_error } else { f64::INFINITY };
                continue;
            }
            let error = (lambda - exact).norm() / exact.norm();
            let is_unstable = exact.re > NEUTRAL_RATIO * exact.norm();
            let is_stable = exact.re < -NEUTRAL_RATIO * exact.norm();
            judged.max_error = judged.max_error.max(error);
            judged.max_error_in_condition_epsilon =
                judged.max_error_in_condition_epsilon.max(error / (refined.condition * f64::EPSILON));
            judged.max_backward_error = judged.max_backward_error.max(least_backward_error(&self.system, lambda));
            judged.wrong_by_bare_sign += usize::from((lambda.re > 0.0) != is_unstable);
            match verdict {
                Verdict::Unstable => {
                    judged.false_instabilities += usize::from(!is_unstable);
                    judged.wrong_signs += usize::from(!is_unstable);
                }
                Verdict::Stable => judged.wrong_signs += usize::from(!is_stable),
                Verdict::Undecided { .. } => judged.undecided += 1,
                Verdict::Marginal { .. } => judged.marginal += 1,
            }
        }
        judged
    }
}

/// Eigenvalues of the structure with Im lambda >= 0 by QrSolver, and the spectrum that they are of. Of a pair that may be a double
/// real eigenvalue split by rounding both members are included.
pub(crate) fn structural_eigenvalues(system: &SecondOrder) -> Result<(Vec<Complex<f64>>, Spectrum), CeaError> {
    let mut work = Workspace::default();
    let spectrum = QrSolver.eigenvalues(system, &mut work)?;
    let modes = Modes::classify(system, &spectrum, &mut work)?;
    let nearly_real = modes.oscillatory.iter().filter(|l| l.im <= NEARLY_REAL_RATIO * l.norm()).map(|l| l.conj());
    let real = modes.real.iter().map(|&l| Complex::from(l));
    Ok((modes.oscillatory.iter().copied().chain(nearly_real).chain(real).collect(), spectrum))
}
