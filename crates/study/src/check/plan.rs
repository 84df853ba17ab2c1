//! A plan: indices into its lists, bodies, and scenes that occur once.

use std::collections::BTreeMap;

use osc_model::{Brake, Sector};

use crate::{Contradiction, Plan, Scene, SceneKey, SceneLabels};

pub(super) fn check(plan: &Plan) -> Result<(), Contradiction> {
    for (what, count) in [("scenes", plan.scenes.len()), ("configurations", plan.configurations.len())] {
        if count == 0 {
            return Err(Contradiction::Empty { what });
        }
    }
    if let Some([from, to]) = plan.band
        && !(0.0 <= from && from < to && to.is_finite())
    {
        return Err(Contradiction::Band { from, to });
    }
    for (at, configuration) in plan.configurations.iter().enumerate() {
        let of = format!("configuration {at}");
        within(&of, "origin", configuration.origin, plan.origins.len(), "Plan::origins")?;
        brake(&of, &configuration.brake)?;
    }
    for (at, origin) in plan.origins.iter().enumerate() {
        brake(&format!("origin {at}"), &origin.brake)?;
    }
    let baseline = plan.labels.baseline_law.unwrap_or(0);
    within("the plan", "baseline law", baseline, plan.labels.laws.len(), "Plan::labels.laws")?;
    for (at, scene) in plan.scenes.iter().enumerate() {
        places(at, scene, plan)?;
    }
    scenes_once(&plan.scenes)
}

fn within(of: &str, what: &'static str, index: usize, count: usize, list: &'static str) -> Result<(), Contradiction> {
    if index < count { Ok(()) } else { Err(Contradiction::Index { of: of.to_owned(), what, index, count, list }) }
}

fn brake(of: &str, Brake { system, dofs, bodies, sectors }: &Brake) -> Result<(), Contradiction> {
    let order = system.order();
    let in_sectors = sectors.iter().map(Sector::order).sum();
    for (what, found) in
        [("free degrees of freedom", dofs.free().len()), ("degrees of freedom in its sectors", in_sectors)]
    {
        if found != order {
            return Err(Contradiction::Order { of: of.to_owned(), what, found, order });
        }
    }
    for body in bodies {
        let (of, body, dofs) = (of.to_owned(), body.name.clone(), &body.dofs);
        if let Some(&dof) = dofs.iter().find(|dof| **dof >= order) {
            return Err(Contradiction::BodyDof { of, body, dof, order });
        }
        let mut is_owned = vec![false; order];
        if let Some(&dof) = dofs.iter().find(|dof| std::mem::replace(&mut is_owned[**dof], true)) {
            return Err(Contradiction::BodyDofTwice { of, body, dof });
        }
    }
    Ok(())
}

/// Checks that all that a scene names is there.
fn places(at: usize, scene: &Scene, plan: &Plan) -> Result<(), Contradiction> {
    let SceneLabels { constraints, laws, speeds, panels, .. } = &plan.labels;
    let (of, SceneKey { constraints: set, law, speed, panel }) = (format!("scene {at}"), scene.key);
    within(&of, "configuration", scene.configuration, plan.configurations.len(), "Plan::configurations")?;
    within(&of, "constraint set", set, constraints.len(), "Plan::labels.constraints")?;
    within(&of, "law", law, laws.len(), "Plan::labels.laws")?;
    if let Some(range) = speed {
        within(&of, "speed range", range, speeds.len(), "Plan::labels.speeds")?;
    }
    within(&of, "panel", panel, panels.len(), "Plan::labels.panels")?;
    if scene.members.is_empty() {
        return Err(Contradiction::NoMembers { scene: at });
    }
    let arrangements = panels[panel].arrangements.len();
    scene
        .members
        .iter()
        .try_for_each(|&member| within(&of, "member", member, arrangements, "the arrangements of its panel"))
}

/// Checks that each arrangement has one scene of a set of constraints, law and speed range.
fn scenes_once(scenes: &[Scene]) -> Result<(), Contradiction> {
    // Of each arrangement its scenes, by speed range; one without a range stands for every one.
    let mut known: BTreeMap<[usize; 4], Vec<(Option<usize>, usize)>> = BTreeMap::new();
    for (second, Scene { key, members, .. }) in scenes.iter().enumerate() {
        for &member in members {
            let same = known.entry([key.constraints, key.law, key.panel, member]).or_default();
            let meets = |speed: Option<usize>| speed.is_none() || key.speed.is_none() || speed == key.speed;
            if let Some(&(_, first)) = same.iter().find(|(speed, _)| meets(*speed)) {
                return Err(Contradiction::SceneTwice { first, second, member });
            }
            same.push((key.speed, second));
        }
    }
    Ok(())
}
