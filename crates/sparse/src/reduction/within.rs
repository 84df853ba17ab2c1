//! A smaller basis within a larger one, for one configuration of a brake.
//!
//! A basis that holds a brake in all its configurations ([`response_basis`](super::response_basis)) has several hundred columns. For one
//! configuration and the friction of its draws a few dozen are enough, and to find them nothing sparse has to be solved: the brake on the
//! larger basis stands for the full one.

use linsys::{AffineSystem, OperatingPoint, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::basis::{ROUNDING, directions, fewest};
use super::compared::{Compared, compared};
use super::full::{largest, outside};
use super::norms::{Norms, NormsAt};
use super::shared::{Friction, Smaller, Structures};
use super::{Options, Wanted, dense, split};
use crate::{SparseAffineSystem, SparseError};

/// Part of the tolerance that the modes at points where the larger system was solved may use.
const AT_KNOWN_POINTS: f64 = 0.5;
/// Frequencies at which an inverse is kept for corrections; chosen: about as many as there are modes, each a factorisation.
const INVERSES: usize = 8;
/// Corrections at one point after which all modes are found there; chosen.
const MOST_CORRECTIONS: usize = 4;

/// A smaller basis, and how it was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Within {
    /// W, k x m, orthonormal: columns of the smaller basis in terms of the larger one.
    pub basis: DMatrix<f64>,
    /// The points at which all modes of the larger system were found.
    pub solved: Vec<OperatingPoint>,
    /// Modes of the larger system that were not held by a smaller basis whose residuals were all small.
    pub missed: Vec<Complex<f64>>,
    /// The modes of the larger system in the rectangle at the first given point.
    pub first: Vec<Complex<f64>>,
    /// The largest distance, relative to |lambda|, of a mode of the smaller basis from that of the larger system, where all modes were
    /// found although every residual was small.
    pub distance: f64,
    /// Whether every training point was within the tolerance, and the last complete solutions showed no missed mode.
    pub is_reached: bool,
}

/// The fewest directions within a larger basis that hold the modes in the rectangle at all given and training points. `reduced` is
/// `system` on that basis, with the same terms and channels.
///
/// All modes of the larger system are found at the given points, of which there is at least one. At a training point where a residual in
/// the larger system is above the tolerance the modes are corrected, and what they become enters the basis, until none is. Then,
/// until `options.probes` in a row show no missed mode, all modes are found at the point whose system differs most from those where they
/// have been.
///
/// # Errors
/// A point of another system, no mode in the rectangle at any given point, a singular reduced mass matrix.
pub fn within(
    system: &SparseAffineSystem,
    reduced: &AffineSystem,
    wanted: &Wanted<'_>,
    options: &Options,
) -> Result<Within, SparseError> {
    let mut search = Search::new(system, reduced, wanted, options)?;
    (0..wanted.points.len()).try_for_each(|at| search.solve(at))?;
    let in_rectangle = |lambda: &Complex<f64>| wanted.rectangle.contains(*lambda, 0.0);
    search.first =
        search.known.first().map_or(&[][..], |known| &known.lambdas).iter().copied().filter(in_rectangle).collect();
    let training: Vec<usize> = (wanted.points.len()..search.points.len()).collect();
    let (mut small, mut next, mut passed, mut quiet) = (search.smaller()?, 0, 0, 0);
    while !training.is_empty() && !search.is_exhausted(small.basis()) {
        if passed < training.len() {
            let at = training[next];
            if search.judged(&mut small, at)?.1 <= options.tolerance {
                (next, passed) = ((next + 1) % training.len(), passed + 1);
                continue;
            }
            search.improve(&mut small, at)?;
            passed = 0;
        } else {
            if quiet >= options.probes {
                break;
            }
            let Some(at) = search.farthest()? else { break };
            if search.probe(&mut small, at)? {
                quiet += 1;
                continue;
            }
            (passed, quiet) = (0, 0);
        }
        small = search.smaller()?;
    }
    let is_reached = passed == training.len() && !search.is_exhausted(small.basis());
    let solved = search.known.iter().filter(|known| known.is_complete());
    let solved = solved.map(|known| (*search.points[known.point].at).clone()).collect();
    let basis = small.into_basis();
    Ok(Within { basis, solved, missed: search.missed, first: search.first, distance: search.distance, is_reached })
}

