//! A reduced brake: a dense affine system over the columns of a basis, with what tells how good its modes are.

use cea::{BatchSolver, CeaError, EigenSolver, QrSolver, Spectrum, WholeSpectra, Workspace};
use linsys::{AffineSystem, OperatingPoint, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use sparse::{Rectangle, SparseAffineSystem};

use super::anchor::{Anchor, middle};
use super::directions::Directions;
use super::follow::{Doubt, Goal, comes_near, follow};
use super::full::largest;
use super::residual::{Pairs, ResidualAt, ResidualForm, Truncation, reduced_residual};
use super::{Options, split};
use crate::{ReductionError, Route, Ways};

/// A reduction of a [`SparseAffineSystem`] for the modes in a rectangle.
///
/// Cloning and sharing are free of state: the modes at a point depend on the point alone.
#[derive(Debug, Clone)]
pub struct Reduced {
    system: AffineSystem,
    basis: DMatrix<f64>,
    rectangle: Rectangle,
    form: ResidualForm,
    anchors: Vec<Anchor>,
    /// Those in which the first anchors differ.
    directions: Directions,
    options: Options,
}

/// The modes of a reduced system in the rectangle at one operating point, ascending in frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct ReducedModes {
    /// Eigenvalues, rad/s.
    pub lambdas: Vec<Complex<f64>>,
    /// Shapes in the columns of the basis, k x m, of unit length; [`Reduced::lift`] makes them shapes of the full system.
    pub shapes: DMatrix<Complex<f64>>,
    /// `|Q(lambda) V y| / ((|lambda|^2 |M| + |lambda| |C| + |K|) |V y|)` of the full system, Frobenius norms of matrices, or a bound: where
    /// [`Reduced::residual_rank`] is 256 or more, one at or below the tolerance is twice the estimate of a random sketch, which is below the true
    /// one with a probability of less than 3e-18.
    pub residuals: Vec<f64>,
    /// How they were found.
    pub route: Route,
    /// Multiplications with addition that finding the modes and their residuals took; an estimate by leading terms.
    pub multiply_adds: u64,
}

impl Reduced {
    /// The projection of a system on the orthonormal columns of a basis. The modes at a point are followed from those of the
    /// nearest of the `anchors`, each of which costs a full spectrum with vectors of the reduced system.
    ///
    /// # Errors
    /// An option out of its range, a point or a basis of another system, a reduced mass matrix that is singular.
    pub fn new(
        system: &SparseAffineSystem,
        basis: DMatrix<f64>,
        rectangle: Rectangle,
        anchors: &[OperatingPoint],
        options: &Options,
    ) -> Result<Self, ReductionError> {
        options.check()?;
        let reduced = system.project(&basis)?;
        anchors.iter().try_for_each(|point| reduced.check(point))?;
        let truncation = Truncation { points: anchors, largest: largest(&rectangle), floor: options.residual_floor };
        let form = ResidualForm::new(system, &basis, &truncation)?;
        let directions = Directions::new(anchors, middle(&rectangle));
        let (options, none) = (options.clone(), Vec::new());
        let mut out = Self { system: reduced, basis, rectangle, form, anchors: none, directions, options };
        anchors.iter().try_for_each(|point| out.add_anchor(point))?;
        Ok(out)
    }

    /// Adds a point from where modes can be followed.
    ///
    /// # Errors
    /// A point of another system, a reduced mass matrix that is singular.
    pub fn add_anchor(&mut self, point: &OperatingPoint) -> Result<(), ReductionError> {
        let anchor = Anchor::new(&self.system, point, &self.rectangle, self.margin(), &self.directions)?;
        self.anchors.push(anchor);
        Ok(())
    }

    /// The same reduction, with these ways to the modes at a point.
    #[must_use]
    pub fn with_ways(mut self, ways: Ways) -> Self {
        self.options.ways = ways;
        self
    }

    /// The ways to the modes at a point that may be taken.
    #[must_use]
    pub fn ways(&self) -> Ways {
        self.options.ways
    }

