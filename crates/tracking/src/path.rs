//! The path from one system to another, and the points of a path.

use std::borrow::Cow;
use std::fmt::Debug;

use cea::{CeaError, GainPath, Mode, NewtonStep};
use linsys::{Internal, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

/// A path from one system, with the modes to be followed, to another system whose modes are known.
///
/// The path is the straight line `Q(lambda, t) = (1 - t) Q_start(lambda) + t Q_end(lambda)`, 0 <= t <= 1 (a homotopy), between two
/// systems with equally many degrees of freedom; their internal states may differ, also in number. Where the systems differ
/// in the stiffness of a contact, this is the continuation in that stiffness.
#[derive(Debug, Clone, Copy)]
pub struct Path<'a> {
    /// The system at t = 0.
    pub start: PathStart<'a>,
    /// The modes at t = 0 that are to be followed.
    pub start_modes: &'a [Mode],
    /// The system at t = 1 and its modes.
    pub end: PathEnd<'a>,
}

/// The beginning of a path, which says how the path is evaluated.
#[derive(Debug, Clone, Copy)]
pub enum PathStart<'a> {
    /// A system: the path is evaluated by its matrices.
    System(&'a SecondOrder),
    /// A path that its owner evaluates, from a system with this mass matrix.
    Owned(&'a DMatrix<f64>, &'a dyn OwnedPath),
    /// A structure with a gain, where the end of the path is the same structure with another gain: the path is evaluated by
    /// the secular equation, which is cheaper.
    Gain(GainPath<'a>),
}

/// An eigenvalue, rad/s, with its shape up to a factor.
pub type Eigenpair = (Complex<f64>, DVector<Complex<f64>>);

/// A path that its owner evaluates, because it knows a cheaper way than by the matrices: from all contacts closed to some of them open, say. It is
/// the straight line between the systems at its ends, as every [`Path`].
pub trait OwnedPath: Debug + Sync {
    /// The eigenvalue at `t` that a guess, rad/s, leads to, converged to a relative error of 1e-4 or less, as no further correction follows; its derivative over t; and its
    /// shape up to a factor. `None` where the guess leads to no eigenvalue.
    fn correct(&self, t: f64, lambda: Complex<f64>) -> Option<(NewtonStep, DVector<Complex<f64>>)>;

    /// Values of a function of t and lambda that is analytic near the eigenvalues and has them as zeros, det Q for one; the same function at all points, up to one
    /// factor for them all. Points go beyond t = 1 by 1e-7, for differences.
    fn characteristic(&self, at: &[(f64, Complex<f64>)]) -> Vec<Complex<f64>>;

    /// Eigenvalues at `t`, the `count` nearest to each number in `to`, rad/s, every one of them once, with shapes up to a
    /// factor; `None` where the owner cannot tell, so that a spectrum is taken.
    fn nearest(&self, _t: f64, _to: &[Complex<f64>], _count: usize) -> Option<Vec<Eigenpair>> {
        None
    }

    /// The system at the beginning, of which spectra are taken where all else leaves a mode in doubt.
    ///
    /// # Errors
    /// A system that cannot be made.
    fn system(&self) -> Result<SecondOrder, CeaError>;
}

/// The end of a path.
#[derive(Debug, Clone, Copy)]
pub struct PathEnd<'a> {
    /// The system at the end.
    pub system: &'a SecondOrder,
    /// Modes of this system.
    pub modes: &'a [Mode],
}

/// Indices of the modes at the end of a path that each mode at its beginning may have become: one index where the
/// mode is identified, several where it is in doubt, none where it ceased to oscillate.
pub type Links = Vec<Vec<usize>>;

/// A point of a path, and an eigenvalue there or a guess of one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PathPoint<'a> {
    pub path: Path<'a>,
    /// Position on the path, 0 at its beginning and 1 at its end.
    pub t: f64,
    /// Eigenvalue lambda, or a guess of it, rad/s.
    pub lambda: Complex<f64>,
}

impl<'a> PathStart<'a> {
    /// The mass matrix at the beginning.
    fn mass(&self) -> &'a DMatrix<f64> {
        match self {
            Self::System(system) => &system.m,
            Self::Owned(mass, _) => mass,
            Self::Gain(gains) => &gains.secular.structure().m,
        }
    }

    /// The system at the beginning.
    fn system(&self) -> Result<Cow<'a, SecondOrder>, CeaError> {
        Ok(match self {
            Self::System(system) => Cow::Borrowed(system),
            Self::Owned(_, path) => Cow::Owned(path.system()?),
            Self::Gain(gains) => Cow::Owned(gains.secular.system(&gains.from)),
        })
    }
}

impl<'a> Path<'a> {
    /// The mass matrix at the beginning.
    pub(crate) fn mass(&self) -> &'a DMatrix<f64> {
        self.start.mass()
    }

    /// The system at t.
    ///
    /// # Errors
    /// A system at the beginning that its owner cannot make.
    pub(crate) fn system_at(&self, t: f64) -> Result<SecondOrder, CeaError> {
        Ok(self.system_from(&*self.start.system()?, t))
    }

    /// The system at t of a path from a system. It has the internal states of both ends; their forces are scaled by 1 - t and t.
    pub(crate) fn system_from(&self, start: &SecondOrder, t: f64) -> SecondOrder {
        let end = self.end.system;
        let mix = |a: &DMatrix<f64>, b: &DMatrix<f64>| a.zip_map(b, |a, b| (1.0 - t) * a + t * b);
        let (n, first, all) = (start.order(), start.states(), start.states() + end.states());
        let mut internal = Internal::zeros(n, all);
        for (states_of, at, part) in [(&start.internal, 0, 1.0 - t), (&end.internal, first, t)] {
            let states = states_of.decay.len();
            internal.decay.rows_mut(at, states).copy_from(&states_of.decay);
            internal.drive.rows_mut(at, states).copy_from(&states_of.drive);
            internal.force.columns_mut(at, states).copy_from(&(&states_of.force * part));
        }
        SecondOrder { m: mix(&start.m, &end.m), c: mix(&start.c, &end.c), k: mix(&start.k, &end.k), internal }
    }
}
