//! The lattice at its worst: systems on which a solver or a verdict could go wrong, each judged against eigenvalues refined
//! in double-double.

use cea::{CeaError, EigenSolver, Modes, QrSolver, Verdict, Workspace, general, verdict};
use linsys::SecondOrder;
use nalgebra::DMatrix;
use num_complex::Complex;
use osc_model::{Lateral, Linearise};
use serde::Serialize;
use squeal::case::Law;
use squeal::study::{FrictionDraw, Plan, Sample, Scene};
use squeal::tracking::Onset;

use crate::ValidationError;
use crate::coalescence::ExceptionalPoint;
use crate::peers::judge_peers;
use crate::refine::{Refined, least_backward_error, refine, refine_all};
use crate::routes::matches;

/// Below this part of |lambda| a refined real part counts as exactly zero.
const NEUTRAL: f64 = 1e-18;

/// |Im lambda| / |lambda| of a pair that may be two real eigenvalues.
const NEARLY_REAL: f64 = 1e-7;

/// The certified routes of ours.
pub(crate) const STANDARD: &str = "QrSolver + verdict";
pub(crate) const GENERAL: &str = "general + certify";

/// A hard system with its refined eigenvalues.
pub struct HardCase {
    /// What is hard about it.
    pub name: String,
    /// The system.
    pub system: SecondOrder,
    /// Eigenvalues of its structure with Im lambda >= 0, those that could be refined.
    pub reference: Vec<Refined>,
}

/// What became of a hard case on one route.
#[derive(Debug, Clone, Serialize)]
#[serde(untagged)]
pub enum HardResult {
    /// Its eigenvalues were judged.
    Judged(Judged),
    /// It was refused.
    Refused {
        /// The case.
        case: String,
        /// The route.
        route: &'static str,
        /// Why.
        reason: String,
    },
}

/// How a route did on a hard case.
#[derive(Debug, Clone, Serialize)]
pub struct Judged {
    /// The case.
    pub case: String,
    /// The route.
    pub route: &'static str,
    /// Eigenvalues judged.
    pub modes: usize,
    /// Largest relative error of an eigenvalue.
    pub max_error: f64,
    /// Largest relative error in units of condition number times machine epsilon.
    pub max_error_in_condition_epsilon: f64,
    /// Largest backward error, the least one with which the number found is an eigenvalue.
    pub max_backward_error: f64,
    /// Decided verdicts that are wrong.
    pub wrong_signs: usize,
    /// Modes called unstable that are stable or neutral.
    pub false_instabilities: usize,
    /// Modes proven to be on the axis as far as doubles tell.
    pub marginal: usize,
    /// Modes within the bound of their error.
    pub undecided: usize,
    /// Modes that a bare `Re lambda > 0` puts on the wrong side.
    pub wrong_by_bare_sign: usize,
}

impl HardResult {
    /// The case.
    pub fn case(&self) -> &str {
        let (Self::Judged(Judged { case, .. }) | Self::Refused { case, .. }) = self;
        case
    }

    /// The route.
    pub fn route(&self) -> &'static str {
        let (Self::Judged(Judged { route, .. }) | Self::Refused { route, .. }) = self;
        route
    }
}

impl HardCase {
    /// A case whose eigenvalues are refined from those of QrSolver; internal states, which nobody asks for, left out.
    ///
    /// # Errors
    /// Those of the solver and of [`Modes::classify`].
    pub fn new(name: String, system: SecondOrder) -> Result<Self, ValidationError> {
        let (lambdas, _) = of_structure(&system)?;
        let one_by_one = || lambdas.iter().filter_map(|&l| refine(&system, l).ok()).collect();
        let reference = refine_all(&system, &lambdas).unwrap_or_else(|_| one_by_one());
        Ok(Self { name, system, reference })
    }

