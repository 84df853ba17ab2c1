//! `squeal compare`: by how much each mode is unstable more or less often in one study than in another.

use std::io::Write;
use std::path::PathBuf;

use output::write;
use report::{compare_figure, write_compare_page};
use squeal::compare::compare;
use squeal::folder::RunFolder;

use super::results_folder;
use crate::Error;

/// Compare studies with the first of them: differences of the occurrence of each mode, with intervals.
///
/// Studies of one seed that kept their samples are compared sample by sample. Modes are linked by their shapes, or by their frequencies
/// where the shapes have not their degrees of freedom in common.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: squeal run brake.toml --keep-samples --out as-is; squeal run brake.toml --set mu=0.6 --keep-samples \
                  --out with-shim; squeal compare as-is with-shim"
)]
pub struct CompareArgs {
    /// Folders of `squeal run`, at least two
    #[arg(required = true, num_args = 2.., value_name = "DIR")]
    pub studies: Vec<PathBuf>,
    /// Folder for report.html, the figure, compare.csv and summary.md: new, empty, or that of the same comparison
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// JSON for machines: the rows of the table
    #[arg(long)]
    pub json: bool,
}

impl CompareArgs {
    /// Runs the command; `out` gets the differences in words.
    ///
    /// # Errors
    /// Folders that cannot be compared.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        let found = compare(&self.studies)?;
        let (table, text) = (found.table(), found.text());
        if let Some(dir) = &self.out {
            let folder = RunFolder::take(dir, &found.identity)?;
            let figure = compare_figure(&found)?;
            folder.publish(|stage| -> Result<(), Error> {
                table.write(stage)?;
                if let Some(figure) = &figure {
                    figure.save_pictures(stage, "compare")?;
                }
                write_compare_page(&found, figure.as_ref(), stage)?;
                Ok(write(&stage.join("summary.md"), found.summary().as_bytes())?)
            })?;
        }
        let place = results_folder::place(self.out.as_deref());
        let said = if self.json { format!("{:#}\n", table.json()) } else { format!("{text}{}", place_line(&place)) };
        out.write_all(said.as_bytes()).map_err(Error::StandardOutput)
    }
}

/// The place of the results as a line of its own.
fn place_line(place: &str) -> String {
    place.strip_prefix("; ").map_or_else(String::new, |place| format!("{place}\n"))
}
