//! What is known while a smaller basis is sought: the modes of the larger system at the points that were looked at.

use cea::{CeaError, Spectrum};
use linsys::{AffineSystem, OperatingPoint, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use sparse::SparseAffineSystem;

use crate::ReductionError;
use crate::basis::{MOST_MISSING, ROUNDING, directions, fewest};
use crate::coarse::{spectra, vectors};
use crate::compared::{Compared, compared};
use crate::full::{largest, outside};
use crate::norms::{Norms, NormsAt};
use crate::shared::{Friction, Smaller, Structures};
use crate::{Options, Wanted, dense, grows_too_fast, split};

/// Part of the tolerance that the modes at points where the larger system was solved may use.
const AT_KNOWN_POINTS: f64 = 0.5;
/// Frequencies at which an inverse is kept for corrections; chosen: about as many as there are modes, each a factorisation.
const INVERSES: usize = 8;
/// Corrections at one point after which all modes are found there; chosen.
const MOST_CORRECTIONS: usize = 4;

/// A point, with the norms of the full system there.
pub(super) struct Point<'a> {
    pub at: &'a OperatingPoint,
    norms: NormsAt,
}

/// Modes of the larger system in and next to the rectangle at a point.
pub(super) struct Known {
    /// Index of the point.
    pub point: usize,
    pub lambdas: Vec<Complex<f64>>,
    /// Of unit length, split, k x 2 p.
    shapes: DMatrix<f64>,
    /// Number of corrections; 0 where all modes were found.
    corrections: usize,
}

/// Eigenvalues of a system, rad/s, and their shapes, split.
type Modes = (Vec<Complex<f64>>, DMatrix<f64>);

/// Modes of a smaller system in and next to the rectangle at a point.
pub(super) struct Judged {
    /// Index of the point.
    pub point: usize,
    pub lambdas: Vec<Complex<f64>>,
    /// In the coordinates of the larger system, split, k x 2 p.
    pub shapes: DMatrix<f64>,
    /// The largest residual of those in the rectangle, in the larger system.
    pub residual: f64,
}

impl Known {
    pub fn is_complete(&self) -> bool {
        self.corrections == 0
    }
}

/// The modes that are known.
pub(super) struct Search<'a> {
    reduced: &'a AffineSystem,
    wanted: &'a Wanted<'a>,
    options: &'a Options,
    /// The given points, then the training points.
    pub points: Vec<Point<'a>>,
    structures: Structures,
    friction: Friction,
    pub known: Vec<Known>,
    pub missed: Vec<Complex<f64>>,
    pub first: Vec<Complex<f64>>,
    pub distance: f64,
    /// `Q(i omega)^-1` at the first point, at some frequencies; made when they are first needed.
    inverses: Vec<(f64, dense::Factored)>,
}

