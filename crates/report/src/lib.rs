//! Results for people: pictures of studies, sweeps, screenings, influences and motions, and the page for a browser.
//!
//! | of | picture | page |
//! | --- | --- | --- |
//! | a study | [`draw_occurrence`] | [`write_page`] |
//! | a sweep | [`sweep_figure`] | [`write_sweep_page`] |
//! | a screening | [`screen_figure`] | [`write_screen_page`] |
//! | studies side by side | [`compare_figure`] | [`write_compare_page`] |
//! | the motion after the onset | [`cycle_figures`] | [`write_cycle_page`] |
//! | its branches over a parameter | [`branches_figure`] | [`write_branches_page`] |
//! | the influence of inputs | [`influence_figure`] | |
//! | likely squealing brakes | [`rare_figure`] | |
//!
//! Numbers are the numbers of the tables that `squeal` writes. Where the degrees of freedom of a brake are its owner says by a [`Geometry`].

mod error;
mod html;
mod pictures;

pub use error::Error;
pub use html::{
    BasisOf, Geometry, MeshMotion, MeshSurface, ModeOf, write_branches_page, write_compare_page, write_cycle_page,
    write_page, write_screen_page, write_sweep_page,
};
pub use pictures::{
    branches_figure, compare_figure, cycle_figures, draw_damping, draw_motions, draw_occurrence, influence_figure,
    occurrence, rare_figure, screen_figure, set_heading, sweep_figure,
};

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
