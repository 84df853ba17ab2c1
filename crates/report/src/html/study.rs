//! The page of a study.

use std::path::Path;

use figures::Figure;
use squeal::cycles::CyclesOfDraws;
use squeal::results::Results;

use super::page::Page;
use super::text::escaped;
use super::{FILE, Geometry, answer, data, facts, shapes};
use crate::Error;
use crate::pictures::{damping, motions_of_draws};

/// The figure of occurrences, with what its marks are: arrangements are told where there are several.
fn occurrence_section(results: &Results) -> String {
    let marks = if results.has_one_arrangement() {
        "A row for each mode. A mark is its occurrence, the dark bar its 95&nbsp;% limits."
    } else {
        "A row for each mode, a figure for each number of contacts. A mark is the median over the arrangements of contacts, the dark bar \
         its 95&nbsp;% limits, the pale bar reaches from the arrangement with least to that with most."
    };
    include_str!("study.html").replace("MARKS", marks)
}

/// A section with a figure for each set of constraints; empty without figures. `head` is what stands above, `label` what the figures are.
fn section(head: &str, label: &str, figures: &[(String, Figure)]) -> String {
    let figure = |(set, figure): &(String, Figure)| {
        let label = escaped(&format!("{label}, constraints {set}"));
        format!(
            "<figure class=\"paper\" tabindex=\"0\" role=\"group\" aria-label=\"{label}\">{}</figure>\n",
            figure.svg()
        )
    };
    let all: String = figures.iter().map(figure).collect();
    if all.is_empty() { all } else { format!("{head}{all}</section>\n") }
}

/// Writes `report.html` into `dir`, in which the tables of the same results stand already; `motions` are the motions of the draws, where they
/// were followed.
///
/// # Errors
/// A table that cannot be read, a file that cannot be written.
pub fn write_page(
    results: &Results,
    motions: Option<&CyclesOfDraws>,
    geometry: &Geometry<'_>,
    dir: &Path,
) -> Result<(), Error> {
    let damping = section(include_str!("damping.html"), "Damping ratio against frequency", &damping(results)?);
    let loudness = motions.map(|motions| motions_of_draws(results, motions)).transpose()?.unwrap_or_default();
    let loudness = section(include_str!("motions.html"), "Loudness of motions against the growth of modes", &loudness);
    let page = Page {
        title: results.plan().name.clone(),
        answer: answer::answer(results, motions)?,
        figures: [occurrence_section(results), damping, loudness, shapes::section_of_modes()].concat(),
        facts: facts::of_study(results),
        data: data::of_study(results, geometry, dir)?,
    };
    page.write(&dir.join(FILE))
}
