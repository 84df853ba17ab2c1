//! The page of a screening.

use std::path::Path;

use figures::Figure;
use serde_json::{Value, json};
use squeal::fingerprint;
use squeal::screen::{Form, Screen, ScreenedSet};
use squeal::study::Plan;

use super::FILE;
use super::facts::{case, described, program};
use super::geometry::{BasisOf, Geometry, ModeOf};
use super::page::Page;
use super::shapes::{self, MovingMode, moving};
use super::tables::with_rows;
use super::text::{capitalised, escaped, filled};
use crate::Error;

/// The tables of a screening, and what they are about.
const TABLES: [(&str, &str); 2] = [
    ("screen.csv", "Every change with what was predicted, and what was confirmed of the best"),
    (
        "screen_differences.csv",
        "Differences of two confirmed sets of changes on the same draws: positive where the second has fewer unstable modes",
    ),
];

/// Writes `report.html` into `dir`, in which the tables of the same screening stand already; `constraints` is the index of the set that
/// was changed.
///
/// # Errors
/// A table that cannot be read, a mode that does not fit the mesh, a file that cannot be written.
pub fn write_screen_page(
    plan: &Plan,
    screen: &Screen,
    constraints: usize,
    geometry: &Geometry<'_>,
    figure: Option<&Figure>,
    title: &str,
    dir: &Path,
) -> Result<(), Error> {
    let tables = with_rows(dir, &TABLES)?;
    let counts = [
        ("Sets of changes predicted", screen.predicted_sets.to_string()),
        ("Spectra for each of them", screen.analyses_per_set.to_string()),
        ("Draws of the prediction", screen.prediction_draws.to_string()),
        ("Draws of the confirmation", screen.samples.to_string()),
        ("Scenes of the confirmation", screen.scenes.to_string()),
        ("Evaluations of the confirmation that failed", screen.failures.to_string()),
    ];
    let sha256 = plan.source_file.as_ref().map(|file| fingerprint(&file.text));
    let page = Page {
        title: title.into(),
        answer: answer(screen),
        figures: figure
            .map_or_else(String::new, |figure| filled(include_str!("screen.html"), &[("figure", &figure.svg())]))
            + &shapes::section_of_modes(),
        facts: format!(
            "<p>Linear about steady sliding. The loads of contacts stay as they are without changes. {}</p>\n<h3>Counts</h3>\n{}{}{}",
            escaped(&screen.rests_on().map(|text| capitalised(&text) + ".").join(" ")),
            described(&counts),
            program(plan),
            case(plan.source_file.as_ref(), sha256.as_deref())
        ),
        data: json!({ "tables": tables, "moving": growing(geometry, screen, constraints)? }),
    };
    page.write(&dir.join(FILE))
}

/// The modes that are unstable without changes, scene by scene.
fn growing(geometry: &Geometry<'_>, screen: &Screen, constraints: usize) -> Result<Value, Error> {
    let mut scenes: Vec<String> = screen.growing.iter().map(|mode| mode.scene.clone()).collect();
    scenes.dedup();
    let modes = screen.growing.iter().map(|mode| MovingMode {
        group: scenes.iter().position(|scene| *scene == mode.scene).unwrap_or_default(),
        name: format!("Mode {}", mode.mode),
        lambda: mode.lambda,
        note: format!("grows by {:.1} 1/s at the medians", mode.lambda.re),
        of: ModeOf { basis: BasisOf::Set(constraints), dofs: &mode.dofs, shape: &mode.shape },
    });
    moving(geometry, &scenes, modes)
}

/// Answer of a screening: what helps, in words, the best of each kind, the largest drop first; then all that was found, as it is printed.
fn answer(screen: &Screen) -> String {
    let mut text = String::from("<h3>What helps</h3>\n<ul class=\"lead\">\n");
    // A drop that is not known ranks last.
    let drop = |set: &ScreenedSet| {
        let found = set.confirmed.as_ref().map(|found| screen.criterion.drop(found).value);
        found.filter(|drop| !drop.is_nan()).unwrap_or(f64::NEG_INFINITY)
    };
    let mut best: Vec<&ScreenedSet> = Vec::new();
    for set in screen.sets.iter().skip(1).filter(|set| set.confirmed.is_some()) {
        match best.iter_mut().find(|other| other.kind == set.kind) {
            Some(other) if drop(set) > drop(other) => *other = set,
            Some(_) => {}
            None => best.push(set),
        }
    }
    best.sort_by(|a, b| drop(b).total_cmp(&drop(a)));
    for set in best {
        let Some(found) = &set.confirmed else { continue };
        let action = set.kind.map_or_else(|| "Set of constraints".to_owned(), |kind| capitalised(kind.action()));
        let (drop, left) = (screen.criterion.drop(found), screen.criterion.left(found).value);
        let sure = if drop.lower > 0.0 {
            ""
        } else if drop.upper < 0.0 {
            ": surely more than without it"
        } else {
            ": no sure difference"
        };
        let Form { times, decimals, unit, fewer, .. } = screen.criterion.form();
        let number = |value: f64| format!("{:.decimals$}", times * value);
        let [value, lower, upper] = [drop.value, drop.lower, drop.upper].map(number);
        let dropped = match drop.value.is_finite() {
            true => format!("{value} ({lower} to {upper}) {fewer}{sure}"),
            false => "the drop is not known".into(),
        };
        let left = match left.is_finite() {
            true => format!("{}{unit} are left", number(left)),
            false => "what is left is not known".into(),
        };
        text += &format!(
            "<li>{action} <strong>{}</strong>: {dropped}; {left}, and {:.1}&nbsp;% of the analyses have any unstable mode.</li>\n",
            escaped(&set.name()),
            100.0 * found.squealing.value
        );
    }
    text += "</ul>\n<p>Of each kind the one with the largest drop that was confirmed, the largest first; limits at 95&nbsp;%.</p>\n";
    let pre = |label: &str, of: &str| {
        format!("<pre tabindex=\"0\" aria-label=\"{label}\">{}</pre>\n", escaped(of.trim_start()))
    };
    let together = screen.together();
    if !together.is_empty() {
        text += &pre("All that was confirmed", &together);
    }
    text + &pre("What the screening found", &screen.text_around().concat())
}
