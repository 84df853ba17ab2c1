//! The reduction of a finite element brake, one for each set of constraints.

use std::f64::consts::TAU;

use linsys::{DofMap, OperatingPoint};
use montecarlo::{Progress, stream};
use rand_distr::{Distribution as _, StandardUniform};
use sparse::reduction::{Options, Reduction, Wanted};
use sparse::{Rectangle, SparseAffineSystem};

use super::points::{draw, full_point, median, no_median, speed};
use crate::Error;
use crate::case::{FiniteElementCase, Law};

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
pub(super) fn rectangle(case: &FiniteElementCase) -> Rectangle {
    let goal = &case.reduction;
    Rectangle { re: goal.growth, im: goal.frequencies.map(|hz| TAU * hz) }
}

/// Reduces the brake with each set of constraints. Points of all arrangements, laws and speeds train the basis.
pub(super) fn reduced_sets(case: &FiniteElementCase, progress: &dyn Progress) -> Result<Vec<ReducedSet>, Error> {
    let patches = case.contact.as_ref().map_or(0, |contact| contact.patches.len());
    let all: Vec<usize> = (0..patches).collect();
    let (middle, baseline) = (median(case), Some((Law::AmontonsCoulomb, 1.0)));
    let at_median = full_point(case, &all, baseline, &middle).map_err(no_median(case))?;
    let training = training_points(case)?;
    let options = Options { tolerance: case.reduction.residual, ..Options::default() };
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

/// Draws, each in an arrangement, under a law and in a range of speed of its own draw.
fn training_points(case: &FiniteElementCase) -> Result<Vec<OperatingPoint>, Error> {
    let mut points = Vec::with_capacity(case.reduction.training);
    for index in 0..case.reduction.training as u64 {
        // Streams from the other end than those of the samples.
        let mut rng = stream(case.seed, u64::MAX - index);
        let sample = draw(case, &mut rng)?;
        let Some(contact) = &case.contact else {
            points.push(full_point(case, &[], None, &sample)?);
            continue;
        };
        let mut choice = |count: usize| {
            let uniform: f64 = StandardUniform.sample(&mut rng);
            ((uniform * count as f64) as usize).min(count - 1)
        };
        let (_, arrangements) = &contact.panels[choice(contact.panels.len())];
        let closed = arrangements[choice(arrangements.len())].in_contact().to_vec();
        let law = contact.laws[choice(contact.laws.len())];
        let at = speed(contact, Some(choice(contact.speeds.len())), &sample);
        points.push(full_point(case, &closed, Some((law, at)), &sample)?);
    }
    Ok(points)
}
