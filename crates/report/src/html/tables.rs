//! The tables of a folder as JSON.

use std::collections::HashMap;
use std::path::Path;

use serde_json::{Value, json};

use crate::Error;

/// Those tables of a folder that have rows, for the page; each by its name, with what it is about.
///
/// # Errors
/// A table that cannot be read.
pub(super) fn with_rows(dir: &Path, tables: &[(&str, &str)]) -> Result<Vec<Value>, Error> {
    let mut found = Vec::new();
    for (name, about) in tables {
        if let Some(table) = Table::read(dir, name)?.filter(|table| !table.rows.is_empty()) {
            found.push(table.json(name, about));
        }
    }
    Ok(found)
}

/// A table as it stands in a file: header, then rows.
pub(super) struct Table {
    pub header: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads `name` in `dir`; `None` where this study has no such table.
    pub fn read(dir: &Path, name: &str) -> Result<Option<Self>, Error> {
        let path = dir.join(name);
        if !path.exists() {
            return Ok(None);
        }
        let failed = |error: csv::Error| Error::Read { path: path.clone(), source: error.into() };
        let mut reader = csv::Reader::from_path(&path).map_err(failed)?;
        let cells = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect();
        let header = cells(reader.headers().map_err(failed)?);
        let rows = reader.records().map(|record| Ok(cells(&record?))).collect::<Result<_, csv::Error>>();
        Ok(Some(Self { header, rows: rows.map_err(failed)? }))
    }

    /// The table for the page, with what it is about.
    pub fn json(&self, name: &str, about: &str) -> Value {
        json!({ "name": name, "about": about, "header": self.header, "rows": self.rows })
    }

    /// The table for the page where neighbouring rows are alike: each distinct tuple of the last `own` columns once, as `values`;
    /// rows with equal first `key` columns as one group, which has the names in the next column, those in the one after it, and
    /// for each of the latter a row of places in `values`, one for each of the former.
    ///
    /// `None` for a table whose groups are no such products, which is none of this program's.
    pub fn grouped_json(&self, name: &str, about: &str, key: usize) -> Option<Value> {
        let mut values: Vec<&[String]> = Vec::new();
        let mut place_of = HashMap::new();
        let mut groups = Vec::new();
        for rows in self.rows.chunk_by(|a, b| a[..key] == b[..key]) {
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
        Some(json!({ "name": name, "about": about, "header": self.header, "values": values, "groups": groups }))
    }
}
