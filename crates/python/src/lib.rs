//! The native module `squeal._squeal`: the functions that the typed ones of the package `squeal` call. Arrays go in and out, work is done with the
//! interpreter free, and every error is an exception of `squeal._errors`.

mod away;
mod brake;
mod eig;
mod errors;
mod matrices;
mod questions;

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the program with these arguments, the first its own name, and returns its exit code.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| squeal_cli::program(arguments))
}

#[pymodule]
mod _squeal {
    #[pymodule_export]
    use super::brake::Brake;
    #[pymodule_export]
    use super::eig::{check, eig, eig_in_box, eigvals, held};
    #[pymodule_export]
    use super::main;
    #[pymodule_export]
    use super::matrices::{is_triangle, read_matrices};
    #[pymodule_export]
    use super::questions::{cea, cycle, estimate, evaluate, influence, merge, rare, run, screen, shard, sweep};
}
