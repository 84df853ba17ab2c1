//! The ways to evaluate a path: the secular equation, where the path leads from one gain to another, the matrices of
//! the systems at its ends, and what its owner knows.

use std::ptr;

use cea::{EigenvaluePair, GainPath, NewtonStep, OnPath, Workspace, eigenvalue_pairs, singular_vectors};
use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::path::{OwnedPath, Path, PathStart};

/// Relative distance from the predicted eigenvalue at which Q is factorised; chosen: exactly at an eigenvalue Q x, from which the
/// left vector is taken, is rounding error only. A Newton step errs by the square of this distance, which is rounding.
const FACTORISATION_OFFSET: f64 = 1e-7;

/// A shape over the degrees of freedom, up to a factor.
pub(crate) type Shape = DVector<Complex<f64>>;

/// A path, a position t on it and a guess of an eigenvalue there, rad/s.
pub(crate) type Guess<P> = OnPath<P>;

/// A path, a position t on it and a guess of a pair of eigenvalues there.
pub(crate) type PairGuess<P> = (P, f64, EigenvaluePair);

/// The operations of continuation on a path; each takes many paths at a time.
pub(crate) trait PathEvaluator: Copy {
    /// The part of the shape that a Newton step computes in passing.
    type Vector: Clone;

    /// True if the first correction counts as converged.
    const CONVERGES_AT_ONCE: bool = false;

    /// A step of Newton's method at each guess; `None` where the step is not finite.
    fn correct(at: &[Guess<Self>], work: &mut Workspace) -> Vec<Option<(NewtonStep, Self::Vector)>>;

    /// The shapes at converged eigenvalues, given with the vectors that their last Newton steps computed.
    fn shapes(at: Vec<(Guess<Self>, Self::Vector)>, work: &mut Workspace) -> Vec<Option<Shape>>;

    /// The pairs of eigenvalues that guesses lead to, with their derivatives over t; `None` where a guess leads to no pair.
    fn pairs(at: &[PairGuess<Self>], work: &mut Workspace) -> Vec<Option<[EigenvaluePair; 2]>>;
}

impl PathEvaluator for GainPath<'_> {
    /// Empty: a Newton step of the secular equation computes no shape. Shapes are computed at converged eigenvalues only.
    type Vector = ();

    fn correct(at: &[Guess<Self>], work: &mut Workspace) -> Vec<Option<(NewtonStep, ())>> {
        let is_finite = |step: &NewtonStep| step.lambda.is_finite() && step.rate.is_finite();
        GainPath::correct(at, work).into_iter().map(|step| is_finite(&step).then_some((step, ()))).collect()
    }

    fn shapes(at: Vec<(Guess<Self>, ())>, work: &mut Workspace) -> Vec<Option<Shape>> {
        let at: Vec<Guess<Self>> = at.into_iter().map(|(guess, ())| guess).collect();
        GainPath::shapes(&at, work)
    }

    fn pairs(at: &[PairGuess<Self>], work: &mut Workspace) -> Vec<Option<[EigenvaluePair; 2]>> {
        GainPath::pairs(at, work)
    }
}

/// A path evaluated by its owner.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OfOwner<'a>(&'a dyn OwnedPath);

impl PathEvaluator for OfOwner<'_> {
    type Vector = Shape;

    const CONVERGES_AT_ONCE: bool = true;

    fn correct(at: &[Guess<Self>], work: &mut Workspace) -> Vec<Option<(NewtonStep, Shape)>> {
        work.counters.factorisations += at.len() as u64;
        at.iter().map(|&(OfOwner(path), t, lambda)| path.correct(t, lambda)).collect()
    }

    fn shapes(at: Vec<(Guess<Self>, Shape)>, _: &mut Workspace) -> Vec<Option<Shape>> {
        at.into_iter().map(|(_, shape)| Some(shape)).collect()
    }

    fn pairs(at: &[PairGuess<Self>], work: &mut Workspace) -> Vec<Option<[EigenvaluePair; 2]>> {
        eigenvalue_pairs(at, |points| {
            work.counters.factorisations += points.len() as u64;
            let groups = points.chunk_by(|a, b| ptr::addr_eq(a.0.0, b.0.0));
            let of_group = |group: &[OnPath<Self>]| {
                group[0].0.0.characteristic(&group.iter().map(|&(_, t, lambda)| (t, lambda)).collect::<Vec<_>>())
            };
            groups.flat_map(of_group).collect()
        })
    }
}

/// The straight line between two systems.
///
/// Next to an eigenvalue, the right and left singular vectors x and y of the smallest singular value of `Q(lambda, t)` give
/// that eigenvalue, with an error of second order, and its derivative along the path:
///
/// ```text
/// lambda - y^H Q x / y^H Q' x,        d lambda / d t = -y^H (d Q / d t) x / y^H Q' x
/// ```
///
/// (Lancaster, Numer. Math. 6, 1964). One factorisation of Q costs a small part of a spectrum.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SystemPath<'a> {
    path: Path<'a>,
    from: &'a SecondOrder,
}

