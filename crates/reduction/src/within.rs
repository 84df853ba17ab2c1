//! A smaller basis within one of modes, for one configuration of a brake: right and left vectors of its own draws.
//!
//! A basis that holds a brake in all its configurations ([`Snapshots`](super::Snapshots)) has a few hundred columns; for one configuration and the friction
//! of its draws half are enough, and to find them nothing sparse has to be solved: the brake on the larger basis stands for the full one.
//!
//! The columns of a basis of modes are principal directions in the order of what they hold, so that the first of them have the modes of every draw, roughly.
//! From there right and left vectors are corrected on the whole basis, with inverses at one point and some frequencies, and their principal directions in
//! the norm of energy are the smaller basis. An eigenvalue is as good as the product of what is missing on both sides: the correction of the left vector
//! times the residual of the right one tells its error.

use cea::grows_too_fast;
use linsys::{AffineSystem, OperatingPoint, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use sparse::Rectangle;

use super::compared::compared;
use super::directions::{ROUNDING, directions};
use super::shared::{Friction, Smaller, Structures};
use super::spectra::{Shapes, spectra, vectors};
use super::wanted::{largest, outside};
use super::{dense, split};
use crate::ReductionError;

/// Largest distance from the rectangle, as a fraction of the largest |lambda| in it, of modes that shape a basis too: at other points such modes come into
/// the rectangle. Chosen: as for the larger basis, which has no modes from farther away.
const MARGIN: f64 = 0.02;
/// Number of frequencies at which an inverse is kept for corrections; chosen: about as many as there are modes, each a factorisation.
const INVERSES: usize = 8;
/// Most corrections at one point, after which all modes are found there anew; chosen: that takes a whole spectrum on the larger basis.
const MOST_CORRECTIONS: usize = 4;
/// Largest change of an eigenvalue that is taken as it is estimated, as a fraction of its size; chosen: with a larger estimate the eigenvalue stays as it is.
const SHIFTED: f64 = 0.02;
/// Most changes of a smaller basis; chosen: where one does not hold the modes after the last change, the larger basis takes its place.
const MOST_ROUNDS: i32 = 12;
/// Factor from the least singular value of a direction in one smaller basis to that in the next; the first is the root of the error that is asked for.
/// Chosen: with less, a basis may have more columns than it needs; with more, it takes more changes.
const LOWER: f64 = 0.6;

/// A smaller basis, and how it was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Within {
    /// W, k x m, orthonormal: columns of the smaller basis in terms of the larger one.
    pub basis: DMatrix<f64>,
    /// The points at which all modes of the larger system were found, as corrections did not reach the error there.
    pub solved: Vec<OperatingPoint>,
    /// Eigenvalues, rad/s, of modes that were missing on a smaller basis after the most corrections at a point, or that the whole spectrum at the middle
    /// point showed to be unknown.
    pub missed: Vec<Complex<f64>>,
    /// The largest estimated error of an eigenvalue in the rectangle, relative to its size.
    pub distance: f64,
}

