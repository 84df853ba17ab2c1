//! A smaller basis within a larger one, for one configuration of a brake.
//!
//! A basis that holds a brake in all its configurations ([`response_basis`](super::response_basis)) has several hundred columns. For one
//! configuration and the friction of its draws a few dozen are enough, and to find them nothing sparse has to be solved: the brake on the
//! larger basis stands for the full one.

use linsys::{AffineSystem, Channel, OperatingPoint, SecondOrder, Term};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::basis::{ROUNDING, directions, fewest};
use super::full::{largest, outside};
use super::norms::{Norms, NormsAt};
use super::residual::reduced_residual;
use super::{Options, Wanted, dense, split};
use crate::{SparseAffineSystem, SparseError};

/// Part of the tolerance that the modes at points where the larger system was solved may use.
const AT_KNOWN_POINTS: f64 = 0.5;
/// Distance, relative to |lambda|, up to which two eigenvalues are of the same mode.
const SAME_MODE: f64 = 1e-3;

/// A smaller basis, and how it was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Within {
    /// W, k x m, orthonormal: columns of the smaller basis in terms of the larger one.
    pub basis: DMatrix<f64>,
    /// How often all modes of the larger system were found.
    pub solved: usize,
    /// Modes of the larger system that were not held by a smaller basis whose residuals were all small.
    pub missed: Vec<Complex<f64>>,
    /// Whether every training point was within the tolerance, and the last complete solutions showed no missed mode.
    pub is_reached: bool,
}

/// The fewest directions within a larger basis that hold the modes in the rectangle at all given and training points. `reduced` is
/// `system` on that basis, with the same terms and channels.
///
/// All modes of the larger system are found at the given points, then at one training point after another at which a residual in the
/// larger system is above the tolerance; then, until `options.probes` in a row show no missed mode, at the training point whose system
/// differs most from those known.
///
/// # Errors
/// A point of another system, no mode in the rectangle at any given point, a singular reduced mass matrix.
pub fn within(
    system: &SparseAffineSystem,
    reduced: &AffineSystem,
    wanted: &Wanted<'_>,
    options: &Options,
) -> Result<Within, SparseError> {
    let norms = Norms::new(system);
    let middle = Complex::new(0.0, 0.5 * (wanted.rectangle.im[0] + wanted.rectangle.im[1]));
    let point = |at: &OperatingPoint| {
        let system = reduced.assemble(at)?;
        Ok(Point { at: at.clone(), middle: system.dynamic_stiffness(middle), system, norms: norms.at(at) })
    };
    let mut search = Search { reduced, wanted, options, known: Vec::new(), missed: Vec::new() };
    for at in wanted.points {
        search.solve(point(at)?)?;
    }
    let mut training = wanted.training.iter().map(point).collect::<Result<Vec<_>, SparseError>>()?;
    let mut basis = search.basis()?;
    let (mut next, mut passed, mut quiet) = (0, 0, 0);
    let mut small = projected(reduced, &basis)?;
    while !training.is_empty() && !search.is_exhausted(&basis) {
        if passed < training.len() {
            let at = next % training.len();
            let residual = search.residual(&small, &basis, &training[at])?;
            if residual <= options.tolerance {
                (next, passed) = (next + 1, passed + 1);
                continue;
            }
            search.solve(training.swap_remove(at))?;
            (next, passed, quiet) = (at, 0, 0);
        } else if quiet < options.probes {
            let point = training.swap_remove(search.farthest(&training));
            let before = search.missed.len();
            search.probe(&small, point)?;
            quiet = if search.missed.len() == before { quiet + 1 } else { 0 };
            if quiet > 0 {
                passed = training.len();
                continue;
            }
            passed = 0;
        } else {
            break;
        }
        basis = search.basis()?;
        small = projected(reduced, &basis)?;
    }
    let is_reached = passed >= training.len() && quiet >= options.probes.min(wanted.training.len());
    Ok(Within { basis, solved: search.known.len(), missed: search.missed, is_reached })
}

/// The larger system at one point.
struct Point {
    at: OperatingPoint,
    system: SecondOrder,
    norms: NormsAt,
    /// Q in the middle of the band.
    middle: DMatrix<Complex<f64>>,
}

/// A point with the modes of the larger system in and next to the rectangle.
struct Known {
    point: Point,
    lambdas: Vec<Complex<f64>>,
    /// Of unit length, split, k x 2 p.
    shapes: DMatrix<f64>,
}

