//! Lists of `row column value` without a header: CalculiX's `.sti` and `.mas`, and Abaqus's `FORMAT=COORDINATE`.
//!
//! CalculiX (`*FREQUENCY, SOLVER=MATRIXSTORAGE`) writes the upper triangle, also of an unsymmetric matrix, and beside it a file
//! `.dof` with the name of each row, `node.direction`. The list itself has no number of rows: that is the number of names, or the
//! largest index where there is no such file.

use std::collections::BTreeSet;

use crate::Dof;
use crate::builder::{Builder, Head, Stated};
use crate::limits::Limits;
use crate::lines::Lines;
use crate::matrix::{Kind, Matrix};
use crate::numbers::{fortran, signed};
use crate::problem::Problem;
use crate::rows::{code, number_rows};
use crate::shortened::cut;

/// Reads the list; `labels` are the names of its rows.
pub(crate) fn parse(
    lines: &mut Lines<'_>,
    limits: &Limits,
    (stated, name, kind): (Stated, &str, Option<Kind>),
    labels: Option<Vec<Dof>>,
) -> Result<Matrix, Problem> {
    let mut builder = Builder::new(limits);
    let most = labels.as_ref().map_or(limits.order, Vec::len);
    let mut order = 0;
    // Rows with negative numbers are internal nodes of Abaqus: then numbers are names, and which there are must be known.
    let mut numbers = BTreeSet::new();
    let (mut first, mut count) = (None, 0_usize);
    let mut rows: Vec<[i64; 3]> = Vec::new();
    while let Some(line) = lines.next_but("%")? {
        let mut fields = line.split([' ', '\t', ',']).filter(|field| !field.is_empty());
        let (Some(row), Some(column), Some(field), None) = (fields.next(), fields.next(), fields.next(), fields.next())
        else {
            let found = line.split([' ', '\t', ',']).filter(|field| !field.is_empty()).count();
            return Err(Problem::Fields { what: "an entry", found, allowed: "row, column, value" });
        };
        let index = |what, field: &str| match signed(what, field)? {
            found if (1..=most as i64).contains(&found) => Ok(found),
            found if labels.is_none() && (-(limits.order as i64)..0).contains(&found) => Ok(found),
            found if found < 0 => Err(Problem::field(what, found, format!("1 to {most}"))),
            found if labels.is_some() => Err(Problem::Index { what, found: found as usize, largest: most }),
            found => Err(Problem::Size { what, found: found as usize, largest: most }),
        };
        let (row, column) = (index("row", row)?, index("column", column)?);
        order = order.max(row).max(column);
        for number in [row, column] {
            if number < 0 {
                numbers.insert(number);
            }
        }
        if first.is_none() {
            first = Some((row, column, field.to_owned()));
        }
        count += 1;
        if let (true, Ok(value)) = (count <= 4, field.parse()) {
            rows.push([row, column, value]);
        }
        builder.push(code(row), code(column), fortran(field)?)?;
    }
    lines.check_end()?;
    if let Some((row, column, value)) = first
        && row == column
        && row == order
        && count > 1
        && value.parse() == Ok(count - 1)
    {
        let allowed = format!(
            "an entry, and this is the size of a matrix with the number of lines that follow: a file of Matrix Market that has lost its line \
             \"%%MatrixMarket matrix coordinate real general\" (an entry of that value may be written as {value}.0)"
        );
        return Err(Problem::field("the first line", format!("{row} {column} {value}"), allowed));
    }
    if let [[_, b, c], [d, _, f], [g, h, _]] = rows[..]
        && (count, [b, c, f]) == (3, [d, g, h])
    {
        let allowed = "a list of entries or the rows of a matrix, and this may be both: in a file of Matrix Market, which says it";
        return Err(Problem::field(
            "the list",
            "three lines of three whole numbers that make a symmetric matrix",
            allowed,
        ));
    }
    let order = order as usize;
    if let Some(labels) = labels.as_ref().filter(|labels| labels.len() != order) {
        // CalculiX lists every diagonal entry, zeros too, so that the last row is always there.
        let allowed = format!("{}, the number of its labels: the file may be cut", labels.len());
        return Err(Problem::field("the last row of the list", order, allowed));
    }
    if order == 0 && numbers.is_empty() {
        return Err(Problem::End { what: "the list of entries" });
    }
    let named = labels.is_some();
    let labels = match numbers.is_empty() {
        true => labels,
        false => {
            numbers.extend(1..=order as i64);
            Some(number_rows(&mut builder, &numbers))
        }
    };
    let order = labels.as_ref().map_or(order, Vec::len);
    let head =
        Head { row_labels: labels.clone(), column_labels: labels, ..Head::unlabelled(name, kind, (order, order)) };
    Ok(Matrix { numbered: !named, ..builder.finish(stated, head)? })
}

/// Reads the names of the rows, one a line.
pub(crate) fn parse_labels(lines: &mut Lines<'_>, limits: &Limits) -> Result<Vec<Dof>, Problem> {
    let mut labels = Vec::new();
    let mut seen = std::collections::HashSet::new();
    while let Some(line) = lines.next_but("%")? {
        let bad = || Problem::field("the name of a row", cut(line), "a node and a direction, as in 1042.3, each once");
        let dof: Dof = line.parse().map_err(|_| bad())?;
        if !seen.insert(dof) {
            return Err(bad());
        }
        if labels.len() >= limits.order {
            return Err(Problem::Limit { what: "degrees of freedom", most: limits.order as u64 });
        }
        labels.push(dof);
    }
    Ok(labels)
}
