//! Matrices and mode shapes in the files of other programs.

mod abaqus;
mod builder;
mod bytes;
mod coordinates;
mod detect;
mod dmig;
mod dof;
mod error;
mod limits;
mod lines;
mod market;
mod mat;
mod matrix;
mod mesh;
mod numbers;
mod numpy;
mod op4;
mod problem;
mod read;
mod source;
mod substructure;
mod unv;
mod vtu;

pub use nalgebra;
pub use nalgebra_sparse;
pub use num_complex;

pub use detect::Format;
pub use dof::{BadDof, Dof};
pub use error::{FormatsError, Place};
pub use limits::{Limits, Options, Progress, Unstated};
pub use market::read_market;
pub use matrix::{Entry, Kind, Matrix, Stored, common_labels};
pub use mesh::{Cell, CellKind, Mesh, ModeShape, Node};
pub use problem::Problem;
pub use read::{File, read, read_bytes, read_labels, read_with};
pub use unv::write_unv;
pub use vtu::write_vtu;
