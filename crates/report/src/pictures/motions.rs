//! Loudness of the motions of a study's draws against the growth of the modes that they start from.

use std::collections::BTreeMap;
use std::path::Path;

use figures::{Figure, LoudMotion, LoudnessFigure, LoudnessPanel, loudness_figure};
use squeal::cycles::{CyclesOfDraws, DrawnFate};
use squeal::results::Results;
use squeal::study::{ModeLabel, Plan};

use super::occurrence::set_and_law;
use crate::Error;

/// Motions of a panel, each with the names of its mode.
type NamedMotions<'a> = Vec<(&'a [ModeLabel], LoudMotion)>;

/// Draws the motions of draws under each set of constraints and each law, `motions-SET-LAW`, or `motions-SET` where there is one law.
///
/// # Errors
/// Those of the figures.
pub fn draw_motions(results: &Results, motions: &CyclesOfDraws, dir: &Path) -> Result<(), Error> {
    for (name, figure) in motions_of_draws(results, motions)? {
        figure.save(dir, &format!("motions-{name}"))?;
    }
    Ok(())
}

/// Figure of each set of constraints and each law under which a motion has a loudness, with its name.
pub(crate) fn motions_of_draws(results: &Results, motions: &CyclesOfDraws) -> Result<Vec<(String, Figure)>, Error> {
    let labels = &results.plan().labels;
    let mut found = Vec::new();
    for constraints in 0..labels.constraints.len() {
        for law in 0..labels.laws.len() {
            let (name, heading) = set_and_law(results, constraints, law);
            let data = loudness(results.plan(), motions, (constraints, law), &heading);
            if !data.panels.is_empty() {
                found.push((name, loudness_figure(&data)?));
            }
        }
    }
    Ok(found)
}

/// Motions under a set of constraints and a law: a panel for each range of speeds and number of contacts; without panels where no motion has a loudness.
fn loudness(plan: &Plan, motions: &CyclesOfDraws, of: (usize, usize), heading: &str) -> LoudnessFigure {
    let (labels, mut without) = (&plan.labels, 0);
    let mut panels: BTreeMap<(Option<usize>, usize), NamedMotions<'_>> = BTreeMap::new();
    let scenes = plan.scenes.iter().zip(&motions.scenes);
    for (scene, of_scene) in scenes.filter(|(scene, _)| (scene.key.constraints, scene.key.law) == of) {
        for (draw, motion) in
            of_scene.draws.iter().flat_map(|draw| draw.motions.iter().map(move |motion| (draw, motion)))
        {
            let Some((fate, loudness)) = motion.fate.as_ref().and_then(|fate| Some((fate, fate.loudness()?))) else {
                without += 1;
                continue;
            };
            let (kind, is_cycle) = (fate.kind(), matches!(fate, DrawnFate::Cycle { .. }));
            let drawn = LoudMotion { mode: 0, growth: motion.growth, loudness, kind, is_cycle, sample: draw.sample };
            panels.entry((scene.key.speed, scene.key.panel)).or_default().push((&motion.names, drawn));
        }
    }
    let mut names: Vec<&[ModeLabel]> = panels.values().flatten().map(|(names, _)| *names).collect();
    names.sort_unstable();
    names.dedup();
    let panel = |((speed, panel), of): ((Option<usize>, usize), NamedMotions<'_>)| {
        // Where nothing depends on the speed before the onset, motions have that of the first range.
        let speed = labels.speeds.get(speed.unwrap_or_default()).map(|range| format!("speed {}", range.name));
        let contacts = (labels.panels.len() > 1).then(|| format!("{} in contact", labels.panels[panel].in_contact));
        let numbered = |(own, motion): (&[ModeLabel], LoudMotion)| {
            names.iter().position(|names| *names == own).map(|mode| LoudMotion { mode, ..motion })
        };
        let name = contacts.into_iter().chain(speed).collect::<Vec<_>>().join(", ");
        LoudnessPanel { name, motions: of.into_iter().filter_map(numbered).collect() }
    };
    LoudnessFigure {
        title: format!("{}: motions of draws, {heading}", plan.name),
        panels: panels.into_iter().map(panel).collect(),
        modes: names.iter().map(|names| ModeLabel::candidates(names)).collect(),
        note: match without {
            0 => String::new(),
            1 => "1 motion without a loudness, unbounded or not followed, is in cycles_of_draws.csv alone".to_owned(),
            more => {
                format!(
                    "{more} motions without a loudness, unbounded or not followed, are in cycles_of_draws.csv alone"
                )
            }
        },
    }
}
