//! Coarse modes: those of a reduced brake on fewer columns still, from which its own are a few steps away.
//!
//! Right and left vectors of the modes at some operating points span the coarse basis W. With both sides the error of an eigenvalue is the product of
//! what is missing on each, so that half as many columns hold eigenvalues to five digits as hold shapes to the residual that is asked for, and a whole
//! spectrum on them takes a tenth of the time or less. Internal states of the friction law, one for each contact, lie in a few directions as well.
//!
//! A sample is solved in three steps: all eigenvalues on W; the residual of each mode in and next to the rectangle, on the basis of the reduced brake: the
//! square of its ratio to the largest residual at the points that W was made of tells the error of the mode; and two-sided inverse iteration on that basis
//! for the modes that may be wanted. A sample in which any of this fails has a [`Doubt`], and gets the whole spectrum of the reduced brake.

use cea::{CeaError, Spectrum, Workspace, right_vectors_of_all};
use linsys::{AffineSystem, OperatingPoint, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::coarse_states::{CoarseStates, apart, of_mode, with_states};
use super::compared::compared;
use super::directions::{ROUNDING, directions, fewest};
use super::inverse_iteration::{Nonlinear, Pair, have_merged};
use super::residual::reduced_residual;
use super::spectra::{Shapes, spectra, vectors};
use super::{Reduced, dense, split};
use crate::ReductionError;

/// Largest distance, relative to |lambda|, of a mode on the coarse basis from the mode of the reduced brake at the points of which the basis was made; chosen:
/// with less, the basis has more columns; with more, more modes of samples have to be polished or found by whole spectra.
const WANTED_ERROR: f64 = 1e-5;
/// Least distance that is assumed there; chosen: far above rounding, where the basis holds the modes as they are.
const LEAST_ERROR: f64 = 1e-9;
/// Largest distance from the rectangle, as a fraction of |lambda|, of modes that shape the basis too; chosen: others come into it from there.
const MARGIN: f64 = 0.01;
/// Factor from the largest distance at these points to the distance that is assumed of a mode of a sample; chosen: with less, distances of samples may be
/// larger than assumed; with more, more modes are polished.
const MORE_DISTANCE: f64 = 10.0;
/// Largest error, relative to |lambda|, that a coarse mode of a sample may be thought to have; chosen: as far apart two modes may be one.
const MOST_ERROR: f64 = 1e-3;
/// Most columns of a coarse basis that spares anything, as a fraction of those of the reduced brake; chosen: with as many, its spectra take as long.
const WORTH: f64 = 0.8;
/// Most inverse iterations of one mode; chosen: each triples the digits, and a mode that needs more is another one.
const MOST_ITERATIONS: usize = 4;
/// Distance of a mode from the nearest other one, relative to |lambda|, below which its error is larger: in inverse proportion to the distance, and at a
/// coalescence, at most, the root of this number times the error. Chosen: no farther from each other are two neighbours at most without their coupling; an
/// error of the coupling, times that, moves the square of half their distance.
const DETUNING: f64 = 0.05;
/// Largest change of an eigenvalue by the last iteration, relative to |lambda|; chosen.
const SETTLED: f64 = 1e-7;

/// Why a sample got the whole spectrum of the reduced brake.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Doubt {
    /// A residual of a coarse mode was so large that it may be no mode, or no number.
    Residual,
    /// The iteration for a mode did not converge, or ended far from its coarse one.
    Moved,
    /// Two coarse modes became one, or one became what is nearer to another.
    Merged,
    /// A mode with dashpots in the place of loss factors did not lead to one of its own with these.
    Loss,
}

/// A coarse basis within the basis of a reduced brake, with the brake on it.
#[derive(Debug, Clone)]
pub(super) struct Coarse {
    own: CoarseBasis,
    system: AffineSystem,
}

/// A coarse basis within the basis of a reduced brake, as it can be kept: [`Reduced::on_coarse`] puts the brake on it.
#[derive(Debug, Clone, PartialEq)]
pub struct CoarseBasis {
    /// W, k x w, orthonormal.
    pub basis: DMatrix<f64>,
    /// Directions of internal states; `None` for a brake without internal states, and where the directions spare nothing.
    pub states: Option<CoarseStates>,
    /// The largest distance of a mode on it from that of the reduced brake, relative to |lambda|, at the points that it was made of; at least 1e-9.
    pub error: f64,
    /// The largest residual there of a mode on it, in the reduced brake.
    pub residual: f64,
}

