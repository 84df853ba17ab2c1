//! A real matrix with the names of its rows and columns.

use std::collections::{BTreeSet, HashMap};
use std::fmt;

use nalgebra::DMatrix;
use nalgebra_sparse::CscMatrix;

use crate::entry::Entry;
use crate::symmetry::{Doubt, KnownBy, Stored, asymmetry};
use crate::{Dof, FormatsError};

/// Role of a matrix in `M u'' + C u' + K u = f`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Mass matrix M.
    Mass,
    /// Viscous damping matrix C.
    Damping,
    /// Stiffness matrix K.
    Stiffness,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Mass => "mass",
            Self::Damping => "damping",
            Self::Stiffness => "stiffness",
        })
    }
}

/// A real matrix, whole: a triangle in a file has been mirrored once, repeated entries have been added. One that is
/// [`Stored::OneSide`] is as the file lists it; [`Matrix::with_symmetry`] makes it whole.
///
/// Entries are sorted by column, then row, without repeats; zeros that a sparse file lists are kept. Every index is within
/// the matrix and every value finite.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    pub(crate) name: String,
    pub(crate) kind: Option<Kind>,
    pub(crate) stored: Stored,
    pub(crate) known_by: KnownBy,
    pub(crate) doubt: Option<Doubt>,
    /// The last line of the file has an end, without which its last number may be cut.
    pub(crate) ended: bool,
    /// The matrix is a stiffness beside which the file has structural damping, which is not read with it.
    pub(crate) beside_structural: bool,
    /// The matrix is from a list that names its rows by numbers, of which the last may be missing.
    pub(crate) numbered: bool,
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    pub(crate) entries: Vec<Entry>,
    pub(crate) row_labels: Option<Vec<Dof>>,
    pub(crate) column_labels: Option<Vec<Dof>>,
}

impl Matrix {
    /// The name in the file; of a file that names nothing, the name of its kind or `matrix`.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Role of the matrix, M, C or K, where the file says it.
    #[must_use]
    pub fn kind(&self) -> Option<Kind> {
        self.kind
    }

    /// Storage of the matrix in the file.
    #[must_use]
    pub fn stored(&self) -> Stored {
        self.stored
    }

    /// Source of what [`Matrix::stored`] says.
    #[must_use]
    pub fn known_by(&self) -> KnownBy {
        self.known_by
    }

