//! A basis that is enriched until every wanted mode of a training set has the residual that was asked for.
//!
//! A residual tells nothing of a mode that the basis does not hold: it is not among the reduced system's. So the full
//! problem is solved at further points too, each as far as can be from all known ones, until several in a row show nothing new.
//! A mode that grows faster than the rectangle reaches is wanted like any other: where a basis has one the full problem is solved farther.

use linsys::OperatingPoint;
use nalgebra::DMatrix;
use num_complex::Complex;
use sparse::{Eigenpair, Rectangle, SparseAffineSystem, SparseSecondOrder};

use super::basis::{ModesAt, of_modes};
use super::compared::compared;
use super::full;
use super::norms::{Norms, NormsAt};
use super::report::{MissedMode, Report, Stage, Why};
use super::{Options, Reduced};
use crate::ReductionError;

/// Part of the tolerance that the modes at a known point may use, so that there is room between known points.
const AT_KNOWN_POINTS: f64 = 0.5;
/// Largest growth rate that is looked for in a full problem, over that of the fastest mode of a basis; chosen.
const BEYOND: f64 = 1.5;

/// A reduction with the history of its basis.
#[derive(Debug, Clone)]
pub struct Reduction {
    /// The reduced brake.
    pub reduced: Reduced,
    /// Cost and residuals of each stage.
    pub report: Report,
}

/// Modes that a reduction shall hold, and the points at which.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'a> {
    /// Rectangle in which modes are wanted, and to its right: the largest growth rate says how far full problems are solved at least.
    pub rectangle: Rectangle,
    /// Operating points at which the full problem is solved first, at least one.
    pub points: &'a [OperatingPoint],
    /// Operating points, draws of a study for example, at which every wanted mode shall have the residual asked for.
    pub training: &'a [OperatingPoint],
}

impl Reduction {
    /// Builds a basis from the full modes at the given points, and enriches it by those at training points: at the one of
    /// the largest residual while that is above the tolerance, else at the one farthest from all known points.
    ///
    /// It ends when the last `options.probes` full problems showed no missed mode and no residual is above the tolerance, or
    /// when a limit of the options is reached; [`Report::is_reached`] tells which.
    ///
    /// # Errors
    /// An option out of its range, no point, a point of another system, what [`eigenpairs_in`](sparse::eigenpairs_in) refuses, a
    /// reduced mass matrix that is singular.
    pub fn build(system: &SparseAffineSystem, wanted: &Wanted<'_>, options: &Options) -> Result<Self, ReductionError> {
        options.check()?;
        let (norms, report, known) = (Norms::new(system), Report::default(), Vec::new());
        let mut work = Building { system, wanted, options, norms, report, known };
        for point in wanted.points {
            let known = work.solve(point, wanted.rectangle.re[1])?;
            work.known.push(known);
        }
        let mut basis = work.basis()?;
        let mut why = Why::Given;
        let mut quiet = 0;
        loop {
            let reduced = Reduced::new(system, basis.clone(), wanted.rectangle, &work.points(), options)?;
            let worst = work.train(&reduced, why)?;
            let is_above = worst.is_some_and(|(_, residual)| residual > options.tolerance);
            if is_above {
                quiet = 0;
            }
            let is_limit =
                work.report.enrichments() >= options.most_enrichments || basis.ncols() >= options.most_columns;
            if let Some((at, growth)) = work.not_searched(&reduced)?.filter(|_| !is_limit) {
                let point = work.known[at].point.clone();
                work.known[at] = work.solve(&point, growth)?;
                (why, quiet) = (Why::Growth, 0);
                basis = work.basis()?;
                continue;
            }
            let has_ended = is_limit || (!is_above && quiet >= options.probes);
            let next = match worst.filter(|_| is_above) {
                Some((at, _)) => Some(at),
                None if has_ended => None,
                None => Self::farthest(&reduced, wanted.training, &work.points())?,
            };
            let Some(next) = next.filter(|_| !has_ended) else {
                work.report.is_reached = !is_above && quiet >= options.probes;
                return Ok(Self { reduced, report: work.report });
            };
            let found = work.solve(&wanted.training[next], searched(wanted, &reduced, &wanted.training[next])?)?;
            let missed = missed(&reduced, &found.point, &found.modes)?;
            why = if is_above { Why::LargestResidual } else { Why::Farthest };
            quiet = if missed.is_empty() { quiet + 1 } else { 0 };
            work.report.missed.extend(missed.into_iter().map(|lambda| MissedMode { training: next, lambda }));
            work.known.push(found);
            basis = work.basis()?;
        }
    }

