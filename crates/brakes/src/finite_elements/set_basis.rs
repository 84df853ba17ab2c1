//! The basis of a set of constraints, V: what holds a brake in all its arrangements, before a smaller one is sought within it for each.

use linsys::OperatingPoint;
use montecarlo::Progress;
use nalgebra::DMatrix;
use num_complex::Complex;
use rayon::prelude::*;
use reduction::{ResponseGoal, Snapshot, Snapshots, response_basis};
use sparse::SparseAffineSystem;

use super::points::{all_patches, naming_point, of_brake};
use super::training::{Drawn, draws, rectangle, training};
use crate::Error;
use crate::case::{FiniteElementCase, PatchContact};

/// Residual that responses to forces in the contacts may have on the basis of a set, as a part of `reduction.residual`. That of modes on this basis is
/// three times as large (measured with cases/disc-pad): half of what is asked for.
const OF_RESPONSES: f64 = 1.0 / 6.0;
/// Error, relative to |lambda|, that modes of a draw may have on a basis of modes that was made without it; chosen: a hundred times that is what is
/// assumed of samples.
const WANTED_ERROR: f64 = 1e-6;
/// Singular values, of vectors of unit length, down to which directions are in a basis of modes: at first, and least where a draw whose modes were added is
/// not held; each time a tenth. Chosen.
const FLOORS: [f64; 2] = [1e-5, 1e-9];
/// Complete solutions that make a basis of modes, with that at the medians, before draws tell whether it is enough; and most of them. Measured with
/// cases/disc-pad and its refinement: 12 hold eigenvalues to 3e-9 and 1e-6.
const FIRST_SOLUTIONS: usize = 9;
const MOST_SOLUTIONS: usize = 40;
/// Draws that a basis of modes was not made of and holds, after which it is enough; chosen: bounds of verdicts are told by them.
const HELD_OUT: usize = 3;
/// Complete solutions at a time; chosen: each takes the memory of a factorisation.
const TOGETHER: usize = 2;
/// Most columns of a basis; chosen, for the time that a complete solution on it takes.
const MOST_COLUMNS: usize = 600;
/// Most pairs of nodes whose responses make a basis; chosen: that of cases/disc-pad has 16 columns for each of its 27 pairs. With more pairs a basis of
/// modes has fewer columns, whatever the number of pairs is.
const MOST_PAIRS: usize = 40;
/// Least number of draws at whose coefficients responses are computed, beside the medians, where any are drawn: one for each law and range of speed if
/// these are more; chosen.
const DRAWN_STRUCTURES: u64 = 4;
/// Largest number of draws or points of a sweep at whose coefficients responses are computed, thinned evenly; chosen: each takes a factorisation at a few
/// frequencies.
const MOST_STRUCTURES: usize = 6;
/// True if responses to forces in the pairs of a contact make the basis of a set: these hold all friction and all arrangements, but have columns for each
/// pair. Else modes at draws do.
pub(super) fn is_of_responses(contact: &PatchContact) -> bool {
    let pairs: usize = contact.patches.iter().map(|patch| patch.pairs.len()).sum();
    !contact.is_of_faces && pairs <= MOST_PAIRS
}

/// Complete solutions of the whole brake that the basis of a set takes, roughly: those that make it, with those at draws that are held out and at the medians.
pub(super) fn solutions(case: &FiniteElementCase) -> usize {
    if case.contact.as_ref().is_some_and(is_of_responses) { 1 } else { FIRST_SOLUTIONS + 2 * HELD_OUT + 1 }
}

/// The basis V of a brake, n x k, and draws that it was not made of.
pub(super) struct SetBasis {
    pub basis: DMatrix<f64>,
    pub held_out: Vec<HeldOut>,
}

/// A draw that a basis of modes was not made of.
#[derive(Debug)]
pub(super) struct HeldOut {
    pub drawn: Drawn,
    /// The modes of the whole brake there, rad/s.
    pub modes: Vec<Complex<f64>>,
}

/// The basis of a brake on the rows that a set of constraints leaves free. Points that a sweep goes through are held in the place of draws,
/// and further ones that were `trained` on. Each complete solution is an advance of the progress.
pub(super) fn basis(
    case: &FiniteElementCase,
    system: &SparseAffineSystem,
    (swept, trained): (&[OperatingPoint], &[OperatingPoint]),
    progress: &dyn Progress,
) -> Result<SetBasis, Error> {
    let all = all_patches(case);
    let at_median = of_brake(case, &all, &naming_point(case, &all)?);
    match &case.contact {
        Some(contact) if is_of_responses(contact) => {
            let basis = of_responses(case, system, at_median, swept, trained)?;
            progress.advance(1);
            Ok(SetBasis { basis, held_out: Vec::new() })
        }
        _ => of_modes(case, system, at_median, (swept, trained), progress),
    }
}

