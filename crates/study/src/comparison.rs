//! Panels, and the pairs of panels that a study compares.

use super::{Plan, SceneKey, SceneLabels};

/// Panel: all arrangements with one number in contact, under one constraint set, law and speed range.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Key that its scenes have in common.
    pub key: SceneKey,
    /// Number of its arrangements.
    pub arrangements: usize,
    /// Indices of its scenes in the plan.
    pub scenes: Vec<usize>,
}

/// Two panels that are compared, and why: the first is expected to have more unstable modes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Comparison {
    /// Kind of difference between the two.
    pub kind: ComparisonKind,
    /// Index of the panel with more expected.
    pub more: usize,
    /// Index of the panel with fewer expected.
    pub fewer: usize,
}

/// Kind of difference between two compared panels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ComparisonKind {
    /// More contacts closed against fewer.
    Contact,
    /// A law against the baseline law.
    Law,
    /// A lower speed range against a higher.
    Speed,
    /// No constraints (the first set) against constraints.
    Constraints,
}

impl ComparisonKind {
    /// Kinds of comparison, all of them.
    pub const ALL: [Self; 4] = [Self::Contact, Self::Law, Self::Speed, Self::Constraints];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Contact => "contact",
            Self::Law => "law",
            Self::Speed => "speed",
            Self::Constraints => "constraints",
        }
    }
}

/// The panels of a plan in the order of their keys.
pub fn panels(plan: &Plan) -> Vec<Panel> {
    let mut panels: std::collections::BTreeMap<SceneKey, Panel> = std::collections::BTreeMap::new();
    for (at, scene) in plan.scenes.iter().enumerate() {
        let empty = || Panel { key: scene.key, arrangements: 0, scenes: Vec::new() };
        let panel = panels.entry(scene.key).or_insert_with(empty);
        panel.arrangements += scene.members.len();
        panel.scenes.push(at);
    }
    panels.into_values().collect()
}

/// The comparisons that a study makes, each between panels that differ in one thing.
pub fn comparisons(plan: &Plan, panels: &[Panel]) -> Vec<Comparison> {
    let mut found = Vec::new();
    for (more, a) in panels.iter().enumerate() {
        for (fewer, b) in panels.iter().enumerate() {
            if let (true, Some(kind)) = (more != fewer, kind(&plan.labels, a.key, b.key)) {
                found.push(Comparison { kind, more, fewer });
            }
        }
    }
    found
}

/// Kind of difference between two panels, if it is one thing that is compared in this direction.
fn kind(labels: &SceneLabels, more: SceneKey, fewer: SceneKey) -> Option<ComparisonKind> {
    let same_scene = more.law == fewer.law && more.speed == fewer.speed;
    if more.constraints != fewer.constraints {
        let is_before_after = more.constraints == 0 && same_scene && more.panel == fewer.panel;
        return is_before_after.then_some(ComparisonKind::Constraints);
    }
    if more.panel != fewer.panel {
        let number = |panel: usize| labels.panels[panel].in_contact;
        let next = labels.panels.iter().map(|panel| panel.in_contact).filter(|&n| n < number(more.panel)).max();
        return (same_scene && next == Some(number(fewer.panel))).then_some(ComparisonKind::Contact);
    }
    if more.law != fewer.law {
        let speeds_agree = fewer.speed.is_none() || more.speed == fewer.speed;
        return (labels.baseline_law == Some(fewer.law) && speeds_agree).then_some(ComparisonKind::Law);
    }
    (more.speed < fewer.speed).then_some(ComparisonKind::Speed)
}
