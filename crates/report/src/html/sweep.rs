//! The page of a sweep.

use std::path::Path;

use figures::Figure;
use serde_json::json;
use squeal::fingerprint;
use squeal::study::Plan;
use squeal::sweep::{BoundaryMode, DIVERGENCE, Evaluations, Found, SweptParameter};

use super::FILE;
use super::facts::{case, described, program};
use super::geometry::{BasisOf, Geometry, ModeOf};
use super::page::Page;
use super::shapes::{self, MovingMode, moving};
use super::sweep_answer::{self, short};
use super::tables::with_rows;
use super::text::{escaped, filled};
use crate::Error;

/// The tables of a sweep, and what they are about.
const TABLES: [(&str, &str); 5] = [
    ("onsets.csv", "Where modes become unstable, or stable again"),
    ("coalescences.csv", "Where two modes meet, or come nearest to each other"),
    ("branches.csv", "The branches at the points where they were computed"),
    ("boundary.csv", "The boundary of stability of each mode"),
    ("regions.csv", "How many modes are unstable in each region, and its share of the map"),
];

/// Writes `report.html` into `dir`, in which the tables of the same sweep stand already; `scene` says what was swept, `modes` are those
/// that the page moves.
///
/// # Errors
/// A table that cannot be read, a mode that does not fit the mesh, a file that cannot be written.
pub fn write_sweep_page(
    plan: &Plan,
    found: &Found,
    modes: &[BoundaryMode],
    geometry: &Geometry<'_>,
    figure: &Figure,
    scene: &str,
    dir: &Path,
) -> Result<(), Error> {
    let tables = with_rows(dir, &TABLES)?;
    let names: Vec<&str> = found.parameters().iter().map(|parameter| parameter.name.as_str()).collect();
    let what = match found {
        Found::Branches(_) => "root locus",
        Found::Map(_) => "stability map",
    };
    let title = format!("{}: {what} over {}", plan.name, names.join(" and "));
    let answer = format!(
        "{}<p>{}</p>\n<pre tabindex=\"0\" aria-label=\"What the sweep found\">{}</pre>\n",
        sweep_answer::answer(found),
        escaped(scene),
        escaped(&found.text())
    );
    let Evaluations { spectra, eigenvectors, continued, whole } = found.evaluations();
    let counts = [
        ("Spectra", spectra.to_string()),
        ("Eigenvectors", eigenvectors.to_string()),
        ("Eigenvalues continued", continued.to_string()),
        ("Eigenvalues of the whole brake", whole.to_string()),
        ("Spectra more, of the modes that move", modes.len().to_string()),
        ("Spectra of a grid of equal steps that is as fine", found.fine_grid().to_string()),
    ];
    let sha256 = plan.source_file.as_ref().map(|file| fingerprint(&file.text));
    let page = Page {
        title,
        answer,
        figures: filled(include_str!("sweep.html"), &[("figure", &figure.svg())]) + &shapes::section_of_modes(),
        facts: format!(
            "<p>Linear about steady sliding; one parameter or two are moved, all others are at their medians.</p>\n<h3>Counts</h3>\n{}{}{}",
            described(&counts),
            program(plan),
            case(plan.source_file.as_ref(), sha256.as_deref())
        ),
        data: json!({ "tables": tables, "moving": moving(geometry, &group(found), of_boundary(plan, found, modes))? }),
    };
    page.write(&dir.join(FILE))
}

/// Heading of the modes: what they have in common.
fn group(found: &Found) -> [String; 1] {
    let what = match found {
        Found::Branches(_) => "At their onsets",
        Found::Map(_) => "At the middle of each curve of the boundary",
    };
    [what.to_owned()]
}

/// The modes with what is known of them.
fn of_boundary<'m>(plan: &'m Plan, found: &Found, modes: &'m [BoundaryMode]) -> Vec<MovingMode<'m>> {
    let scene = &plan.scenes[0];
    let of_mode = |mode: &'m BoundaryMode| {
        let does = mode.does.map_or(String::new(), |does| format!("{does} at "));
        let place = |(parameter, value): (&SweptParameter, &f64)| format!("{} = {}", parameter.name, short(*value));
        let places: Vec<String> = found.parameters().iter().zip(&mode.at).map(place).collect();
        MovingMode {
            group: 0,
            name: if mode.mode == DIVERGENCE { "Divergence".into() } else { format!("Mode {}", mode.mode) },
            lambda: mode.lambda,
            note: format!("{does}{}", places.join(", ")),
            of: ModeOf { basis: BasisOf::Scene(scene), dofs: &plan.brake(scene).dofs, shape: &mode.shape },
        }
    };
    modes.iter().map(of_mode).collect()
}
