//! MATLAB's `.mat` files: version 4, and version 5 up to 7 with compression. Version 7.3 is HDF5 and refused.
//!
//! Read are two-dimensional real arrays, full and sparse, of any numeric class. What else a file holds (complex numbers, text,
//! cells, structures, arrays of more dimensions) is left out by name.

pub(crate) mod elements;
pub(crate) mod v4;
pub(crate) mod v5;
