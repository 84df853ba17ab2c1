//! Systems of thousands of degrees of freedom, as finite element programs export them, and all their eigenvalues in a rectangle.
//!
//! | where | what |
//! | --- | --- |
//! | [`SparseSecondOrder`] | M, C, K as sparse matrices, with internal first-order states |
//! | [`SparseAffineSystem`] | named terms and friction channels whose sum at an operating point is such a system |
//! | [`eigenpairs_in`] | all eigenvalues of such a system in a rectangle, with right and left vectors |
//! | [`product`] | the columns of a sparse matrix, and its product with a dense one |
//! | [`health`] | what the matrices of a model are, which rows make them singular, and how well it can be solved with |
//! | [`Problem`] | such a system ready to be solved with at many lambda |
//!
//! Sparse matrices are matrices of [`nalgebra_sparse`], which is re-exported.

mod affine;
mod error;
pub mod health;
#[cfg(test)]
mod of_entries;
mod ordering;
pub mod product;
mod solver;
mod symmetric;
mod system;
mod unpatterned;

pub use nalgebra_sparse;

pub use affine::{SparseAffineSystem, SparseTerm};
pub use error::SparseError;
pub use solver::{
    Circle, Count, Counters, Disc, Eigenpair, Found, Guess, Options, Problem, Progress, Reach, Rectangle, eigenpairs_in,
};
pub use system::{SparseSecondOrder, State};

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