/// What the first columns of a smaller basis hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Rung {
    /// How many columns.
    pub columns: usize,
    /// The largest residual in the full system of a mode in the rectangle, at all given and training points.
    pub residual: f64,
    /// The eigenvalues in the rectangle at the first given point.
    pub first: Vec<Complex<f64>>,
}

/// Cost against error: what some of the first columns of the basis that [`within()`] found hold. They are its principal directions in
/// the order of what they hold, and an evaluation costs about the square of their number.
///
/// # Errors
/// A point of another system, a singular reduced mass matrix.
pub fn rungs(
    system: &SparseAffineSystem,
    reduced: &AffineSystem,
    wanted: &Wanted<'_>,
    basis: &DMatrix<f64>,
    columns: &[usize],
) -> Result<Vec<Rung>, SparseError> {
    let options = Options::default();
    let search = Search::new(system, reduced, wanted, &options)?;
    let rung = |&columns: &usize| {
        let basis = basis.columns(0, columns.min(basis.ncols())).into_owned();
        let columns = basis.ncols();
        let mut small = Smaller::new(basis, reduced);
        let (mut first, mut residual) = (None, 0.0_f64);
        for at in 0..search.points.len() {
            let (lambdas, largest) = search.judged(&mut small, at)?;
            residual = residual.max(largest);
            first.get_or_insert(lambdas);
        }
        Ok(Rung { columns, residual, first: first.unwrap_or_default() })
    };
    columns.iter().map(rung).collect()
}

/// A point, with the norms of the full system there.
struct Point<'a> {
    at: &'a OperatingPoint,
    norms: NormsAt,
}

/// Modes of the larger system in and next to the rectangle at a point.
struct Known {
    /// Its place.
    point: usize,
    lambdas: Vec<Complex<f64>>,
    /// Of unit length, split, k x 2 p.
    shapes: DMatrix<f64>,
    /// How often they were corrected; 0 where all modes were found.
    corrections: usize,
}

impl Known {
    fn is_complete(&self) -> bool {
        self.corrections == 0
    }
}

struct Search<'a> {
    reduced: &'a AffineSystem,
    wanted: &'a Wanted<'a>,
    options: &'a Options,
    /// The given points, then the training points.
    points: Vec<Point<'a>>,
    structures: Structures,
    friction: Friction,
    known: Vec<Known>,
    missed: Vec<Complex<f64>>,
    first: Vec<Complex<f64>>,
    distance: f64,
    /// `Q(i omega)^-1` at the first point, at some frequencies; made when they are first needed.
    inverses: Vec<(f64, dense::Factored)>,
}

impl<'a> Search<'a> {
    fn new(
        system: &SparseAffineSystem,
        reduced: &'a AffineSystem,
        wanted: &'a Wanted<'a>,
        options: &'a Options,
    ) -> Result<Self, SparseError> {
        let norms = Norms::new(system);
        wanted.points.iter().chain(wanted.training).try_for_each(|at| reduced.check(at))?;
        let points: Vec<Point<'_>> =
            wanted.points.iter().chain(wanted.training).map(|at| Point { at, norms: norms.at(at) }).collect();
        Ok(Self {
            structures: Structures::new(reduced, points.iter().map(|point| point.at))?,
            friction: Friction::new(reduced),
            reduced,
            wanted,
            options,
            points,
            known: Vec::new(),
            missed: Vec::new(),
            first: Vec::new(),
            distance: 0.0,
            inverses: Vec::new(),
        })
    }

    fn margin(&self) -> f64 {
        self.options.margin * largest(&self.wanted.rectangle)
    }