    /// Oddities in how the matrix is stored, each worth a line to whoever gave the file.
    #[must_use]
    pub fn doubts(&self) -> Vec<Doubt> {
        let beside = self.beside_structural.then_some(Doubt::BesideStructural);
        self.doubt.into_iter().chain((!self.ended).then_some(Doubt::NoEnd)).chain(beside).collect()
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The entries, by column, then row.
    #[must_use]
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The degree of freedom of each row, where the file names them; of a square matrix also the degree of freedom of each column.
    #[must_use]
    pub fn row_labels(&self) -> Option<&[Dof]> {
        self.row_labels.as_deref()
    }

    /// The degree of freedom of each column, where the file names them.
    #[must_use]
    pub fn column_labels(&self) -> Option<&[Dof]> {
        self.column_labels.as_deref()
    }

    /// The largest `|a_ij - a_ji|`, of a square matrix.
    #[must_use]
    pub fn asymmetry(&self) -> Option<f64> {
        (self.rows == self.columns).then(|| asymmetry(&self.entries))
    }

    /// The matrix in compressed columns. Takes 8 bytes a column and 16 an entry.
    #[must_use]
    pub fn to_csc(&self) -> CscMatrix<f64> {
        let mut offsets = vec![0_usize; self.columns + 1];
        for entry in &self.entries {
            offsets[entry.column as usize + 1] += 1;
        }
        for column in 0..self.columns {
            offsets[column + 1] += offsets[column];
        }
        let rows = self.entries.iter().map(|entry| entry.row as usize).collect();
        let values = self.entries.iter().map(|entry| entry.value).collect();
        // The entries are sorted and within bounds, so that this cannot fail.
        CscMatrix::try_from_csc_data(self.rows, self.columns, offsets, rows, values)
            .unwrap_or_else(|_| CscMatrix::zeros(self.rows, self.columns))
    }

    /// The matrix with all its zeros, rows times columns numbers: ask for [`Matrix::rows`] and [`Matrix::columns`] first.
    #[must_use]
    pub fn to_dense(&self) -> DMatrix<f64> {
        let mut dense = DMatrix::zeros(self.rows, self.columns);
        for entry in &self.entries {
            dense[(entry.row as usize, entry.column as usize)] = entry.value;
        }
        dense
    }

    /// A copy with the rows and columns that `labels` names, in that order: rows and columns that the matrix lacks are zero. So the
    /// matrices of one model, each written with the degrees of freedom that it has entries for, become equally large; see
    /// [`common_labels`].
    ///
    /// # Errors
    /// [`FormatsError::Unlabelled`], or [`FormatsError::UnknownDof`] where `labels` lacks one that the matrix has.
    pub fn on(&self, labels: &[Dof]) -> Result<Self, FormatsError> {
        let place: HashMap<Dof, u32> = labels.iter().copied().zip(0..).collect();
        let places = |own: &Option<Vec<Dof>>| -> Result<Vec<u32>, FormatsError> {
            let own = own.as_ref().ok_or_else(|| FormatsError::Unlabelled { matrix: self.name.clone() })?;
            let unknown = |dof: &Dof| FormatsError::UnknownDof { matrix: self.name.clone(), dof: dof.to_string() };
            own.iter().map(|dof| place.get(dof).copied().ok_or_else(|| unknown(dof))).collect()
        };
        let (row, column) = (places(&self.row_labels)?, places(&self.column_labels)?);
        let moved =
            |entry: &Entry| Entry { row: row[entry.row as usize], column: column[entry.column as usize], ..*entry };
        let mut entries: Vec<Entry> = self.entries.iter().map(moved).collect();
        entries.sort_by_key(Entry::key);
        let (labels, order) = (Some(labels.to_vec()), labels.len());
        let (row_labels, column_labels) = (labels.clone(), labels);
        let name = self.name.clone();
        Ok(Self { name, rows: order, columns: order, entries, row_labels, column_labels, ..*self })
    }

    /// A copy of a square matrix without these rows and the columns of the same indices, from 0.
    #[must_use]
    pub fn without(&self, rows: &BTreeSet<usize>) -> Self {
        let mut places = Vec::with_capacity(self.rows);
        let mut next = 0_u32;
        for row in 0..self.rows {
            let stays = !rows.contains(&row);
            places.push(stays.then_some(next));
            next += u32::from(stays);
        }
        let moved = |entry: &Entry| {
            let place = |at: u32| places.get(at as usize).copied().flatten();
            Some(Entry { row: place(entry.row)?, column: place(entry.column)?, ..*entry })
        };
        let labels = |own: &Option<Vec<Dof>>| {
            let kept =
                |own: &Vec<Dof>| own.iter().zip(&places).filter(|(_, p)| p.is_some()).map(|(dof, _)| *dof).collect();
            own.as_ref().map(kept)
        };
        Self {
            name: self.name.clone(),
            rows: next as usize,
            columns: next as usize,
            entries: self.entries.iter().filter_map(moved).collect(),
            row_labels: labels(&self.row_labels),
            column_labels: labels(&self.column_labels),
            ..*self
        }
    }
}

/// Degrees of freedom of all rows and columns of these matrices, each once, ascending by node and direction.
///
/// # Errors
/// [`FormatsError::Unlabelled`] for a matrix without labels.
pub fn common_labels<'a>(matrices: impl IntoIterator<Item = &'a Matrix>) -> Result<Vec<Dof>, FormatsError> {
    let mut all = BTreeSet::new();
    for matrix in matrices {
        for labels in [&matrix.row_labels, &matrix.column_labels] {
            let labels = labels.as_ref().ok_or_else(|| FormatsError::Unlabelled { matrix: matrix.name.clone() })?;
            all.extend(labels.iter().copied());
        }
    }
    Ok(all.into_iter().collect())
}