/// Responses to forces in the contacts.
fn of_responses(
    case: &FiniteElementCase,
    system: &SparseAffineSystem,
    at_median: OperatingPoint,
    swept: &[OperatingPoint],
    trained: &[OperatingPoint],
) -> Result<DMatrix<f64>, Error> {
    let mut points = vec![at_median.clone()];
    if !case.parameters.is_empty() {
        let training = training(case, &[all_patches(case)], DRAWN_STRUCTURES, swept)?;
        let step = training.len().div_ceil(MOST_STRUCTURES);
        points.extend(training.into_iter().step_by(step));
        points.extend(trained.iter().map(|point| all_closed(case, &at_median, point)));
    }
    let goal = ResponseGoal {
        frequencies: rectangle(case).im,
        tolerance: OF_RESPONSES * case.reduction.residual,
        most_columns: MOST_COLUMNS,
    };
    Ok(response_basis(system, &points, &goal)?.basis)
}

/// Modes at the medians, at points that were trained on, and at draws, one after another, until some in a row are held that were not added.
fn of_modes(
    case: &FiniteElementCase,
    system: &SparseAffineSystem,
    at_median: OperatingPoint,
    (swept, trained): (&[OperatingPoint], &[OperatingPoint]),
    progress: &dyn Progress,
) -> Result<SetBasis, Error> {
    let mut snapshots = Snapshots::new(system, rectangle(case));
    let mut known = vec![at_median];
    known.extend_from_slice(trained);
    for points in known.chunks(TOGETHER) {
        solved(&snapshots, points, progress)?.iter().try_for_each(|found| snapshots.add(found))?;
    }
    let mut drawn_once: Vec<Drawn> = Vec::new();
    // There may be nothing that is drawn.
    for drawn in draws(case, swept, MOST_SOLUTIONS + HELD_OUT)? {
        if !known.contains(&drawn.at) && !drawn_once.contains(&drawn) {
            drawn_once.push(drawn);
        }
    }
    let ([mut floor, least], mut held_out) = (FLOORS, Vec::new());
    let mut basis = None;
    let (mut solutions, mut in_a_row) = (known.len(), 0);
    for drawn in drawn_once.chunks(TOGETHER) {
        let points: Vec<OperatingPoint> = drawn.iter().map(|drawn| drawn.at.clone()).collect();
        for (drawn, found) in drawn.iter().zip(solved(&snapshots, &points, progress)?) {
            let is_held = basis.as_ref().is_some_and(|basis| found.error(basis) <= WANTED_ERROR);
            if is_held || solutions >= MOST_SOLUTIONS {
                held_out.push(HeldOut { drawn: drawn.clone(), modes: found.lambdas() });
                in_a_row += 1;
                continue;
            }
            in_a_row = 0;
            snapshots.add(&found)?;
            solutions += 1;
            if solutions < FIRST_SOLUTIONS {
                continue;
            }
            let mut wider = snapshots.basis(floor, MOST_COLUMNS)?;
            while found.error(&wider) > WANTED_ERROR && floor > least && wider.ncols() < MOST_COLUMNS {
                floor *= 0.1;
                wider = snapshots.basis(floor, MOST_COLUMNS)?;
            }
            basis = Some(wider);
        }
        if in_a_row >= HELD_OUT {
            break;
        }
    }
    let basis = match basis {
        Some(basis) => basis,
        // So few that none of them was asked about: all that there is.
        None => snapshots.basis(least, MOST_COLUMNS)?,
    };
    Ok(SetBasis { basis, held_out })
}

/// All modes of the whole brake at some points.
fn solved(
    snapshots: &Snapshots<'_>,
    points: &[OperatingPoint],
    progress: &dyn Progress,
) -> Result<Vec<Snapshot>, Error> {
    let one = |point: &OperatingPoint| {
        progress.go_on()?;
        let found = snapshots.at(point)?;
        progress.advance(1);
        Ok(found)
    };
    points.par_iter().map(one).collect()
}

/// A point with all patches closed, as stiff as they are where they are closed: at least those of the medians.
fn all_closed(case: &FiniteElementCase, medians: &OperatingPoint, at: &OperatingPoint) -> OperatingPoint {
    let patches = all_patches(case).len();
    let first = at.coefficients.len() - patches;
    let factor = at.coefficients[first..].iter().copied().find(|&factor| factor != 0.0);
    let mut coefficients = at.coefficients.clone();
    let closed = coefficients[first..].iter_mut().zip(&medians.coefficients[first..]);
    closed.for_each(|(own, median)| *own = factor.unwrap_or(*median));
    OperatingPoint { coefficients, channels: at.channels.clone() }
}
