//! The program's commands, each a function of its arguments that a test can call.

pub mod bar;
mod case_file;
mod cea;
mod check;
mod eig;
mod error;
mod influence;
mod log_lines;
mod merge;
mod mesh_shapes;
mod options;
mod program;
mod reasons;
mod reduction;
mod refuse;
mod results_folder;
mod run;
mod scene;
mod screen;
mod sized;
mod sweep;
pub mod terminal;

pub use self::cea::CeaArgs;
pub use case_file::commit;
pub use check::CheckArgs;
pub use eig::{EigArgs, largest_order, search_options};
pub use error::Error;
pub use influence::InfluenceArgs;
pub use merge::MergeArgs;
pub use options::{MemoryArgs, override_run, threads, whole_number};
pub use program::program;
pub use refuse::{finish, refuse};
pub use run::RunArgs;
pub use scene::SceneArgs;
pub use screen::ScreenArgs;
pub use sweep::SweepArgs;
