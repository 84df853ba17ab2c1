//! Modes of samples of a finite element brake in its band, by its reduction, and how far they may be off.

use std::sync::PoisonError;
use std::sync::atomic::Ordering;

use cea::Mode;
use linsys::{OperatingPoint, SecondOrder};
use nalgebra::{DVector, DVectorView};
use num_complex::Complex;
use reduction::{ReducedModes, RouteCounts};
use study::{BandMode, Bridge, CoarsePath, FullChecks, ModeResidual, ModeSource, Scene, WholeEigenvalue};

use super::{FiniteElementBrake, bridge, on_axis, parameters, settled, whole};
use crate::Error;

/// Factor of the relative error that is assumed of an eigenvalue. It multiplies the sum of two relative distances, each the largest that was measured: of
/// eigenvalues on the basis of a part from eigenvalues on the basis of its set, and of the latter from eigenvalues of the whole brake. Chosen;
/// how far off samples really are is told by the samples that are solved with the whole brake.
const ALLOWANCE: f64 = 100.0;
/// Least assumed error of an eigenvalue, relative to |lambda|: three times the largest distance in 130 samples of cases/disc-pad that were
/// solved with the whole brake.
const LEAST_ERROR: f64 = 1e-5;
/// Factor of the largest distance at full checks that is assumed at least; chosen: these are draws as the samples are.
const BEYOND_CHECKED: f64 = 3.0;
/// Reason why nothing is known of the errors of a reduced brake that has other modes than the whole one.
const OTHER_MODES: &str =
    "the reduced brake does not have the modes of the whole one, at the medians or at draws of which it was not made";
/// Most degrees of freedom at which a table has shapes, roughly; chosen: enough to tell modes of a band apart.
const ROWS_OF_SHAPES: usize = 300;
/// Largest residual of a mode whose error is told by the distances measured at draws of which the basis was not made, as a multiple of the largest residual
/// there; chosen: with less, modes are marked that are as well known as those; with more, the measured distances are believed of modes that are unlike those.
const BEYOND_HELD_OUT: f64 = 10.0;

impl FiniteElementBrake {
    /// Finds the modes of samples by whole spectra alone, without coarse modes.
    pub fn use_spectra_alone(&mut self) {
        for part in &mut self.parts {
            part.reduced = part.reduced.clone().without_coarse();
        }
    }

    /// Number of samples whose modes each route has found so far, in all scenes.
    #[must_use]
    pub fn routes(&self) -> RouteCounts {
        // What a panic of another thread left is a count all the same.
        self.parts.iter().map(|part| *part.routes.lock().unwrap_or_else(PoisonError::into_inner)).sum()
    }

    /// Modes of the reduced brake of a scene at an operating point of the whole one, with what they may be off by and their residuals; open verdicts are settled
    /// with the whole brake, where they are not too many ([`ReductionGoal::full_verdicts`](crate::case::ReductionGoal::full_verdicts)).
    ///
    /// # Errors
    /// A point of another brake.
    pub fn judged(&self, scene: &Scene, at: &OperatingPoint, found: &ReducedModes) -> Result<Vec<BandMode>, Error> {
        let part = self.part(scene);
        let mut modes = self.with_bounds(scene, at, found);
        // Where it is not even known which modes there are, settling the verdict of one of them helps nothing.
        let are_known = self.unknown_error(scene).is_none();
        let most = if are_known { self.case.reduction.full_verdicts } else { 0 };
        if settled::settle(&mut modes, &self.plan, (part, &self.sets[part.set]), at, most)? {
            part.settled.fetch_add(1, Ordering::Relaxed);
        }
        Ok(modes)
    }

    /// Modes of the reduced brake of a scene at an operating point of the whole one, with what they may be off by and their residuals.
    fn with_bounds(&self, scene: &Scene, at: &OperatingPoint, found: &ReducedModes) -> Vec<BandMode> {
        let (part, error) = (self.part(scene), self.error_of_modes(scene));
        let set = &self.sets[part.set];
        let enough = self.case.reduction.residual.max(BEYOND_HELD_OUT * set.held_out_residual);
        let on_axis = self.on_axis(scene, at, &found.lambdas);
        let each = found.lambdas.iter().zip(found.shapes.column_iter()).zip(&found.residuals).zip(on_axis);
        type Found<'a> = (((&'a Complex<f64>, DVectorView<'a, Complex<f64>>), &'a f64), bool);
        let mode = |(((&lambda, shape), &value), is_on_axis): Found<'_>| {
            // One that is no number is above too.
            let is_within = value <= enough;
            let residual = Some(ModeResidual { value, is_above: !is_within });
            BandMode { lambda, shape: shape.into_owned(), bound: error * lambda.norm(), is_on_axis, residual }
        };
        each.map(mode).collect()
    }

    /// Flags of eigenvalues at an operating point of the whole brake, rad/s, that are on the imaginary axis because nothing damps the brake.
    pub(super) fn on_axis(&self, scene: &Scene, at: &OperatingPoint, lambdas: &[Complex<f64>]) -> Vec<bool> {
        if !on_axis::is_undamped(&self.case.system, at) {
            return vec![false; lambdas.len()];
        }
        let band = self.case.reduction.frequencies.map(|hz| std::f64::consts::TAU * hz);
        on_axis::on_axis(lambdas, self.error_of_modes(scene), band)
    }

    /// Relative error of an eigenvalue of a sample of a scene against the eigenvalue of the whole brake: a rule, not a bound.
    pub(super) fn error_of_modes(&self, scene: &Scene) -> f64 {
        let part = self.part(scene);
        let set = &self.sets[part.set];
        let of_set = set.compared.distance.max(set.held_out);
        (ALLOWANCE * (part.within.distance + of_set)).max(BEYOND_CHECKED * set.checked).max(LEAST_ERROR)
    }
}

