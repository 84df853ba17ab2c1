//! Matrices of one model on the same rows.

use std::collections::HashSet;

use crate::builder::Builder;
use crate::{Dof, FormatsError, Matrix, common_labels};

/// Puts the matrices of one model on the same rows and columns, as far as they say what their rows are.
///
/// Matrices whose files name their rows get the rows that any of them has. Where a matrix has no names, the others must have equal names, because
/// nothing else says which of its rows is which. A list of `row column value` has no size of its own: it is as large as the largest
/// matrix beside it. Sizes of matrices without names are else left as they are.
///
/// # Errors
/// The index of a matrix in the list, and [`FormatsError::Unlabelled`]; [`FormatsError::Apart`] for one that has no row of any other one, as where
/// exports number their nodes differently.
pub fn on_common_rows(all: &mut [&mut Matrix]) -> Result<(), (usize, FormatsError)> {
    if all.iter().all(|matrix| matrix.numbered) && all.iter().any(|matrix| matrix.row_labels.is_some()) {
        all.iter_mut().for_each(|matrix| matrix.name_by_numbers());
    }
    let labels = |matrix: &Matrix| (matrix.row_labels.clone(), matrix.column_labels.clone());
    let named: Vec<&Matrix> = all.iter().map(|matrix| &**matrix).filter(|matrix| matrix.row_labels.is_some()).collect();
    if named.windows(2).any(|pair| labels(pair[0]) != labels(pair[1])) {
        if let Some(at) = all.iter().position(|matrix| matrix.row_labels.is_none()) {
            return Err((at, FormatsError::Unlabelled { matrix: all[at].name.clone() }));
        }
        let rows = row_sets(&named);
        if let Some((at, own)) = own_rows(&rows).enumerate().find(|(at, own)| own.len() == rows[*at].len()) {
            let row = own.iter().min().map_or_else(String::new, |row| row.to_string());
            return Err((at, FormatsError::Apart { matrix: all[at].name.clone(), rows: own.len(), row }));
        }
        let labels = common_labels(named).map_err(|error| (0, error))?;
        for (at, matrix) in all.iter_mut().enumerate() {
            **matrix = matrix.on(&labels).map_err(|error| (at, error))?;
        }
        return Ok(());
    }
    let largest = all.iter().map(|matrix| matrix.rows.max(matrix.columns)).max().unwrap_or(0);
    for matrix in all.iter_mut().filter(|matrix| matrix.numbered && matrix.row_labels.is_none()) {
        (matrix.rows, matrix.columns) = (largest, largest);
    }
    Ok(())
}

/// Words, for each of the matrices of one model, on the rows that it alone has; `None` where it has none, or another matrix does not name its rows.
#[must_use]
pub fn own_rows_in_words(all: &[&Matrix]) -> Vec<Option<String>> {
    let rows = row_sets(all);
    let words = |(at, own): (usize, Vec<&Dof>)| {
        let mut others = rows.iter().enumerate().filter(|(other, _)| *other != at);
        let (first, count) = (own.iter().min()?, rows[at].len());
        if others.any(|(_, other)| other.is_empty()) {
            return None;
        }
        Some(match own.len() {
            1 => format!("1 of its {count} rows is in no other matrix: {first}"),
            own => format!("{own} of its {count} rows are in no other matrix: {first} and others"),
        })
    };
    own_rows(&rows).enumerate().map(words).collect()
}

/// The rows of each matrix, as far as it names them.
fn row_sets<'a>(all: &[&'a Matrix]) -> Vec<HashSet<&'a Dof>> {
    all.iter().map(|matrix| matrix.row_labels.iter().flatten().collect()).collect()
}

/// The rows of each matrix that no other one has.
fn own_rows<'a>(rows: &[HashSet<&'a Dof>]) -> impl Iterator<Item = Vec<&'a Dof>> {
    (0..rows.len()).map(|at| {
        let others = || rows.iter().enumerate().filter(|(other, _)| *other != at);
        rows[at].iter().copied().filter(|row| !others().any(|(_, other)| other.contains(row))).collect()
    })
}

impl Matrix {
    /// Makes the numbers of rows their names, where there are none.
    fn name_by_numbers(&mut self) {
        let names = |count: usize| Some((1..=count as i64).map(numbered).collect());
        if self.row_labels.is_none() {
            (self.row_labels, self.column_labels) = (names(self.rows), names(self.columns));
        }
    }
}

/// The name of a row that is known by its number.
pub(crate) fn numbered(row: i64) -> Dof {
    Dof { node: row, direction: 0 }
}

/// Index of a row in a list, before it is known which rows there are: rows with negative numbers come last, backwards.
pub(crate) fn code(row: i64) -> usize {
    if row < 0 { (u32::MAX as usize).saturating_sub(row.unsigned_abs() as usize - 1) } else { row as usize - 1 }
}

/// Names rows by their numbers, and brings the entries to the indices of the names.
pub(crate) fn number_rows(builder: &mut Builder, rows: &std::collections::BTreeSet<i64>) -> Vec<Dof> {
    let places: std::collections::HashMap<u32, u32> = rows.iter().map(|&row| code(row) as u32).zip(0..).collect();
    builder.place(|code| places.get(&code).copied().unwrap_or_default());
    rows.iter().copied().map(numbered).collect()
}
