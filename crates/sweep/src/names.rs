//! Names of branches: the names of the modes that they are at the medians.

use cea::Mode;
use num_complex::Complex;
use study::{ModeLabel, Reference};
use tracking::{Ambiguity, Branches, TrackingError, follow_branch};

use super::family::SHORTEST_STEP;
use crate::Error;

/// Candidates for the name of a branch, ascending: one; several where a coalescence leaves open which mode it is; empty where no name is known.
pub(super) type Names = Vec<ModeLabel>;

/// The names of the eigenvalues at `at`, each followed there from the medians at `median`.
pub(super) fn names_at<B: Branches<Error = Error>>(
    branches: &mut B,
    reference: &Reference,
    median: f64,
    at: f64,
) -> Result<Vec<Names>, Error> {
    let there = branches.lambdas(at)?.len();
    let here = branches.lambdas(median)?.to_vec();
    let mut names = vec![Names::new(); there];
    for (index, of_mode) in nearest(&here, &reference.modes).into_iter().zip(&reference.names) {
        // A mode that cannot be told from others all the way has no name there.
        match follow_branch(branches, median, index, at, SHORTEST_STEP) {
            Ok(there) => there.into_iter().for_each(|to| names[to].extend(of_mode)),
            Err(Error::Study(study::Error::Tracking(TrackingError::Unresolved { .. }))) => {}
            Err(error) => return Err(error),
        }
    }
    for of_branch in &mut names {
        sort(of_branch);
    }
    Ok(names)
}

fn sort(names: &mut Names) {
    names.sort_unstable();
    names.dedup();
}

/// Index of the eigenvalue of each mode in a list, each index once.
fn nearest(lambdas: &[Complex<f64>], modes: &[Mode]) -> Vec<usize> {
    let mut free: Vec<usize> = (0..lambdas.len()).collect();
    let mut places = Vec::with_capacity(modes.len());
    for mode in modes {
        let distance = |at: usize| (lambdas[at] - mode.lambda).norm();
        let Some(best) = (0..free.len()).min_by(|&a, &b| distance(free[a]).total_cmp(&distance(free[b]))) else {
            break;
        };
        places.push(free.remove(best));
    }
    places
}

/// Carries the names that branches have at the parameter `known_at` over the ambiguities above and below: a branch that begins at an
/// ambiguity may be each of those that end there.
pub(super) fn carry(names: &mut [Names], ambiguities: &[Ambiguity], known_at: f64) {
    let mut share = |from: &[usize], to: &[usize]| {
        let mut all: Names = from.iter().flat_map(|&branch| names[branch].clone()).collect();
        sort(&mut all);
        for &branch in to {
            names[branch].clone_from(&all);
        }
    };
    for ambiguity in ambiguities.iter().filter(|ambiguity| ambiguity.from >= known_at) {
        share(&ambiguity.before, &ambiguity.after);
    }
    for ambiguity in ambiguities.iter().rev().filter(|ambiguity| ambiguity.to <= known_at) {
        share(&ambiguity.after, &ambiguity.before);
    }
}
