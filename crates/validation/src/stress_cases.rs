//! Stress cases: systems of the lattice that are hard for a solver or a verdict.

use brakes::case::Law;
use brakes::{FrictionDraw, LatticeBrake, LatticeSample};
use cea::CeaError;
use linsys::SecondOrder;
use nalgebra::DMatrix;
use osc_model::Lateral;
use squeal::study::Scene;
use squeal::tracking::Onset;

use crate::ValidationError;
use crate::exceptional_point::ExceptionalPoint;
use crate::problem::ReferenceProblem;

/// The system of a scene with one draw in all contacts and a separate lateral coefficient.
///
/// # Errors
/// Those of the friction law.
pub fn with_lateral(
    brake: &LatticeBrake,
    scene: &Scene,
    draw: FrictionDraw,
    lateral_mu: f64,
    speed_quantile: f64,
) -> Result<SecondOrder, ValidationError> {
    let mut at = brake.sliding(scene, &LatticeSample::shared(draw, speed_quantile))?;
    at.contacts.iter_mut().for_each(|contact| contact.lateral_mu = lateral_mu);
    Ok(brake.lattice(scene).linearised(&at).map_err(squeal::Error::from)?)
}

/// Systems around an onset, from 1e-9 below to 1e-9 above, for a scene of Coulomb friction.
///
/// # Errors
/// Those of [`ReferenceProblem::new`].
pub fn around_onset(
    brake: &LatticeBrake,
    scene: &Scene,
    onset: &Onset,
) -> Result<Vec<ReferenceProblem>, ValidationError> {
    let median = *LatticeSample::median(&brake.case).contact(0);
    let hertz = onset.omega / std::f64::consts::TAU;
    let at = |offset: f64| {
        let mu = onset.at + offset;
        let system = with_lateral(brake, scene, FrictionDraw { mu, ..median }, mu, 0.5)?;
        ReferenceProblem::new(format!("onset at {hertz:.0} Hz, mu_c {offset:+.0e}"), system)
    };
    [-1e-9, -1e-12, 0.0, 1e-12, 1e-9].into_iter().map(at).collect()
}

/// Systems at distances in the parameter from an exceptional point.
///
/// # Errors
/// Those of `system` and of [`ReferenceProblem::new`].
pub fn around_exceptional_point(
    system: &mut dyn FnMut(f64) -> Result<SecondOrder, ValidationError>,
    point: &ExceptionalPoint,
    distances: &[f64],
) -> Result<Vec<ReferenceProblem>, ValidationError> {
    let at = |&distance: &f64| {
        ReferenceProblem::new(format!("exceptional point {distance:+.0e}"), system(point.mu + distance)?)
    };
    distances.iter().map(at).collect()
}

/// Speeds near zero, bristles from soft to stiff, other units, multiple and neutral eigenvalues; `coulomb` and `lugre` are
/// scenes of the brake with those laws.
///
/// # Errors
/// Those of [`ReferenceProblem::new`].
pub fn extremes(
    brake: &LatticeBrake,
    coulomb: &Scene,
    lugre: &Scene,
) -> Result<Vec<ReferenceProblem>, ValidationError> {
    let median = *LatticeSample::median(&brake.case).contact(0);
    let mut cases = Vec::new();
    for v in [1e-3, 1e-6, 1e-9] {
        let system = with_lateral(brake, lugre, median, median.lateral_mu, speed_quantile(brake, lugre, v))?;
        cases.push(ReferenceProblem::new(format!("LuGre, v = {v:.0e} m/s"), system)?);
    }
    for exponent in 2..=9 {
        let sigma0 = 10.0_f64.powi(exponent);
        let system = with_lateral(brake, lugre, FrictionDraw { sigma0, ..median }, median.lateral_mu, 0.5)?;
        cases.push(ReferenceProblem::new(format!("LuGre, sigma0 = {sigma0:.0e} 1/m"), system)?);
    }
    let mut vector = brake.case.clone();
    vector.readings.lateral = Lateral::Vector;
    vector.laws = vec![Law::AmontonsCoulomb];
    let vector = LatticeBrake::new(vector)?;
    for v in [1e-3, 1e-6, 1e-9] {
        let scene = &vector.plan.scenes[0];
        let system = with_lateral(&vector, scene, median, median.mu, speed_quantile(&vector, scene, v))?;
        cases.push(ReferenceProblem::new(format!("lateral dashpots mu N0 / v, v = {v:.0e} m/s"), system)?);
    }
    let plain = with_lateral(brake, coulomb, median, median.mu, 0.5)?;
    for (name, mass, damping, stiffness) in [("t, mm, s", 1e-3, 1e-3, 1e-3), ("kg, mm, ms", 1.0, 1e-3, 1e-6)] {
        let system = SecondOrder::new(&plain.m * mass, &plain.c * damping, &plain.k * stiffness);
        cases.push(ReferenceProblem::new(format!("units {name}"), system.map_err(CeaError::from)?)?);
    }
    let twice = SecondOrder::new(twice(&plain.m), twice(&plain.c), twice(&plain.k)).map_err(CeaError::from)?;
    let single = ReferenceProblem::new(String::new(), plain)?.reference;
    let reference = single.iter().chain(&single).copied().collect();
    cases.push(ReferenceProblem { name: "two uncoupled copies".into(), system: twice, reference });
    for mu in [0.0, 0.1] {
        let mut system = with_lateral(brake, coulomb, FrictionDraw { mu, ..median }, mu, 0.5)?;
        system.c.fill(0.0);
        cases.push(ReferenceProblem::new(format!("no damping, mu = {mu}"), system)?);
    }
    Ok(cases)
}

/// The probability at which the quantile of the speed of a scene is `v`, m/s; it is negative below the range of the speed.
fn speed_quantile(brake: &LatticeBrake, scene: &Scene, v: f64) -> f64 {
    let range = scene.key.speed.map(|at| &brake.case.speeds[at]);
    range.map_or(0.5, |range| (v / range.from).ln() / (range.to / range.from).ln())
}

/// The block diagonal matrix of two copies.
fn twice(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let n = matrix.nrows();
    let mut both = DMatrix::zeros(2 * n, 2 * n);
    both.view_mut((0, 0), (n, n)).copy_from(matrix);
    both.view_mut((n, n), (n, n)).copy_from(matrix);
    both
}
