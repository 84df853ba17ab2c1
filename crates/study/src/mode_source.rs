//! The capability of a brake that finds its modes itself: a reduction of a full model, which knows some of its modes.

use cea::{Mode, Threshold, Verdict};
use linsys::{OperatingPoint, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use tracking::OwnedPath;

use crate::{Error, FullChecks, Scene};

/// The residual of a mode in the system that a brake is a reduction of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeResidual {
    /// Norm of the residual relative to `|lambda|^2 |M| + |lambda| |C| + |K|`.
    pub value: f64,
    /// True if the residual is above the one that was asked for.
    pub is_above: bool,
}

/// A mode that a brake finds itself.
#[derive(Debug, Clone, PartialEq)]
pub struct BandMode {
    /// The eigenvalue, rad/s.
    pub lambda: Complex<f64>,
    /// The shape over the free degrees of freedom of the configuration.
    pub shape: DVector<Complex<f64>>,
    /// Error bound of the eigenvalue, rad/s: a mode nearer than that to the threshold of the plan is undecided.
    pub bound: f64,
    /// True if the mode is on the imaginary axis for a reason that no error changes, as of a brake without damping.
    pub is_on_axis: bool,
    /// The residual in the full model that the brake is a reduction of; `None` for a brake that is not reduced.
    pub residual: Option<ModeResidual>,
}

impl BandMode {
    /// The verdict on the mode: what is on the axis is marginal where any growth counts, and of a threshold beside the axis its margin tells.
    pub fn verdict(&self, threshold: &Threshold) -> Verdict {
        match self.is_on_axis && threshold.is_axis() {
            true => Verdict::Marginal { tolerance: self.bound },
            false => threshold.verdict(self.lambda, self.bound),
        }
    }
}

/// An eigenvalue of the full model, of which the brake is a reduction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WholeEigenvalue {
    /// Eigenvalue, rad/s.
    pub lambda: Complex<f64>,
    /// Error bound of the eigenvalue to first order, rad/s, for matrices that are rounded.
    pub bound: f64,
}

/// A brake at two operating points of a scene in fewer coordinates.
#[derive(Debug)]
pub struct CoarsePath<'a> {
    /// The brake at both points.
    pub systems: [SecondOrder; 2],
    /// Basis of these coordinates in the coordinates of the scene, orthonormal columns.
    pub basis: &'a DMatrix<f64>,
}

/// Common subspace of an origin and a configuration: a larger brake, of which both are reductions, in coordinates that they have in common.
/// There the modes of the origin are followed to the modes of the configuration.
#[derive(Debug)]
pub struct Bridge {
    /// The larger brake at the operating point of the origin.
    pub start: SecondOrder,
    /// The larger brake at the naming point of the configuration.
    pub end: SecondOrder,
    /// The path between these, where the brake evaluates it in a cheaper way than by matrices.
    pub path: Option<Box<dyn OwnedPath>>,
    /// The coordinates of the origin in the common coordinates, as columns.
    pub origin: DMatrix<f64>,
    /// The coordinates of the configuration in the common coordinates, as columns.
    pub configuration: DMatrix<f64>,
    /// The coordinates of the origin in the coordinates of the configuration, as columns, as near as these come: both are orthonormal, so that a shape of which
    /// these hold little is short there.
    pub between: DMatrix<f64>,
}

/// The modes of a brake in the band of its plan, which it must have, found by the brake. It has one sector, and shows no divergence.
pub trait ModeSource: Sync {
    /// The modes of samples of a scene in the band of the plan, given their operating points; those that are surely stable may be missing.
    ///
    /// # Errors
    /// Of a sample: an operating point of another scene, a system that is not supported.
    fn band_modes(&self, scene: &Scene, at: &[OperatingPoint]) -> Vec<Result<Vec<BandMode>, Error>>;

    /// True if the system of a scene has dashpots where the brake has loss factors, which no real system has: its eigenvalues are then only near the
    /// eigenvalues of [`band_modes`](Self::band_modes).
    fn has_dashpots_for_losses(&self, scene: &Scene) -> bool;

    /// The modes as by [`band_modes`](Self::band_modes) with parameters at `values`, as [`Parametrised::system_with`](crate::Parametrised::system_with) takes
    /// them; nothing is asked of the full model, so that verdicts within the error of the reduction stay open.
    ///
    /// # Errors
    /// As there; a value that is not allowed.
    fn band_modes_with(&self, scene: &Scene, values: &[(usize, f64)]) -> Result<Vec<BandMode>, Error>;

    /// The modes as by [`band_modes_with`](Self::band_modes_with) of a `changed` system of a scene: with masses, springs and dashpots attached, or contacts taken
    /// out. `at` has the coefficients of the terms that the changes leave, which say the losses; its channels have no part in it.
    ///
    /// # Errors
    /// A system of another order, or one that is not supported.
    fn band_modes_of_changed(
        &self,
        scene: &Scene,
        at: &OperatingPoint,
        changed: &SecondOrder,
    ) -> Result<Vec<BandMode>, Error>;

    /// The brake of a scene at two operating points in fewer coordinates, in which modes are followed from the one to the other; `None` without such
    /// coordinates.
    ///
    /// # Errors
    /// An operating point of another scene.
    fn coarse(&self, scene: &Scene, at: [&OperatingPoint; 2]) -> Result<Option<CoarsePath<'_>>, Error>;

    /// The common subspace of a configuration, by its index in the plan, and its origin; `None` where the degrees of freedom of both are
    /// the same. `modes` are the modes of the origin and of the configuration.
    ///
    /// # Errors
    /// Medians that have no operating point.
    fn bridge(&self, configuration: usize, modes: [&[Mode]; 2]) -> Result<Option<Bridge>, Error>;

    /// Relative error of an eigenvalue of the reduced system of a scene against the full model: a rule, not a bound. Of a scene with dashpots for loss
    /// factors the error of a mode by [`band_modes`](Self::band_modes) is smaller: only the system is beside the brake there.
    fn relative_error(&self, scene: &Scene) -> f64;

    /// Reason why nothing is known of the errors of a scene, which leaves all its verdicts open; `None` where they are known.
    fn unknown_error(&self, scene: &Scene) -> Option<&'static str>;

    /// The eigenvalue of the full model next to `near`, with parameters at `values`, as
    /// [`Parametrised::system_with`](crate::Parametrised::system_with) takes them.
    ///
    /// # Errors
    /// Values without an operating point, an eigenvalue that cannot be found.
    fn whole_eigenvalue(
        &self,
        scene: &Scene,
        values: &[(usize, f64)],
        near: Complex<f64>,
    ) -> Result<WholeEigenvalue, Error>;

    /// The eigenvalue of the brake, rad/s, for the eigenvalue `lambda` of a mode at the origin of a set of constraints in the system in which the mode is
    /// followed: the two differ where dashpots stand there for loss factors.
    fn eigenvalue_at_origin(&self, constraints: usize, lambda: Complex<f64>) -> Complex<f64>;

    /// The shape of a mode of the origin of a set of constraints at chosen degrees of freedom of the full model, by their names: few enough for a table, and
    /// the same ones in every study of this model, whatever its reduction.
    fn whole_shape(&self, constraints: usize, shape: &DVector<Complex<f64>>) -> Vec<(String, Complex<f64>)>;

    /// Number of samples by the route on which their modes were found since the brake was made, by its name.
    fn routes(&self) -> Vec<(&'static str, u64)>;

    /// Results of the draws checked against the full model; `None` where none was checked.
    fn full_checks(&self) -> Option<&FullChecks>;
}
