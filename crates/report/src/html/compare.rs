//! The page of studies side by side.

use std::path::Path;

use figures::Figure;
use output::Block;
use serde_json::json;
use squeal::compare::ComparedStudies;
use squeal::results::VERSION;

use super::FILE;
use super::answer::html;
use super::facts::described;
use super::page::Page;
use super::tables::with_rows;
use super::text::{escaped, filled};
use crate::Error;

/// The table of a comparison, and what it is about.
const TABLES: [(&str, &str); 1] =
    [("compare.csv", "Each mode of each scene in both studies, with the difference of its occurrence")];

/// Writes `report.html` into `dir`, in which the table of the same comparison stands already.
///
/// # Errors
/// A table that cannot be read, a file that cannot be written.
pub fn write_compare_page(found: &ComparedStudies, figure: Option<&Figure>, dir: &Path) -> Result<(), Error> {
    let section = |figure: &Figure| filled(include_str!("compare.html"), &[("figure", &figure.svg())]);
    let mut answer = html(&Block::Paragraph(ComparedStudies::ABOUT.into()), false);
    for (at, (heading, lines)) in found.said().into_iter().enumerate() {
        // One letter, so that no line breaks within the arrow.
        let lines = lines.iter().map(|line| line.replace("->", "\u{2192}")).collect();
        answer += &format!("{}{}", html(&Block::Heading(heading), false), html(&Block::List(lines), at == 0));
    }
    let facts: Vec<(&str, String)> = [("First study", found.first.display().to_string())]
        .into_iter()
        .chain(found.others.iter().map(|other| ("Compared with it", other.path.display().to_string())))
        .chain([("squeal", VERSION.to_owned())])
        .collect();
    let page = Page {
        title: "Studies side by side".into(),
        answer,
        figures: figure.map(section).unwrap_or_default(),
        facts: format!("<p>{}</p>\n{}", escaped("What each study rests on stands on its own page."), described(&facts)),
        data: json!({ "tables": with_rows(dir, &TABLES)? }),
    };
    page.write(&dir.join(FILE))
}
