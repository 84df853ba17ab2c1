//! The basis of a set of constraints, V: it holds a brake in all its arrangements, and a smaller one is sought within it for each of them. It is made of the
//! modes at the medians, of what these lead to at some draws, and of all modes at further draws, one after another, until it holds several in a row that it was not made
//! of.

use cea::{BatchSolver, EigenSolver as _, Workspace, grows_too_fast};
use linsys::OperatingPoint;
use montecarlo::Progress;
use nalgebra::DMatrix;
use num_complex::Complex;
use rayon::prelude::*;
use reduction::{Losses, NearModes, ReductionError, Snapshot, SnapshotMode, Snapshots};
use sparse::SparseAffineSystem;

use super::points::{all_patches, naming_point, of_brake};
use super::together::search_options;
use super::training::{Drawn, draws, rectangle};
use crate::Error;
use crate::bits::{Bits as _, bits};
use crate::case::FiniteElementCase;
use crate::prepared::Pieces;

/// Error, relative to |lambda|, that modes of a draw may have on a basis that was made without it; chosen: a hundred times that is what is
/// assumed of samples.
const WANTED_ERROR: f64 = 1e-6;
/// Floors of a basis, which has the directions of larger singular values (of vectors of unit length): the first one, which is divided by ten each time that
/// a draw whose modes were added is not held, and the least one. Chosen: a lower one adds directions, which cost time and may make modes that the brake does
/// not have.
const FLOORS: [f64; 2] = [3e-5, 1e-9];
/// First floor of a basis for points that are all known. It has no more directions than hold them, as each direction that is a part of modes beside the band
/// may make a mode that the brake does not have.
const FEWEST: f64 = 1e-2;
/// Factor from one floor to the next that is tried, if a basis has modes that the brake does not have; chosen: it adds few directions.
const FINER: f64 = 0.5;
/// Smallest singular value of the leading columns of a basis, which have all modes of any draw, roughly; chosen: with a smaller one, spectra on these columns
/// take longer; with a larger one, they miss modes that have to be found on all columns.
const LEADING: f64 = 3e-3;
/// Number of draws to which the modes at the medians are led ([`NearModes`]), before complete solutions tell whether a basis of these is enough. Chosen: so many in a row
/// reach all of ten scenes. Measured with cases/disc-pad and its refinement: eigenvalues at other draws of the latter are held to 2e-7.
const NEAR: usize = 12;
/// Most complete solutions of which a basis is made; draws after these are held out, whatever their error on it is.
const MOST_SOLUTIONS: usize = 40;
/// Number of draws in a row that a basis was not made of and has to hold; chosen: the error bounds of verdicts are told by them.
const HELD_OUT: usize = 3;
/// Most columns of a basis; chosen, for the time that a complete solution on it takes.
const MOST_COLUMNS: usize = 600;
/// Number of advances that the basis of a set makes, roughly: complete solutions, at the medians and at draws that are held out, and modes led to draws.
pub(super) const ADVANCES: usize = 1 + NEAR + HELD_OUT;
/// Number of complete solutions in whose time the basis of a set is made, roughly: three draws to which modes are led count as one, as measured on the same meshes.
pub(super) const SOLUTIONS: usize = 1 + NEAR / 3 + HELD_OUT + 1;

/// Orthonormal directions, n x k, by descending singular value, with these.
type Directions = (DMatrix<f64>, Vec<f64>);

/// The basis V of a brake, n x k, and draws that it was not made of.
pub(super) struct SetBasis {
    pub basis: DMatrix<f64>,
    /// Number of its first columns that have all modes of any draw, roughly.
    pub leading: usize,
    /// Eigenvalues of the whole brake at the medians, in the rectangle and around it, rad/s.
    pub at_medians: Vec<Complex<f64>>,
    /// True if at the medians the brake on it has modes that the whole one does not have.
    pub has_others: bool,
    /// Draws that it was not made of, in their order; fewer than [`HELD_OUT`] where nearly nothing is drawn.
    pub held_out: Vec<HeldOut>,
}

/// A draw that a basis was not made of.
#[derive(Debug)]
pub(super) struct HeldOut {
    pub drawn: Drawn,
    /// The modes of the whole brake there, rad/s.
    pub modes: Vec<Complex<f64>>,
}

