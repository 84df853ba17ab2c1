//! MATLAB's `.mat` files: version 4 in `v4.rs`, versions 5 to 7, of which 7 is compressed, in `v5.rs`. Version 7.3 is HDF5 and refused where the format is found
//! (`detect.rs` of the crate).
//!
//! Reads two-dimensional arrays of numbers, full or sparse, at top level or as members of structures (`s.K`); logical ones as 0 and 1. A complex array is read if
//! all its imaginary parts are 0, and left out otherwise. Everything else (text, cells, arrays of more dimensions) is skipped, and its name and the reason are
//! listed in `File::left_out`. Two arrays of one name, as in a file that was appended to, are both read; who asks for that name is refused.

pub(crate) mod elements;
pub(crate) mod v4;
pub(crate) mod v5;