/// The fewest directions within a basis of modes that hold the eigenvalues in and to the right of a rectangle at the given points, draws of a study for
/// example, up to an error relative to their size, as it is estimated; where no fewer are found that do, all of them. `reduced` is the brake on that basis, of which the first `leading` columns have all
/// modes, roughly.
///
/// # Errors
/// No point or one of another system, no mode in the rectangle at any point, a singular reduced mass matrix.
pub fn within(
    (reduced, leading): (&AffineSystem, usize),
    (rectangle, points): (Rectangle, &[OperatingPoint]),
    error: f64,
) -> Result<Within, ReductionError> {
    let search = Search::new(reduced, rectangle, points)?;
    let mut small = Smaller::new(DMatrix::identity(reduced.order(), leading.clamp(1, reduced.order())), reduced);
    let started = search.judged(&mut small)?;
    let mut known = started.into_iter().map(|judged| search.better(judged)).collect::<Result<Vec<Modes>, _>>()?;
    let mut corrections = vec![1; known.len()];
    let (mut missed, mut round) = (Vec::new(), 0);
    // The point at which all modes of the larger system are found once, whatever the first columns of its basis have.
    let (probe, mut is_probed) = (points.len() / 2, false);
    loop {
        small = search.smaller(&known, error.sqrt() * LOWER.powi(round))?;
        let (mut is_reached, mut distance, mut at_probe) = (true, 0.0, Vec::new());
        for (at, judged) in search.judged(&mut small)?.into_iter().enumerate() {
            let [lost, found] = search.others(&known[at].lambdas, &judged.modes.lambdas);
            if at == probe {
                at_probe.clone_from(&judged.modes.lambdas);
            }
            let is_same = lost.is_empty() && found.is_empty();
            distance = f64::max(distance, if is_same { judged.error } else { 1.0 });
            if is_same && judged.error <= error {
                continue;
            }
            is_reached = false;
            corrections[at] += 1;
            if corrections[at] <= MOST_CORRECTIONS {
                // Where no fewer are new than are lost, the new ones are taken for the lost ones at other eigenvalues.
                let lost = if lost.len() > found.len() { lost } else { Vec::new() };
                let lost = known[at].selected(&lost);
                known[at] = search.better(judged)?.and(&lost);
            } else if corrections[at] == MOST_CORRECTIONS + 1 {
                missed.extend(known[at].selected(&lost).lambdas);
                known[at] = search.solved(at)?;
            }
        }
        if is_reached && !is_probed {
            is_probed = true;
            let all = search.solved(probe)?;
            let [lost, _] = search.others(&all.lambdas, &at_probe);
            if !lost.is_empty() {
                is_reached = false;
                distance = 1.0;
                missed.extend(all.selected(&lost).lambdas);
                known[probe] = all;
            }
        }
        if !is_reached && (small.basis().ncols() == reduced.order() || round == MOST_ROUNDS) {
            // On the larger basis itself, whatever is known of its modes, nothing is missing.
            small = Smaller::new(DMatrix::identity(reduced.order(), reduced.order()), reduced);
            (is_reached, distance) = (true, 0.0);
        }
        if is_reached {
            let solved = search.points.iter().zip(&corrections).filter(|(_, times)| **times > MOST_CORRECTIONS);
            let solved = solved.map(|(at, _)| at.clone()).collect();
            return Ok(Within { basis: small.into_basis(), solved, missed, distance });
        }
        round += 1;
    }
}

/// The largest error, relative to their size, of the eigenvalues in and to the right of a rectangle on a smaller basis, k x m, within one of modes, as it is
/// estimated at the given points: draws of which the smaller basis was not made, for example. `reduced` is the brake on the larger basis.
///
/// # Errors
/// No point or one of another system, a singular reduced mass matrix.
pub fn error_within(
    (reduced, smaller): (&AffineSystem, &DMatrix<f64>),
    (rectangle, points): (Rectangle, &[OperatingPoint]),
) -> Result<f64, ReductionError> {
    let search = Search::new(reduced, rectangle, points)?;
    let judged = search.judged(&mut Smaller::new(smaller.clone(), reduced))?;
    Ok(judged.iter().map(|judged| judged.error).fold(0.0, f64::max))
}

/// Modes at a point in and next to the rectangle.
struct Modes {
    lambdas: Vec<Complex<f64>>,
    /// Vectors x with `Q(lambda) x = 0` and y with `Q(lambda)^T y = 0`, split.
    right: DMatrix<f64>,
    left: DMatrix<f64>,
}

/// Modes of a smaller basis at a point.
struct Judged {
    /// With shapes of unit length in the coordinates of the larger basis.
    modes: Modes,
    /// `Q(lambda) x`.
    residual: DMatrix<f64>,
    better_left: DMatrix<f64>,
    /// Changes of the eigenvalues that better vectors make, to first order.
    shifts: Vec<Complex<f64>>,
    /// The largest of these in the rectangle, relative to |lambda|.
    error: f64,
}

impl Modes {
    /// The modes `which`, by their indices.
    fn selected(&self, which: &[usize]) -> Self {
        let lambdas = which.iter().map(|&at| self.lambdas[at]).collect();
        Self { lambdas, right: split::selected(&self.right, which), left: split::selected(&self.left, which) }
    }

    /// These and others.
    fn and(self, others: &Self) -> Self {
        let (right, left) = (split::joined(&self.right, &others.right), split::joined(&self.left, &others.left));
        Self { lambdas: [self.lambdas, others.lambdas.clone()].concat(), right, left }
    }
}

/// What is needed to judge modes at the points and to correct them.
struct Search<'a> {
    reduced: &'a AffineSystem,
    rectangle: Rectangle,
    points: &'a [OperatingPoint],
    structures: Structures,
    friction: Friction,
    /// `Q(i omega)^-1` at the first point, each with its frequency omega, rad/s.
    inverses: Vec<(f64, dense::Factored)>,
    /// `L^T` of `L L^T = K + omega^2 M`, symmetric parts without friction at the first point, omega the highest frequency that is wanted; the identity
    /// where the sum is not positive definite.
    energy: DMatrix<f64>,
}

