//! Files for the archives of a release: completions and manual pages of the program.

use std::path::PathBuf;

use clap::ValueEnum;
use clap_complete::Shell;
use squeal::output::make_folder;

use crate::error::TaskError;

/// Write completions for every shell and a manual page for every command, for the archives of a release.
#[derive(Debug, clap::Args)]
pub struct ReleaseFilesArgs {
    /// Folder for `completions` and `man`
    #[arg(long, value_name = "DIR", default_value = "target/release-files")]
    out: PathBuf,
}

/// Writes the files.
///
/// # Errors
/// A folder that cannot be written.
pub fn run(args: &ReleaseFilesArgs) -> Result<(), TaskError> {
    let [completions, man] = ["completions", "man"].map(|name| args.out.join(name));
    for dir in [&completions, &man] {
        make_folder(dir)?;
    }
    for shell in Shell::value_variants() {
        clap_complete::generate_to(*shell, &mut squeal_cli::command(), "squeal", &completions)
            .map_err(TaskError::Start)?;
    }
    clap_mangen::generate_to(squeal_cli::command(), &man).map_err(TaskError::Start)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shell_and_every_command_has_its_file() {
        let dir = tempfile::tempdir().unwrap();
        run(&ReleaseFilesArgs { out: dir.path().to_owned() }).unwrap();
        assert_eq!(std::fs::read_dir(dir.path().join("completions")).unwrap().count(), Shell::value_variants().len());
        for command in squeal_cli::command().get_subcommands() {
            let page =
                std::fs::read_to_string(dir.path().join(format!("man/squeal-{}.1", command.get_name()))).unwrap();
            assert!(page.contains("Example: squeal"), "{}", command.get_name());
        }
    }
}