/// Modes of the reduced brake at a point: eigenvalues, rad/s, and shapes, split, k x 2 m.
pub(super) type Polished = (Vec<Complex<f64>>, DMatrix<f64>);

impl Coarse {
    /// The coarse basis of the modes of a reduced brake at `points`; `None` where it would spare nothing.
    pub fn new(reduced: &Reduced, points: &[OperatingPoint]) -> Result<Option<Self>, ReductionError> {
        let systems =
            points.iter().map(|point| reduced.system().assemble(point)).collect::<Result<Vec<SecondOrder>, _>>()?;
        let known = spectra(&systems).into_iter().map(|found| Ok(reduced.next_to_rectangle(&found?, MARGIN)));
        let known = known.collect::<Result<Vec<_>, CeaError>>()?;
        let both = vectors(&systems, &known)?;
        let transposed: Vec<SecondOrder> = systems.iter().map(SecondOrder::transposed).collect();
        let channels = reduced.system().channels();
        let of_point = |at: usize| {
            let of = |(system, shapes): (&SecondOrder, &Shapes)| {
                let [of_contacts, _] = apart(channels, &points[at], &system.internal);
                let modes = shapes.iter().zip(&known[at]);
                modes.filter_map(|(shape, &lambda)| of_mode(&of_contacts, lambda, shape)).collect::<Shapes>()
            };
            [&systems[at], &transposed[at]].into_iter().zip(&both[at]).flat_map(of).collect()
        };
        let states = CoarseStates::new(channels, points, &(0..points.len()).map(of_point).collect::<Vec<_>>())?;
        let shapes: Vec<_> = both.iter().flatten().flatten().collect();
        if shapes.is_empty() {
            return Ok(None);
        }
        let columns = split::from_columns(&DMatrix::from_columns(&shapes.into_iter().cloned().collect::<Vec<_>>()));
        let empty = DMatrix::zeros(columns.nrows(), 0);
        let found = directions(&empty, columns, ROUNDING)?;
        let on = |basis: DMatrix<f64>| -> Result<Self, ReductionError> {
            let states = states.clone();
            Self::on(reduced, CoarseBasis { basis, states, error: f64::INFINITY, residual: f64::INFINITY })
        };
        let error = |basis: &DMatrix<f64>| {
            let measured = on(basis.clone()).and_then(|coarse| coarse.distance(reduced, points, &known));
            measured.unwrap_or(f64::INFINITY)
        };
        let most = (WORTH * columns_of(reduced)) as usize;
        if most == 0 {
            return Ok(None);
        }
        let mut coarse = on(fewest(&found, most, WANTED_ERROR, error))?;
        coarse.own.error = coarse.distance(reduced, points, &known)?.max(LEAST_ERROR);
        if coarse.own.error > WANTED_ERROR {
            return Ok(None);
        }
        coarse.own.residual = 0.0;
        let modes = coarse.modes(reduced, &points.iter().collect::<Vec<_>>());
        for ((at, modes), system) in points.iter().zip(modes).zip(&systems) {
            let (lambdas, shapes) = modes?;
            let residuals = residuals(reduced, at, system, &lambdas, &shapes);
            if residuals.iter().any(|residual| residual.is_nan()) {
                return Ok(None);
            }
            coarse.own.residual = residuals.into_iter().fold(coarse.own.residual, f64::max);
        }
        Ok(Some(coarse))
    }

    /// A reduced brake on a coarse basis.
    pub fn on(reduced: &Reduced, own: CoarseBasis) -> Result<Self, ReductionError> {
        let system = reduced.system().projected(&own.basis)?;
        Ok(Self { own, system })
    }

    /// Error, relative to |lambda|, that an eigenvalue on the coarse basis with a residual may have: it is quadratic in what is missing of both vectors.
    /// Next to another mode, at a distance relative to |lambda|, it is larger.
    fn error_of(&self, residual: f64, distance: f64) -> f64 {
        if residual.is_nan() {
            return f64::INFINITY;
        }
        let error = MORE_DISTANCE * self.own.error * (residual / self.own.residual).max(1.0).powi(2);
        error * (DETUNING / distance.max((DETUNING * error).sqrt())).max(1.0)
    }

