//! Abaqus's sparse matrices with labels: what `*MATRIX OUTPUT, FORMAT=MATRIX INPUT` writes and `*MATRIX INPUT` reads.
//!
//! A line is `row node, direction, column node, direction, value`. The file states neither a size nor a symmetry. Negative nodes
//! are internal nodes of Abaqus (such as the interior of a beam B33), with stiffness and mass like any other. A line `*MATRIX
//! INPUT, NAME=..., TYPE=...` may come before the entries; then several matrices may follow each other.

use crate::Dof;
use crate::builder::{Builder, Head, LabelSet, Stated};
use crate::limits::Limits;
use crate::lines::Lines;
use crate::matrix::{Kind, Matrix};
use crate::numbers::{fortran, signed, value, whole};
use crate::problem::Problem;
use crate::shortened::cut;

/// Statements of a keyword line on the matrix after it.
struct Keyword {
    name: String,
    kind: Option<Kind>,
    stated: Stated,
    scale: f64,
}

/// Reads all matrices of the file; a list without a keyword gets `name` and `kind`.
pub(crate) fn parse(
    lines: &mut Lines<'_>,
    limits: &Limits,
    (name, kind): (&str, Option<Kind>),
) -> Result<Vec<Matrix>, Problem> {
    let mut keyword = Keyword { name: name.to_owned(), kind, stated: Stated::Nothing, scale: 1.0 };
    let mut matrices = Vec::new();
    let (mut builder, mut labels) = (Builder::new(limits), LabelSet::default());
    while let Some(line) = lines.next_but("**")? {
        if line.starts_with('*') {
            let next = read_keyword(line)?;
            let before = std::mem::replace(&mut keyword, next);
            if builder.len() > 0 || !matrices.is_empty() {
                let done = std::mem::replace(&mut builder, Builder::new(limits));
                matrices.push(finish(done, std::mem::take(&mut labels), before)?);
            }
            continue;
        }
        let mut fields = line.split(',').map(str::trim);
        let mut next = || fields.next().filter(|field| !field.is_empty());
        let (Some(a), Some(i), Some(b), Some(j), Some(field), None) = (next(), next(), next(), next(), next(), next())
        else {
            let allowed = "row node, direction, column node, direction, value";
            return Err(Problem::Fields { what: "an entry", found: line.split(',').count(), allowed });
        };
        let row = labels.number(dof("row node", a, i)?, limits)?;
        let column = labels.number(dof("column node", b, j)?, limits)?;
        builder.push(row, column, keyword.scale * fortran(field)?)?;
    }
    lines.check_end()?;
    matrices.push(finish(builder, labels, keyword)?);
    Ok(matrices)
}

fn dof(what: &'static str, node: &str, direction: &str) -> Result<Dof, Problem> {
    let direction = whole("direction", direction)?;
    let direction = u32::try_from(direction).map_err(|_| Problem::field("direction", direction, "1 to 4294967295"))?;
    Ok(Dof { node: signed(what, node)?, direction })
}

fn finish(mut builder: Builder, labels: LabelSet, keyword: Keyword) -> Result<Matrix, Problem> {
    if builder.len() == 0 {
        return Err(Problem::End { what: "the list of entries" });
    }
    let order = labels.len();
    let (labels, places) = labels.sorted();
    builder.renumber(&places, &places);
    let head = Head::unlabelled(keyword.name, keyword.kind, (order, order));
    builder.finish(keyword.stated, Head { row_labels: Some(labels.clone()), column_labels: Some(labels), ..head })
}

fn read_keyword(line: &str) -> Result<Keyword, Problem> {
    let mut parts = line.split(',').map(str::trim);
    let first = parts.next().unwrap_or_default();
    if !first.eq_ignore_ascii_case("*MATRIX INPUT") {
        let allowed = "*MATRIX INPUT; write the matrix into a file of its own";
        return Err(Problem::Keyword { what: "keyword", found: cut(first), allowed });
    }
    // The shape that Abaqus takes where TYPE is left out. Who writes friction may not know it.
    let mut keyword = Keyword { name: "matrix".to_owned(), kind: None, stated: Stated::SymmetricByDefault, scale: 1.0 };
    for part in parts.filter(|part| !part.is_empty()) {
        let (key, given) = part.split_once('=').unwrap_or((part, ""));
        let (key, given) = (key.trim().to_uppercase(), given.trim());
        match (key.as_str(), given.to_uppercase().as_str()) {
            ("NAME", _) if !given.is_empty() => keyword.name = given.trim_matches('"').to_owned(),
            ("TYPE", "SYMMETRIC") => keyword.stated = Stated::SymmetricOrWhole,
            ("TYPE", "UNSYMMETRIC") => keyword.stated = Stated::General,
            ("SCALE FACTOR", _) => keyword.scale = value(given)?,
            _ => {
                let allowed = "NAME, TYPE=SYMMETRIC or UNSYMMETRIC, SCALE FACTOR; entries in the same file";
                return Err(Problem::Keyword { what: "parameter", found: cut(part), allowed });
            }
        }
    }
    Ok(keyword)
}
