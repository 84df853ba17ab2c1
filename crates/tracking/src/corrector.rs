//! The corrector: from a guess of an eigenvalue at a point of a path to the mode there, by Newton's method.
//!
//! All paths go through here. From the eigenpair of a neighbouring system, without a path, leads
//! [`cea::Eigentriple::of_neighbour`]; a Ritz value of a large system is polished in `sparse`, and digits beyond a double are
//! computed in `certified`.

use std::{mem::discriminant, slice};

use cea::{EigenvaluePair, Mode, NewtonStep, Workspace};
use linsys::real_times_complex;
use num_complex::Complex;

use crate::evaluator::{Guess, PairGuess, PathEvaluator, Shape};
use crate::mac::{Match, match_weighted};
use crate::path::{Path, PathPoint};
use crate::tuning::tuning;

/// Most modes that are corrected together, times the square of the order of their matrices; eight modes are in any case, as many as the batched solvers
/// take at a time at most. Chosen: at four real matrices a mode that is 64 MB of memory.
const MOST_NUMBERS: usize = 2 << 20;

/// A mode at a point of its path.
#[derive(Debug, Clone)]
pub(crate) struct ModeOnPath {
    pub mode: Mode,
    /// Product M phi.
    pub weighted: Shape,
    /// Derivative d lambda / d t, rad/s.
    pub rate: Complex<f64>,
}

impl ModeOnPath {
    /// Match of this mode to one of `known`, by MAC.
    pub fn matched(&self, known: &[Mode]) -> Match {
        match_weighted(slice::from_ref(&self.mode), slice::from_ref(&self.weighted), known).remove(0)
    }
}

/// Most modes of a path that are corrected together: all of small systems, which is cheaper, and of large ones as many as fill little memory.
fn most_together(path: &Path<'_>) -> usize {
    let order = path.mass().nrows().max(1);
    (MOST_NUMBERS / (order * order) / 8).max(1) * 8
}

/// The mode that Newton's method finds from each guess; `None` where Newton's method does not converge.
pub(crate) fn modes_on_paths(at: &[PathPoint<'_>], work: &mut Workspace) -> Vec<Option<ModeOnPath>> {
    let mut found = Vec::with_capacity(at.len());
    let blocks = at.chunk_by(|a, b| discriminant(&a.path.start) == discriminant(&b.path.start));
    for group in blocks.flat_map(|block| block.chunks(most_together(&block[0].path))) {
        let gains: Vec<_> = group.iter().filter_map(|p| Some((p.path.as_gains()?, p.t, p.lambda))).collect();
        let systems: Vec<_> = group.iter().filter_map(|p| Some((p.path.as_systems()?, p.t, p.lambda))).collect();
        let owned: Vec<_> = group.iter().filter_map(|p| Some((p.path.as_owned()?, p.t, p.lambda))).collect();
        // All but one are empty.
        found.extend(converged(gains, work));
        found.extend(converged(systems, work));
        found.extend(converged(owned, work));
    }
    let mode = |(found, at): (Option<(NewtonStep, Shape)>, &PathPoint<'_>)| {
        let (NewtonStep { lambda, rate }, mut shape) = found?;
        let mut weighted = real_times_complex(at.path.mass(), &shape);
        let size = shape.dotc(&weighted).re.abs().sqrt();
        shape.unscale_mut(size);
        weighted.unscale_mut(size);
        Some(ModeOnPath { mode: Mode { lambda, shape }, weighted, rate })
    };
    found.into_iter().zip(at).map(mode).collect()
}

/// The pair of eigenvalues that each guess leads to, with its derivative over t; `None` where a guess leads to no pair, or where
/// the matrices of its ends evaluate the path.
pub(crate) fn pairs_on_paths(at: &[PairGuess<Path<'_>>], work: &mut Workspace) -> Vec<Option<[EigenvaluePair; 2]>> {
    let mut found = Vec::with_capacity(at.len());
    let blocks = at.chunk_by(|a, b| discriminant(&a.0.start) == discriminant(&b.0.start));
    for group in blocks.flat_map(|block| block.chunks(most_together(&block[0].0))) {
        let gains: Vec<_> = group.iter().filter_map(|p| Some((p.0.as_gains()?, p.1, p.2))).collect();
        let systems: Vec<_> = group.iter().filter_map(|p| Some((p.0.as_systems()?, p.1, p.2))).collect();
        let owned: Vec<_> = group.iter().filter_map(|p| Some((p.0.as_owned()?, p.1, p.2))).collect();
        // All but one are empty.
        found.extend(PathEvaluator::pairs(&gains, work));
        found.extend(PathEvaluator::pairs(&systems, work));
        found.extend(PathEvaluator::pairs(&owned, work));
    }
    found
}

/// Newton's method from each guess; each step corrects all guesses that have not converged yet.
fn converged<P: PathEvaluator>(mut at: Vec<Guess<P>>, work: &mut Workspace) -> Vec<Option<(NewtonStep, Shape)>> {
    let mut found: Vec<Option<(NewtonStep, P::Vector)>> = vec![None; at.len()];
    let mut open: Vec<usize> = (0..at.len()).collect();
    let tuning = tuning();
    for _ in 0..tuning.most_corrections {
        if open.is_empty() {
            break;
        }
        let asked: Vec<Guess<P>> = open.iter().map(|&i| at[i]).collect();
        let mut corrected = P::correct(&asked, work).into_iter();
        open.retain(|&i| {
            let Some((step, vector)) = corrected.next().flatten() else { return false };
            let correction = (step.lambda - at[i].2).norm();
            at[i].2 = step.lambda;
            let has_converged = P::CONVERGES_AT_ONCE || correction <= tuning.converged * step.lambda.norm();
            if has_converged {
                found[i] = Some((step, vector));
            }
            !has_converged
        });
    }
    let (mut steps, mut asked) = (Vec::with_capacity(at.len()), Vec::with_capacity(at.len()));
    for (found, at) in found.into_iter().zip(at) {
        let (step, vector) = found.unzip();
        steps.push(step);
        asked.extend(vector.map(|vector| (at, vector)));
    }
    let mut shapes = P::shapes(asked, work).into_iter();
    steps.into_iter().map(|step| step.and_then(|step| Some((step, shapes.next()??)))).collect()
}
