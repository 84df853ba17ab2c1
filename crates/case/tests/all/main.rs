//! Tests of case files: one program, which is linked once.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

mod matrices_of_any_format;
mod names_on_mesh;
