//! Solid finite elements: mass, stiffness, loads and what turning adds, integrated over a mesh whose other matrices another program exports.
//!
//! | where | what |
//! | --- | --- |
//! | [`Kind`] | C3D4, C3D6, C3D8, C3D10, C3D15 and C3D20: nodes, shape functions, rules of integration, faces |
//! | [`Mesh`], [`Rows`] | nodes and elements by the numbers of a model, and the degrees of freedom of that |
//! | [`Face`], [`FaceId`], [`SurfacePoint`] | faces with their normals to the outside, by the numbers of Abaqus and CalculiX |
//! | [`Body`] | mass, stiffness and centrifugal load of a body |
//! | [`Transport`], [`Body::stress_stiffness`] | what turning adds: gyroscopic and centripetal terms, and the stiffness of stress |
//!
//! Units are those of the mesh. Nothing is solved here.

mod body;
mod elastic;
mod error;
mod faces;
mod kind;
mod mesh;
mod points;
mod rotation;
mod rules;
mod shape;
mod surface;

pub use nalgebra;
pub use nalgebra_sparse;

pub use body::Body;
pub use elastic::Material;
pub use error::ElementsError;
pub use faces::{FaceKind, FaceShape};
pub use kind::Kind;
pub use mesh::{Element, Mesh, Rows};
pub use rotation::{Axis, Transport};
pub use rules::{FacePoint, SolidPoint};
pub use shape::Shape;
pub use surface::{Face, FaceId, SurfacePoint};

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