impl PathEvaluator for SystemPath<'_> {
    type Vector = Shape;

    fn correct(at: &[Guess<Self>], work: &mut Workspace) -> Vec<Option<(NewtonStep, Shape)>> {
        let mut found = Vec::with_capacity(at.len());
        for group in at.chunk_by(|a, b| a.0.from.order() == b.0.from.order()) {
            let systems: Vec<SecondOrder> = group.iter().map(|(at, t, _)| at.path.system_from(at.from, *t)).collect();
            let guesses: Vec<_> = group.iter().map(|(.., guess)| guess * (1.0 + FACTORISATION_OFFSET)).collect();
            let stiffness: Vec<_> =
                systems.iter().zip(&guesses).map(|(system, &lambda)| system.dynamic_stiffness(lambda)).collect();
            let vectors = singular_vectors(&stiffness, work);
            let step = |(i, vector): (usize, Option<Shape>)| {
                let step = group[i].0.newton(&systems[i], guesses[i], &stiffness[i], vector.as_ref()?)?;
                Some((step, vector?))
            };
            found.extend(vectors.into_iter().enumerate().map(step));
        }
        found
    }

    fn shapes(at: Vec<(Guess<Self>, Shape)>, _: &mut Workspace) -> Vec<Option<Shape>> {
        at.into_iter().map(|(_, shape)| Some(shape)).collect()
    }

    /// None: sixteen determinants of the system for each pair cost more than a spectrum.
    fn pairs(at: &[PairGuess<Self>], _: &mut Workspace) -> Vec<Option<[EigenvaluePair; 2]>> {
        vec![None; at.len()]
    }
}

impl SystemPath<'_> {
    /// A Newton step from `lambda`, where `stiffness` is Q and x the right singular vector of its smallest singular value.
    fn newton(
        &self,
        system: &SecondOrder,
        lambda: Complex<f64>,
        stiffness: &DMatrix<Complex<f64>>,
        x: &Shape,
    ) -> Option<NewtonStep> {
        let mut y = stiffness * x;
        let size = y.norm();
        y.unscale_mut(size);
        let slope = y.dotc(&system.derivative_times(lambda, x));
        let rate = -y.dotc(&self.change(lambda, x)) / slope;
        let lambda = lambda - size / slope;
        (lambda.is_finite() && rate.is_finite()).then_some(NewtonStep { lambda, rate })
    }

    /// `d Q(lambda) / d t x = (Q_end(lambda) - Q_start(lambda)) x`.
    fn change(&self, lambda: Complex<f64>, x: &Shape) -> Shape {
        let (from, to) = (self.from, self.path.end.system);
        let mut change = DVector::zeros(x.len());
        let matrices =
            [(&from.m, &to.m, lambda * lambda), (&from.c, &to.c, lambda), (&from.k, &to.k, Complex::new(1.0, 0.0))];
        for (a, b, factor) in matrices {
            let columns = a.as_slice().chunks_exact(x.len()).zip(b.as_slice().chunks_exact(x.len()));
            for ((a, b), x) in columns.zip(x) {
                // In most paths few columns change; the others are skipped.
                if a != b {
                    let factor = factor * x;
                    change.iter_mut().zip(a.iter().zip(b)).for_each(|(change, (a, b))| *change += factor * (b - a));
                }
            }
        }
        for (end, sign) in [(&from.internal, 1.0), (&to.internal, -1.0)] {
            for (s, &decay) in end.decay.iter().enumerate() {
                let reading: Complex<f64> = end.drive.row(s).iter().zip(x).map(|(drive, x)| x * drive).sum();
                let gain = sign * lambda / (lambda + decay) * reading;
                change.iter_mut().zip(&end.force.column(s)).for_each(|(change, force)| *change += gain * force);
            }
        }
        change
    }
}

impl<'a> Path<'a> {
    /// The path of gains, if the secular equation evaluates this path.
    pub(crate) fn as_gains(&self) -> Option<GainPath<'a>> {
        if let PathStart::Gain(gains) = self.start { Some(gains) } else { None }
    }

    /// The path of an owner, if its owner evaluates this path.
    pub(crate) fn as_owned(&self) -> Option<OfOwner<'a>> {
        if let PathStart::Owned(_, path) = self.start { Some(OfOwner(path)) } else { None }
    }

    /// The path of systems, if the matrices of its ends evaluate this path.
    pub(crate) fn as_systems(&self) -> Option<SystemPath<'a>> {
        if let PathStart::System(from) = self.start { Some(SystemPath { path: *self, from }) } else { None }
    }
}
