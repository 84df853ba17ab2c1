//! Degrees of freedom that `*BOUNDARY` of a deck fixes.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::keyword::set_name;
use crate::Dof;

/// Adds to `held` the displacements that a data line of `*BOUNDARY` fixes: `node or set, first, last`, or `node or set, name` with one of Abaqus's names
/// of fixed directions. A prescribed value other than 0, in the fourth field, fixes the degree of freedom too: it does not vibrate.
///
/// A line in any other form adds nothing and is not refused: nodes that it fixes then count among the nodes without rows where faces radiate.
/// `places` has the nodes of the deck by their labels: a label that stands in the line itself must be one of them, the labels of a set need not.
pub(super) fn add(
    held: &mut BTreeSet<Dof>,
    fields: &[&str],
    places: &HashMap<i64, usize>,
    sets: &BTreeMap<String, Vec<i64>>,
) {
    let [who, what, rest @ ..] = fields else { return };
    let nodes = match (who.parse::<i64>(), set_name(who)) {
        (Ok(label), _) if places.contains_key(&label) => vec![label],
        (Err(_), Ok(name)) => sets.get(&name).cloned().unwrap_or_default(),
        _ => return,
    };
    // Displacements alone: the nodes of solids have no rotations, which ENCASTRE and the symmetries fix too.
    let directions = match (what.to_ascii_uppercase().as_str(), what.parse::<u32>()) {
        ("ENCASTRE" | "PINNED", _) => 1..=3,
        ("XSYMM", _) => 1..=1,
        ("YSYMM", _) => 2..=2,
        ("ZSYMM", _) => 3..=3,
        // A missing or unreadable last direction is the first.
        (_, Ok(first)) => first.max(1)..=rest.first().and_then(|last| last.parse().ok()).unwrap_or(first).min(3),
        _ => return,
    };
    held.extend(nodes.iter().flat_map(|&node| directions.clone().map(move |direction| Dof { node, direction })));
}
