//! The basis of a set of constraints, V: what holds a brake in all its arrangements, before a smaller one is sought within it for each.

use linsys::OperatingPoint;
use nalgebra::DMatrix;
use reduction::{Options, Reduction, ResponseGoal, Wanted, response_basis, snapshot_basis};
use sparse::SparseAffineSystem;

use super::points::{all_patches, naming_point, of_brake};
use super::training::{HELD_OUT, MOST_SOLUTIONS, arrangements, rectangle, training};
use crate::Error;
use crate::case::{FiniteElementCase, PatchContact};

/// Residual that responses to forces in the contacts may have on the basis of a set, as a part of `reduction.residual`. That of modes on this basis is
/// three times as large (measured with cases/disc-pad): half of what is asked for.
const OF_RESPONSES: f64 = 1.0 / 6.0;
/// Residual that modes may have on the basis of a set at the points where they were found, as a part of `reduction.residual`; chosen.
const OF_MODES: f64 = 0.5;
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
/// Least number of draws with all patches closed at which modes enter a basis of modes, one for each law and range of speed if these are more; chosen.
const CLOSED_DRAWS: u64 = 6;
/// Most arrangements with open patches at a draw of which modes enter a basis of modes, thinned evenly; chosen: what several open patches change is nearly
/// the sum of what each does.
const MOST_OPENED: usize = 24;

/// True if responses to forces in the pairs of a contact make the basis of a set: these hold all friction and all arrangements, but have columns for each
/// pair. Else modes at some points do.
pub(super) fn is_of_responses(contact: &PatchContact) -> bool {
    let pairs: usize = contact.patches.iter().map(|patch| patch.pairs.len()).sum();
    !contact.is_of_faces && pairs <= MOST_PAIRS
}

/// True if modes at points that are known beforehand make the basis of a set: of a contact of many pairs of nodes.
pub(super) fn is_of_snapshots(contact: &PatchContact) -> bool {
    !contact.is_of_faces && !is_of_responses(contact)
}

/// Complete solutions of the whole brake that the basis of a set takes, where it is made of modes at points that are known beforehand, with those at the
/// medians and at draws that are held out; else 0, as they are few or not known.
pub(super) fn solutions(case: &FiniteElementCase) -> usize {
    match &case.contact {
        Some(contact) if is_of_snapshots(contact) => {
            snapshots(case, &[]).map_or(0, |points| points.len() + 2 + HELD_OUT)
        }
        _ => 0,
    }
}

/// The basis V of a brake, n x k, on the rows that a set of constraints leaves free. Points that a sweep goes through are held in the place of draws,
/// and further ones that were `trained` on.
pub(super) fn basis(
    case: &FiniteElementCase,
    system: &SparseAffineSystem,
    swept: &[OperatingPoint],
    trained: &[OperatingPoint],
) -> Result<DMatrix<f64>, Error> {
    let all = all_patches(case);
    let at_median = of_brake(case, &all, &naming_point(case, &all)?);
    match &case.contact {
        Some(contact) if is_of_responses(contact) => of_responses(case, system, at_median, swept, trained),
        Some(contact) if is_of_snapshots(contact) => {
            let mut points = snapshots(case, swept)?;
            points.extend_from_slice(trained);
            points.insert(0, at_median);
            let tolerance = OF_MODES * case.reduction.residual;
            Ok(snapshot_basis(system, &rectangle(case), &points, tolerance, MOST_COLUMNS)?)
        }
        _ => enriched(case, system, at_median, swept, trained),
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

/// Points at which modes enter a basis of modes: some with all patches closed under each law and range of speed, and one of each other arrangement, the
/// laws and ranges in turn.
fn snapshots(case: &FiniteElementCase, swept: &[OperatingPoint]) -> Result<Vec<OperatingPoint>, Error> {
    if !swept.is_empty() {
        let step = swept.len().div_ceil(MOST_STRUCTURES);
        return Ok(swept.iter().step_by(step).cloned().collect());
    }
    let all = all_patches(case);
    let mut points = training(case, std::slice::from_ref(&all), CLOSED_DRAWS, &[])?;
    let opened: Vec<_> = arrangements(case).into_iter().filter(|closed| *closed != all).collect();
    // By arrangements, and for each of them by laws and ranges of speed.
    let drawn = training(case, &opened, 0, &[])?;
    let states = drawn.len() / opened.len().max(1);
    let step = opened.len().div_ceil(MOST_OPENED).max(1);
    let turn = (0..opened.len()).step_by(step).enumerate().map(|(turn, at)| at * states + turn % states);
    points.extend(turn.map(|at| drawn[at].clone()));
    Ok(points)
}

/// Modes at training points, as many as it takes.
fn enriched(
    case: &FiniteElementCase,
    system: &SparseAffineSystem,
    at_median: OperatingPoint,
    swept: &[OperatingPoint],
    trained: &[OperatingPoint],
) -> Result<DMatrix<f64>, Error> {
    let mut training = training(case, &arrangements(case), case.reduction.training as u64, swept)?;
    training.extend_from_slice(trained);
    let wanted = Wanted { rectangle: rectangle(case), points: std::slice::from_ref(&at_median), training: &training };
    let tolerance = OF_MODES * case.reduction.residual;
    let options = Options { tolerance, most_enrichments: MOST_SOLUTIONS, ..Options::default() };
    Ok(Reduction::build(system, &wanted, &options)?.reduced.basis().clone())
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
