//! `squeal run`: the study of a case, from its file to tables and figures.

use std::io::Write;
use std::path::PathBuf;

use crate::brakes::{LatticeBrake, MatricesBrake};
use crate::case::{CaseFile, LatticeCase};
use crate::report::{Claim, Results, claims, claims_markdown, draw_occurrence};
use crate::study::UncertainBrake;
use crate::{Error, run_study};

/// More worker threads than any machine has cores for.
const MOST_THREADS: usize = 1024;

/// Run the study of a case: every draw in every scene, then tables and figures.
///
/// A run that was stopped, even killed, is continued by the same command; one that has finished, by a larger --samples.
#[derive(Debug, clap::Args)]
pub struct RunArgs {
    /// The case file (TOML); docs/case-files.md describes its fields
    pub case: PathBuf,
    /// Folder for the results: new, empty, or that of the same study
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Samples per scene, instead of the case's; more than the folder holds extend its study to as many
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub samples: Option<u64>,
    /// Seed of the random streams, instead of the case's
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub seed: Option<u64>,
    /// Worker threads [default: one per core]; the results do not depend on it
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub threads: Option<usize>,
}

/// Puts the options of the command line in place of a case's own samples and seed.
///
/// # Errors
/// Samples or threads out of range.
pub fn override_run(
    own: (&mut u64, &mut u64),
    samples: Option<u64>,
    seed: Option<u64>,
    threads: Option<usize>,
) -> Result<(), Error> {
    let refused = |option, value: String, most: u64| Error::Option { option, value, allowed: format!("1 to {most}") };
    if let Some(samples) = samples.filter(|samples| !(1..=LatticeCase::MOST_SAMPLES).contains(samples)) {
        return Err(refused("--samples", samples.to_string(), LatticeCase::MOST_SAMPLES));
    }
    if let Some(threads) = threads.filter(|threads| !(1..=MOST_THREADS).contains(threads)) {
        return Err(refused("--threads", threads.to_string(), MOST_THREADS as u64));
    }
    *own.0 = samples.unwrap_or(*own.0);
    *own.1 = seed.unwrap_or(*own.1);
    Ok(())
}

impl RunArgs {
    /// Runs the command; `out` gets a summary for people.
    ///
    /// # Errors
    /// One line for the user each.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        match CaseFile::read(&self.case)? {
            CaseFile::Lattice(mut case) => {
                override_run((&mut case.samples, &mut case.seed), self.samples, self.seed, self.threads)?;
                let brake = LatticeBrake::new(*case)?;
                self.run_brake(&brake, &|results| claims(results, &brake), out)
            }
            CaseFile::Matrices(mut case) => {
                override_run((&mut case.samples, &mut case.seed), self.samples, self.seed, self.threads)?;
                self.run_brake(&MatricesBrake::new(*case)?, &|_| Ok(Vec::new()), out)
            }
        }
    }

    /// Runs the study of a brake, with a scorecard of what a publication claims of it.
    fn run_brake<B: UncertainBrake>(
        &self,
        brake: &B,
        claims: &(dyn Fn(&Results<'_>) -> Result<Vec<Claim>, Error> + Sync),
        out: &mut dyn Write,
    ) -> Result<(), Error> {
        let mut scorecard = Vec::new();
        let manifest = run_study(brake, &self.out, self.threads, &mut |results, dir| {
            draw_occurrence(results, dir)?;
            scorecard = claims(results)?;
            Ok(())
        })?;
        let failed = |source| Error::Write { path: "standard output".into(), source };
        if !scorecard.is_empty() {
            writeln!(out, "{}", claims_markdown(&scorecard)).map_err(failed)?;
        }
        writeln!(
            out,
            "{} CEAs ({} solved, {} of them by a certificate of stability) in {:.2} s, {} failures; results in {}",
            manifest.analyses,
            manifest.solved,
            manifest.certified,
            manifest.seconds.samples,
            manifest.failures,
            self.out.display()
        )
        .map_err(failed)
    }
}
