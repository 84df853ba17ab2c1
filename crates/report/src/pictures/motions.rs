//! Loudness of the motions of a study's draws against the growth of the modes that they start from.

use std::collections::BTreeMap;
use std::path::Path;

use figures::{Figure, LoudMotion, LoudnessFigure, LoudnessPanel, loudness_figure};
use squeal::cycles::{CyclesOfDraws, DrawnFate};
use squeal::results::Results;
use squeal::study::{ModeLabel, Plan};

use super::set_heading;
use crate::Error;

/// Motions of a panel, each with the names of its mode.
type NamedMotions<'a> = Vec<(&'a [ModeLabel], LoudMotion)>;

/// Draws the motions of draws under each set of constraints, `motions-SET`.
///
/// # Errors
/// Those of the figures.
pub fn draw_motions(results: &Results, motions: &CyclesOfDraws, dir: &Path) -> Result<(), Error> {
    for (set, figure) in motions_of_draws(results, motions)? {
        figure.save(dir, &format!("motions-{set}"))?;
    }
    Ok(())
}

/// Figure of each set of constraints under which a motion has a loudness, with the name of the set: a panel for each law and speed range.
pub(crate) fn motions_of_draws(results: &Results, motions: &CyclesOfDraws) -> Result<Vec<(String, Figure)>, Error> {
    let Plan { name, labels, scenes, .. } = results.plan();
    let mut found = Vec::new();
    for (constraints, set) in labels.constraints.iter().enumerate() {
        let mut panels: BTreeMap<(usize, Option<usize>), NamedMotions<'_>> = BTreeMap::new();
        let mut without = 0;
        for (scene, of) in scenes.iter().zip(&motions.scenes).filter(|(scene, _)| scene.key.constraints == constraints)
        {
            for motion in of.draws.iter().flat_map(|draw| &draw.motions) {
                let Some(fate) = &motion.fate else { continue };
                let Some(loudness) = fate.loudness() else {
                    without += 1;
                    continue;
                };
                let is_cycle = matches!(fate, DrawnFate::Cycle { .. });
                let drawn = LoudMotion { mode: 0, growth: motion.growth, loudness, is_cycle };
                panels.entry((scene.key.law, scene.key.speed)).or_default().push((&motion.names, drawn));
            }
        }
        if panels.is_empty() {
            continue;
        }
        let mut names: Vec<&[ModeLabel]> = panels.values().flatten().map(|(names, _)| *names).collect();
        names.sort_unstable();
        names.dedup();
        let panel = |((law, speed), of): ((usize, Option<usize>), NamedMotions<'_>)| {
            let speed = speed.map_or("all speeds", |speed| &labels.speeds[speed].name);
            let numbered = |(own, motion): (&[ModeLabel], LoudMotion)| {
                let mode = names.iter().position(|names| *names == own).unwrap_or_default();
                LoudMotion { mode, ..motion }
            };
            let name = format!("{} friction, {speed}", labels.laws[law].title);
            LoudnessPanel { name, motions: of.into_iter().map(numbered).collect() }
        };
        let data = LoudnessFigure {
            title: format!("{name}: motions of draws, {}", set_heading(results, constraints)),
            panels: panels.into_iter().map(panel).collect(),
            modes: names.iter().map(|names| ModeLabel::candidates(names)).collect(),
            note: match without {
                0 => String::new(),
                1 => "1 motion without a loudness is in cycles_of_draws.csv alone".to_owned(),
                more => format!("{more} motions without a loudness are in cycles_of_draws.csv alone"),
            },
        };
        found.push((set.clone(), loudness_figure(&data)?));
    }
    Ok(found)
}