struct Search<'a> {
    reduced: &'a AffineSystem,
    wanted: &'a Wanted<'a>,
    options: &'a Options,
    known: Vec<Known>,
    missed: Vec<Complex<f64>>,
}

impl Search<'_> {
    fn margin(&self) -> f64 {
        self.options.margin * largest(&self.wanted.rectangle)
    }

    fn is_exhausted(&self, basis: &DMatrix<f64>) -> bool {
        basis.ncols() >= self.options.most_columns || self.known.len() > self.options.most_enrichments
    }

    /// Finds all modes of the larger system at a point.
    fn solve(&mut self, point: Point) -> Result<(), SparseError> {
        let (lambdas, shapes) = self.modes(&point.system)?;
        self.known.push(Known { point, lambdas, shapes });
        Ok(())
    }

    /// The same at a point whose residuals are small; modes that the smaller system does not have are missed ones.
    fn probe(&mut self, small: &AffineSystem, point: Point) -> Result<(), SparseError> {
        let (mut held, _) = self.modes(&small.assemble(&point.at)?)?;
        self.solve(point)?;
        let found = self.known.last().map_or(&[][..], |known| &known.lambdas);
        for &lambda in found.iter().filter(|&&lambda| self.wanted.rectangle.contains(lambda, 0.0)) {
            let distance = |other: &Complex<f64>| (other - lambda).norm();
            let nearest = (0..held.len()).min_by(|&a, &b| distance(&held[a]).total_cmp(&distance(&held[b])));
            match nearest.filter(|&at| distance(&held[at]) <= SAME_MODE * lambda.norm()) {
                Some(at) => drop(held.swap_remove(at)),
                None => self.missed.push(lambda),
            }
        }
        Ok(())
    }

    /// The eigenvalues in and next to the rectangle, with their shapes.
    fn modes(&self, system: &SecondOrder) -> Result<(Vec<Complex<f64>>, DMatrix<f64>), SparseError> {
        let (all, vectors) = eigen(system, largest(&self.wanted.rectangle))?;
        let is_near = |&at: &usize| outside(&self.wanted.rectangle, all[at]) <= self.margin() && all[at].im > 0.0;
        let near: Vec<usize> = (0..all.len()).filter(is_near).collect();
        let mut shapes = split::zeros(system.order(), near.len());
        for (to, &from) in near.iter().enumerate() {
            let shape: DVector<Complex<f64>> = vectors.column(from).rows(0, system.order()).into_owned();
            split::set(&mut shapes, to, shape.normalize().iter().copied());
        }
        Ok((near.iter().map(|&at| all[at]).collect(), shapes))
    }

    /// The fewest principal directions of all shapes that hold them at the points where they were found.
    fn basis(&self) -> Result<DMatrix<f64>, SparseError> {
        let columns: Vec<_> = self.known.iter().flat_map(|known| known.shapes.column_iter()).collect();
        if columns.is_empty() {
            return Err(SparseError::Option {
                option: "the number of modes in the rectangle",
                value: 0.0,
                allowed: "1 or more",
            });
        }
        let empty = DMatrix::zeros(self.reduced.order(), 0);
        let found = directions(&empty, DMatrix::from_columns(&columns), ROUNDING)?;
        let wanted = AT_KNOWN_POINTS * self.options.tolerance;
        Ok(fewest(&empty, &found, self.options.most_columns, wanted, |basis| self.projection_error(basis)))
    }

    /// The largest residual of the known modes' parts in a basis.
    fn projection_error(&self, basis: &DMatrix<f64>) -> f64 {
        let transposed = basis.transpose();
        let of_point = |known: &Known| {
            let missing = &known.shapes - basis * (&transposed * &known.shapes);
            let residual = reduced_residual(&known.point.system, &known.lambdas, &missing);
            largest_residual(&known.point.norms, &known.lambdas, &residual, &known.shapes)
        };
        self.known.iter().map(of_point).fold(0.0, f64::max)
    }

    /// The largest residual, in the larger system, of a mode of the smaller one in the rectangle.
    fn residual(&self, small: &AffineSystem, basis: &DMatrix<f64>, point: &Point) -> Result<f64, SparseError> {
        let (lambdas, shapes) = self.modes(&small.assemble(&point.at)?)?;
        let is_wanted = |at: &usize| self.wanted.rectangle.contains(lambdas[*at], 0.0);
        let wanted: Vec<usize> = (0..lambdas.len()).filter(is_wanted).collect();
        let mut y = split::zeros(small.order(), wanted.len());
        for (to, &from) in wanted.iter().enumerate() {
            split::set(&mut y, to, split::vector(&shapes, from).iter().copied());
        }
        let (lambdas, shapes): (Vec<_>, _) = (wanted.iter().map(|&at| lambdas[at]).collect(), basis * y);
        let residual = reduced_residual(&point.system, &lambdas, &shapes);
        Ok(largest_residual(&point.norms, &lambdas, &residual, &shapes))
    }

    /// The training point whose Q differs most from those of all known points.
    fn farthest(&self, training: &[Point]) -> usize {
        let distance = |point: &Point| {
            let from = |known: &Known| (&known.point.middle - &point.middle).norm();
            self.known.iter().map(from).fold(f64::INFINITY, f64::min)
        };
        let distances = training.iter().map(distance).enumerate();
        distances.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(at, _)| at)
    }
}