    /// The reduced system: a brake like any other.
    #[must_use]
    pub fn system(&self) -> &AffineSystem {
        &self.system
    }

    /// V, n x k, orthonormal.
    #[must_use]
    pub fn basis(&self) -> &DMatrix<f64> {
        &self.basis
    }

    /// Where modes are wanted.
    #[must_use]
    pub fn rectangle(&self) -> &Rectangle {
        &self.rectangle
    }

    /// The number of points from where modes are followed.
    #[must_use]
    pub fn anchors(&self) -> usize {
        self.anchors.len()
    }

    /// Directions outside of the basis in which residuals are computed.
    #[must_use]
    pub fn residual_rank(&self) -> usize {
        self.form.rank()
    }

    /// `V y`, a shape of the full system.
    #[must_use]
    pub fn lift(&self, y: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        linsys::real_times_complex(&self.basis, y)
    }

    /// The modes in the rectangle at a point, with their residuals.
    ///
    /// # Errors
    /// A point of another system, or a reduced system that the dense solver does not support.
    pub fn modes(&self, point: &OperatingPoint) -> Result<ReducedModes, ReductionError> {
        self.modes_among(point, &|_| true)
    }

    /// Those of the modes in the rectangle at a point whose eigenvalues are asked for: residuals of others cost nothing.
    ///
    /// # Errors
    /// As [`Reduced::modes`].
    pub fn modes_among(
        &self,
        point: &OperatingPoint,
        is_wanted: &dyn Fn(Complex<f64>) -> bool,
    ) -> Result<ReducedModes, ReductionError> {
        let system = self.system.assemble(point)?;
        match self.followed(point, &system, is_wanted)? {
            Ok(found) => Ok(found),
            Err(doubt) => {
                let spectrum = QrSolver.eigenvalues(&system, &mut Workspace::default());
                self.by_spectrum(&system, spectrum, &self.form.at(point), doubt, is_wanted)
            }
        }
    }

    /// [`Reduced::modes_among`] of each of several points; those of whole spectra together, where [`Ways::batches`] has it so.
    ///
    /// # Errors
    /// As [`Reduced::modes`], of each point.
    pub fn modes_of_all(
        &self,
        points: &[OperatingPoint],
        is_wanted: &dyn Fn(Complex<f64>) -> bool,
    ) -> Vec<Result<ReducedModes, ReductionError>> {
        if !self.options.ways.batches {
            return points.iter().map(|point| self.modes_among(point, is_wanted)).collect();
        }
        let mut open = Vec::new();
        let mut followed = |point: &OperatingPoint| -> Result<Option<ReducedModes>, ReductionError> {
            let system = self.system.assemble(point)?;
            Ok(self.followed(point, &system, is_wanted)?.map_err(|doubt| open.push((system, doubt))).ok())
        };
        let found: Vec<_> = points.iter().map(|point| followed(point).transpose()).collect();
        let (systems, doubts): (Vec<SecondOrder>, Vec<_>) = open.into_iter().unzip();
        let mut spectra = Vec::with_capacity(systems.len());
        WholeSpectra(&BatchSolver).eigenvalues_of_all(&systems, &mut Workspace::default(), &mut spectra);
        let mut left = systems.iter().zip(spectra).zip(doubts);
        let each = |(found, point): (Option<Result<ReducedModes, ReductionError>>, &OperatingPoint)| {
            found.or_else(|| {
                let ((system, spectrum), doubt) = left.next()?;
                Some(self.by_spectrum(system, spectrum, &self.form.at(point), doubt, is_wanted))
            })
        };
        found.into_iter().zip(points).filter_map(each).collect()
    }

