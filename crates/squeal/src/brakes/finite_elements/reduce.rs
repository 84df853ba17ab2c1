//! The reduction of a finite element brake, one for each set of constraints.

use std::f64::consts::TAU;

use linsys::{DofMap, OperatingPoint};
use montecarlo::{Progress, stream};
use sparse::reduction::{Options, Reduction, Wanted};
use sparse::{Rectangle, SparseAffineSystem};

use super::points::{draw, naming_point, of_brake, scene_point, speed, speeds_of};
use crate::Error;
use crate::case::{FiniteElementCase, Law};

/// Most full problems for one set of constraints; chosen: a second each, and a basis that needs more is as large as its limit.
const MOST_ENRICHMENTS: usize = 60;

/// The brake with one set of constraints, reduced.
#[derive(Debug)]
pub struct ReducedSet {
    /// Which rows of the matrices are free.
    pub dofs: DofMap,
    /// The system over the free rows.
    pub system: SparseAffineSystem,
    /// Its reduction.
    pub reduction: Reduction,
}

/// Where the modes of a case are wanted, rad/s.
fn rectangle(case: &FiniteElementCase) -> Rectangle {
    let goal = &case.reduction;
    Rectangle { re: goal.growth, im: goal.frequencies.map(|hz| TAU * hz) }
}

/// Reduces the brake with each set of constraints. Points of all arrangements, laws and speeds train the basis.
pub(super) fn reduced_sets(case: &FiniteElementCase, progress: &dyn Progress) -> Result<Vec<ReducedSet>, Error> {
    let patches = case.contact.as_ref().map_or(0, |contact| contact.patches.len());
    let all: Vec<usize> = (0..patches).collect();
    let at_median = of_brake(case, &all, &naming_point(case, &all)?);
    let training = training_points(case)?;
    let tolerance = case.reduction.residual;
    let options = Options { tolerance, most_enrichments: MOST_ENRICHMENTS, ..Options::default() };
    progress.begin(case.constraints.len() as u64, 0);
    let mut sets = Vec::with_capacity(case.constraints.len());
    for set in &case.constraints {
        let dofs = DofMap::new(case.dofs.len(), &set.fixed)?;
        let system = case.system.on(&dofs)?;
        let points = std::slice::from_ref(&at_median);
        let wanted = Wanted { rectangle: rectangle(case), points, training: &training };
        let reduction = Reduction::build(&system, &wanted, &options)?;
        sets.push(ReducedSet { dofs, system, reduction });
        progress.advance(1);
    }
    progress.end();
    Ok(sets)
}

/// The closed patches of a scene, from 0, and its law with the place of its range of speed, where it has one.
type PatchScene<'a> = (&'a [usize], Option<(Law, Option<usize>)>);

/// Draws, each in one arrangement, law and range of speed after another: at least as many as these are, so that every arrangement is
/// known to the basis.
fn training_points(case: &FiniteElementCase) -> Result<Vec<OperatingPoint>, Error> {
    let scenes: Vec<PatchScene<'_>> = match &case.contact {
        None => vec![(&[], None)],
        Some(contact) => {
            let arrangements = contact.panels.iter().flat_map(|(_, arrangements)| arrangements);
            let states = |&law: &Law| speeds_of(contact, law).into_iter().map(move |range| (law, range));
            let states: Vec<_> = contact.laws.iter().flat_map(states).collect();
            let of = |closed| states.iter().map(move |&state| (closed, Some(state)));
            arrangements.flat_map(|arrangement| of(arrangement.in_contact())).collect()
        }
    };
    let count = case.reduction.training.max(scenes.len()) as u64;
    let point = |(index, &(closed, state)): (u64, &PatchScene<'_>)| {
        // Streams from the other end than those of the samples.
        let sample = draw(case, &mut stream(case.seed, u64::MAX - index))?;
        let at = case.contact.as_ref().zip(state);
        let state = at.map(|(contact, (law, range))| (law, speed(contact, range, &sample)));
        Ok(of_brake(case, closed, &scene_point(case, closed, state, &sample)?))
    };
    (0..count).zip(scenes.iter().cycle()).map(point).collect()
}
