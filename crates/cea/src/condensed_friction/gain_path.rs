//! Modes with feedback: their shapes, and their eigenvalues along a path of gains.

use std::ptr;

use nalgebra::DVector;
use num_complex::Complex;

use super::response::{Point, characteristic, secular_matrices};
use super::{Gain, MIDDLE_FREQUENCY, Resolvent, Secular};
use crate::dense::{NullVector, null_vectors, start};
use crate::eigenvalue_pair::{EigenvaluePair, eigenvalue_pairs};
use crate::{Mode, Workspace};

/// Steps of the differences that derivatives are computed by, relative to the eigenvalue and to the length of the path; chosen near the square
/// root of machine epsilon.
const DIFFERENCE_STEP: f64 = 1e-7;
/// Largest relative residual of the secular equation's null vector at an eigenvalue; chosen. The residual is large for an uncontrollable
/// mode, whose shape is no response to feedback forces.
const LARGEST_RESIDUAL: f64 = 1e-8;
/// Largest such residual at an approximation of an eigenvalue on a path; chosen: larger, as there the equation has no zero to rounding.
const LARGEST_RESIDUAL_ON_PATH: f64 = 1e-3;
/// Largest relative distance of two eigenvalues that may share one shape, so that no shapes are given; chosen.
const LEAST_SEPARATION: f64 = 1e-6;
/// Largest relative distance from the eigenvalue of an uncontrollable mode at which an eigenvalue counts as equal to it; chosen, of the size of rounding.
const UNCONTROLLABLE_DISTANCE: f64 = 1e-13;

/// The path from one gain of a structure to another: `Q(lambda, t) = (1 - t) Q_from(lambda) + t Q_to(lambda)`, 0 <= t <= 1.
#[derive(Debug, Clone, Copy)]
pub struct GainPath<'a> {
    /// The structure.
    pub secular: &'a Secular,
    /// The gain at the beginning.
    pub from: Gain,
    /// The gain at the end.
    pub to: Gain,
}

/// Step of Newton's method next to an eigenvalue on a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NewtonStep {
    /// The next guess of the eigenvalue, rad/s.
    pub lambda: Complex<f64>,
    /// Rate d lambda / d t there, rad/s.
    pub rate: Complex<f64>,
}

impl GainPath<'_> {
    pub(super) fn at(&self, t: f64, sigma: Complex<f64>) -> Point {
        let unit = self.secular.resolvent.unit;
        let [from, to] = [self.from, self.to].map(|gain| gain.in_units(unit).at(sigma));
        let mix = 1.0 - t;
        Point { sigma, mu: mix * from.mu + t * to.mu, slope: from.slope * mix + to.slope * t }
    }

    /// Steps of Newton's method for the secular equation, one from each guess of an eigenvalue in `at`, rad/s, which is on a path at a
    /// position t. Each step costs three values of the equation, computed in batches per structure. The derivatives are
    /// differences, with relative errors of about 1e-7. A step is not finite where the equation has no value or no slope.
    pub fn correct(at: &[(Self, f64, Complex<f64>)], work: &mut Workspace) -> Vec<NewtonStep> {
        let (mut found, mut values) = (Vec::with_capacity(at.len()), Vec::new());
        for group in at.chunk_by(|a, b| ptr::eq(a.0.secular, b.0.secular)) {
            let resolvent = &group[0].0.secular.resolvent;
            let three = |(path, t, guess): &(GainPath<'_>, f64, Complex<f64>)| {
                let sigma = guess / resolvent.unit;
                [path.at(*t, sigma), path.at(*t, sigma * (1.0 + DIFFERENCE_STEP)), path.at(t + DIFFERENCE_STEP, sigma)]
            };
            let points: Vec<Point> = group.iter().flat_map(three).collect();
            characteristic(resolvent, &points, work, &mut values);
            for ((_, _, guess), value) in group.iter().zip(values.as_chunks::<3>().0) {
                let slope = (value[1] - value[0]) / (guess * DIFFERENCE_STEP);
                let rate = (value[0] - value[2]) / (slope * DIFFERENCE_STEP);
                found.push(NewtonStep { lambda: guess - value[0] / slope, rate });
            }
        }
        found
    }

    /// The two eigenvalues next to each guess in `at`, which is on a path at a position t, with the derivative of the pair by t: [`eigenvalue_pairs`] of
    /// the secular equation, and `None` as there.
    pub fn pairs(at: &[(Self, f64, EigenvaluePair)], work: &mut Workspace) -> Vec<Option<[EigenvaluePair; 2]>> {
        let mut values = Vec::new();
        eigenvalue_pairs(at, |points| {
            let mut all = Vec::with_capacity(points.len());
            for group in points.chunk_by(|a, b| ptr::eq(a.0.secular, b.0.secular)) {
                let resolvent = &group[0].0.secular.resolvent;
                let points: Vec<Point> =
                    group.iter().map(|(path, t, lambda)| path.at(*t, lambda / resolvent.unit)).collect();
                characteristic(resolvent, &points, work, &mut values);
                all.extend_from_slice(&values);
            }
            all
        })
    }

    /// The shape (length n, any factor) of the mode of each eigenvalue in `at`, rad/s, which is on a path at a position t. Each shape costs
    /// one value of the secular equation. `None` where the equation has no zero, or the mode is uncontrollable.
    pub fn shapes(at: &[(Self, f64, Complex<f64>)], work: &mut Workspace) -> Vec<Option<DVector<Complex<f64>>>> {
        let mut found = Vec::with_capacity(at.len());
        for group in at.chunk_by(|a, b| ptr::eq(a.0.secular, b.0.secular)) {
            let resolvent = &group[0].0.secular.resolvent;
            let points: Vec<Point> =
                group.iter().map(|(path, t, lambda)| path.at(*t, lambda / resolvent.unit)).collect();
            let near = |found: &ShapeWithResidual| found.residual <= LARGEST_RESIDUAL_ON_PATH;
            let shapes = responses(resolvent, &points, work).into_iter();
            found.extend(shapes.map(|found| found.filter(near).map(|found| found.shape)));
        }
        found
    }
}

