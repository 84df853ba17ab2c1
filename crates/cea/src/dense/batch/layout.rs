//! How a batch of matrices stands in memory.

/// Reflectors that a window of the sweep generates before it applies them to the rest of the matrix.
pub(super) const REFLECTORS_PER_WINDOW: usize = 6;
/// Spare rows above each column: the sweep works on groups of four rows and may begin before row 0.
const ROWS_ABOVE: usize = 4;

/// Entry (i, j) of all matrices of a batch is one register; columns are contiguous, with zeros around the matrix
/// so that the sweep need not treat its edges apart.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    /// N, rows and columns of a matrix.
    pub order: usize,
    /// Registers from one column to the next: odd, so that a row does not fall into one set of the cache.
    pub stride: usize,
}

impl Layout {
    pub fn new(order: usize) -> Self {
        Self { order, stride: (ROWS_ABOVE + order + REFLECTORS_PER_WINDOW + 1) | 1 }
    }

    /// Where entry (i, j) stands, in registers.
    #[inline(always)]
    pub fn at(self, i: usize, j: usize) -> usize {
        self.row(i) + self.column(j)
    }

    /// Where row i stands in its column.
    #[inline(always)]
    pub fn row(self, i: usize) -> usize {
        ROWS_ABOVE + i
    }

    /// Where column j begins; there is one spare column in front.
    #[inline(always)]
    pub fn column(self, j: usize) -> usize {
        (j + 1) * self.stride
    }

    /// Registers in all.
    pub fn len(self) -> usize {
        self.column(self.order + REFLECTORS_PER_WINDOW + 1)
    }
}

/// `W` consecutive columns of `block`, of each the rows `from..from + rows` (in memory, not of the matrix).
#[inline(always)]
pub(super) fn columns<V, const W: usize>(block: &mut [V], stride: usize, from: usize, rows: usize) -> [&mut [V]; W] {
    let mut each = block.chunks_exact_mut(stride);
    let columns: [&mut [V]; W] =
        std::array::from_fn(|_| each.next().map(|column| &mut column[from..from + rows]).unwrap_or_default());
    // One check here spares one per access.
    for column in &columns {
        assert_eq!(column.len(), rows);
    }
    columns
}
