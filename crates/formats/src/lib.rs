//! Matrices and mode shapes in the files of other programs.
//!
//! | where | what |
//! | --- | --- |
//! | [`read`], [`read_with`], [`read_bytes`] | every matrix of a file; its [`Format`] is told by its contents, not by its name |
//! | [`File`] | the matrices of a file, the choice of one by [`Wanted`], and names of what was left out, with reasons |
//! | [`read_one`], [`split_name`] | one matrix of `FILE` or `FILE:NAME` |
//! | [`Symmetry`], [`Stored`], [`Doubt`] | storage of a matrix, whole or a triangle: as the caller knows it, as it was taken, what is odd in that |
//! | [`Matrix`] | a matrix, a triangle mirrored: entries, [`Dof`] of each row, compressed columns of [`nalgebra_sparse`], dense |
//! | [`on_common_rows`], [`common_labels`], [`Matrix::on`] | matrices of one model on the same rows; [`own_rows_in_words`]: what one alone has |
//! | [`Limits`], [`Options`] | bounds on sizes, and with them a listener to progress |
//! | [`read_market`] | Matrix Market alone |
//! | [`read_deck`] | nodes, elements and node sets of an Abaqus or CalculiX input deck |
//! | [`write_unv`], [`write_vtu`] | a [`Mesh`] with complex [`ModeShape`]s |
//! | [`write_fields_vtu`] | a [`Mesh`] with numbers and vectors at its nodes, [`MeshField`]s |
//! | [`Surface`] | the outside of a [`Mesh`], for a picture |
//! | [`FormatsError`] | one line: the [`Place`] in the file, and the [`Problem`] there |
//!
//! Readers stream: memory grows with the entries that are there, never with a size that a file declares. The zip container is
//! read by the crate `zip`, compressed data by `flate2` with its decoder in Rust; the formats themselves have readers here, because no
//! maintained crate reads them (for those of MATLAB, `matfile` 0.5 has no sparse arrays, and allocates whatever size a compressed array
//! declares).

mod abaqus_matrices;
mod arrays;
mod builder;
mod bytes;
mod coordinates;
mod deck;
mod detect;
mod dmig;
mod dof;
mod entry;
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
mod whole;

pub use nalgebra;
pub use nalgebra_sparse;
pub use num_complex;

pub use deck::{Deck, Solid, SurfaceSet, read_deck};
pub use detect::Format;
pub use dof::{BadDof, Dof};
pub use entry::Entry;
pub use error::{FormatsError, Place};
pub use limits::{Limits, Options, Progress};
pub use lines::plain_text;
pub use market::read_market;
pub use matrix::{Kind, Matrix, common_labels};
pub use mesh::{Cell, CellKind, Mesh, MeshField, ModeShape, Node};
pub use problem::Problem;
pub use read::{File, Wanted, read, read_bytes, read_labels, read_one, read_with, split_name};
pub use rows::{on_common_rows, own_rows_in_words};
pub use surface::Surface;
pub use symmetry::{Doubt, KnownBy, Stored, Symmetry};
pub use unv::write_unv;
pub use vtu::{write_fields_vtu, write_vtu};

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