/// Place in which complete solutions of the whole brake are kept until its bases are made.
pub(super) struct KeptSolutions<'a> {
    pub pieces: &'a Pieces<'a>,
    /// Rows that the set of constraints fixes.
    pub fixed: &'a Vec<usize>,
}

bits!(SetBasis { basis, leading, at_medians, has_others, held_out });
bits!(HeldOut { drawn, modes });
bits!(Drawn { closed, at });

/// The basis of a brake on the rows that a set of constraints leaves free, of modes at the medians, at the points `trained` and at draws, in whose place are
/// the points `swept` of a sweep, if there are any. Each complete solution is an advance of the progress; `together` of them are made at once, on which
/// nothing depends but how long it takes.
pub(super) fn basis(
    case: &FiniteElementCase,
    (system, together): (&SparseAffineSystem, usize),
    (swept, trained): (&[OperatingPoint], &[OperatingPoint]),
    kept: &KeptSolutions<'_>,
    progress: &dyn Progress,
) -> Result<SetBasis, Error> {
    let all = all_patches(case);
    let at_median = of_brake(case, &all, &naming_point(case, &all)?);
    let mut snapshots = Snapshots::new(system, rectangle(case), search_options(together));
    let alone = || snapshots.modes_around(&at_median, &search_options(1));
    let around = kept.modes(("solution around", &at_median), alone, progress)?;
    let at_medians = snapshots.known(&at_median, around.clone());
    snapshots.add(&at_medians)?;
    // What the basis was made of, until there is one.
    let mut made_of = vec![at_medians.clone()];
    for points in trained.chunks(together) {
        for found in solved(&snapshots, points, kept, progress)? {
            snapshots.add(&found)?;
            made_of.push(found);
        }
    }
    let mut drawn_once: Vec<Drawn> = Vec::new();
    // There may be nothing that is drawn.
    for drawn in draws(case, swept, NEAR + MOST_SOLUTIONS + HELD_OUT)? {
        if drawn.at != at_median && !trained.contains(&drawn.at) && !drawn_once.contains(&drawn) {
            drawn_once.push(drawn);
        }
    }
    let ([mut floor, _], mut held_out) = (FLOORS, Vec::new());
    let mut basis = None;
    // Of fewer draws each is solved, and is all that there is to hold.
    if drawn_once.len() >= NEAR + HELD_OUT {
        let near = NearModes::new(system, &rectangle(case), &around, search_options(together).threads)?;
        let led: Vec<OperatingPoint> = drawn_once.drain(..NEAR).map(|drawn| drawn.at).collect();
        let one = |point: &OperatingPoint| kept.modes(("near", point), || near.at(point), progress);
        for points in led.chunks(together) {
            for (point, modes) in points.iter().zip(points.par_iter().map(one).collect::<Result<Vec<_>, Error>>()?) {
                snapshots.add(&snapshots.known(point, modes))?;
            }
        }
        basis = Some(holding(&snapshots, &std::mem::take(&mut made_of), &mut floor)?);
    }
    let (mut solutions, mut in_a_row) = (1 + trained.len(), 0);
    while !drawn_once.is_empty() && in_a_row < HELD_OUT {
        // No more than may be the last ones.
        let count = if basis.is_some() { together.min(HELD_OUT - in_a_row) } else { together };
        let drawn: Vec<Drawn> = drawn_once.drain(..count.min(drawn_once.len())).collect();
        let points: Vec<OperatingPoint> = drawn.iter().map(|drawn| drawn.at.clone()).collect();
        for (drawn, found) in drawn.into_iter().zip(solved(&snapshots, &points, kept, progress)?) {
            solutions += 1;
            let Some((known, _)) = &basis else {
                snapshots.add(&found)?;
                made_of.push(found);
                continue;
            };
            if found.error(known)? <= WANTED_ERROR || solutions > MOST_SOLUTIONS {
                held_out.push(HeldOut { drawn, modes: found.lambdas() });
                in_a_row += 1;
                continue;
            }
            in_a_row = 0;
            snapshots.add(&found)?;
            basis = Some(holding(&snapshots, &[found], &mut floor)?);
        }
    }
    let (basis, values) = match basis {
        Some(basis) => basis,
        None => holding(&snapshots, &made_of, &mut { FEWEST })?,
    };
    let ((basis, values), has_others) = without_others((system, &at_median), &snapshots, &at_medians, (basis, values))?;
    let leading = values.iter().take_while(|&&value| value > LEADING).count();
    let at_medians = around.into_iter().map(|mode| mode.lambda).collect();
    Ok(SetBasis { basis, leading, at_medians, has_others, held_out })
}

