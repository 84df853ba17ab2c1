//! A reduced brake: a dense affine system over the columns of a basis, with what tells how good its modes are.

use std::sync::Arc;

use cea::{BatchSolver, CeaError, EigenSolver, QrSolver, Spectrum, Workspace, grows_too_fast};
use linsys::{AffineSystem, OperatingPoint, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use sparse::Rectangle;

use super::coarse::{Coarse, CoarseBasis, Doubt, Polished};
use super::loss::Losses;
use super::norms::NormsAt;
use super::residual::{Pairs, ResidualForm, largest_residual, reduced_residual};
use super::spectra::spectra;
use super::{Combinations, dense, split};
use crate::{ReductionError, Route};

/// A reduction of a [`SparseAffineSystem`](sparse::SparseAffineSystem) for the modes in a rectangle.
///
/// It keeps nothing from one point to the next: the modes at a point depend on the point alone, also where threads share it.
#[derive(Debug, Clone)]
pub struct Reduced {
    system: AffineSystem,
    /// Larger basis V, n x k, which the reductions on smaller ones within it share.
    larger: Arc<DMatrix<f64>>,
    /// Smaller basis W, k x m.
    columns: DMatrix<f64>,
    rectangle: Rectangle,
    form: ResidualForm,
    /// Loss factors, whose dashpots are in the system.
    losses: Option<Losses>,
    coarse: Option<Coarse>,
    tolerance: f64,
}

/// The modes of a reduced system in the rectangle or to its right at one operating point, ascending in frequency, but those that grow faster than they
/// oscillate ([`grows_too_fast`]).
#[derive(Debug, Clone, PartialEq)]
pub struct ReducedModes {
    /// Eigenvalues, rad/s.
    pub lambdas: Vec<Complex<f64>>,
    /// Shapes in the columns of the basis, m x modes, of unit length; [`Reduced::lift`] makes them shapes of the full system.
    pub shapes: DMatrix<Complex<f64>>,
    /// Bounds of `|Q(lambda) V W y| / ((|lambda|^2 |M| + |lambda| |C| + |K|) |V W y|)` of the full system, Frobenius norms of matrices: twice the estimate of
    /// random combinations, which is below the true one with a probability of less than 3e-18.
    pub residuals: Vec<f64>,
    /// Route by which the modes were found.
    pub route: Route,
}

impl Reduced {
    /// The projection on a smaller basis W, k x m, within a basis V, n x k, of orthonormal columns, from the `system` on V and `combinations` for V:
    /// nothing large is computed. Modes are found to a tenth of the tolerance, the residual that they shall not exceed, above 0 and below 1. Not checked:
    /// `combinations` of another basis than V. Where there are `losses` the system has their dashpots ([`Losses::with_dashpots`]), and modes are those of
    /// the complex stiffness.
    ///
    /// # Errors
    /// A tolerance out of its range, a basis of another system, a projection that is not finite.
    pub fn within(
        (larger, system, combinations): (&Arc<DMatrix<f64>>, &AffineSystem, &Combinations),
        losses: Option<&Losses>,
        columns: &DMatrix<f64>,
        rectangle: Rectangle,
        tolerance: f64,
    ) -> Result<Self, ReductionError> {
        if !(tolerance > 0.0 && tolerance < 1.0) {
            return Err(ReductionError::Tolerance { value: tolerance });
        }
        let reduced = system.projected(columns)?;
        let losses = losses.map(|losses| losses.projected(columns));
        let form = match &losses {
            Some(losses) => ResidualForm::new(combinations, columns, &losses.without_dashpots(&reduced)?),
            None => ResidualForm::new(combinations, columns, &reduced),
        };
        let (larger, columns) = (Arc::clone(larger), columns.clone());
        Ok(Self { system: reduced, larger, columns, rectangle, form, losses, coarse: None, tolerance })
    }

    /// The largest distance, relative to |lambda| and to first order, of modes next to the axis with dashpots from those with loss factors at some points; 0
    /// without any.
    ///
    /// # Errors
    /// A point of another system, a reduced system that the dense solver does not support.
    pub fn distance_of_losses(&self, points: &[OperatingPoint]) -> Result<f64, ReductionError> {
        let Some(losses) = &self.losses else { return Ok(0.0) };
        let systems = points.iter().map(|point| self.system.assemble(point)).collect::<Result<Vec<_>, _>>()?;
        let mut largest = 0.0_f64;
        for ((found, point), system) in spectra(&systems).into_iter().zip(points).zip(&systems) {
            let lambdas = self.next_to_rectangle(&found?, 0.0);
            let own = losses.distance((&self.system, point, system), &lambdas)?;
            largest = largest_residual([largest, own]);
        }
        Ok(largest)
    }

    /// The same reduction, whose modes next to the axis with dashpots are taken to lead to those with loss factors within ten times a distance, relative to
    /// |lambda|, that was measured ([`Reduced::distance_of_losses`]).
    #[must_use]
    pub fn with_distance_of_losses(mut self, distance: f64) -> Self {
        self.losses = self.losses.map(|losses| losses.measured(distance));
        self
    }

    /// The same reduction, whose modes are found from coarse ones where that spares time: on a smaller basis within its own, made of its modes at
    /// some points, draws of a study for example. What is found is the same, up to the tolerance.
    ///
    /// # Errors
    /// A point of another system, a reduced system that the dense solver does not support.
    pub fn with_coarse(mut self, points: &[OperatingPoint]) -> Result<Self, ReductionError> {
        self.coarse = Coarse::new(&self, points)?;
        Ok(self)
    }

    /// The same reduction with a coarse basis that [`Reduced::with_coarse`] made of the same reduction before, or without a coarse basis.
    ///
    /// # Errors
    /// A basis of another system.
    pub fn on_coarse(mut self, coarse: Option<CoarseBasis>) -> Result<Self, ReductionError> {
        self.coarse = coarse.map(|coarse| Coarse::on(&self, coarse)).transpose()?;
        Ok(self)
    }

    /// The coarse basis; `None` where modes are found from whole spectra.
    #[must_use]
    pub fn coarse_basis(&self) -> Option<&CoarseBasis> {
        self.coarse.as_ref().map(Coarse::own)
    }

    /// The same reduction, whose modes are found from whole spectra alone.
    #[must_use]
    pub fn without_coarse(mut self) -> Self {
        self.coarse = None;
        self
    }

    /// Columns of the coarse basis; `None` where modes are found from whole spectra.
    #[must_use]
    pub fn coarse_columns(&self) -> Option<usize> {
        self.coarse_basis().map(|coarse| coarse.basis.ncols())
    }

    /// The brake at a point on the coarse basis, and the columns of that basis, k x w; `None` without a coarse basis.
    ///
    /// # Errors
    /// A point of another system.
    pub fn coarse_at(&self, point: &OperatingPoint) -> Result<Option<(SecondOrder, &DMatrix<f64>)>, ReductionError> {
        let Some(coarse) = &self.coarse else { return Ok(None) };
        Ok(Some((coarse.at(point)?, &coarse.own().basis)))
    }

    /// The reduced system: a brake like any other.
    #[must_use]
    pub fn system(&self) -> &AffineSystem {
        &self.system
    }

    /// V W, n x m, orthonormal: made anew each time.
    #[must_use]
    pub fn basis(&self) -> DMatrix<f64> {
        dense::product(&self.larger, &self.columns)
    }

    /// Rectangle in which modes are wanted.
    #[must_use]
    pub fn rectangle(&self) -> &Rectangle {
        &self.rectangle
    }

    /// `V W y`, a shape of the full system.
    #[must_use]
    pub fn lift(&self, y: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        linsys::real_times_complex(&self.larger, &linsys::real_times_complex(&self.columns, y))
    }

    /// The modes in the rectangle or to its right at a point, with their residuals.
    ///
    /// # Errors
    /// A point of another system, or a reduced system that the dense solver does not support.
    pub fn modes(&self, point: &OperatingPoint) -> Result<ReducedModes, ReductionError> {
        self.modes_of_all(std::slice::from_ref(point), &|_, _| true).remove(0)
    }

    /// The modes in the rectangle or to its right at each of several points whose eigenvalues, rad/s, are wanted. `is_wanted` is asked of each with the
    /// relative error up to which it is known then: a mode that may be wanted is found exactly, and asked for again with an error of 0. Others cost little.
    ///
    /// # Errors
    /// As [`Reduced::modes`], of each point.
    pub fn modes_of_all(
        &self,
        points: &[OperatingPoint],
        is_wanted: &dyn Fn(Complex<f64>, f64) -> bool,
    ) -> Vec<Result<ReducedModes, ReductionError>> {
        let made: Vec<_> = points.iter().map(|point| self.system.assemble(point)).collect();
        let are_made = points.iter().zip(&made).filter_map(|(point, made)| Some((point, made.as_ref().ok()?)));
        let (points, systems): (Vec<&OperatingPoint>, Vec<&SecondOrder>) = are_made.unzip();
        let may_be_wanted = |lambda, error: f64| is_wanted(lambda, error + self.error_of_dashpots());
        let polished = match &self.coarse {
            Some(coarse) => coarse.polished(self, (&points, &systems), &may_be_wanted),
            None => points.iter().map(|_| Err(None)).collect(),
        };
        let open: Vec<usize> = (0..points.len()).filter(|&at| polished[at].is_err()).collect();
        let of_open: Vec<SecondOrder> = open.iter().map(|&at| systems[at].clone()).collect();
        let mut spectra = spectra(&of_open).into_iter();
        let mut each = points.into_iter().zip(systems).zip(polished);
        let one = |made: &Result<SecondOrder, linsys::LinsysError>| {
            made.as_ref().map_err(Clone::clone)?;
            let Some(((point, system), polished)) = each.next() else {
                return Err(ReductionError::Decomposition { what: NO_SPECTRUM });
            };
            match polished {
                Ok(found) => self.judged(point, system, found, Route::Coarse, is_wanted),
                Err(doubt) => {
                    let spectrum = spectra.next().ok_or(ReductionError::Decomposition { what: NO_SPECTRUM })?;
                    self.by_spectrum(point, system, spectrum, doubt, is_wanted)
                }
            }
        };
        made.iter().map(one).collect()
    }

    /// [`Reduced::modes`] from the whole spectrum of the reduced system.
    ///
    /// # Errors
    /// As [`Reduced::modes`].
    pub fn modes_by_spectrum(&self, point: &OperatingPoint) -> Result<ReducedModes, ReductionError> {
        let system = self.system.assemble(point)?;
        let spectrum = QrSolver.eigenvalues(&system, &mut Workspace::default());
        self.by_spectrum(point, &system, spectrum, None, &|_, _| true)
    }

    /// Eigenvalues of a spectrum in the rectangle or to its right, or outside by no more than `part` and the error of dashpots, as fractions of |lambda|;
    /// without those that grow faster than they oscillate ([`grows_too_fast`]).
    pub(super) fn next_to_rectangle(&self, spectrum: &Spectrum, part: f64) -> Vec<Complex<f64>> {
        let part = part + self.error_of_dashpots();
        spectrum.eigenvalues.iter().copied().filter(|&lambda| self.is_wanted_within(lambda, part)).collect()
    }

    /// True of an eigenvalue in the rectangle or to its right, or outside by no more than `part` times |lambda|, that does not grow too fast.
    fn is_wanted_within(&self, lambda: Complex<f64>, part: f64) -> bool {
        self.rectangle.contains_to_the_right(lambda, part * lambda.norm()) && !grows_too_fast(lambda)
    }

    /// The modes at a point as by [`Reduced::modes`], from the whole spectrum of another system in its place: one that was changed, with the losses of the
    /// unchanged brake at the point. `residuals` is empty, as only residuals in the unchanged brake are known.
    ///
    /// # Errors
    /// A system of another order, or one that the dense solver does not support.
    pub fn modes_of_changed(
        &self,
        point: &OperatingPoint,
        changed: &SecondOrder,
    ) -> Result<ReducedModes, ReductionError> {
        let (found, expected) = (changed.order(), self.system.order());
        if found != expected {
            return Err(linsys::LinsysError::Count { what: "rows of a changed system", found, expected }.into());
        }
        let spectrum = BatchSolver.eigenvalues(changed, &mut Workspace::default());
        let found = self.by_spectrum(point, changed, spectrum, None, &|_, _| true)?;
        Ok(ReducedModes { residuals: Vec::new(), ..found })
    }

    /// True if there are loss factors, so that the [`system`](Self::system) has dashpots in their place.
    #[must_use]
    pub fn has_losses(&self) -> bool {
        self.losses.is_some()
    }

    /// Distance, relative to |lambda|, that is assumed of a mode next to the axis of the [`system`](Self::system), which has dashpots, from one with loss
    /// factors; 0 without any.
    #[must_use]
    pub fn error_of_dashpots(&self) -> f64 {
        self.losses.as_ref().map_or(0.0, Losses::error)
    }

    /// Sizes that residuals at a point are relative to.
    pub(super) fn norms(&self, point: &OperatingPoint) -> NormsAt {
        self.form.norms.at(point)
    }

    /// Residual, in the reduced system, at which its modes have converged.
    pub(super) fn converged(&self) -> f64 {
        REDUCED_PART * self.tolerance
    }

    /// The residual of any pair (lambda, V W y) at a point, bounded as [`ReducedModes::residuals`].
    ///
    /// # Errors
    /// A point of another system.
    pub fn residual(
        &self,
        point: &OperatingPoint,
        lambda: Complex<f64>,
        y: &DVector<Complex<f64>>,
    ) -> Result<f64, ReductionError> {
        let (found, expected) = (y.len(), self.system.order());
        if found != expected {
            return Err(linsys::LinsysError::Count { what: "entries of the shape", found, expected }.into());
        }
        let system = self.system.assemble(point)?;
        let y = split::from_columns(&DMatrix::from_columns(std::slice::from_ref(y)));
        Ok(self.residuals(point, &system, &[lambda], &y).first().copied().unwrap_or(f64::NAN))
    }

    /// The residuals of some pairs at a point, at which the system is given, shapes split.
    fn residuals(
        &self,
        point: &OperatingPoint,
        system: &SecondOrder,
        lambdas: &[Complex<f64>],
        y: &DMatrix<f64>,
    ) -> Vec<f64> {
        let mut inner = reduced_residual(system, lambdas, y);
        let losses = self.losses.as_ref().map(|losses| {
            losses.at(&self.system, point).add_images(&mut inner, lambdas, y);
            losses.factors(&point.coefficients)
        });
        let (at, inner) = (self.form.at(point), split::norms(&inner));
        Pairs { at: &at, lambdas, y, losses: losses.as_deref(), inner: &inner }.residuals()
    }

    /// The modes with loss factors to which some with dashpots lead, shapes split; all next to the rectangle where one does not lead to one of its own.
    fn with_losses(
        &self,
        losses: &Losses,
        (point, system): (&OperatingPoint, &SecondOrder),
        (lambdas, shapes): Polished,
        route: Route,
    ) -> Result<(Polished, Route), ReductionError> {
        let at = losses.at(&self.system, point);
        let guesses: Vec<_> =
            lambdas.iter().enumerate().map(|(at, &lambda)| (lambda, split::vector(&shapes, at))).collect();
        let (pairs, route) = match at.led_from_guesses(system, &guesses) {
            Some(pairs) => (pairs, route),
            None => {
                let mut all = at.spectrum(system)?;
                all.retain(|(lambda, _)| self.is_wanted_within(*lambda, 0.0));
                (all, Route::Spectrum(Some(Doubt::Loss)))
            }
        };
        let mut columns = split::zeros(system.order(), pairs.len());
        pairs.iter().enumerate().for_each(|(at, (_, shape))| split::set(&mut columns, at, shape.iter().copied()));
        Ok(((pairs.into_iter().map(|(lambda, _)| lambda).collect(), columns), route))
    }

    fn by_spectrum(
        &self,
        point: &OperatingPoint,
        system: &SecondOrder,
        spectrum: Result<Spectrum, CeaError>,
        doubt: Option<Doubt>,
        is_wanted: &dyn Fn(Complex<f64>, f64) -> bool,
    ) -> Result<ReducedModes, ReductionError> {
        let error = self.error_of_dashpots();
        let wanted: Vec<Complex<f64>> =
            self.next_to_rectangle(&spectrum?, 0.0).into_iter().filter(|&lambda| is_wanted(lambda, error)).collect();
        let shapes = cea::right_vectors(system, &wanted, &mut Workspace::default())?;
        let mut columns = split::zeros(system.order(), wanted.len());
        shapes.iter().enumerate().for_each(|(at, shape)| split::set(&mut columns, at, shape.iter().copied()));
        self.judged(point, system, (wanted, columns), Route::Spectrum(doubt), is_wanted)
    }

    /// The modes of `found` that are wanted, in order, with scaled shapes and their residuals; with loss factors where the brake has them.
    fn judged(
        &self,
        point: &OperatingPoint,
        system: &SecondOrder,
        found: Polished,
        route: Route,
        is_wanted: &dyn Fn(Complex<f64>, f64) -> bool,
    ) -> Result<ReducedModes, ReductionError> {
        let ((lambdas, shapes), route) = match &self.losses {
            Some(losses) => self.with_losses(losses, (point, system), found, route)?,
            None => (found, route),
        };
        let is_in = |&at: &usize| self.rectangle.contains_to_the_right(lambdas[at], 0.0) && is_wanted(lambdas[at], 0.0);
        let mut order: Vec<usize> = (0..lambdas.len()).filter(is_in).collect();
        order.sort_by(|&a, &b| cea::by_frequency(&lambdas[a], &lambdas[b]));
        let lambdas: Vec<Complex<f64>> = order.iter().map(|&at| lambdas[at]).collect();
        let shapes = split::selected(&shapes, &order);
        let residuals = self.residuals(point, system, &lambdas, &shapes);
        let columns: Vec<_> = (0..lambdas.len()).map(|at| split::vector(&shapes, at).normalize()).collect();
        let shapes =
            if columns.is_empty() { DMatrix::zeros(shapes.nrows(), 0) } else { DMatrix::from_columns(&columns) };
        Ok(ReducedModes { lambdas, shapes, residuals, route })
    }
}

/// Name of a spectrum that is not there, in messages.
const NO_SPECTRUM: &str = "spectrum of a reduced system";
/// Residual in the reduced system, as a fraction of the tolerance, at which its modes have converged; chosen: so that what is left of them adds little to
/// the residual in the large system.
const REDUCED_PART: f64 = 0.1;

impl ReducedModes {
    /// The largest residual, 0 where there is no mode, NaN where one of them is NaN.
    #[must_use]
    pub fn largest_residual(&self) -> f64 {
        largest_residual(self.residuals.iter().copied())
    }
}
