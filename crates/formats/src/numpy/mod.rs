//! NumPy's `.npy` (one array) and `.npz` (an archive of arrays), among them what `scipy.sparse.save_npz` writes.

mod archive;
pub(crate) mod npy;
pub(crate) mod npz;
mod sparse;
