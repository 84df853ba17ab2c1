//! Limits on what a file may ask for, and progress.

/// Bounds on what a reader takes, so that no file, however small, can fill the memory.
///
/// A reader never allocates from a size that a file declares; it grows with what is there. Measured with
/// `cargo run --release -p brake-squeal-formats --example list` on a triangle of 4.5 million entries (132 MB of text), in order and shuffled: a
/// peak of 214 MB, 24 bytes for each of the 9 million entries of the whole matrix. An `.npz` archive is held in memory besides, as
/// it is on disk. Contents that are compressed can be far larger than the file; these limits bound them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Most bytes of contents, after decompression. Default 8 GiB, chosen: it bounds the time.
    pub bytes: u64,
    /// Most entries of one matrix, mirrored ones included. Default 2^27, chosen: 2.1 GB.
    pub entries: usize,
    /// Most rows or columns; never more than 2^31, which entries can name. Default 2^24, chosen: above it an empty matrix costs more than 128 MB in compressed columns.
    pub order: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { bytes: 1 << 33, entries: 1 << 27, order: 1 << 24 }
    }
}

impl Limits {
    /// Limits with an order, at most 2^31, whose square and whose indices can be computed with.
    pub(crate) fn bounded(self) -> Self {
        Self { order: self.order.min(1 << 31), ..self }
    }
}

/// Listener called with the bytes of the file read so far and its size, about once in a megabyte.
pub type Progress<'a> = Box<dyn FnMut(u64, u64) + 'a>;

/// Options of reading a file; the default suits.
#[derive(Default)]
pub struct Options<'a> {
    /// Bounds on what the file may ask for.
    pub limits: Limits,
    /// Listener to how far the reading is.
    pub progress: Option<Progress<'a>>,
}
