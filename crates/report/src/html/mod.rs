//! `report.html`: one file that a person reads in a browser, without a network.
//!
//! The page says the answer in words, then shows it: figures whose points tell their numbers, modes that move, tables that sort
//! and can be saved, and at the end everything from which the results came. Its numbers are the numbers of the tables that stand
//! beside it: they are read from these files. Words and facts are in the document itself and need no script; figures and tables are made
//! by `*.js` from one JSON element.
//!
//! The content security policy allows the page's own style and script, by their hashes, and nothing else.

mod answer;
mod compare;
mod cycles;
mod data;
mod facts;
mod geometry;
mod mesh;
mod packed;
mod page;
mod screen;
mod shapes;
mod study;
mod sweep;
mod sweep_answer;
mod tables;
mod text;

pub use compare::write_compare_page;
pub use cycles::{write_branches_page, write_cycle_page};
pub use geometry::{BasisOf, Geometry, MeshMotion, ModeOf};
pub use mesh::MeshSurface;
pub use screen::write_screen_page;
pub use study::write_page;
pub use sweep::write_sweep_page;

/// Name of the page of a study, a sweep, a screening, a comparison or a motion, in the folder of its other results.
const FILE: &str = "report.html";
