//! A basis of modes at a few points: its columns follow the modes that are wanted, whatever the number of contacts is.
//!
//! What friction and opened contacts do to the modes of a band is smooth over a face, and lies in few directions: the
//! directions of the modes at a few draws. Left vectors are among them, so that the error of an eigenvalue is the product
//! of what is missing on both sides. How many draws it takes is told by the next ones: by what a basis misses of their modes before these enter it.

use cea::grows_too_fast;
use linsys::OperatingPoint;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use sparse::product::times;
use sparse::{Eigenpair, Rectangle, SparseAffineSystem, SparseSecondOrder, eigenpairs_in};

use super::compared::compared;
use super::directions::{ROUNDING, directions};
use super::norms::{Norms, NormsAt};
use super::wanted::largest;
use super::{dense, split};
use crate::ReductionError;

/// Largest distance from the rectangle, as a fraction of the largest |lambda| in it, of modes that shape a basis too: others come into it
/// from there. Chosen: with less, a mode that friction moves into the rectangle may be missing; with more, full problems have more modes.
const MARGIN: f64 = 0.02;

/// Largest distance from the rectangle, as such a fraction, of the modes from which those at other points go out; chosen: contacts that open lower the frequencies of modes beside the band by less, and with more a
/// search finds more modes.
const FAR_MARGIN: f64 = 0.3;

/// Largest part of a mode's length that a basis may miss, whatever residual is asked for; chosen. Without it, where stiff parts make all residuals small, a
/// basis without any columns would meet a residual that is not small.
const MOST_MISSING: f64 = 0.1;

/// Modes of a large brake at the points that are added, and the bases that hold them.
#[derive(Debug)]
pub struct Snapshots<'a> {
    system: &'a SparseAffineSystem,
    rectangle: Rectangle,
    /// Settings of the searches.
    options: sparse::Options,
    norms: Norms,
    /// Orthonormal directions of all vectors, n x q.
    directions: DMatrix<f64>,
    /// The vectors, of unit length, in these directions, q x c.
    coordinates: DMatrix<f64>,
}

/// Modes of a large brake at one point. The matrices there, which take more memory than all its modes, are assembled again where they are asked for.
#[derive(Debug, Clone)]
pub struct Snapshot<'a> {
    system: &'a SparseAffineSystem,
    point: OperatingPoint,
    norms: NormsAt,
    rectangle: Rectangle,
    modes: Vec<SnapshotMode>,
}

/// Mode of a large brake at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct SnapshotMode {
    /// Eigenvalue lambda, rad/s.
    pub lambda: Complex<f64>,
    /// Right vector phi, over the n free rows.
    pub right: DVector<Complex<f64>>,
    /// Left vector psi, `psi^H Q(lambda) = 0`, over the same rows.
    pub left: DVector<Complex<f64>>,
    /// Condition number of lambda, as [`Eigenpair::condition`].
    pub condition: f64,
}

impl<'a> Snapshots<'a> {
    /// No modes yet, of a system in and to the right of a rectangle, which is searched by these settings.
    #[must_use]
    pub fn new(system: &'a SparseAffineSystem, rectangle: Rectangle, options: sparse::Options) -> Self {
        let (directions, coordinates) = (DMatrix::zeros(system.order(), 0), DMatrix::zeros(0, 0));
        Self { system, rectangle, options, norms: Norms::new(system), directions, coordinates }
    }

