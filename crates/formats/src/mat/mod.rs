//! MATLAB's `.mat` files: version 4, and version 5 up to 7 with compression. Version 7.3 is HDF5 and refused.
//!
//! Read are two-dimensional arrays, full and sparse, of any numeric class, alone and in structures (`s.K`); complex ones where all
//! imaginary parts are 0. What else a file holds (text, cells, arrays of more dimensions) is left out by name.

pub(crate) mod elements;
pub(crate) mod v4;
pub(crate) mod v5;
