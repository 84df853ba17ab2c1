//! Check how the names of a finite element case belong together: nodes of the mesh with rows of the matrices, the normal with the bodies.

use brakes::case::{FiniteElementCase, NamesOnMesh, Side};

use super::Lines;

/// Bodies that are listed; chosen: a line holds them.
const BODIES_LISTED: usize = 5;

/// The lines of a check on names.
pub(super) fn of(case: &FiniteElementCase) -> Lines {
    let mut lines = case.names.as_ref().map_or_else(Lines::default, on_mesh);
    for missing in &case.missing_rows {
        let warning = if missing.field.starts_with("contact.") { "WARNING: " } else { "" };
        lines.add("", format!("{warning}{missing}"));
    }
    match case.sides {
        None => {}
        Some([Side::Unknown, Side::Unknown]) => {
            let found =
                "WARNING: not compared with the mesh, which has no elements at the contact that tell where the pad is";
            lines.add("normal", found);
        }
        Some([pad, disc]) => {
            let by = |side: Side, body: &str| match side {
                Side::Unknown => format!("nothing of the {body}"),
                told => format!("{told} of the {body}"),
            };
            let found = format!("from the disc into the pad, by {} and {}", by(pad, "pad"), by(disc, "disc"));
            lines.add("normal", found);
        }
    }
    lines
}

fn on_mesh(names: &NamesOnMesh) -> Lines {
    let NamesOnMesh { nodes, with_rows, not_on_mesh, bodies_without } = names;
    let others = if with_rows < nodes { ", the others count as held" } else { "" };
    let mut lines = Lines::default();
    lines.add("names", format!("{with_rows} of {nodes} nodes of the mesh have rows{others}"));
    if *not_on_mesh > 0 {
        lines.add("", format!("{not_on_mesh} nodes with rows are not of the mesh"));
    }
    if !bodies_without.is_empty() {
        let first: Vec<String> = bodies_without.iter().take(BODIES_LISTED).map(i64::to_string).collect();
        let more = if bodies_without.len() > BODIES_LISTED { ", ..." } else { "" };
        let found = format!(
            "WARNING: {} bodies of the mesh have no row at all: those of nodes {}{more}",
            bodies_without.len(),
            first.join(", ")
        );
        lines.add("", found);
    }
    lines
}
