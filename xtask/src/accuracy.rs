//! How right the answers are, and at what price.

use std::path::{Path, PathBuf};

use squeal::accuracy::{AccuracyError, Effort, accuracy};
use squeal::case::Case;

/// Accuracy against time: solver routes, estimators, the lattice at its worst, hard problems
#[derive(Debug, clap::Args)]
pub struct AccuracyArgs {
    /// A minute instead of some
    #[arg(long)]
    quick: bool,
    /// Folder for the results [default: target/accuracy]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Runs the task.
pub fn run(args: &AccuracyArgs) -> Result<(), AccuracyError> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let case = Case::read(&root.join("cases/paper.toml")).map_err(squeal::Error::from)?;
    let effort = if args.quick { Effort::quick() } else { Effort::full() };
    let report = accuracy(&case, &root.join("tests/fixtures/hard"), &effort)?;
    let out = args.out.clone().unwrap_or_else(|| root.join("target/accuracy"));
    report.save(&out)?;
    println!("{}", report.markdown());
    println!("Figures and data: {}", out.display());
    Ok(())
}