impl<'a> Search<'a> {
    pub fn new(
        system: &SparseAffineSystem,
        reduced: &'a AffineSystem,
        wanted: &'a Wanted<'a>,
        options: &'a Options,
    ) -> Result<Self, ReductionError> {
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

    pub fn is_exhausted(&self, basis: &DMatrix<f64>) -> bool {
        let complete = self.known.iter().filter(|known| known.is_complete()).count();
        basis.ncols() >= self.options.most_columns || complete > self.options.most_enrichments
    }

    /// Finds all modes of the larger system at a point.
    pub fn solve(&mut self, point: usize) -> Result<(), ReductionError> {
        let system = self.reduced.assemble(self.points[point].at)?;
        let (lambdas, shapes) = self.modes(&[system])?.remove(0);
        self.known.retain(|known| known.point != point);
        self.known.push(Known { point, lambdas, shapes, corrections: 0 });
        Ok(())
    }

    /// Makes the modes of the smaller system at a point better ones of the larger system: `x - Q_0(i omega)^-1 Q(lambda) x`, with Q_0 that of
    /// the first point at the nearest of some frequencies, leaves of an error what lies along x, and what both Q differ in. Where that
    /// does not help often enough all modes are found.
    pub fn improve(&mut self, Judged { point, lambdas, mut shapes, .. }: Judged) -> Result<(), ReductionError> {
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
    pub fn probe(&mut self, small: &mut Smaller, point: usize) -> Result<bool, ReductionError> {
        let held = self.judged(small, &[point])?.remove(0).lambdas;
        self.solve(point)?;
        let before = self.missed.len();
        let found = self.known.last().map_or(&[][..], |known| &known.lambdas);
        let found = found.iter().copied().filter(|&lambda| self.wanted.rectangle.contains_to_the_right(lambda, 0.0));
        let Compared { distance, missed, .. } = compared(&found.collect::<Vec<_>>(), held);
        self.missed.extend(missed);
        self.distance = self.distance.max(distance);
        Ok(self.missed.len() == before)
    }

    /// The eigenvalues in and next to the rectangle of each of some systems, with their shapes, split; without those that no sample counts
    /// ([`grows_too_fast`]).
    fn modes(&self, systems: &[SecondOrder]) -> Result<Vec<Modes>, ReductionError> {
        let is_near = |lambda: &Complex<f64>| {
            outside(&self.wanted.rectangle, *lambda) <= self.margin() && lambda.im > 0.0 && !grows_too_fast(*lambda)
        };
        let near = |found: Result<Spectrum, CeaError>| Ok(found?.eigenvalues.into_iter().filter(is_near).collect());
        let near = spectra(systems).into_iter().map(near).collect::<Result<Vec<Vec<_>>, CeaError>>()?;
        let shapes = vectors(systems, &near)?;
        let of_system = |((lambdas, shapes), system): ((Vec<Complex<f64>>, Vec<_>), &SecondOrder)| {
            let mut columns = split::zeros(system.order(), lambdas.len());
            let shapes = shapes.iter().map(|shape: &DVector<Complex<f64>>| shape.normalize());
            shapes.enumerate().for_each(|(at, shape)| split::set(&mut columns, at, shape.iter().copied()));
            (lambdas, columns)
        };
        Ok(near.into_iter().zip(shapes).zip(systems).map(of_system).collect())
    }

    /// The system on the fewest principal directions of all shapes that hold them at the points where they were found.
    pub fn smaller(&self) -> Result<Smaller, ReductionError> {
        let columns: Vec<_> = self.known.iter().flat_map(|known| known.shapes.column_iter()).collect();
        if columns.is_empty() {
            return Err(ReductionError::NoModes);
        }
        let empty = DMatrix::zeros(columns[0].len(), 0);
        let found = directions(&empty, DMatrix::from_columns(&columns), ROUNDING)?;
        let wanted = AT_KNOWN_POINTS * self.options.tolerance;
        let basis = fewest(&empty, &found, self.options.most_columns, wanted, |basis| self.projection_error(basis));
        Ok(Smaller::new(basis, self.reduced))
    }

    /// The largest residual of the known modes' parts in a basis, infinite where too little of one is in it.
    fn projection_error(&self, basis: &DMatrix<f64>) -> f64 {
        let transposed = basis.transpose();
        let of_point = |known: &Known| {
            let missing = &known.shapes - basis * (&transposed * &known.shapes);
            let lost = |at: usize| {
                split::norm_squared(&missing, at) > MOST_MISSING.powi(2) * split::norm_squared(&known.shapes, at)
            };
            if (0..known.lambdas.len()).any(lost) {
                return f64::INFINITY;
            }
            let residual = self.residual(known.point, &known.lambdas, &missing);
            largest_residual(&self.points[known.point].norms, &known.lambdas, &residual, &known.shapes)
        };
        self.known.iter().map(of_point).fold(0.0, f64::max)
    }

    /// The smaller system at a point.
    fn small_system(&self, small: &mut Smaller, point: usize) -> Result<SecondOrder, ReductionError> {
        small.at(self.structures.of(point), &self.points[point].at.channels)
    }

    /// `Q(lambda_j) x_j` of the larger system at a point, split.
    fn residual(&self, point: usize, lambdas: &[Complex<f64>], shapes: &DMatrix<f64>) -> DMatrix<f64> {
        let (_, SecondOrder { m, c, k, .. }) = self.structures.of(point);
        let mut out = split::quadratic([m, c, k], lambdas, shapes);
        self.friction.add(&self.points[point].at.channels, lambdas, shapes, &mut out);
        out
    }

    /// The modes of the smaller system at some points, with the largest residual of those in the rectangle in the larger system.
    pub fn judged(&self, small: &mut Smaller, points: &[usize]) -> Result<Vec<Judged>, ReductionError> {
        let systems =
            points.iter().map(|&point| self.small_system(small, point)).collect::<Result<Vec<_>, ReductionError>>()?;
        let judged = |(&point, (lambdas, shapes)): (&usize, Modes)| {
            let shapes = small.basis() * shapes;
            let is_wanted = |at: &usize| self.wanted.rectangle.contains_to_the_right(lambdas[*at], 0.0);
            let wanted: Vec<usize> = (0..lambdas.len()).filter(is_wanted).collect();
            let (of_wanted, own) =
                (wanted.iter().map(|&at| lambdas[at]).collect::<Vec<_>>(), split::selected(&shapes, &wanted));
            let residual = self.residual(point, &of_wanted, &own);
            let residual = largest_residual(&self.points[point].norms, &of_wanted, &residual, &own);
            Judged { point, lambdas, shapes, residual }
        };
        Ok(points.iter().zip(self.modes(&systems)?).map(judged).collect())
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
    pub fn farthest(&self) -> Result<Option<usize>, ReductionError> {
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
    let worse = |largest: f64, value: f64| if largest.is_nan() || value <= largest { largest } else { value };
    let found = lambdas.iter().enumerate().map(relative).fold(0.0, worse);
    if found.is_nan() { f64::INFINITY } else { found }
}
