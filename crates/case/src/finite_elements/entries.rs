//! Fields that several tables of a case file with a finite element brake have: names of nodes and faces, the sliding, friction across it.

use serde::Deserialize;

/// Names of node sets, and numbers of nodes.
#[derive(Debug, Clone, Deserialize)]
#[serde(
    untagged,
    expecting = "expected names of node sets or numbers of nodes, as [\"PAD\", \"1042\"], or one of them in quotes"
)]
pub(super) enum Nodes {
    One(String),
    List(Vec<String>),
}

impl Nodes {
    pub fn items(&self) -> &[String] {
        match self {
            Self::One(item) => std::slice::from_ref(item),
            Self::List(items) => items,
        }
    }
}

/// The velocity of the disc under the pad: one direction, or around an axis.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a direction, as [1.0, 0.0, 0.0], or { axis = [0.0, 0.0, 1.0], through = [0.0, 0.0, 0.0] }"
)]
pub(super) enum SlidingEntry {
    Direction([f64; 3]),
    About(AxisTable),
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AxisTable {
    pub axis: [f64; 3],
    #[serde(default)]
    pub through: [f64; 3],
}

/// Friction across the sliding: the direction of friction follows the direction of the sliding, or no friction acts across.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum LateralEntry {
    Vector,
    None,
}