    /// The basis, as it can be kept.
    pub fn own(&self) -> &CoarseBasis {
        &self.own
    }

    /// The wanted modes of the reduced brake at `points`, with its `systems` there: those whose eigenvalue, rad/s, `may_be_wanted`, given its relative
    /// error. Where a point has a doubt it is the error, and never `None` here.
    pub fn polished(
        &self,
        reduced: &Reduced,
        (points, systems): (&[&OperatingPoint], &[&SecondOrder]),
        may_be_wanted: &dyn Fn(Complex<f64>, f64) -> bool,
    ) -> Vec<Result<Polished, Option<Doubt>>> {
        let found = self.modes(reduced, points).into_iter().zip(points.iter().copied().zip(systems.iter().copied()));
        let of_point = |(found, (at, system)): (Result<Polished, ReductionError>, (&OperatingPoint, &SecondOrder))| {
            let (lambdas, shapes) = found.map_err(|_| Doubt::Residual)?;
            let residuals = residuals(reduced, at, system, &lambdas, &shapes);
            let alone = |mode: usize| self.error_of(residuals[mode], f64::INFINITY);
            if !(0..lambdas.len()).all(|mode| alone(mode) <= MOST_ERROR) {
                return Err(Some(Doubt::Residual));
            }
            let error = |mode: usize| self.error_of(residuals[mode], nearest_other(&lambdas, mode));
            let errors: Vec<f64> = (0..lambdas.len()).map(error).collect();
            let wanted: Vec<usize> =
                (0..lambdas.len()).filter(|&mode| may_be_wanted(lambdas[mode], errors[mode])).collect();
            let one = |mode: usize| {
                let coarse = (lambdas[mode], split::vector(&shapes, mode));
                next_to(reduced, at, system, coarse, errors[mode])
            };
            let modes = wanted.iter().map(|&mode| one(mode)).collect::<Option<Vec<_>>>().ok_or(Doubt::Moved)?;
            let is_others = |(&own, (lambda, _)): (&usize, &(Complex<f64>, _))| {
                let nearest = nearest(&lambdas, *lambda);
                nearest.is_some_and(|nearest| nearest != own && !wanted.contains(&nearest))
            };
            if have_merged(&modes) || wanted.iter().zip(&modes).any(is_others) {
                return Err(Some(Doubt::Merged));
            }
            let mut polished = split::zeros(system.order(), modes.len());
            modes.iter().enumerate().for_each(|(to, (_, shape))| split::set(&mut polished, to, shape.iter().copied()));
            Ok((modes.into_iter().map(|(lambda, _)| lambda).collect(), polished))
        };
        found.map(of_point).collect()
    }

    /// The modes in and next to the rectangle on the coarse basis, with shapes of the reduced brake.
    fn modes(&self, reduced: &Reduced, points: &[&OperatingPoint]) -> Vec<Result<Polished, ReductionError>> {
        let made = points.iter().map(|point| self.at(point)).collect::<Vec<_>>();
        let systems: Vec<SecondOrder> = made.iter().flatten().cloned().collect();
        let found = spectra(&systems);
        let slack = MORE_DISTANCE * self.own.error;
        let near_rectangle = |found: &Result<Spectrum, CeaError>| match found {
            Ok(found) => reduced.next_to_rectangle(found, slack),
            Err(_) => Vec::new(),
        };
        let near: Vec<Vec<Complex<f64>>> = found.iter().map(near_rectangle).collect();
        let of: Vec<(&SecondOrder, &[Complex<f64>])> = systems.iter().zip(near.iter().map(Vec::as_slice)).collect();
        let mut shapes = right_vectors_of_all(&of, &mut Workspace::default()).into_iter();
        let mut found = found.into_iter().zip(near);
        let one = |made: Result<SecondOrder, ReductionError>| {
            made?;
            let (Some((spectrum, near)), Some(shapes)) = (found.next(), shapes.next()) else {
                return Ok((Vec::new(), split::zeros(self.own.basis.nrows(), 0)));
            };
            spectrum?;
            let mut of_coarse = split::zeros(self.own.basis.ncols(), near.len());
            shapes?.iter().enumerate().for_each(|(at, shape)| split::set(&mut of_coarse, at, shape.iter().copied()));
            Ok((near, dense::product(&self.own.basis, &of_coarse)))
        };
        made.into_iter().map(one).collect()
    }

