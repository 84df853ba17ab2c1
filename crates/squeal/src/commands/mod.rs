//! The program's commands, each a function of its arguments that a test can call.

mod cea;
mod check;
mod eig;
mod influence;
mod mesh_shapes;
mod options;
mod reasons;
mod reduction;
mod refuse;
mod results_folder;
mod run;
mod scene;
mod screen;
mod sized;
mod sweep;

pub use self::cea::CeaArgs;
pub use check::CheckArgs;
pub use eig::EigArgs;
pub use influence::InfluenceArgs;
pub use options::{MemoryArgs, override_run, threads, whole_number};
pub use refuse::{finish, refuse};
pub use run::RunArgs;
pub use scene::SceneArgs;
pub use screen::ScreenArgs;
pub use sweep::SweepArgs;