    /// All modes at a point, in and next to the rectangle, but those that grow faster than they oscillate ([`grows_too_fast`]).
    ///
    /// # Errors
    /// A point of another system, what [`eigenpairs_in`](sparse::eigenpairs_in) refuses.
    pub fn at(&self, point: &OperatingPoint) -> Result<Snapshot<'a>, ReductionError> {
        Ok(self.known(point, self.modes(point, MARGIN, &self.options)?))
    }

    /// The modes as of [`Snapshots::at`], and those that are farther beside the rectangle, from which [`NearModes`](crate::NearModes) go out; by settings of this search.
    ///
    /// # Errors
    /// As of [`Snapshots::at`].
    pub fn modes_around(
        &self,
        point: &OperatingPoint,
        options: &sparse::Options,
    ) -> Result<Vec<SnapshotMode>, ReductionError> {
        self.modes(point, FAR_MARGIN, options)
    }

    fn modes(
        &self,
        point: &OperatingPoint,
        margin: f64,
        options: &sparse::Options,
    ) -> Result<Vec<SnapshotMode>, ReductionError> {
        let system = self.system.assemble(point)?;
        let wider = with_margin(&self.rectangle, margin);
        let mut found = eigenpairs_in(&system, &wider, options, &mut |_| ())?.pairs;
        found.retain(|mode| !grows_too_fast(mode.lambda));
        Ok(found.into_iter().map(SnapshotMode::from).collect())
    }

    /// The snapshot at a point whose modes are known, of the same system and rectangle; those far beside the rectangle are left out.
    #[must_use]
    pub fn known(&self, point: &OperatingPoint, mut modes: Vec<SnapshotMode>) -> Snapshot<'a> {
        let wider = with_margin(&self.rectangle, MARGIN);
        modes.retain(|mode| wider.contains_to_the_right(mode.lambda, 0.0));
        let (system, norms) = (self.system, self.norms.at(point));
        Snapshot { system, point: point.clone(), norms, rectangle: self.rectangle, modes }
    }

    /// Adds the right and left vectors of modes to what bases hold.
    ///
    /// # Errors
    /// Vectors that are no numbers.
    pub fn add(&mut self, snapshot: &Snapshot<'_>) -> Result<(), ReductionError> {
        let vectors = columns(&snapshot.modes);
        if vectors.ncols() == 0 {
            return Ok(());
        }
        let new = directions(&self.directions, vectors.clone(), ROUNDING)?;
        let (known, more) = (self.directions.ncols(), new.ncols());
        let mut all =
            std::mem::replace(&mut self.directions, DMatrix::zeros(0, 0)).resize_horizontally(known + more, 0.0);
        all.columns_mut(known, more).copy_from(&new);
        let own = dense::transposed_product(&all, &vectors);
        let before = self.coordinates.ncols();
        let coordinates = std::mem::replace(&mut self.coordinates, DMatrix::zeros(0, 0));
        self.coordinates = coordinates.resize(known + more, before + own.ncols(), 0.0);
        self.coordinates.columns_mut(before, own.ncols()).copy_from(&own);
        self.directions = all;
        Ok(())
    }

    /// The principal directions of all vectors, of unit length, by descending singular value down to a floor: V, n x k with k at least 1 and at most
    /// `most_columns`; with the k singular values.
    ///
    /// # Errors
    /// No mode that was added.
    pub fn basis(&self, floor: f64, most_columns: usize) -> Result<(DMatrix<f64>, Vec<f64>), ReductionError> {
        if self.coordinates.ncols() == 0 {
            return Err(ReductionError::NoModes);
        }
        let (vectors, mut values) = dense::left_singular(&self.coordinates)?;
        let count = values.iter().take_while(|&&value| value > floor).count().clamp(1, most_columns.max(1));
        values.truncate(count);
        Ok((dense::product(&self.directions, &vectors.columns(0, count).into_owned()), values))
    }
}

