//! A basis that is enriched until every wanted mode of a training set has the residual that was asked for.
//!
//! A residual tells nothing of a mode that the basis does not hold: it is not among the reduced system's. So the full
//! problem is solved at further points too, each as far as can be from all known ones, until several in a row show nothing new.

use linsys::OperatingPoint;
use nalgebra::DMatrix;
use num_complex::Complex;

use super::basis::{ROUNDING, candidates, directions, fewest, projected_residual};
use super::compared::compared;
use super::full;
use super::norms::{Norms, NormsAt};
use super::report::{MissedMode, Report, Stage, Why};
use super::{Options, Reduced};
use crate::{Eigenpair, Rectangle, SparseAffineSystem, SparseError, SparseSecondOrder};

/// Part of the tolerance that the modes at a known point may use, so that there is room between known points.
const AT_KNOWN_POINTS: f64 = 0.5;

/// A reduction with the history of its basis.
#[derive(Debug, Clone)]
pub struct Reduction {
    /// The reduced brake.
    pub reduced: Reduced,
    /// What each stage cost and reached.
    pub report: Report,
}

/// What a reduction is to hold.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'a> {
    /// Where modes are wanted.
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
    /// An option out of its range, no point, a point of another system, what [`eigenpairs_in`](crate::eigenpairs_in) refuses, a
    /// reduced mass matrix that is singular.
    pub fn build(system: &SparseAffineSystem, wanted: &Wanted<'_>, options: &Options) -> Result<Self, SparseError> {
        options.check()?;
        let (norms, report, solved) = (Norms::new(system), Report::default(), Vec::new());
        let mut work = Building { system, wanted, options, norms, report, solved };
        let mut known: Vec<OperatingPoint> = wanted.points.to_vec();
        let mut modes = Vec::with_capacity(known.len());
        for point in &known {
            modes.push(work.solve(point)?);
        }
        let mut basis = work.basis(&modes)?;
        let mut why = Why::Given;
        let mut quiet = 0;
        loop {
            let reduced = Reduced::new(system, basis.clone(), wanted.rectangle, &known, options)?;
            let worst = work.train(&reduced, why, known.len())?;
            let is_above = worst.is_some_and(|(_, residual)| residual > options.tolerance);
            if is_above {
                quiet = 0;
            }
            let is_limit =
                work.report.enrichments() >= options.most_enrichments || basis.ncols() >= options.most_columns;
            let has_ended = is_limit || (!is_above && quiet >= options.probes);
            let farthest = || Self::farthest(&reduced, wanted.training, &known);
            let next = worst.filter(|_| is_above).map(|(at, _)| at).or_else(farthest);
            let Some(next) = next.filter(|_| !has_ended) else {
                work.report.is_reached = !is_above && quiet >= options.probes;
                return work.finish(reduced, &known);
            };
            let point = &wanted.training[next];
            let found = work.solve(point)?;
            let missed = missed(&reduced, point, &found)?;
            why = if is_above { Why::LargestResidual } else { Why::Farthest };
            quiet = if missed.is_empty() { quiet + 1 } else { 0 };
            work.report.missed.extend(missed.into_iter().map(|lambda| MissedMode { training: next, lambda }));
            known.push(point.clone());
            modes.push(found);
            basis = work.basis(&modes)?;
        }
    }

    /// The training point farthest from the known ones.
    fn farthest(reduced: &Reduced, training: &[OperatingPoint], known: &[OperatingPoint]) -> Option<usize> {
        let unknown = training.iter().enumerate().filter(|(_, point)| !known.contains(point));
        let distances = unknown.map(|(at, point)| (reduced.distance(point), at));
        distances.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, at)| at)
    }
}

struct Building<'a> {
    system: &'a SparseAffineSystem,
    wanted: &'a Wanted<'a>,
    options: &'a Options,
    norms: Norms,
    report: Report,
    /// The systems at the known points, in their order, with their norms.
    solved: Vec<(SparseSecondOrder, NormsAt)>,
}

impl Building<'_> {
    /// The full modes at a point.
    fn solve(&mut self, point: &OperatingPoint) -> Result<Vec<Eigenpair>, SparseError> {
        let solver = crate::Options { tolerance: self.options.full_tolerance, ..crate::Options::default() };
        let full = self.system.assemble(point)?;
        let (modes, factorisations) = full::solve(&full, &self.wanted.rectangle, &solver)?;
        self.solved.push((full, self.norms.at(point)));
        self.report.full_problems += 1;
        self.report.factorisations += factorisations;
        Ok(modes)
    }

    /// The fewest principal directions of all vectors that hold the modes at all points.
    fn basis(&self, modes: &[Vec<Eigenpair>]) -> Result<DMatrix<f64>, SparseError> {
        let empty = DMatrix::zeros(self.system.order(), 0);
        let all: Vec<Eigenpair> = modes.iter().flatten().cloned().collect();
        let found = directions(&empty, candidates(&all, self.options.vectors), ROUNDING)?;
        if found.ncols() == 0 {
            return Err(SparseError::Option {
                option: "the number of modes in the rectangle",
                value: 0.0,
                allowed: "1 or more",
            });
        }
        let error = |basis: &DMatrix<f64>| {
            let errors = self
                .solved
                .iter()
                .zip(modes)
                .map(|((full, norms), modes)| projected_residual(full, |lambda| norms.size(lambda), basis, modes));
            errors.fold(0.0, f64::max)
        };
        Ok(fewest(&empty, &found, self.options.most_columns, AT_KNOWN_POINTS * self.options.tolerance, error))
    }

    /// Adds a stage to the report; the training point of the largest residual with it.
    fn train(&mut self, reduced: &Reduced, why: Why, points: usize) -> Result<Option<(usize, f64)>, SparseError> {
        let (stage, worst) = Stage::measure(reduced, self.wanted.training, self.options.tolerance)?;
        self.report.stages.push(Stage {
            why,
            points,
            full_problems: self.report.full_problems,
            factorisations: self.report.factorisations,
            missed: self.report.missed.len(),
            ..stage
        });
        Ok(worst)
    }

    /// More anchors among the training points, each the farthest from all others.
    fn finish(self, mut reduced: Reduced, known: &[OperatingPoint]) -> Result<Reduction, SparseError> {
        let mut known = known.to_vec();
        while reduced.anchors() < self.options.anchors {
            let Some(next) = Reduction::farthest(&reduced, self.wanted.training, &known) else { break };
            let point = &self.wanted.training[next];
            reduced.add_anchor(point)?;
            known.push(point.clone());
        }
        Ok(Reduction { reduced, report: self.report })
    }
}

/// Full modes without a reduced one near them.
fn missed(reduced: &Reduced, point: &OperatingPoint, modes: &[Eigenpair]) -> Result<Vec<Complex<f64>>, SparseError> {
    let lambdas: Vec<Complex<f64>> = modes.iter().map(|mode| mode.lambda).collect();
    Ok(compared(&lambdas, reduced.spectrum(point)?).missed)
}