/// A basis of all snapshots, with its singular values, that holds the modes `of` these: its floor is lowered until it does, or cannot be lowered further.
fn holding(snapshots: &Snapshots<'_>, of: &[Snapshot<'_>], floor: &mut f64) -> Result<Directions, ReductionError> {
    loop {
        let basis = snapshots.basis(*floor, MOST_COLUMNS)?;
        let errors = of.iter().map(|found| found.error(&basis.0)).collect::<Result<Vec<f64>, _>>()?;
        if errors.iter().all(|&error| error <= WANTED_ERROR) || *floor <= FLOORS[1] || basis.0.ncols() >= MOST_COLUMNS {
            return Ok(basis);
        }
        *floor *= 0.1;
    }
}

/// The basis `given`, and false, if the brake on it has no modes at the medians that the `whole` brake does not have: directions that are parts of modes
/// beside the band may together look like one in it. Otherwise a basis with fewer or more directions that has no such modes and holds those of the whole
/// brake, and false; where none is found the basis `given`, and true.
fn without_others(
    (system, at): (&SparseAffineSystem, &OperatingPoint),
    snapshots: &Snapshots<'_>,
    whole: &Snapshot<'_>,
    given: Directions,
) -> Result<(Directions, bool), Error> {
    let has_others = |basis: &DMatrix<f64>| -> Result<bool, Error> {
        let reduced = system.project(basis)?;
        let mut modes = match Losses::new(system, &reduced, at)? {
            Some(losses) => losses.eigenvalues(&losses.with_dashpots(&reduced)?, at)?,
            None => BatchSolver.eigenvalues(&reduced.assemble(at)?, &mut Workspace::default())?.eigenvalues,
        };
        modes.retain(|&lambda| !grows_too_fast(lambda));
        Ok(!whole.has_all(&modes))
    };
    if !has_others(&given.0)? {
        return Ok((given, false));
    }
    let mut tried = given.0.ncols();
    let mut floor = FEWEST;
    while floor > FLOORS[1] {
        let other = snapshots.basis(floor, MOST_COLUMNS)?;
        let is_new = std::mem::replace(&mut tried, other.0.ncols()) != other.0.ncols();
        if is_new && whole.error(&other.0)? <= WANTED_ERROR && !has_others(&other.0)? {
            return Ok((other, false));
        }
        floor *= FINER;
    }
    Ok((given, true))
}

/// All modes of the whole brake at each of `points`.
fn solved<'a>(
    snapshots: &Snapshots<'a>,
    points: &[OperatingPoint],
    kept: &KeptSolutions<'_>,
    progress: &dyn Progress,
) -> Result<Vec<Snapshot<'a>>, Error> {
    let one = |point: &OperatingPoint| {
        let modes = kept.modes(("solution", point), || Ok(snapshots.at(point)?.into_modes()), progress)?;
        Ok(snapshots.known(point, modes))
    };
    points.par_iter().map(one).collect()
}

impl KeptSolutions<'_> {
    /// Modes at a point, which are kept under a name: an advance of the progress.
    fn modes(
        &self,
        (name, point): (&str, &OperatingPoint),
        find: impl FnOnce() -> Result<Vec<SnapshotMode>, ReductionError>,
        progress: &dyn Progress,
    ) -> Result<Vec<SnapshotMode>, Error> {
        progress.go_on()?;
        let inputs = |to: &mut Vec<u8>| {
            self.fixed.put(to);
            point.put(to);
        };
        let modes = self.pieces.interim(name, inputs, || Ok(find()?))?;
        progress.advance(1);
        Ok(modes)
    }
}