impl<'a> Search<'a> {
    fn new(
        reduced: &'a AffineSystem,
        rectangle: Rectangle,
        points: &'a [OperatingPoint],
    ) -> Result<Self, ReductionError> {
        points.iter().try_for_each(|at| reduced.check(at))?;
        let origin = reduced.assemble(points.first().ok_or(ReductionError::NoModes)?)?;
        let structures = Structures::new(reduced, points.iter())?;
        let [from, to] = rectangle.im;
        let inverse = |at: usize| {
            let omega = from + (at as f64 + 0.5) * (to - from) / INVERSES as f64;
            (omega, dense::Factored::new(&origin.dynamic_stiffness(Complex::new(0.0, omega))))
        };
        let (_, SecondOrder { m, k, .. }) = structures.of(0);
        let energy = k + m * (to * to);
        let energy = (0.5 * (&energy + energy.transpose())).cholesky();
        let order = reduced.order();
        let energy = energy.map_or_else(|| DMatrix::identity(order, order), |found| found.unpack().transpose());
        let (friction, inverses) = (Friction::new(reduced), (0..INVERSES).map(inverse).collect());
        Ok(Self { reduced, rectangle, points, structures, friction, inverses, energy })
    }

    /// The modes in and next to the rectangle of each of `systems`, vectors of unit length.
    fn modes(&self, systems: &[SecondOrder]) -> Result<Vec<Modes>, ReductionError> {
        let margin = MARGIN * largest(&self.rectangle);
        let is_near = |lambda: &Complex<f64>| {
            outside(&self.rectangle, *lambda) <= margin && lambda.im > 0.0 && !grows_too_fast(*lambda)
        };
        let mut near = Vec::with_capacity(systems.len());
        for found in spectra(systems) {
            near.push(found?.eigenvalues.into_iter().filter(is_near).collect::<Vec<_>>());
        }
        let both = vectors(systems, &near)?;
        let split = |shapes: Vec<DVector<Complex<f64>>>, order: usize| {
            let mut out = split::zeros(order, shapes.len());
            let shapes = shapes.iter().map(|shape| shape.normalize());
            shapes.enumerate().for_each(|(at, shape)| split::set(&mut out, at, shape.iter().copied()));
            out
        };
        let one = |((lambdas, [right, left]), system): ((_, [Shapes; 2]), &SecondOrder)| {
            let [right, left] = [right, left].map(|shapes| split(shapes, system.order()));
            Modes { lambdas, right, left }
        };
        Ok(near.into_iter().zip(both).zip(systems).map(one).collect())
    }

    /// All modes of the larger system at a point.
    fn solved(&self, point: usize) -> Result<Modes, ReductionError> {
        Ok(self.modes(&[self.reduced.assemble(&self.points[point])?])?.remove(0))
    }

    /// The modes of a smaller system at all points.
    fn judged(&self, small: &mut Smaller) -> Result<Vec<Judged>, ReductionError> {
        let at = |(point, at): (usize, &OperatingPoint)| small.at(self.structures.of(point), &at.channels);
        let systems = self.points.iter().enumerate().map(at).collect::<Result<Vec<_>, ReductionError>>()?;
        let modes = self.modes(&systems)?;
        let one = |(point, (system, modes)): (usize, (&SecondOrder, Modes))| {
            let slope = |(at, &lambda): (usize, &Complex<f64>)| {
                split::vector(&modes.left, at).dot(&system.derivative_times(lambda, &split::vector(&modes.right, at)))
            };
            let slopes: Vec<Complex<f64>> = modes.lambdas.iter().enumerate().map(slope).collect();
            let on_larger = |shapes| dense::product(small.basis(), shapes);
            let (right, left) = (on_larger(&modes.right), on_larger(&modes.left));
            self.judge(point, Modes { lambdas: modes.lambdas, right, left }, &slopes)
        };
        systems.iter().zip(modes).enumerate().map(one).collect()
    }

