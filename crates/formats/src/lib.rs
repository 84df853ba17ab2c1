//! Matrices and mode shapes in the files of other programs.
//!
//! | where | what |
//! | --- | --- |
//! | [`read`], [`read_with`], [`read_bytes`] | every matrix of a file, whose [`Format`] its contents tell |
//! | [`File`] | the matrices, the one that is [`Wanted`], and what was left out with the reason |
//! | [`read_one`], [`split_name`] | one matrix of `FILE` or `FILE:NAME` |
//! | [`Symmetry`], [`Stored`], [`Doubt`] | how the entries of a file are taken |
//! | [`Matrix`] | whole: entries, [`Dof`] of each row, compressed columns of [`nalgebra_sparse`], or all numbers |
//! | [`on_common_rows`], [`common_labels`], [`Matrix::on`] | matrices of one model on the same rows |
//! | [`Limits`], [`Options`] | bounds on memory, progress |
//! | [`read_market`] | Matrix Market alone |
//! | [`read_deck`] | nodes, elements and node sets of an Abaqus or CalculiX input deck |
//! | [`write_unv`], [`write_vtu`] | a [`Mesh`] with complex [`ModeShape`]s |
//! | [`Surface`] | what of a [`Mesh`] is seen from outside |
//! | [`FormatsError`] | one line: [`Place`] and [`Problem`] |
//!
//! Readers stream: memory grows with the entries that are there, never with a size that a file declares. The zip container is
//! read by the crate `zip`, compressed data by `flate2` with its decoder in Rust; the formats themselves have readers here, because no
//! kept crate reads them (of MATLAB's, `matfile` 0.5 has no sparse arrays and takes all memory that a compressed array asks for).

mod abaqus;
mod builder;
mod bytes;
mod coordinates;
mod deck;
mod detect;
mod dmig;
mod dof;
mod error;
mod harwell_boeing;
mod limits;
mod lines;
mod market;
mod mat;
mod matrix;
mod mesh;
mod names;
mod numbers;
mod numpy;
mod op4;
mod problem;
mod read;
mod rows;
mod shortened;
mod source;
mod substructure;
mod surface;
mod symmetry;
mod unv;
mod vtu;

pub use nalgebra;
pub use nalgebra_sparse;
pub use num_complex;

pub use deck::{Deck, Solid, SurfaceSet, read_deck};
pub use detect::Format;
pub use dof::{BadDof, Dof};
pub use error::{FormatsError, Place};
pub use limits::{Limits, Options, Progress};
pub use market::read_market;
pub use matrix::{Entry, Kind, Matrix, common_labels};
pub use mesh::{Cell, CellKind, Mesh, ModeShape, Node};
pub use problem::Problem;
pub use read::{File, Wanted, read, read_bytes, read_labels, read_one, read_with, split_name};
pub use rows::on_common_rows;
pub use surface::Surface;
pub use symmetry::{Doubt, KnownBy, Stored, Symmetry};
pub use unv::write_unv;
pub use vtu::write_vtu;

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