impl Snapshot<'_> {
    /// The modes, those next to the rectangle among them.
    #[must_use]
    pub fn into_modes(self) -> Vec<SnapshotMode> {
        self.modes
    }

    /// The eigenvalues in and to the right of the rectangle, rad/s.
    #[must_use]
    pub fn lambdas(&self) -> Vec<Complex<f64>> {
        let all = self.modes.iter().map(|mode| mode.lambda);
        all.filter(|&lambda| self.rectangle.contains_to_the_right(lambda, 0.0)).collect()
    }

    /// True if eigenvalues of a reduced system in and to the right of the rectangle, rad/s, are all counterparts of modes here, in the rectangle or next to it.
    #[must_use]
    pub fn has_all(&self, reduced: &[Complex<f64>]) -> bool {
        let inside = reduced.iter().copied().filter(|&lambda| self.rectangle.contains_to_the_right(lambda, 0.0));
        let own: Vec<_> = self.modes.iter().map(|mode| mode.lambda).collect();
        compared(&inside.collect::<Vec<_>>(), &own).missed.is_empty()
    }

    /// The largest error, relative to |lambda| and to first order, that the eigenvalues have on a basis V, n x k, of orthonormal columns:
    /// `|w^H Q(lambda) x / (lambda psi^H Q'(lambda) phi)|`, x and w the parts of the vectors phi and psi in the span of V; infinite where more than a tenth
    /// of the length of one is outside of it.
    ///
    /// # Errors
    /// Those of assembling the brake at its point.
    pub fn error(&self, basis: &DMatrix<f64>) -> Result<f64, ReductionError> {
        let Some(first) = self.modes.first() else { return Ok(0.0) };
        let held = |of: &dyn Fn(&SnapshotMode) -> &DVector<Complex<f64>>| {
            let mut vectors = split::zeros(first.right.len(), self.modes.len());
            self.modes.iter().enumerate().for_each(|(at, mode)| split::set(&mut vectors, at, of(mode).iter().copied()));
            dense::product(basis, &dense::transposed_product(basis, &vectors))
        };
        let (right, left) = (held(&|mode| &mode.right), held(&|mode| &mode.left));
        let residuals = residuals(&self.system.assemble(&self.point)?, &self.modes, &right);
        let mut largest = 0.0_f64;
        for (at, (mode, residual)) in self.modes.iter().zip(residuals).enumerate() {
            let is_lost = |side: &DMatrix<f64>| split::norm_squared(side, at) < 1.0 - MOST_MISSING.powi(2);
            let product = split::vector(&left, at).dotc(&residual).norm();
            let error = product * mode.condition / self.norms.size(mode.lambda);
            largest =
                largest.max(if is_lost(&right) || is_lost(&left) || error.is_nan() { f64::INFINITY } else { error });
        }
        Ok(largest)
    }
}

impl From<Eigenpair> for SnapshotMode {
    fn from(Eigenpair { lambda, right, left, condition, .. }: Eigenpair) -> Self {
        Self { lambda, right, left, condition }
    }
}

/// A rectangle with what is beside it, up to a fraction of the largest |lambda| in it, but for larger Re lambda.
pub(super) fn with_margin(rectangle: &Rectangle, fraction: f64) -> Rectangle {
    let margin = fraction * largest(rectangle);
    let Rectangle { re: [lowest, highest], im: [from, to] } = *rectangle;
    Rectangle { re: [lowest - margin, highest], im: [from - margin.min(0.5 * from.abs()), to + margin] }
}

/// Real and imaginary parts of the right and left vectors of modes as columns, each vector of unit length; a conjugate pair has one entry.
pub(super) fn columns(modes: &[SnapshotMode]) -> DMatrix<f64> {
    let mut columns: Vec<DVector<f64>> = Vec::new();
    let mut add = |x: &DVector<Complex<f64>>| {
        let size = x.norm();
        if size > 0.0 {
            columns.push(x.map(|x| x.re / size));
            columns.push(x.map(|x| x.im / size));
        }
    };
    for mode in modes {
        add(&mode.right);
        add(&mode.left);
    }
    let rows = modes.first().map_or(0, |mode| mode.right.len());
    if columns.is_empty() { DMatrix::zeros(rows, 0) } else { DMatrix::from_columns(&columns) }
}

/// `Q(lambda_j) x_j` of a system at the eigenvalues of `modes`, x n x m split.
fn residuals(system: &SparseSecondOrder, modes: &[SnapshotMode], x: &DMatrix<f64>) -> Vec<DVector<Complex<f64>>> {
    let [m, c, k] = [&system.m, &system.c, &system.k].map(|matrix| times(matrix, x));
    let h = system.h.as_ref().map(|h| times(h, x));
    let residual = |(at, mode): (usize, &SnapshotMode)| {
        let lambda = mode.lambda;
        let mut residual =
            split::vector(&m, at) * (lambda * lambda) + split::vector(&c, at) * lambda + split::vector(&k, at);
        h.iter().for_each(|h| residual += split::vector(h, at) * Complex::I);
        for state in &system.states {
            let drive: Complex<f64> = state
                .drive
                .iter()
                .map(|&(dof, value)| Complex::new(x[(dof, at)], x[(dof, modes.len() + at)]) * value)
                .sum();
            let pull = drive * lambda / (lambda + state.decay);
            state.force.iter().for_each(|&(dof, value)| residual[dof] -= pull * value);
        }
        residual
    };
    modes.iter().enumerate().map(residual).collect()
}
