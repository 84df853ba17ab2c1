//! An entry of a sparse matrix.

/// An entry of a [`Matrix`](crate::Matrix).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entry {
    /// Row, from 0.
    pub row: u32,
    /// Column, from 0.
    pub column: u32,
    /// The value: finite.
    pub value: f64,
}

impl Entry {
    /// Row and column as one number that sorts by column, then row.
    pub(crate) fn key(&self) -> u64 {
        u64::from(self.column) << 32 | u64::from(self.row)
    }

    pub(crate) fn mirrored(self) -> Self {
        Self { row: self.column, column: self.row, value: self.value }
    }
}