    /// The training point farthest from the known ones: whose Q on the basis, in the middle of the band, differs most from those.
    fn farthest(
        reduced: &Reduced,
        training: &[OperatingPoint],
        known: &[OperatingPoint],
    ) -> Result<Option<usize>, ReductionError> {
        let [from, to] = reduced.rectangle().im;
        let middle = Complex::new(0.0, 0.5 * (from + to));
        let q = |point: &OperatingPoint| Ok(reduced.system().assemble(point)?.dynamic_stiffness(middle));
        let of_known = known.iter().map(q).collect::<Result<Vec<_>, ReductionError>>()?;
        let mut farthest: Option<(f64, usize)> = None;
        for (at, point) in training.iter().enumerate().filter(|(_, point)| !known.contains(point)) {
            let own = q(point)?;
            let distance = of_known.iter().map(|other| (other - &own).norm()).fold(f64::INFINITY, f64::min);
            if farthest.is_none_or(|(largest, _)| distance > largest) {
                farthest = Some((distance, at));
            }
        }
        Ok(farthest.map(|(_, at)| at))
    }
}

/// The growth up to which the full problem at a point is to be solved: the limit of the rectangle, or more where a basis has a mode there
/// that grows faster.
fn searched(wanted: &Wanted<'_>, reduced: &Reduced, point: &OperatingPoint) -> Result<f64, ReductionError> {
    let fastest = reduced.modes(point)?.lambdas.iter().map(|lambda| lambda.re).fold(0.0, f64::max);
    let limit = wanted.rectangle.re[1];
    Ok(if fastest > limit { BEYOND * fastest } else { limit })
}

/// A point at which the full problem was solved.
struct Known {
    point: OperatingPoint,
    system: SparseSecondOrder,
    norms: NormsAt,
    /// Up to which growth, 1/s.
    searched: f64,
    modes: Vec<Eigenpair>,
}

struct Building<'a> {
    system: &'a SparseAffineSystem,
    wanted: &'a Wanted<'a>,
    options: &'a Options,
    norms: Norms,
    report: Report,
    known: Vec<Known>,
}

impl Building<'_> {
    /// The full modes at a point up to a growth, 1/s.
    fn solve(&mut self, point: &OperatingPoint, searched: f64) -> Result<Known, ReductionError> {
        let solver = sparse::Options { tolerance: self.options.full_tolerance, ..sparse::Options::default() };
        let Rectangle { re: [lowest, _], im } = self.wanted.rectangle;
        let system = self.system.assemble(point)?;
        let (modes, factorisations) = full::solve(&system, &Rectangle { re: [lowest, searched], im }, &solver)?;
        self.report.full_problems += 1;
        self.report.factorisations += factorisations;
        Ok(Known { point: point.clone(), system, norms: self.norms.at(point), searched, modes })
    }

    fn points(&self) -> Vec<OperatingPoint> {
        self.known.iter().map(|known| known.point.clone()).collect()
    }

    /// A known point at which a basis has a mode that grows faster than was searched, with the growth up to which it is to be.
    fn not_searched(&self, reduced: &Reduced) -> Result<Option<(usize, f64)>, ReductionError> {
        for (at, known) in self.known.iter().enumerate() {
            let growth = searched(self.wanted, reduced, &known.point)?;
            if growth > BEYOND * known.searched {
                return Ok(Some((at, growth)));
            }
        }
        Ok(None)
    }

    /// The fewest principal directions of all vectors that hold the modes at all points.
    fn basis(&self) -> Result<DMatrix<f64>, ReductionError> {
        let known: Vec<_> =
            self.known.iter().map(|Known { system, norms, modes, .. }| ModesAt { system, norms, modes }).collect();
        let goal = (self.options.most_columns, AT_KNOWN_POINTS * self.options.tolerance);
        of_modes(self.system.order(), &known, self.options.vectors, goal)
    }

    /// Adds a stage to the report; the training point of the largest residual with it.
    fn train(&mut self, reduced: &Reduced, why: Why) -> Result<Option<(usize, f64)>, ReductionError> {
        let (stage, worst) = Stage::measure(reduced, self.wanted.training, self.options.tolerance)?;
        self.report.stages.push(Stage {
            why,
            points: self.known.len(),
            full_problems: self.report.full_problems,
            factorisations: self.report.factorisations,
            missed: self.report.missed.len(),
            ..stage
        });
        Ok(worst)
    }
}

/// Full modes without a reduced one near them.
fn missed(reduced: &Reduced, point: &OperatingPoint, modes: &[Eigenpair]) -> Result<Vec<Complex<f64>>, ReductionError> {
    let lambdas: Vec<Complex<f64>> = modes.iter().map(|mode| mode.lambda).collect();
    Ok(compared(&lambdas, reduced.spectrum(point)?).missed)
}
