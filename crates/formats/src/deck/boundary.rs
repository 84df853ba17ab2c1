//! Degrees of freedom that a deck holds.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::keyword::set_name;
use crate::Dof;

/// Adds the displacements that a data line of `*BOUNDARY` holds: `node or set, first, last`, or one of Abaqus's names of held directions. A line that says it in
/// another way adds nothing. What is prescribed and not 0 does not vibrate either.
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
    let directions = match (what.to_ascii_uppercase().as_str(), what.parse::<u32>()) {
        ("ENCASTRE" | "PINNED", _) => 1..=3,
        ("XSYMM", _) => 1..=1,
        ("YSYMM", _) => 2..=2,
        ("ZSYMM", _) => 3..=3,
        (_, Ok(first)) => first.max(1)..=rest.first().and_then(|last| last.parse().ok()).unwrap_or(first).min(3),
        _ => return,
    };
    held.extend(nodes.iter().flat_map(|&node| directions.clone().map(move |direction| Dof { node, direction })));
}
