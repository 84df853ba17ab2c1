//! The page of the motion after the onset.

use std::path::Path;

use figures::Figure;
use output::hertz;
use serde_json::json;
use squeal::cycle::{ContactMoment, ContactState, Motion, Shares};
use squeal::cycles::{Branch, Branches, Cycles, MotionOfMode};
use squeal::fingerprint;
use squeal::study::Plan;
use squeal::sweep::{Sweep, event};

use super::FILE;
use super::facts::{case, described, program};
use super::geometry::{BasisOf, Geometry};
use super::page::Page;
use super::shapes::{self, MovingCycle, moving_cycles};
use super::sweep_answer::short;
use super::tables::with_rows;
use super::text::{capitalised, escaped, filled};
use crate::Error;

/// The tables of motions, and what they are about.
const TABLES: [(&str, &str); 4] = [
    ("cycles.csv", "The motions, each with its start and what it becomes"),
    ("cycle_branches.csv", "The cycles along each branch"),
    ("cycle_spectrum.csv", "Harmonics of the velocity of each cycle"),
    ("cycle_contacts.csv", "Normal force, sliding velocity and state of each contact over the period of each cycle"),
];

/// Figures by the names of their files: what they show, and how it is read.
const FIGURES: [(&str, &str, &str); 3] = [
    (
        "cycle_branches",
        "Cycles over the parameter",
        "Solid where a small deviation dies out, dashed where it grows. Grey are the modes of the linear analysis, thick where they grow. Point at a mark for \
         its numbers; cycle_branches.csv has all.",
    ),
    (
        "cycle_contacts",
        "What the contacts do",
        "Over one period. Point at a line or a bar for the contact and its numbers; cycle_contacts.csv has all.",
    ),
    (
        "cycle_spectrum",
        "Harmonics",
        "Root mean square of the velocities of all degrees of freedom that are no rotations, together. Point at a line for its numbers; cycle_spectrum.csv \
         has all, and those of each body.",
    ),
];

/// Assumptions of every motion.
const ASSUMPTIONS: &str = "Contacts open, slide and stick; the structure between them is linear. The picture of a moving cycle has its mean and its first \
                           harmonics, as many as hold all but a millionth of the mean square of the displacements or as there is room for, rounded to a \
                           32767th of the largest; tables have all digits. Motions that are not periodic have no harmonics, no figure and no moving \
                           picture: no spectrum of theirs is computed.";

/// Writes `report.html` into `dir`, in which the tables of the same motions stand already; `figures` are made by [`cycle_figures`](crate::cycle_figures),
/// `scene` says at which parameters the motions are.
///
/// # Errors
/// A table that cannot be read, a motion that does not fit the mesh, a file that cannot be written.
pub fn write_cycle_page(
    plan: &Plan,
    cycles: &Cycles,
    geometry: &Geometry<'_>,
    figures: &[(&str, Figure)],
    scene: &str,
    dir: &Path,
) -> Result<(), Error> {
    let moving = cycles.motions.iter().filter_map(|of| {
        Some(MovingCycle {
            name: format!("Cycle from {}", of.start_in_words()),
            note: of.loudness.map_or(String::new(), |loudness| format!("loudness {loudness:.4} m/s")),
            open: openings(cycles, of),
            harmonics: of.harmonics.as_ref()?,
        })
    });
    let facts = [
        ("Harmonics of the balance", cycles.harmonics.to_string()),
        (
            "Deviation of the motion's tangent from the complex eigenvalue analysis",
            format!("{:.1e}", cycles.tangent_deviation),
        ),
    ];
    let diverges = cycles.divergence_in_words().map(|words| capitalised(&words) + ".");
    let sentences: Vec<String> = diverges.into_iter().chain(cycles.motions.iter().map(sentence)).collect();
    let found = Found {
        title: format!("{}: the motion after the onset", plan.name),
        sentences,
        text: cycles.text(),
        facts: described(&facts),
    };
    write(plan, found, (moving.collect(), geometry), figures, scene, dir)
}

