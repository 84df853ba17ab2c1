//! Tests of solvers on known problems: one program, which is linked once.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

mod large;
mod lattice;
mod nlevp;
#[path = "../../../study/tests/common/paper_brake.rs"]
mod paper_brake;
