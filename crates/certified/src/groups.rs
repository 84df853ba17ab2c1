//! Groups of eigenvalues of a spectrum that belong together, and discs around them.

use std::collections::HashSet;

use num_complex::Complex;

use super::clusters::{ClusterKind, Enclosed, Semisimple, enclose, nearly_defective};
use super::expansion::Disc;
use super::measure::{Measure, ROUNDING_ONLY, State};

/// Positions of the members of a group, and what it is.
pub(super) type Group = (Vec<usize>, ClusterKind);

/// Discs around the eigenvalues that are not simple, alone or as groups, and the groups, with the groups of the conjugates; members
/// of semisimple groups are taken from their common null space.
pub(super) fn enclose_groups(
    problem: &Measure,
    found: &mut [State],
    conjugates: &[Option<usize>],
) -> (Vec<Option<Disc>>, Vec<Group>) {
    let sigmas: Vec<_> = found.iter().map(|s| s.sigma).collect();
    let blurs: Vec<_> = found.iter().map(|s| s.blur).collect();
    let mut discs: Vec<_> = found.iter().map(|s| s.alone.disc()).collect();
    let (mut groups, mut seen) = (Vec::new(), HashSet::new());
    for i in 0..found.len() {
        if found[i].is_simple || conjugates[i].is_some() || discs[i].is_some() {
            continue;
        }
        let enclosed = enclose(&problem.scaled, &sigmas, &blurs, i, &found[i], &mut seen);
        let Some(Enclosed { members, disc, space }) = enclosed else {
            continue;
        };
        for &j in members.iter().filter(|&&j| !found[j].is_simple) {
            discs[j] = discs[j].or(Some(disc));
        }
        let kind = if space.is_some() { ClusterKind::Semisimple } else { ClusterKind::Defective };
        if let Some(space) = space {
            adopt(problem, found, &members, disc.centre, &space);
        }
        if members.len() > 1 {
            groups.push((members, kind));
        }
    }
    let mirrored = groups.iter().filter_map(|(members, kind)| {
        let mirror = members.iter().map(|&i| conjugates.iter().position(|&first| first == Some(i)));
        Some((mirror.collect::<Option<Vec<_>>>()?, *kind))
    });
    groups.extend(mirrored.collect::<Vec<_>>());
    (discs, groups)
}

/// Gives the members of a semisimple group the vectors and eigenvalues of their common null space. Simple ones keep their own, as zeros of an exact count do.
fn adopt(problem: &Measure, found: &mut [State], members: &[usize], mean: Complex<f64>, space: &Semisimple) {
    let (scaled_condition, condition) = problem.conditions(mean, &space.right, &space.left);
    for (at, &i) in members.iter().enumerate() {
        if found[i].is_simple {
            continue;
        }
        let sigma = space.sigmas.as_ref().map_or(found[i].sigma, |s| s[at]);
        let member = problem.state(sigma, space.right[at].clone(), space.left[at].clone());
        // Members that are told apart have vectors of their own, and those of a wide group may solve the equations worse.
        if member.error() <= ROUNDING_ONLY.max(found[i].error()) {
            found[i] = member;
        }
        (found[i].scaled_condition, found[i].condition) = (scaled_condition, condition);
    }
}

/// Pairs of the same half plane that belong to no group and have nearly parallel vectors.
pub(super) fn nearly_defective_pairs(found: &[State], conjugates: &[Option<usize>], groups: &[Group]) -> Vec<Group> {
    let alone: Vec<usize> = (0..found.len())
        .filter(|&i| found[i].sigma != Complex::default() && !groups.iter().any(|(members, _)| members.contains(&i)))
        .collect();
    let mut pairs = Vec::new();
    for (at, &i) in alone.iter().enumerate() {
        for &j in &alone[..at] {
            let (a, b) = (&found[i], &found[j]);
            if conjugates[i].is_none() == conjugates[j].is_none() && nearly_defective((a.sigma, &a.x), (b.sigma, &b.x))
            {
                pairs.push((vec![j, i], ClusterKind::NearlyDefective));
            }
        }
    }
    pairs
}