    /// Modes followed from an anchor, or why a whole spectrum is needed.
    fn followed(
        &self,
        point: &OperatingPoint,
        system: &SecondOrder,
        is_wanted: &dyn Fn(Complex<f64>) -> bool,
    ) -> Result<Result<ReducedModes, Option<Doubt>>, ReductionError> {
        if !self.options.ways.following {
            return Ok(Err(None));
        }
        let residual = self.form.at(point);
        let mut anchors: Vec<(f64, &Anchor)> =
            self.anchors.iter().map(|anchor| (anchor.distance(point), anchor)).collect();
        anchors.sort_by(|a, b| a.0.total_cmp(&b.0));
        if anchors.is_empty() {
            return Ok(Err(Some(Doubt::NoStart)));
        }
        let goal = Goal {
            rectangle: &self.rectangle,
            margin: self.margin(),
            backward_error: REDUCED_PART * self.options.tolerance,
        };
        // One from where no other mode is predicted to come near.
        let is_apart = |anchor: &&Anchor| !comes_near(anchor, point, &goal);
        let Some(anchor) = anchors.iter().take(MOST_ANCHORS).map(|&(_, anchor)| anchor).find(is_apart) else {
            return Ok(Err(Some(Doubt::Moved)));
        };
        let found = follow(anchor, point, system, |lambda| residual.norms.size(lambda), &goal)?;
        Ok(found.map_err(Some).map(|found| {
            let route = Route::Followed { corrections: found.corrections };
            let kept: Vec<usize> = (0..found.lambdas.len()).filter(|&at| is_wanted(found.lambdas[at])).collect();
            let lambdas = kept.iter().map(|&at| found.lambdas[at]).collect();
            let (shapes, inner) = (split::selected(&found.shapes, &kept), kept.iter().map(|&at| found.residuals[at]));
            self.judged(&residual, lambdas, shapes, &inner.collect::<Vec<_>>(), route, found.multiply_adds)
        }))
    }

    /// [`Reduced::modes`] from the whole spectrum of the reduced system: slower, and without an anchor.
    ///
    /// # Errors
    /// As [`Reduced::modes`].
    pub fn modes_by_spectrum(&self, point: &OperatingPoint) -> Result<ReducedModes, ReductionError> {
        let system = self.system.assemble(point)?;
        let spectrum = QrSolver.eigenvalues(&system, &mut Workspace::default());
        self.by_spectrum(&system, spectrum, &self.form.at(point), None, &|_| true)
    }

    /// What residuals are computed by.
    pub(super) fn form(&self) -> &ResidualForm {
        &self.form
    }

    /// The residual of any pair (lambda, V y) at a point.
    ///
    /// # Errors
    /// A point of another system.
    pub fn residual(
        &self,
        point: &OperatingPoint,
        lambda: Complex<f64>,
        y: &DVector<Complex<f64>>,
    ) -> Result<f64, ReductionError> {
        let (found, expected) = (y.len(), self.basis.ncols());
        if found != expected {
            return Err(linsys::LinsysError::Count { what: "entries of the shape", found, expected }.into());
        }
        let system = self.system.assemble(point)?;
        let y = split::from_columns(&DMatrix::from_columns(std::slice::from_ref(y)));
        let inner = split::norms(&reduced_residual(&system, &[lambda], &y));
        let at = self.form.at(point);
        let pairs = Pairs { at: vec![&at], lambdas: &[lambda], y: &y, inner: &inner };
        Ok(pairs.residuals(0.0).first().copied().unwrap_or(f64::NAN))
    }

    /// All eigenvalues of the reduced system at a point.
    pub(super) fn spectrum(&self, point: &OperatingPoint) -> Result<Vec<Complex<f64>>, ReductionError> {
        Ok(QrSolver.eigenvalues(&self.system.assemble(point)?, &mut Workspace::default())?.eigenvalues)
    }

    /// Distance in which eigenvalues outside of the rectangle are looked after, rad/s.
    fn margin(&self) -> f64 {
        self.options.margin * largest(&self.rectangle)
    }

    pub(super) fn distance(&self, point: &OperatingPoint) -> f64 {
        self.anchors.iter().map(|anchor| anchor.distance(point)).fold(f64::INFINITY, f64::min)
    }

