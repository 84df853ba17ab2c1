//! The tables of a folder as JSON.

use std::collections::HashMap;
use std::path::Path;

use output::Table;
use serde_json::{Value, json};

use crate::Error;

/// Largest file of a table of which a page has the rows, bytes; chosen: no browser is slow with it. A longer one is read where it stands.
const MOST_BYTES: u64 = 8_000_000;

/// Tables of a folder that have rows, for the page; each by its name, with what it is about. Of one that is too long for a page that is said, in the
/// place of its rows.
///
/// # Errors
/// A table that cannot be read.
pub(super) fn with_rows(dir: &Path, tables: &[(&str, &str)]) -> Result<Vec<Value>, Error> {
    let mut found = Vec::new();
    for (name, about) in tables {
        let bytes = std::fs::metadata(dir.join(name)).map_or(0, |file| file.len());
        if bytes > MOST_BYTES {
            let about =
                format!("{about}. With {} MB it is too long for this page: open {name} beside it", bytes / 1_000_000);
            found.push(on_page(&Table::new(*name, [""; 0], []), name, &about));
        } else if let Some(table) = read(dir, name)?.filter(|table| !table.rows.is_empty()) {
            found.push(on_page(&table, name, about));
        }
    }
    Ok(found)
}

/// Reads the table of a file; `None` where this study has no such table.
pub(super) fn read(dir: &Path, file: &str) -> Result<Option<Table>, Error> {
    let path = dir.join(file);
    Table::read(&path).map_err(|error| Error::Read { path, source: error.into() })
}

/// A table for the page, with what it is about.
pub(super) fn on_page(table: &Table, file: &str, about: &str) -> Value {
    json!({ "name": file, "about": about, "header": table.columns, "rows": table.rows })
}

/// The table for the page where neighbouring rows are alike: each distinct tuple of the last `own` columns once, as `values`;
/// rows with equal first `key` columns as one group, which has the names in the next column, those in the one after it, and
/// for each of the latter a row of indices into `values`, one for each of the former.
///
/// `None` for a table whose groups are no such products: no table of this program.
pub(super) fn grouped_on_page(table: &Table, file: &str, about: &str, key: usize) -> Option<Value> {
    let mut values: Vec<&[String]> = Vec::new();
    let mut place_of = HashMap::new();
    let mut groups = Vec::new();
    for rows in table.rows.chunk_by(|a, b| a[..key] == b[..key]) {
        let mut outer: Vec<&str> = Vec::new();
        let mut inner: Vec<&str> = Vec::new();
        for row in rows {
            if outer.last() != Some(&row[key + 1].as_str()) {
                outer.push(&row[key + 1]);
            }
            if outer.len() == 1 {
                inner.push(&row[key]);
            }
        }
        let is_product = rows.iter().enumerate().all(|(i, row)| {
            outer.get(i / inner.len()) == Some(&row[key + 1].as_str()) && inner[i % inner.len()] == row[key]
        });
        if !is_product {
            return None;
        }
        let mut places = Vec::new();
        for row in rows {
            let own = &row[key + 2..];
            places.push(*place_of.entry(own).or_insert_with(|| {
                values.push(own);
                values.len() - 1
            }));
        }
        groups.push(json!({ "key": rows[0][..key], "inner": inner, "outer": outer, "places": places }));
    }
    Some(json!({ "name": file, "about": about, "header": table.columns, "values": values, "groups": groups }))
}