/// Writes the page of branches of cycles, as [`write_cycle_page`] writes the page of the motions at medians.
///
/// # Errors
/// As [`write_cycle_page`].
pub fn write_branches_page(
    plan: &Plan,
    branches: &Branches,
    geometry: &Geometry<'_>,
    figure: Figure,
    scene: &str,
    dir: &Path,
) -> Result<(), Error> {
    let parameter = &branches.sweep.parameter.name;
    let all = branches.branches.iter().flat_map(|of| of.last.iter().map(move |last| (of, last)));
    let moving = all.map(|(of, (place, harmonics))| {
        let cycle = &of.cycles[*place];
        let is_stable = cycle.in_time.as_ref().is_some_and(|(cycle, _)| cycle.is_stable());
        let stable = if is_stable { "stable" } else { "unstable" };
        let loudness = cycle.loudness.map_or(String::new(), |loudness| format!(", loudness {loudness:.4} m/s"));
        MovingCycle {
            name: format!("Cycle of mode {}", of.mode),
            note: format!("{stable}, at {parameter} = {}{loudness}", short(cycle.at)),
            open: Vec::new(),
            harmonics,
        }
    });
    let mut sentences: Vec<String> =
        branches.branches.iter().map(|of| sentence_of_branch(of, &branches.sweep)).collect();
    sentences.extend(branches.divergence_in_words().map(|words| capitalised(&words) + "."));
    let from = branches.sweep.parameter.from;
    sentences.extend(match branches.growing_at_start() {
        0 => None,
        1 => Some(format!("One mode grows at {parameter} = {from} already: its cycles are not followed.")),
        number => Some(format!("{number} modes grow at {parameter} = {from} already: their cycles are not followed.")),
    });
    let found = Found {
        title: format!("{}: cycles over {parameter}", plan.name),
        sentences,
        text: branches.text(),
        facts: described(&[("Steps of the sweep", branches.sweep.steps.to_string())]),
    };
    write(plan, found, (moving.collect(), geometry), &[("cycle_branches", figure)], scene, dir)
}

/// Words and facts of a page, beside its figures.
struct Found {
    title: String,
    sentences: Vec<String>,
    /// The words of the terminal.
    text: String,
    /// Facts as HTML.
    facts: String,
}

fn write(
    plan: &Plan,
    found: Found,
    (moving, geometry): (Vec<MovingCycle<'_>>, &Geometry<'_>),
    figures: &[(&str, Figure)],
    scene: &str,
    dir: &Path,
) -> Result<(), Error> {
    let of_page = |(id, title, about): &(&str, &str, &str)| {
        let (_, figure) = figures.iter().find(|(stem, _)| stem == id)?;
        let values = [("id", *id), ("title", *title), ("about", *about), ("figure", &figure.svg())];
        Some(filled(include_str!("cycle.html"), &values))
    };
    let sections: String = FIGURES.iter().filter_map(of_page).collect();
    let items: String = found.sentences.iter().map(|text| format!("<li>{}</li>\n", escaped(text))).collect();
    let sha256 = plan.source_file.as_ref().map(|file| fingerprint(&file.text));
    let of_scene = BasisOf::Scene(&plan.scenes[0]);
    let page = Page {
        title: found.title,
        answer: format!(
            "<ul class=\"lead\">\n{items}</ul>\n<p>{}</p>\n<pre tabindex=\"0\" aria-label=\"What was found\">{}</pre>\n",
            escaped(&capitalised(scene)),
            escaped(&found.text)
        ),
        figures: sections + &shapes::section_of_cycles(),
        facts: format!(
            "<p>{ASSUMPTIONS}</p>\n<h3>Counts</h3>\n{}{}{}",
            found.facts,
            program(plan),
            case(plan.source_file.as_ref(), sha256.as_deref())
        ),
        data: json!({
            "tables": with_rows(dir, &TABLES)?,
            "moving": moving_cycles(geometry, (of_scene, &plan.brake(&plan.scenes[0]).dofs), moving)?,
        }),
    };
    page.write(&dir.join(FILE))
}

