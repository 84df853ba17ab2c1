//! The memory layout of a batch of matrices.

/// Reflectors that a window of the sweep generates before they are applied to the rest of the matrix; chosen.
pub(super) const REFLECTORS_PER_WINDOW: usize = 6;
/// Spare rows above each column: the sweep works on groups of four rows and may begin up to four rows above row 0.
const ROWS_ABOVE: usize = 4;

/// Layout of a batch: a register holds entry (i, j) of all its matrices. Columns are contiguous, with zeros around the matrix, so that
/// the sweep needs no special cases at the edges.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    /// N, rows and columns of a matrix.
    pub order: usize,
    /// Registers from one column to the next; odd, so that the entries of a row are spread over the sets of the cache.
    pub stride: usize,
}

impl Layout {
    pub fn new(order: usize) -> Self {
        Self { order, stride: (ROWS_ABOVE + order + REFLECTORS_PER_WINDOW + 1) | 1 }
    }

    /// Index of the register of entry (i, j).
    #[inline(always)]
    pub fn at(self, i: usize, j: usize) -> usize {
        self.row(i) + self.column(j)
    }

    /// Index of row i within a column.
    #[inline(always)]
    pub fn row(self, i: usize) -> usize {
        ROWS_ABOVE + i
    }

    /// Index of the first register of column j; there is one spare column in front.
    #[inline(always)]
    pub fn column(self, j: usize) -> usize {
        (j + 1) * self.stride
    }

    /// Registers in all.
    pub fn len(self) -> usize {
        self.column(self.order + REFLECTORS_PER_WINDOW + 1)
    }
}

/// The registers `from..from + rows` of each of `W` consecutive columns of `block`.
#[inline(always)]
pub(super) fn columns<V, const W: usize>(block: &mut [V], stride: usize, from: usize, rows: usize) -> [&mut [V]; W] {
    let mut each = block.chunks_exact_mut(stride);
    let columns: [&mut [V]; W] =
        std::array::from_fn(|_| each.next().map(|column| &mut column[from..from + rows]).unwrap_or_default());
    // With this check the compiler omits one per access.
    for column in &columns {
        assert_eq!(column.len(), rows);
    }
    columns
}
