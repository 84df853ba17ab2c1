//! `cargo xtask accuracy`: accuracy and cost of solvers and estimators.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use brakes::case::LatticeCase;
use squeal_cli::terminal::say;
use validation::{Effort, accuracy};

use crate::again::run_again;
use crate::error::TaskError;

/// Accuracy against time: solver routes, estimators, stress cases of the lattice, NLEVP and BrakeSqueal problems
///
/// LAPACK's dgeev and dggev take part with --features lapack: the system's OpenBLAS (libopenblas-dev).
#[derive(Debug, clap::Args)]
pub struct AccuracyArgs {
    /// Build with these features first: lapack
    #[arg(long, value_name = "LIST")]
    features: Option<String>,
    /// Measure less, in about a minute
    #[arg(long)]
    quick: bool,
    /// Folder for the results [default: target/accuracy]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl AccuracyArgs {
    /// The task and its options, without `--features`.
    fn words(&self) -> Vec<OsString> {
        let mut words = vec!["accuracy".into()];
        words.extend(self.quick.then(|| "--quick".into()));
        words.extend(self.out.iter().flat_map(|path| ["--out".into(), path.into()]));
        words
    }
}

/// Runs the task.
pub fn run(args: &AccuracyArgs) -> Result<(), TaskError> {
    run_again(args.features.as_deref(), &args.words())?;
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let case = LatticeCase::read(&root.join("cases/paper.toml")).map_err(brakes::Error::from)?;
    let effort = if args.quick { Effort::quick() } else { Effort::full() };
    let report = accuracy(&case, &root.join("tests/fixtures/hard"), &effort)?;
    let out = args.out.clone().unwrap_or_else(|| root.join("target/accuracy"));
    report.save(&out)?;
    say(&format!("{}\nFigures and data: {}\n", report.markdown(), out.display()))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_options_but_features_are_told_again() {
        let args = AccuracyArgs { features: Some("lapack".into()), quick: true, out: Some("a b".into()) };
        assert_eq!(args.words(), ["accuracy", "--quick", "--out", "a b"]);
    }
}
