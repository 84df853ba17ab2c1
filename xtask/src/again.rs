//! Starts a task again in another process, where this process has not the features or environment that the task needs.

use std::ffi::OsString;
use std::io::Error;
use std::process::Command;

use crate::error::TaskError;

/// Runs `task`, its name and its options without `--features`, in a process that has these features and one thread of
/// OpenBLAS, and exits with its code. Does nothing where this process has both already.
///
/// # Errors
/// [`TaskError::Start`].
pub fn run_again(features: Option<&str>, task: &[OsString]) -> Result<(), TaskError> {
    let Some(command) = again(features, task) else { return Ok(()) };
    let status = command.and_then(|mut command| command.status()).map_err(TaskError::Start)?;
    std::process::exit(status.code().unwrap_or(2))
}

/// The command that starts the task with other features, or with one thread of OpenBLAS, which reads this number when it is loaded;
/// `None` where neither is needed.
fn again(features: Option<&str>, task: &[OsString]) -> Option<Result<Command, Error>> {
    const OPENBLAS_THREADS: &str = "OPENBLAS_NUM_THREADS";
    let command = if let Some(features) = features {
        let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
        cargo.args(["run", "--release", "--package", "xtask", "--features", features, "--"]).args(task);
        // The variables that cargo sets for this package would make it rebuild some of the others.
        for (name, _) in std::env::vars_os() {
            let is_own = |name: &str| name.starts_with("CARGO_PKG_") || name.starts_with("CARGO_MANIFEST_");
            if name.to_str().is_some_and(is_own) {
                cargo.env_remove(name);
            }
        }
        Ok(cargo)
    } else if cfg!(feature = "lapack") && std::env::var_os(OPENBLAS_THREADS).is_none_or(|threads| threads != "1") {
        std::env::current_exe().map(|program| {
            let mut same = Command::new(program);
            same.args(std::env::args_os().skip(1));
            same
        })
    } else {
        return None;
    };
    Some(command.map(|mut command| {
        command.env(OPENBLAS_THREADS, "1");
        command
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn features_and_the_task_reach_cargo() {
        let task: Vec<OsString> = ["bench", "--quick", "--json", "a b.json"].map(OsString::from).to_vec();
        let command = again(Some("faer"), &task).unwrap().unwrap();
        let words: Vec<_> = command.get_args().map(|word| word.to_str().unwrap()).collect();
        let [cargo, bench] = words.split(|&word| word == "--").collect::<Vec<_>>()[..] else { unreachable!() };
        assert_eq!(cargo, ["run", "--release", "--package", "xtask", "--features", "faer"]);
        assert_eq!(bench, ["bench", "--quick", "--json", "a b.json"]);
        assert!(command.get_envs().any(|(name, value)| name == "OPENBLAS_NUM_THREADS" && value == Some("1".as_ref())));
    }
}