/// The shape of a mode, up to a factor.
struct ShapeWithResidual {
    shape: DVector<Complex<f64>>,
    /// Relative residual of the secular equation's null vector.
    residual: f64,
}

/// The shape of the mode at each point.
fn responses(resolvent: &Resolvent, points: &[Point], work: &mut Workspace) -> Vec<Option<ShapeWithResidual>> {
    let matrices = secular_matrices(resolvent, points, work);
    let forces = null_vectors(&matrices, &start(resolvent.ports, 0), &mut work.scratch);
    let shape = |(forces, point): (Option<[NullVector; 1]>, &Point)| {
        let [NullVector { vector, residuals }] = forces?;
        Some(ShapeWithResidual { shape: resolvent.response(point.sigma, &vector), residual: residuals[1] })
    };
    forces.into_iter().zip(points).map(shape).collect()
}

impl Secular {
    /// The partial derivatives of eigenvalues by the mu and by the slope of a gain, `d lambda / d p` and `d lambda / d v`, with
    /// relative errors of about 1e-5.
    pub fn rates(&self, of: &[(Gain, Complex<f64>)], work: &mut Workspace) -> Vec<[Complex<f64>; 2]> {
        let (resolvent, mut values) = (&self.resolvent, Vec::new());
        let unit = resolvent.unit;
        let [reading, mobility] =
            resolvent.at(MIDDLE_FREQUENCY).map(|sum| DIFFERENCE_STEP / sum.norm().max(f64::MIN_POSITIVE));
        let steps = [reading.min(DIFFERENCE_STEP), mobility];
        let four = |(gain, lambda): &(Gain, Complex<f64>)| {
            let here = gain.in_units(unit).at(lambda / unit);
            [
                here,
                Point { sigma: here.sigma * (1.0 + DIFFERENCE_STEP), ..here },
                Point { mu: here.mu + steps[0], ..here },
                Point { slope: here.slope + steps[1], ..here },
            ]
        };
        let points: Vec<Point> = of.iter().flat_map(four).collect();
        characteristic(resolvent, &points, work, &mut values);
        let rates = |((_, lambda), value): (&(Gain, Complex<f64>), &[Complex<f64>; 4])| {
            let is_uncontrollable = |uncontrollable: &Complex<f64>| {
                (lambda / unit - uncontrollable).norm() <= UNCONTROLLABLE_DISTANCE * uncontrollable.norm()
            };
            if resolvent.uncontrollable.iter().any(is_uncontrollable) {
                return [Complex::default(); 2];
            }
            let slope = (value[1] - value[0]) / (lambda * DIFFERENCE_STEP);
            [0, 1].map(|by| (value[0] - value[2 + by]) / (slope * steps[by]))
        };
        of.iter().zip(values.as_chunks::<4>().0).map(rates).collect()
    }

    /// The modes with each of the gains at the given eigenvalues, which ascend in frequency; `None` where the secular equation
    /// does not determine their shapes.
    pub fn modes(&self, of: &[(Gain, &[Complex<f64>])], work: &mut Workspace) -> Vec<Option<Vec<Mode>>> {
        let unit = self.resolvent.unit;
        let point = |gain: &Gain, lambda: &Complex<f64>| gain.in_units(unit).at(lambda / unit);
        let of_gain = |(gain, lambdas): &(Gain, &[Complex<f64>])| -> Vec<Point> {
            lambdas.iter().map(|lambda| point(gain, lambda)).collect()
        };
        let points: Vec<Point> = of.iter().flat_map(of_gain).collect();
        let mut shapes = responses(&self.resolvent, &points, work).into_iter();
        let is_close = |pair: &[Complex<f64>]| (pair[1] - pair[0]).norm() <= LEAST_SEPARATION * pair[0].norm();
        let modes = |&(_, lambdas): &(Gain, &[Complex<f64>])| {
            let shapes: Vec<_> = shapes.by_ref().take(lambdas.len()).collect();
            let mode = |(shape, &lambda): (Option<ShapeWithResidual>, &Complex<f64>)| {
                let ShapeWithResidual { shape, residual } = shape?;
                (residual <= LARGEST_RESIDUAL).then(|| Mode::normalised(&self.structure.m, lambda, shape))
            };
            let modes: Option<Vec<Mode>> = shapes.into_iter().zip(lambdas).map(mode).collect();
            modes.filter(|_| !lambdas.windows(2).any(is_close))
        };
        let modes: Vec<Option<Vec<Mode>>> = of.iter().map(modes).collect();
        work.counters.eigenvectors += modes.iter().flatten().flatten().count() as u64;
        modes
    }
}