/// Contacts of a cycle that open, with the steps of its period at which they are.
fn openings(cycles: &Cycles, of: &MotionOfMode) -> Vec<(String, String)> {
    let letters = |contact: usize| -> String {
        let is_open = |moments: &Vec<ContactMoment>| moments[contact].state == ContactState::Open;
        of.history.iter().map(|moments| if is_open(moments) { 'o' } else { '-' }).collect()
    };
    let all = cycles.contacts.iter().enumerate().map(|(contact, name)| (name.clone(), letters(contact)));
    all.filter(|(_, steps)| steps.contains('o')).collect()
}

/// Fate of a motion, in a sentence.
fn sentence(of: &MotionOfMode) -> String {
    let mode_hz = of.lambda.im / std::f64::consts::TAU;
    let from = match of.start_in_words() {
        mode if mode.starts_with("mode") => format!("From {mode} ({} Hz)", hertz(mode_hz)),
        noise => format!("From {noise}"),
    };
    match &of.motion {
        Motion::Rest => format!("{from} the motion dies out: steady sliding."),
        Motion::Unbounded => {
            format!("{from} the motion grows without bounds: no contact that opens or sticks stops it.")
        }
        Motion::NotPeriodic { may_settle: true, .. } => format!(
            "{from} the motion has not settled in the time that was looked at: it may yet come to a cycle or to rest."
        ),
        Motion::NotPeriodic { .. } => {
            format!("{from} the motion does not repeat itself in the time that was looked at: it is not periodic.")
        }
        Motion::Cycle(cycle) => {
            let hz = cycle.frequency_hz();
            let change = 100.0 * (hz / mode_hz - 1.0);
            let beside = format!("{:.1} % {} the mode", change.abs(), if change < 0.0 { "below" } else { "above" });
            let does = |share: fn(&Shares) -> f64, verb: &str, none: &str| {
                let contacts = of.measures.iter().flat_map(|measures| &measures.contacts);
                match contacts.map(share).fold(0.0, f64::max) {
                    0.0 => none.to_owned(),
                    share => format!("a contact {verb} for up to {:.1} % of the period", 100.0 * share),
                }
            };
            format!(
                "{from} the motion becomes a cycle at {} Hz, {beside}: {}, {}. Its loudness is {:.4} m/s.",
                hertz(hz),
                does(|shares| shares.open, "is open", "no contact opens"),
                does(|shares| shares.stuck, "sticks", "none sticks"),
                of.loudness.unwrap_or_default()
            )
        }
    }
}

/// Course of a branch and how much of it is stable, in a sentence.
fn sentence_of_branch(of: &Branch, sweep: &Sweep) -> String {
    let parameter = &sweep.parameter.name;
    let in_time = of.cycles.iter().filter_map(|cycle| cycle.in_time.as_ref());
    let (known, stable) =
        in_time.fold((0, 0), |(known, stable), (cycle, _)| (known + 1, stable + usize::from(cycle.is_stable())));
    let folds = of.cycles.iter().filter(|cycle| cycle.is_fold).count();
    let folds = match folds {
        0 => "no fold".to_owned(),
        1 => "one fold".to_owned(),
        folds => format!("{folds} folds"),
    };
    format!(
        "Mode {} {} at {parameter} = {} with {} Hz. Of {} cycles on its branch {known} were found in time, of which {stable} are stable; it has \
         {folds}. Where it ends: {}.",
        of.mode,
        event(of.starts, &sweep.threshold),
        short(of.onset),
        hertz(of.onset_hz),
        of.cycles.len(),
        of.end
    )
}