    fn is_exhausted(&self, basis: &DMatrix<f64>) -> bool {
        let complete = self.known.iter().filter(|known| known.is_complete()).count();
        basis.ncols() >= self.options.most_columns || complete > self.options.most_enrichments
    }

    /// Finds all modes of the larger system at a point.
    fn solve(&mut self, point: usize) -> Result<(), SparseError> {
        let system = self.reduced.assemble(self.points[point].at)?;
        let (lambdas, shapes) = self.modes(&system)?;
        self.known.retain(|known| known.point != point);
        self.known.push(Known { point, lambdas, shapes, corrections: 0 });
        Ok(())
    }

    /// Makes the modes of the smaller system at a point better ones of the larger system: `x - Q_0(i omega)^-1 Q(lambda) x`, with Q_0 that of
    /// the first point at the nearest of some frequencies, leaves of an error what lies along x, and what both Q differ in. Where that
    /// does not help often enough all modes are found.
    fn improve(&mut self, small: &mut Smaller, point: usize) -> Result<(), SparseError> {
        let before = self.known.iter().position(|known| known.point == point);
        let corrections = 1 + before.map_or(0, |at| self.known[at].corrections);
        if corrections > MOST_CORRECTIONS {
            return self.solve(point);
        }
        if self.inverses.is_empty() {
            let [from, to] = self.wanted.rectangle.im;
            let (step, first) = ((to - from) / INVERSES as f64, self.reduced.assemble(self.points[0].at)?);
            for at in 0..INVERSES {
                let omega = from + (at as f64 + 0.5) * step;
                let q = first.dynamic_stiffness(Complex::new(0.0, omega));
                self.inverses.push((omega, dense::Factored::new(&q)));
            }
        }
        let (lambdas, shapes) = self.modes(&self.small_system(small, point)?)?;
        let mut shapes = small.basis() * shapes;
        let residual = self.residual(point, &lambdas, &shapes);
        for (at, lambda) in lambdas.iter().enumerate() {
            let distance = |(omega, _): &&(f64, dense::Factored)| (lambda.im - omega).abs();
            let Some((_, inverse)) = self.inverses.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))) else {
                continue;
            };
            let better = split::vector(&shapes, at) - inverse.solve(&split::vector(&residual, at))?;
            split::set(&mut shapes, at, better.normalize().iter().copied());
        }
        let known = Known { point, lambdas, shapes, corrections };
        match before {
            Some(at) => self.known[at] = known,
            None => self.known.push(known),
        }
        Ok(())
    }

    /// Finds all modes of the larger system at a point whose residuals are small; those that the smaller system does not have are missed
    /// ones. Whether there is none.
    fn probe(&mut self, small: &mut Smaller, point: usize) -> Result<bool, SparseError> {
        let (held, _) = self.modes(&self.small_system(small, point)?)?;
        self.solve(point)?;
        let before = self.missed.len();
        let found = self.known.last().map_or(&[][..], |known| &known.lambdas);
        let found = found.iter().copied().filter(|&lambda| self.wanted.rectangle.contains(lambda, 0.0));
        let Compared { distance, missed, .. } = compared(&found.collect::<Vec<_>>(), held);
        self.missed.extend(missed);
        self.distance = self.distance.max(distance);
        Ok(self.missed.len() == before)
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

    /// The system on the fewest principal directions of all shapes that hold them at the points where they were found.
    fn smaller(&self) -> Result<Smaller, SparseError> {
        let columns: Vec<_> = self.known.iter().flat_map(|known| known.shapes.column_iter()).collect();
        if columns.is_empty() {
            return Err(SparseError::Option {
                option: "the number of modes in the rectangle",
                value: 0.0,
                allowed: "1 or more",
            });
        }
        let empty = DMatrix::zeros(columns[0].len(), 0);
        let found = directions(&empty, DMatrix::from_columns(&columns), ROUNDING)?;
        let wanted = AT_KNOWN_POINTS * self.options.tolerance;
        let basis = fewest(&empty, &found, self.options.most_columns, wanted, |basis| self.projection_error(basis));
        Ok(Smaller::new(basis, self.reduced))
    }

    /// The largest residual of the known modes' parts in a basis.
    fn projection_error(&self, basis: &DMatrix<f64>) -> f64 {
        let transposed = basis.transpose();
        let of_point = |known: &Known| {
            let missing = &known.shapes - basis * (&transposed * &known.shapes);
            let residual = self.residual(known.point, &known.lambdas, &missing);
            largest_residual(&self.points[known.point].norms, &known.lambdas, &residual, &known.shapes)
        };
        self.known.iter().map(of_point).fold(0.0, f64::max)
    }

    /// The smaller system at a point.
    fn small_system(&self, small: &mut Smaller, point: usize) -> Result<SecondOrder, SparseError> {
        small.at(self.structures.of(point), &self.points[point].at.channels)
    }

    /// `Q(lambda_j) x_j` of the larger system at a point, split.
    fn residual(&self, point: usize, lambdas: &[Complex<f64>], shapes: &DMatrix<f64>) -> DMatrix<f64> {
        let (_, SecondOrder { m, c, k, .. }) = self.structures.of(point);
        let mut out = split::quadratic([m, c, k], lambdas, shapes);
        self.friction.add(|_| &self.points[point].at.channels, lambdas, shapes, &mut out);
        out
    }

    /// The modes of the smaller system in the rectangle, with the largest of their residuals in the larger system.
    fn judged(&self, small: &mut Smaller, point: usize) -> Result<(Vec<Complex<f64>>, f64), SparseError> {
        let (lambdas, shapes) = self.modes(&self.small_system(small, point)?)?;
        let is_wanted = |at: &usize| self.wanted.rectangle.contains(lambdas[*at], 0.0);
        let wanted: Vec<usize> = (0..lambdas.len()).filter(is_wanted).collect();
        let (lambdas, shapes): (Vec<_>, _) =
            (wanted.iter().map(|&at| lambdas[at]).collect(), small.basis() * split::selected(&shapes, &wanted));
        let residual = self.residual(point, &lambdas, &shapes);
        let largest = largest_residual(&self.points[point].norms, &lambdas, &residual, &shapes);
        Ok((lambdas, largest))
    }

    /// The Frobenius norm of the change of Q from one point to another.
    fn change(&self, from: usize, to: usize, lambda: Complex<f64>) -> f64 {
        let mut change = self.friction.change([from, to].map(|at| &self.points[at].at.channels[..]), lambda);
        let [(first, a), (second, b)] = [from, to].map(|at| self.structures.of(at));
        if first != second {
            change += b.dynamic_stiffness(lambda) - a.dynamic_stiffness(lambda);
        }
        change.norm()
    }

    /// The point whose Q, in the middle of the band, differs most from those at which all modes were found; `None` where they were at
    /// every point.
    fn farthest(&self) -> Result<Option<usize>, SparseError> {
        let [from, to] = self.wanted.rectangle.im;
        let middle = Complex::new(0.0, 0.5 * (from + to));
        let complete: Vec<usize> =
            self.known.iter().filter(|known| known.is_complete()).map(|known| known.point).collect();
        let mut farthest: Option<(f64, usize)> = None;
        for place in (0..self.points.len()).filter(|place| !complete.contains(place)) {
            let distance =
                complete.iter().map(|&other| self.change(place, other, middle)).fold(f64::INFINITY, f64::min);
            if farthest.is_none_or(|(largest, _)| distance > largest) {
                farthest = Some((distance, place));
            }
        }
        Ok(farthest.map(|(_, place)| place))
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

/// All eigenvalues of a system, and vectors whose first n entries are the shapes.
///
/// With `z = [y; lambda y / gamma; t s]` and internal states s the system is `A z = lambda z`,
/// `A = [0, gamma I, 0; -M^-1 K / gamma, -M^-1 C, M^-1 F / (gamma t); 0, gamma t E, -diag(a)]`; t makes both couplings of a state alike in
/// size.
pub(super) fn eigen(system: &SecondOrder, gamma: f64) -> Result<dense::Eigen, SparseError> {
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
