//! The memory layout of a batch of matrices.

/// Reflectors of a window: steps of the bulge on a small diagonal block before all are applied together to the rest; chosen:
/// with fewer the rest of the matrix is read more often, with more a window and its reflectors do not fit into the nearest cache.
pub(super) const REFLECTORS_PER_WINDOW: usize = 6;
/// Spare rows above each column: the sweep applies reflectors to groups of four rows, counted upwards from the window, so that the last group may begin
/// up to three rows above row 0; four keep whole groups.
const ROWS_ABOVE: usize = 4;

/// Layout of a batch by columns: element `at(i, j)` is a SIMD register with entry (i, j) of each matrix, one per lane. Columns are contiguous. Around
/// the matrix are zeros, so that the sweep needs no special cases at the edges: `ROWS_ABOVE` rows above, at least `REFLECTORS_PER_WINDOW + 1` below, one
/// column in front and `REFLECTORS_PER_WINDOW + 1` behind.
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

/// The registers `from..from + rows` of each of the first `W` columns of `block`, which begins at the start of a column and has as many.
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
