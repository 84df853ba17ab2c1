//! The program's commands, each a function of its arguments that a test can call.

mod cea;
mod check;
mod eig;
mod refuse;
mod run;
mod scene;
mod sweep;

pub use self::cea::CeaArgs;
pub use check::CheckArgs;
pub use eig::EigArgs;
pub use refuse::{finish, refuse};
pub use run::{RunArgs, override_run, threads, whole_number};
pub use scene::SceneArgs;
pub use sweep::SweepArgs;