    /// Both certified routes on this case, or why one refused it, and what users script.
    pub fn judge(&self) -> Vec<HardResult> {
        let result = |route: &'static str, found: Result<Vec<(Complex<f64>, Verdict)>, CeaError>| match found {
            Ok(found) => HardResult::Judged(self.compare(route, &found)),
            Err(error) => HardResult::Refused { case: self.name.clone(), route, reason: error.to_string() },
        };
        let mut results = vec![result(STANDARD, self.standard()), result(GENERAL, self.general())];
        results.extend(judge_peers(self));
        results
    }

    /// The eigenvalues as a study sees them.
    fn standard(&self) -> Result<Vec<(Complex<f64>, Verdict)>, CeaError> {
        let mut work = Workspace::default();
        let (lambdas, scale) = of_structure(&self.system)?;
        lambdas.into_iter().map(|l| Ok((l, verdict(&self.system, l, scale, &mut work)?))).collect()
    }

    fn general(&self) -> Result<Vec<(Complex<f64>, Verdict)>, CeaError> {
        let mut work = Workspace::default();
        let spectrum = general::solve(&self.system, &mut work)?;
        let certified = general::certify(&self.system, &spectrum, &mut work)?;
        Ok(certified.eigenvalues.iter().map(|c| (c.lambda, c.verdict)).collect())
    }

    pub(crate) fn compare(&self, route: &'static str, found: &[(Complex<f64>, Verdict)]) -> Judged {
        let wanted: Vec<_> = self.reference.iter().map(|r| r.lambda).collect();
        let lambdas: Vec<_> = found.iter().map(|f| f.0).collect();
        let mut judged = Judged {
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
        let places = matches(&wanted, &lambdas);
        for (refined, at) in self.reference.iter().zip(places) {
            let Some((lambda, verdict)) = at.map(|at| found[at]) else {
                (judged.max_error, judged.max_error_in_condition_epsilon) = (f64::INFINITY, f64::INFINITY);
                continue;
            };
            let exact = refined.lambda;
            if exact == Complex::default() {
                // An exact zero has no relative error: it is found as such or missed.
                judged.max_error = if lambda == exact { judged.max_error } else { f64::INFINITY };
                continue;
            }
            let error = (lambda - exact).norm() / exact.norm();
            let is_unstable = exact.re > NEUTRAL * exact.norm();
            let is_stable = exact.re < -NEUTRAL * exact.norm();
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

/// QrSolver's eigenvalues of the structure with Im lambda >= 0, and the scale of their errors. Of two equal real ones that
/// rounding made a pair both are there.
fn of_structure(system: &SecondOrder) -> Result<(Vec<Complex<f64>>, f64), CeaError> {
    let mut work = Workspace::default();
    let spectrum = QrSolver.eigenvalues(system, &mut work)?;
    let modes = Modes::classify(system, &spectrum, &mut work)?;
    let nearly_real = modes.oscillatory.iter().filter(|l| l.im <= NEARLY_REAL * l.norm()).map(|l| l.conj());
    let real = modes.real.iter().map(|&l| Complex::from(l));
    Ok((modes.oscillatory.iter().copied().chain(nearly_real).chain(real).collect(), spectrum.scale))
}

/// The system of a scene with one draw in all contacts, its lateral coefficient given apart.
///
/// # Errors
/// A draw that the law refuses.
pub fn with_lateral(
    plan: &Plan,
    scene: &Scene,
    draw: FrictionDraw,
    lateral_mu: f64,
    speed_quantile: f64,
) -> Result<SecondOrder, ValidationError> {
    let mut at = plan.sliding(scene, &Sample::shared(draw, speed_quantile))?;
    at.contacts.iter_mut().for_each(|contact| contact.lateral_mu = lateral_mu);
    Ok(plan.lattice(scene).linearised(&at).map_err(squeal::Error::from)?)
}

/// Systems around a critical coefficient, from 1e-12 below to 1e-12 above, for a scene of Coulomb friction.
///
/// # Errors
/// Those of [`HardCase::new`].
pub fn onset(plan: &Plan, scene: &Scene, crossing: &Onset) -> Result<Vec<HardCase>, ValidationError> {
    let median = *Sample::median(&plan.case).contact(0);
    let hertz = crossing.omega / std::f64::consts::TAU;
    let at = |offset: f64| {
        let mu = crossing.at + offset;
        let system = with_lateral(plan, scene, FrictionDraw { mu, ..median }, mu, 0.5)?;
        HardCase::new(format!("onset at {hertz:.0} Hz, mu_c {offset:+.0e}"), system)
    };
    [-1e-9, -1e-12, 0.0, 1e-12, 1e-9].into_iter().map(at).collect()
}

/// Systems at distances in the parameter from an exceptional point.
///
/// # Errors
/// Those of `system` and of [`HardCase::new`].
pub fn approach(
    system: &mut dyn FnMut(f64) -> Result<SecondOrder, ValidationError>,
    point: &ExceptionalPoint,
    distances: &[f64],
) -> Result<Vec<HardCase>, ValidationError> {
    let at =
        |&distance: &f64| HardCase::new(format!("exceptional point {distance:+.0e}"), system(point.mu + distance)?);
    distances.iter().map(at).collect()
}

/// Speeds near zero, bristles from soft to stiff, other units, multiple and neutral eigenvalues; `coulomb` and `lugre` are
/// scenes of the plan with those laws.
///
/// # Errors
/// Those of [`HardCase::new`].
pub fn extremes(plan: &Plan, coulomb: &Scene, lugre: &Scene) -> Result<Vec<HardCase>, ValidationError> {
    let median = *Sample::median(&plan.case).contact(0);
    let mut cases = Vec::new();
    let range = lugre.key.speed.map(|at| plan.case.speeds[at].clone());
    for v in [1e-3, 1e-6, 1e-9] {
        // The quantile function of the speed goes on below its range.
        let quantile = range.as_ref().map_or(0.5, |r| (v / r.from).ln() / (r.to / r.from).ln());
        let system = with_lateral(plan, lugre, median, median.lateral_mu, quantile)?;
        cases.push(HardCase::new(format!("LuGre, v = {v:.0e} m/s"), system)?);
    }
    for exponent in 2..=9 {
        let sigma0 = 10.0_f64.powi(exponent);
        let system = with_lateral(plan, lugre, FrictionDraw { sigma0, ..median }, median.lateral_mu, 0.5)?;
        cases.push(HardCase::new(format!("LuGre, sigma0 = {sigma0:.0e} 1/m"), system)?);
    }
    let mut vector = plan.case.clone();
    vector.readings.lateral = Lateral::Vector;
    vector.laws = vec![Law::AmontonsCoulomb];
    let vector = Plan::new(vector)?;
    for v in [1e-3, 1e-6, 1e-9] {
        let scene = &vector.scenes[0];
        let range = scene.key.speed.map(|at| vector.case.speeds[at].clone());
        let quantile = range.map_or(0.5, |r| (v / r.from).ln() / (r.to / r.from).ln());
        let system = with_lateral(&vector, scene, median, median.mu, quantile)?;
        cases.push(HardCase::new(format!("lateral dashpots mu N0 / v, v = {v:.0e} m/s"), system)?);
    }
    let plain = with_lateral(plan, coulomb, median, median.mu, 0.5)?;
    for (name, mass, damping, stiffness) in [("t, mm, s", 1e-3, 1e-3, 1e-3), ("kg, mm, ms", 1.0, 1e-3, 1e-6)] {
        let system = SecondOrder::new(&plain.m * mass, &plain.c * damping, &plain.k * stiffness);
        cases.push(HardCase::new(format!("units {name}"), system.map_err(CeaError::from)?)?);
    }
    let twice = SecondOrder::new(twice(&plain.m), twice(&plain.c), twice(&plain.k)).map_err(CeaError::from)?;
    let single = HardCase::new(String::new(), plain)?.reference;
    let reference = single.iter().chain(&single).copied().collect();
    cases.push(HardCase { name: "two uncoupled copies".into(), system: twice, reference });
    for mu in [0.0, 0.1] {
        let mut system = with_lateral(plan, coulomb, FrictionDraw { mu, ..median }, mu, 0.5)?;
        system.c.fill(0.0);
        cases.push(HardCase::new(format!("no damping, mu = {mu}"), system)?);
    }
    Ok(cases)
}

/// Block diagonal, the matrix twice.
fn twice(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let n = matrix.nrows();
    let mut both = DMatrix::zeros(2 * n, 2 * n);
    both.view_mut((0, 0), (n, n)).copy_from(matrix);
    both.view_mut((n, n), (n, n)).copy_from(matrix);
    both
}