    fn by_spectrum(
        &self,
        system: &SecondOrder,
        spectrum: Result<Spectrum, CeaError>,
        residual: &ResidualAt<'_>,
        doubt: Option<Doubt>,
        is_wanted: &dyn Fn(Complex<f64>) -> bool,
    ) -> Result<ReducedModes, ReductionError> {
        let (mut work, spectrum) = (Workspace::default(), spectrum?);
        let is_meant = |lambda: &Complex<f64>| self.rectangle.contains_to_the_right(*lambda, 0.0) && is_wanted(*lambda);
        let wanted: Vec<_> = spectrum.eigenvalues.into_iter().filter(is_meant).collect();
        let shapes = cea::right_vectors(system, &wanted, &mut work)?;
        let mut columns = split::zeros(system.order(), wanted.len());
        shapes.iter().enumerate().for_each(|(at, shape)| split::set(&mut columns, at, shape.iter().copied()));
        // Hessenberg form and QR iteration of a matrix of order d: 10 d^3 operations (Golub and Van Loan, section 7.5).
        let (d, k) = (system.dimension() as u64, system.order() as u64);
        let multiply_adds = 5 * d.pow(3) + 2 * wanted.len() as u64 * k.pow(3);
        let inner = split::norms(&reduced_residual(system, &wanted, &columns));
        Ok(self.judged(residual, wanted, columns, &inner, Route::Spectrum(doubt), multiply_adds))
    }

    /// Modes in order, their shapes scaled, with their residuals.
    fn judged(
        &self,
        residual: &ResidualAt<'_>,
        lambdas: Vec<Complex<f64>>,
        shapes: DMatrix<f64>,
        inner: &[f64],
        route: Route,
        multiply_adds: u64,
    ) -> ReducedModes {
        let pairs = Pairs { at: vec![residual; lambdas.len()], lambdas: &lambdas, y: &shapes, inner };
        let residuals = self.residuals(&pairs);
        let mut order: Vec<usize> = (0..lambdas.len()).collect();
        order.sort_by(|&a, &b| cea::by_frequency(&lambdas[a], &lambdas[b]));
        let in_order = |of: &[f64]| order.iter().map(|&at| of[at]).collect();
        let residuals = in_order(&residuals);
        let lambdas = order.iter().map(|&at| lambdas[at]).collect();
        self.with_residuals(lambdas, &split::selected(&shapes, &order), residuals, route, multiply_adds)
    }

    /// The residuals of some modes, as far as they are asked for.
    pub(super) fn residuals(&self, pairs: &Pairs<'_>) -> Vec<f64> {
        pairs.residuals(self.options.tolerance)
    }

    /// Modes in order with their residuals, their shapes scaled.
    pub(super) fn with_residuals(
        &self,
        lambdas: Vec<Complex<f64>>,
        shapes: &DMatrix<f64>,
        residuals: Vec<f64>,
        route: Route,
        multiply_adds: u64,
    ) -> ReducedModes {
        let columns: Vec<_> = (0..lambdas.len()).map(|at| split::vector(shapes, at).normalize()).collect();
        let k = shapes.nrows();
        let residual_cost = 6 * (k * self.form.sketch_rows() * lambdas.len()) as u64;
        let shapes = if columns.is_empty() { DMatrix::zeros(k, 0) } else { DMatrix::from_columns(&columns) };
        ReducedModes { lambdas, shapes, residuals, route, multiply_adds: multiply_adds + residual_cost }
    }
}

/// Of how many anchors, from the nearest, one is sought; chosen.
const MOST_ANCHORS: usize = 4;
/// Part of the wanted residual at which the modes of the reduced system itself have converged.
const REDUCED_PART: f64 = 0.1;

impl ReducedModes {
    /// The largest residual, zero where there is no mode, not a number where one is not.
    #[must_use]
    pub fn largest_residual(&self) -> f64 {
        self.residuals
            .iter()
            .fold(0.0, |largest, &residual| if residual > largest || residual.is_nan() { residual } else { largest })
    }
}