/// The largest of some residuals relative to the size of the terms of Q and the length of the shapes; infinite where one is no number.
fn largest_residual(norms: &NormsAt, lambdas: &[Complex<f64>], residual: &DMatrix<f64>, shapes: &DMatrix<f64>) -> f64 {
    let relative = |(at, &lambda): (usize, &Complex<f64>)| {
        (split::norm_squared(residual, at) / split::norm_squared(shapes, at)).sqrt() / norms.size(lambda)
    };
    let worse = |largest: f64, value: f64| if value <= largest { largest } else { value };
    let found = lambdas.iter().enumerate().map(relative).fold(0.0, worse);
    if found.is_nan() { f64::INFINITY } else { found }
}

/// A system on a smaller basis, term by term and channel by channel.
fn projected(system: &AffineSystem, basis: &DMatrix<f64>) -> Result<AffineSystem, SparseError> {
    let transposed = basis.transpose();
    let onto = |matrix: &DMatrix<f64>| &transposed * (matrix * basis);
    let term = |term: &Term| {
        let SecondOrder { m, c, k, .. } = term.matrices();
        let matrices = SecondOrder::new(onto(m), onto(c), onto(k))?;
        Ok(Term::new(&term.name, &term.family, matrices)?)
    };
    let side = |side: &[(usize, f64)]| {
        let coordinate = |column: usize| (column, side.iter().map(|&(dof, value)| value * basis[(dof, column)]).sum());
        (0..basis.ncols()).map(coordinate).collect::<Vec<(usize, f64)>>()
    };
    let channel = |c: &Channel| Channel::new(c.name.clone(), c.family.clone(), side(&c.force), side(&c.reading));
    let terms = system.terms().iter().map(term).collect::<Result<_, SparseError>>()?;
    Ok(AffineSystem::new(terms, system.channels().iter().map(channel).collect())?)
}

/// All eigenvalues of a system, and vectors whose first n entries are the shapes.
///
/// With `z = [y; lambda y / gamma; t s]` and internal states s the system is `A z = lambda z`,
/// `A = [0, gamma I, 0; -M^-1 K / gamma, -M^-1 C, M^-1 F / (gamma t); 0, gamma t E, -diag(a)]`; t makes both couplings of a state alike in
/// size.
fn eigen(system: &SecondOrder, gamma: f64) -> Result<dense::Eigen, SparseError> {
    let (n, s) = (system.order(), system.states());
    let SecondOrder { m, c, k, internal } = system;
    let right = {
        let mut right = DMatrix::zeros(n, 2 * n + s);
        right.columns_mut(0, n).copy_from(k);
        right.columns_mut(n, n).copy_from(c);
        right.columns_mut(2 * n, s).copy_from(&internal.force);
        dense::solve_real(m, &right)?
    };
    let mut state = DMatrix::zeros(2 * n + s, 2 * n + s);
    state.view_mut((0, n), (n, n)).fill_diagonal(gamma);
    state.view_mut((n, 0), (n, n)).copy_from(&(right.columns(0, n) / -gamma));
    state.view_mut((n, n), (n, n)).copy_from(&-right.columns(n, n));
    for at in 0..s {
        let (force, drive) = (right.column(2 * n + at), internal.drive.row(at));
        let (given, taken) = (force.norm() / gamma, gamma * drive.norm());
        let t = if given > 0.0 && taken > 0.0 { (given / taken).sqrt() } else { 1.0 };
        state.view_mut((n, 2 * n + at), (n, 1)).copy_from(&(force / (gamma * t)));
        state.view_mut((2 * n + at, n), (1, n)).copy_from(&(drive * (gamma * t)));
        state[(2 * n + at, 2 * n + at)] = -internal.decay[at];
    }
    dense::eigen_real(&state)
}