    /// The error of modes whose slopes `y^T Q'(lambda) x` are given: with a better left vector y - c the eigenvalue changes by `c^T Q(lambda) x` over the
    /// slope.
    fn judge(&self, point: usize, modes: Modes, slopes: &[Complex<f64>]) -> Result<Judged, ReductionError> {
        let ((_, SecondOrder { m, c, k, .. }), gains) = (self.structures.of(point), &self.points[point].channels);
        let mut residual = split::quadratic([m, c, k], &modes.lambdas, &modes.right);
        self.friction.add(gains, &modes.lambdas, &modes.right, &mut residual);
        let [m, c, k] = [m, c, k].map(DMatrix::transpose);
        let mut of_left = split::quadratic([&m, &c, &k], &modes.lambdas, &modes.left);
        self.friction.add_transposed(gains, &modes.lambdas, &modes.left, &mut of_left);
        let (mut better_left, mut shifts, mut error) = (modes.left.clone(), Vec::with_capacity(slopes.len()), 0.0_f64);
        for (at, (&lambda, slope)) in modes.lambdas.iter().zip(slopes).enumerate() {
            let correction = self.inverse(lambda).solve_transposed(&split::vector(&of_left, at))?;
            let shift = correction.dot(&split::vector(&residual, at)) / slope;
            if self.rectangle.contains_to_the_right(lambda, 0.0) {
                let own = shift.norm() / lambda.norm();
                error = if own.is_nan() { f64::INFINITY } else { error.max(own) };
            }
            shifts.push(shift);
            let better = (split::vector(&modes.left, at) - correction).normalize();
            split::set(&mut better_left, at, better.iter().copied());
        }
        Ok(Judged { modes, residual, better_left, shifts, error })
    }

    /// The modes of a smaller system, improved as modes of the larger system: `x - Q_0(i omega)^-1 Q(lambda) x`, with Q_0 the matrix Q of the first point at
    /// the nearest of the frequencies with an inverse, leaves of an error what lies along x, and what comes from the difference of Q and Q_0.
    fn better(&self, judged: Judged) -> Result<Modes, ReductionError> {
        let Judged { modes: Modes { mut lambdas, mut right, .. }, residual, better_left: left, shifts, .. } = judged;
        for (at, (lambda, shift)) in lambdas.iter_mut().zip(shifts).enumerate() {
            let correction = self.inverse(*lambda).solve(&split::vector(&residual, at))?;
            let better = (split::vector(&right, at) - correction).normalize();
            split::set(&mut right, at, better.iter().copied());
            if shift.norm() <= SHIFTED * lambda.norm() {
                *lambda += shift;
            }
        }
        Ok(Modes { lambdas, right, left })
    }

    /// `Q(i omega)^-1` at the first point, omega the frequency with an inverse that is nearest to Im lambda.
    fn inverse(&self, lambda: Complex<f64>) -> &dense::Factored {
        let distance = |at: &usize| (lambda.im - self.inverses[*at].0).abs();
        let nearest = (0..INVERSES).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        &self.inverses[nearest.unwrap_or_default()].1
    }

    /// The system on the principal directions of all vectors, scaled to unit energy, down to the singular value `floor`.
    fn smaller(&self, known: &[Modes], floor: f64) -> Result<Smaller, ReductionError> {
        let none = split::zeros(self.reduced.order(), 0);
        let sides = known.iter().flat_map(|modes| [&modes.right, &modes.left]);
        let vectors = sides.fold(none, |all, side| split::joined(&all, side));
        if vectors.ncols() == 0 {
            return Err(ReductionError::NoModes);
        }
        let mut vectors = dense::product(&self.energy, &vectors);
        for (at, size) in split::norms(&vectors).into_iter().enumerate() {
            let unit = split::vector(&vectors, at).unscale(size);
            split::set(&mut vectors, at, unit.iter().copied());
        }
        let found = directions(&DMatrix::zeros(vectors.nrows(), 0), vectors, floor.max(ROUNDING))?;
        let basis = dense::solve_real(&self.energy, &found)?.qr().q();
        Ok(Smaller::new(basis, self.reduced))
    }

    /// Indices of known modes in the rectangle that a smaller system does not have, and of those that it has in it and that are not known.
    fn others(&self, known: &[Complex<f64>], found: &[Complex<f64>]) -> [Vec<usize>; 2] {
        let is_inside = |lambda: &&Complex<f64>| self.rectangle.contains_to_the_right(**lambda, 0.0);
        let without = |of: &[Complex<f64>], others: &[Complex<f64>]| {
            let inside: Vec<Complex<f64>> = of.iter().filter(is_inside).copied().collect();
            let missed = compared(&inside, others).missed;
            (0..of.len()).filter(|&at| missed.contains(&of[at])).collect()
        };
        [without(known, found), without(found, known)]
    }
}