impl ModeSource for FiniteElementBrake {
    fn band_modes(&self, scene: &Scene, at: &[OperatingPoint]) -> Vec<Result<Vec<BandMode>, study::Error>> {
        let (part, threshold, error) = (self.part(scene), self.plan.threshold, self.error_of_modes(scene));
        let may_grow = |lambda: Complex<f64>, also: f64| threshold.margin(lambda) >= -(error + also) * lambda.norm();
        let points: Vec<OperatingPoint> = at.iter().map(|at| self.full_point(scene, at)).collect();
        let found = part.reduced.modes_of_all(&points, &may_grow);
        let mut counts = RouteCounts::default();
        found.iter().flatten().for_each(|found| counts.record(found.route));
        let mut routes = part.routes.lock().unwrap_or_else(PoisonError::into_inner);
        *routes = *routes + counts;
        drop(routes);
        let found = found.into_iter().zip(&points);
        found.map(|(found, at)| Ok(self.judged(scene, at, &found.map_err(Error::from)?)?)).collect()
    }

    fn has_dashpots_for_losses(&self, scene: &Scene) -> bool {
        self.part(scene).reduced.has_losses()
    }

    fn band_modes_with(&self, scene: &Scene, values: &[(usize, f64)]) -> Result<Vec<BandMode>, study::Error> {
        let at = parameters::point(&self.scene_of(scene), values)?;
        let found = self.part(scene).reduced.modes(&at).map_err(Error::from)?;
        Ok(self.with_bounds(scene, &at, &found))
    }

    fn band_modes_of_changed(
        &self,
        scene: &Scene,
        at: &OperatingPoint,
        changed: &SecondOrder,
    ) -> Result<Vec<BandMode>, study::Error> {
        let found = self.part(scene).reduced.modes_of_changed(&self.full_point(scene, at), changed);
        let ReducedModes { lambdas, shapes, .. } = found.map_err(Error::from)?;
        let error = self.error_of_modes(scene);
        let mode = |(lambda, shape): (Complex<f64>, DVectorView<'_, Complex<f64>>)| BandMode {
            lambda,
            shape: shape.into_owned(),
            bound: error * lambda.norm(),
            is_on_axis: false,
            residual: None,
        };
        Ok(lambdas.into_iter().zip(shapes.column_iter()).map(mode).collect())
    }

    fn coarse(&self, scene: &Scene, at: [&OperatingPoint; 2]) -> Result<Option<CoarsePath<'_>>, study::Error> {
        let of = |at| self.part(scene).reduced.coarse_at(&self.full_point(scene, at)).map_err(Error::from);
        let [from, to] = at.map(of);
        let Some(((from, basis), (to, _))) = from?.zip(to?) else { return Ok(None) };
        Ok(Some(CoarsePath { systems: [from, to], basis }))
    }

    fn bridge(&self, configuration: usize, modes: [&[Mode]; 2]) -> Result<Option<Bridge>, study::Error> {
        Ok(bridge::bridge(self, configuration, modes)?)
    }

    fn relative_error(&self, scene: &Scene) -> f64 {
        // The reduced system has dashpots in the place of loss factors.
        self.error_of_modes(scene) + self.part(scene).reduced.error_of_dashpots()
    }

    fn unknown_error(&self, scene: &Scene) -> Option<&'static str> {
        (self.sets[self.part(scene).set].held_out >= 1.0).then_some(OTHER_MODES)
    }

    fn eigenvalue_at_origin(&self, constraints: usize, lambda: Complex<f64>) -> Complex<f64> {
        let origin = self.origin(constraints);
        let distance = |own: &Complex<f64>| (own - lambda).norm();
        let nearest = origin.first.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        // Of a brake without loss factors it is the same but for rounding.
        let is_near = |own: &Complex<f64>| distance(own) < origin.reduced.error_of_dashpots() * lambda.norm();
        nearest.filter(is_near).unwrap_or(lambda)
    }

    fn whole_shape(&self, constraints: usize, shape: &DVector<Complex<f64>>) -> Vec<(String, Complex<f64>)> {
        // Every `every`-th row of the model, counted before any is fixed: the same rows with another set of constraints.
        let every = self.case.dofs.len().div_ceil(ROWS_OF_SHAPES);
        let lifted = self.origin(constraints).reduced.lift(shape);
        let rows = self.sets[constraints].dofs.free().iter().zip(lifted.iter());
        rows.filter(|(row, _)| *row % every == 0).map(|(&row, &u)| (self.case.dofs[row].to_string(), u)).collect()
    }

    fn whole_eigenvalue(
        &self,
        scene: &Scene,
        values: &[(usize, f64)],
        near: Complex<f64>,
    ) -> Result<WholeEigenvalue, study::Error> {
        whole::eigenvalue(self.part(scene), &self.sets, &parameters::point(&self.scene_of(scene), values)?, near)
    }

    fn routes(&self) -> Vec<(&'static str, u64)> {
        let RouteCounts { coarse, spectra } = FiniteElementBrake::routes(self);
        let settled = self.parts.iter().map(|part| part.settled.load(Ordering::Relaxed)).sum();
        vec![("coarse", coarse), ("spectra", spectra), ("settled", settled)]
    }

    fn full_checks(&self) -> Option<&FullChecks> {
        self.full_checks.as_ref()
    }
}
