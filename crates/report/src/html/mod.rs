//! `report.html`: one file that a person reads in a browser, without a network.
//!
//! The page says the answer in words, then shows it: figures whose points tell their numbers, modes that move, tables that sort
//! and can be saved, and at the end everything from which the results came. Its numbers are the numbers of the tables that stand
//! beside it: they are read from these files. Words and facts are in the document itself and need no script; figures and tables are made
//! by `*.js` from one JSON element.
//!
//! The content security policy allows the page's own style and script, by their hashes, and nothing else.

mod answer;
mod compare;
mod cycles;
mod data;
mod facts;
mod geometry;
mod mesh;
mod packed;
mod page;
mod screen;
mod shapes;
mod sweep;
mod sweep_answer;
mod tables;
mod text;

pub use compare::write_compare_page;
pub use cycles::{write_branches_page, write_cycle_page};
pub use geometry::{BasisOf, Geometry, MeshMotion, ModeOf};
pub use mesh::MeshSurface;
pub use screen::write_screen_page;
pub use sweep::write_sweep_page;

use std::path::Path;

use figures::Figure;
use squeal::cycles::CyclesOfDraws;
use squeal::results::Results;

use self::page::Page;
use self::text::escaped;
use crate::Error;
use crate::pictures::damping;

/// Name of the page of a study, a sweep, a screening, a comparison or a motion, in the folder of its other results.
const FILE: &str = "report.html";

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

/// The figures of damping ratio against frequency; empty where no set of constraints has modes.
fn damping_section(results: &Results) -> Result<String, Error> {
    let figures = damping(results)?;
    let figure = |(set, figure): &(String, Figure)| {
        let label = escaped(&format!("Damping ratio against frequency, constraints {set}"));
        format!(
            "<figure class=\"paper\" tabindex=\"0\" role=\"group\" aria-label=\"{label}\">{}</figure>\n",
            figure.svg()
        )
    };
    let all: String = figures.iter().map(figure).collect();
    Ok(if all.is_empty() { all } else { format!("{}{all}</section>\n", include_str!("damping.html")) })
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
    let page = Page {
        title: results.plan().name.clone(),
        answer: answer::answer(results, motions)?,
        figures: [occurrence_section(results), damping_section(results)?, shapes::section_of_modes()].concat(),
        facts: facts::of_study(results),
        data: data::of_study(results, geometry, dir)?,
    };
    page.write(&dir.join(FILE))
}
