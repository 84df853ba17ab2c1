//! `squeal prepare`.

use std::io::Write;
use std::path::PathBuf;

use brakes::Purpose;
use brakes::case::{CaseFile, ChosenSpeed};
use output::{bytes_in_words, printable};

use super::options::MachineArgs;
use super::prepared::{in_words, none_prepared};
use super::scene::SceneArgs;
use super::sized;
use crate::Error;
use crate::case_file::CaseArgs;

/// Reduce a brake of finite elements once, for all commands: its bases, their errors and the checks against the whole brake.
///
/// It prepares what run, merge, influence, check, screen, cea, cycle and rare start from without options that choose a scene; what an option chooses, and what a
/// sweep goes through, is prepared by the command itself. All is kept beside the case, in the folder .squeal, where commands find it, and in a file
/// that --prepared names. A preparation that was stopped, even killed, goes on by the same command.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: squeal prepare brake.toml --out brake.prepared")]
pub struct PrepareArgs {
    /// The case
    #[command(flatten)]
    pub case: CaseArgs,
    /// Also one file, for other folders and machines of the same kind
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Threads and memory
    #[command(flatten)]
    pub machine: MachineArgs,
}

impl PrepareArgs {
    /// Runs the command; `out` gets what was prepared.
    ///
    /// # Errors
    /// A case that is not one of finite elements, a file that cannot be written.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        let (case, args) = (self.case.read()?, &self.case.prepared);
        if !matches!(case, CaseFile::FiniteElements(_)) {
            return Err(none_prepared("CASE", &self.case.case));
        }
        let mut prepared = args.open(&case)?.within(self.machine.memory.budget());
        if self.out.is_some() {
            prepared = prepared.collecting();
        }
        let first = |speed| SceneArgs::default().only(case.clone(), speed);
        for (case, purpose) in [
            (case.clone(), Purpose::Study),
            (case.clone(), Purpose::Screen),
            (first(ChosenSpeed::Median)?, Purpose::Point),
            (first(ChosenSpeed::Median)?, Purpose::Analysis),
            (first(ChosenSpeed::Range(None))?, Purpose::Study),
        ] {
            sized::of_pieces(case, purpose, self.machine, &prepared)?;
        }
        let mut lines = in_words(&prepared, args).map_or_else(String::new, |line| line + "\n");
        if let Some(path) = &self.out {
            let size = bytes_in_words(prepared.write(path)? as f64);
            lines += &format!("{}: written, {size}\n", printable(&path.display().to_string()));
        }
        out.write_all(lines.as_bytes()).map_err(Error::StandardOutput)
    }
}
