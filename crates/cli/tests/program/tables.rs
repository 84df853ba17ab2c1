//! Tables as tests read them.

use std::path::Path;

/// The cells of a table under some of its columns, row by row.
pub fn columns(table: &Path, names: &[&str]) -> Vec<Vec<String>> {
    let mut table = csv::Reader::from_path(table).unwrap();
    let header = table.headers().unwrap().clone();
    let places: Vec<usize> = names.iter().map(|name| header.iter().position(|other| other == *name).unwrap()).collect();
    table.records().map(|row| places.iter().map(|&at| row.as_ref().unwrap()[at].to_owned()).collect()).collect()
}
