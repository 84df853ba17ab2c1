//! Contact of bodies of finite elements whose meshes do not match, and what it adds to a brake.
//!
//! | where | what |
//! | --- | --- |
//! | [`Interface`], [`Pairing`] | contact points: where the slave's faces are integrated, with normal, sliding, gap and area of each |
//! | [`OppositeFaces`] | the faces of a body that look at the other side |
//! | [`ContactPoint`], [`Row`] | rows of gap and slip over the degrees of freedom of a model |
//! | [`Interface::channels`] and others | friction channels, springs and damping, in the signs of `linsys` |
//! | [`Stiffness`] | by area, in all, or growing with the pressure |
//! | [`Interface::uniform`], [`Interface::of_pressures`] | normal forces that are given |
//! | [`Condensed`], [`Balance`], [`Equilibrium`] | normal forces in static equilibrium, friction among them, and whether they are unique |
//! | [`complementarity`] | linear complementarity problems |
//!
//! The slave is the side that is integrated over, as a rule the pad; the master the one that slides under it, as a rule the disc. Normals
//! point from the master into the slave. Units are those of the model.

pub mod complementarity;
mod condensed_structure;
mod equilibrium;
mod error;
mod faces_of_whole_body;
mod grid;
mod law;
mod load;
mod pairing;
mod patches;
mod point;
mod project;
mod rows;
mod segments;
mod sliding;
mod stiffness;
mod uniqueness;

pub use elements;
pub use nalgebra;

pub use condensed_structure::Condensed;
pub use equilibrium::{Balance, Equilibrium};
pub use error::{ContactError, Side};
pub use faces_of_whole_body::OppositeFaces;
pub use pairing::{Integration, Interface, Pairing};
pub use point::ContactPoint;
pub use rows::Row;
pub use sliding::Sliding;
pub use stiffness::Stiffness;
pub use uniqueness::Uniqueness;

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
