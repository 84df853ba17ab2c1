//! Panels, and the pairs of panels that a study compares.

use super::{Plan, SceneKey};

/// All arrangements with one number in contact, under one constraint set, law and speed range.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// What its scenes have in common.
    pub key: SceneKey,
    /// How many arrangements it has.
    pub arrangements: usize,
    /// Its scenes.
    pub scenes: Vec<usize>,
}

/// Two panels and why they are compared: the first is expected to have more unstable modes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Comparison {
    /// What differs.
    pub kind: ComparisonKind,
    /// Place of the panel with more expected.
    pub more: usize,
    /// Place of the panel with fewer expected.
    pub fewer: usize,
}

/// What differs between two compared panels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ComparisonKind {
    /// More contacts closed against fewer.
    Contact,
    /// A law against the baseline law.
    Law,
    /// A lower speed range against a higher.
    Speed,
    /// Without constraints (the first set) against with.
    Constraints,
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
    let number = |panel: &Panel| plan.labels.panels[panel.key.panel].in_contact;
    let kind = |a: &Panel, b: &Panel| {
        let (p, q) = (a.key, b.key);
        let same_scene = p.law == q.law && p.speed == q.speed;
        if p.constraints != q.constraints {
            return (p.constraints == 0 && same_scene && p.panel == q.panel).then_some(ComparisonKind::Constraints);
        }
        if p.panel != q.panel {
            let next = plan.labels.panels.iter().map(|panel| panel.in_contact).filter(|&n| n < number(a)).max();
            return (same_scene && next == Some(number(b))).then_some(ComparisonKind::Contact);
        }
        if p.law != q.law {
            let speeds_agree = q.speed.is_none() || p.speed == q.speed;
            return (plan.labels.baseline_law == Some(q.law) && speeds_agree).then_some(ComparisonKind::Law);
        }
        (p.speed < q.speed).then_some(ComparisonKind::Speed)
    };
    let mut found = Vec::new();
    for (more, a) in panels.iter().enumerate() {
        for (fewer, b) in panels.iter().enumerate() {
            if let (true, Some(kind)) = (more != fewer, kind(a, b)) {
                found.push(Comparison { kind, more, fewer });
            }
        }
    }
    found
}
