//! The pictures of what was found: data of `squeal`, drawn by `figures`.

mod compare;
mod cycles;
mod damping;
mod influence;
mod motions;
mod occurrence;
mod rare;
mod screen;
mod sweep;

pub use compare::compare_figure;
pub use cycles::{branches_figure, cycle_figures};
pub(crate) use damping::damping;
pub use damping::draw_damping;
pub use influence::influence_figure;
pub use motions::draw_motions;
pub(crate) use motions::motions_of_draws;
pub use occurrence::{draw_occurrence, occurrence, set_heading};
pub use rare::rare_figure;
pub use screen::screen_figure;
pub use sweep::sweep_figure;
