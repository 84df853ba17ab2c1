//! `squeal prepare`, and where commands look for what it prepared.

use std::io::Write;
use std::path::{Path, PathBuf};

use brakes::case::{CaseFile, ChosenSpeed};
use brakes::{Prepared, PreparedCounts, Purpose};
use output::{bytes_in_words, printable};

use super::options::MachineArgs;
use super::scene::SceneArgs;
use super::sized;
use crate::Error;
use crate::case_file::CaseArgs;

/// Name of the folder beside a case in which its prepared brake is kept.
const FOLDER: &str = ".squeal";

/// Where a command looks for the prepared brake of its case, and keeps it.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct PreparedArgs {
    /// File that squeal prepare wrote, in which the reduced brake of finite elements is looked for first
    #[arg(long, value_name = "FILE")]
    pub prepared: Option<PathBuf>,
    /// Neither read nor keep the reduced brake of finite elements in the folder .squeal beside the case
    #[arg(long)]
    pub no_cache: bool,
}

impl PreparedArgs {
    /// Where pieces of the brake of a case are.
    ///
    /// # Errors
    /// A file of pieces that cannot be read, or for a case that nothing is prepared of.
    pub(super) fn open(&self, case: &CaseFile) -> Result<Prepared, Error> {
        let CaseFile::FiniteElements(of) = case else {
            return match &self.prepared {
                Some(path) => Err(none_prepared("--prepared", path)),
                None => Ok(Prepared::default()),
            };
        };
        let prepared = Prepared::default();
        let prepared = if let Some(path) = &self.prepared { prepared.from_file(path)? } else { prepared };
        let beside = of.header.path.parent().unwrap_or(Path::new(""));
        Ok(if self.no_cache { prepared } else { prepared.in_folder(beside.join(FOLDER)) })
    }
}

/// Refusal to prepare what takes no time.
fn none_prepared(option: &'static str, value: &Path) -> Error {
    let allowed = "with cases of finite elements; others need no preparation".to_owned();
    Error::Option { option, value: value.display().to_string(), allowed }
}

/// Line on where a brake was read from and where it is kept; `None` where nothing was asked for.
pub(super) fn in_words(prepared: &Prepared, PreparedArgs { prepared: file, .. }: &PreparedArgs) -> Option<String> {
    let PreparedCounts { from_file, from_folder, made, damaged, not_kept } = prepared.counts();
    let (pieces, place) = (from_file + from_folder + made, |path: &Path| printable(&path.display().to_string()));
    let folder = prepared.folder().map(place);
    let mut parts = Vec::new();
    if let Some(file) = file {
        parts.push(format!("{from_file} of {pieces} pieces read from {}", place(file)));
    }
    if let Some(folder) = folder.as_ref().filter(|_| from_folder > 0) {
        parts.push(format!("{from_folder} of {pieces} pieces read from {folder}"));
    }
    let damaged = if damaged == 0 { String::new() } else { format!(", {damaged} in the place of damaged ones") };
    match (made, &folder, &not_kept) {
        (0, _, _) => {}
        (_, Some(folder), None) => parts.push(format!("{made} made and kept in {folder}{damaged}")),
        (_, Some(folder), Some(why)) => parts.push(format!("{made} made, which cannot be kept in {folder}: {why}")),
        (_, None, _) => parts.push(format!("{made} made")),
    }
    (!parts.is_empty()).then(|| format!("Prepared brake: {}", parts.join(", ")))
}

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
        let mut prepared = args.open(&case)?;
        if self.out.is_some() {
            prepared = prepared.collecting();
        }
        let first = |speed| SceneArgs::default().only(case.clone(), speed);
        for (case, purpose) in [
            (case.clone(), Purpose::Study),
            (case.clone(), Purpose::Screen),
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