    /// The largest distance, relative to |lambda|, of the `known` modes in and next to the rectangle at `points` from those on the coarse basis; infinite
    /// where one in it is missing, or one is there that is not known.
    fn distance(
        &self,
        reduced: &Reduced,
        points: &[OperatingPoint],
        known: &[Vec<Complex<f64>>],
    ) -> Result<f64, ReductionError> {
        let systems = points.iter().map(|point| self.at(point)).collect::<Result<Vec<_>, _>>()?;
        let mut largest = 0.0_f64;
        for (found, known) in spectra(&systems).into_iter().zip(known) {
            let found = reduced.next_to_rectangle(&found?, MARGIN);
            let found = compared(known, &found);
            let is_inside = |lambda: &Complex<f64>| {
                reduced.rectangle().contains_to_the_right(*lambda, -WANTED_ERROR * lambda.norm())
            };
            if found.missed.iter().chain(&found.left).any(is_inside) {
                return Ok(f64::INFINITY);
            }
            largest = largest.max(found.distance);
        }
        Ok(largest)
    }

    /// The coarse brake at a point, its internal states in their directions.
    pub fn at(&self, point: &OperatingPoint) -> Result<SecondOrder, ReductionError> {
        let mut system = self.system.assemble(point)?;
        let channels = self.system.channels();
        if let Some(states) = self.own.states.as_ref().filter(|of| of.channels == with_states(channels, point)) {
            system.internal = states.of(apart(channels, point, &system.internal));
        }
        Ok(system)
    }
}

/// The mode of a reduced brake next to a coarse one with an error, relative to |lambda|, by inverse iteration on both sides; `None` where it does not
/// converge, or not there.
fn next_to(reduced: &Reduced, at: &OperatingPoint, system: &SecondOrder, coarse: Pair, error: f64) -> Option<Pair> {
    let problem = Nonlinear {
        matrix: |lambda| system.dynamic_stiffness(lambda),
        image: |lambda, x: &DVector<Complex<f64>>| image(system, lambda, x),
        slope: |lambda, x: &DVector<Complex<f64>>| system.derivative_times(lambda, x),
    };
    problem.led_from(coarse, (error, MOST_ITERATIONS), |lambda, right, step| {
        let shape = split::from_columns(&DMatrix::from_columns(std::slice::from_ref(right)));
        step <= SETTLED * lambda.norm() && residuals(reduced, at, system, &[lambda], &shape)[0] <= reduced.converged()
    })
}

/// `Q(lambda) x`.
fn image(system: &SecondOrder, lambda: Complex<f64>, x: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
    let x = split::from_columns(&DMatrix::from_columns(std::slice::from_ref(x)));
    split::vector(&reduced_residual(system, &[lambda], &x), 0)
}

/// Residuals of modes of a reduced brake in it, relative to the size of the terms of Q and the length of the shapes.
fn residuals(
    reduced: &Reduced,
    at: &OperatingPoint,
    system: &SecondOrder,
    lambdas: &[Complex<f64>],
    shapes: &DMatrix<f64>,
) -> Vec<f64> {
    let norms = reduced.norms(at);
    let residuals = split::norms(&reduced_residual(system, lambdas, shapes)).into_iter().zip(split::norms(shapes));
    residuals.zip(lambdas).map(|((residual, size), &lambda)| residual / (size * norms.size(lambda))).collect()
}

/// Index of the eigenvalue that is nearest to a number.
fn nearest(lambdas: &[Complex<f64>], to: Complex<f64>) -> Option<usize> {
    let distance = |at: usize| (lambdas[at] - to).norm();
    (0..lambdas.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b)))
}

/// Distance of an eigenvalue from the nearest other eigenvalue, relative to its size; infinite where there is no other.
fn nearest_other(lambdas: &[Complex<f64>], own: usize) -> f64 {
    let others = lambdas.iter().enumerate().filter(|(at, _)| *at != own);
    others.map(|(_, other)| (other - lambdas[own]).norm() / lambdas[own].norm()).fold(f64::INFINITY, f64::min)
}

/// Columns of a reduced brake.
fn columns_of(reduced: &Reduced) -> f64 {
    reduced.system().order() as f64
}
