//! `squeal merge`: a study from the parts that `squeal run --shard` has sampled.

use std::io::Write;
use std::path::PathBuf;

use brakes::Purpose;
use squeal::parts::{completed, consistent, whole};

use super::cycle::has_motion;
use super::options::{MachineArgs, number, override_run, samples};
use super::run::RunArgs;
use super::sized;
use crate::Error;
use crate::bar::Bars;
use crate::case_file::CaseArgs;
use crate::terminal::note;

/// Put the shards of a study together: the same tables, figures and page as those of one run, byte for byte.
///
/// Parts are folders of `squeal run --shard`, in any order; a part that is there twice counts once. What is missing is said.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: squeal run brake.toml --shard 1/2 --out parts/1; squeal run brake.toml --shard 2/2 --out parts/2; squeal merge brake.toml parts/1 parts/2 --out results"
)]
pub struct MergeArgs {
    /// The case
    #[command(flatten)]
    pub case: CaseArgs,
    /// Folders of the parts
    #[arg(required = true, value_name = "PART")]
    pub parts: Vec<PathBuf>,
    /// Folder for the results: new, empty, or that of the same study
    #[arg(long, value_name = "DIR", required_unless_present = "check")]
    pub out: Option<PathBuf>,
    /// Only say what the parts hold, whether they belong together and which samples no part has
    #[arg(long, conflicts_with_all = ["out", "half_width", "cycles", "every_mode", "parquet", "json"])]
    pub check: bool,
    /// Also every occurrence to this half width at 95 %, by the cheapest estimator, in estimates.csv
    #[arg(long, value_name = "H", allow_negative_numbers = true, value_parser = number)]
    pub half_width: Option<f64>,
    /// Also every mode of every sample, stable ones too, in every_mode.csv: a whole spectrum each, for surrogates
    #[arg(long)]
    pub every_mode: bool,
    /// Also samples.parquet, unstable_modes.parquet and every_mode.parquet, of parts that keep their samples and --every-mode, beside the CSV
    #[arg(long)]
    pub parquet: bool,
    /// Also the motion from each unstable mode of the first K unstable samples of each scene, in cycles_of_draws.csv; docs/cycles.md
    #[arg(long, value_name = "K", allow_negative_numbers = true, value_parser = samples)]
    pub cycles: Option<u64>,
    /// Let parts of other programs, and of processors that round differently, pass; manifest.json lists what made them
    #[arg(long)]
    pub mixed: bool,
    /// JSON for machines: how often what is unstable, with limits, and the manifest
    #[arg(long)]
    pub json: bool,
    /// Threads and memory
    #[command(flatten)]
    pub machine: MachineArgs,
}

impl MergeArgs {
    /// Runs the command; `out` gets a summary for people.
    ///
    /// # Errors
    /// One line for the user each.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        if self.case.case.is_dir() {
            let (option, value) = ("CASE", self.case.case.display().to_string());
            return Err(Error::Option {
                option,
                value,
                allowed: "a case file, and then the folders of its parts".into(),
            });
        }
        let mut case = self.case.read()?;
        if self.check {
            return self.say(out);
        }
        if let Some(draws) = self.cycles {
            has_motion(&case, "--cycles", &draws.to_string())?;
        }
        // Parts that are not complete are refused before anything large is made.
        let parts = self.parts.iter().map(|part| completed(part)).collect::<Result<Vec<_>, _>>()?;
        consistent(&self.parts, &parts, self.mixed)?;
        // The study has the seed of its parts, and as many samples as the longest of them is a part of.
        let samples = parts.iter().map(|part| part.of).max();
        let seed = parts.first().map(|part| part.seed);
        if let Some(seed) = seed.filter(|seed| *seed != case.header().seed) {
            note(&format!(
                "the seed is {seed}, that of the parts; {} says {}",
                self.case.case.display(),
                case.header().seed
            ));
        }
        override_run(case.header_mut(), samples, seed, self.machine.threads)?;
        let run = RunArgs {
            case: self.case.clone(),
            out: self.out.clone().unwrap_or_default(),
            samples: None,
            seed: None,
            half_width: self.half_width.or(case.header().half_width),
            until_half_width: None,
            keep_samples: parts.iter().any(|part| part.identity.contains(" samples=kept")),
            cycles: self.cycles,
            every_mode: self.every_mode,
            parquet: self.parquet,
            shard: None,
            from: 0,
            json: self.json,
            machine: self.machine,
        };
        let brake = sized::brake(case, Purpose::Study, self.machine, &self.case.prepared)?;
        run.study(&brake, run.half_width, Some((&self.parts, self.mixed)), &Bars, out)
    }

    /// Says of each part what it holds.
    ///
    /// # Errors
    /// A part that is not complete, parts that do not belong together, samples that no part has: the same as a merge of these parts.
    fn say(&self, out: &mut dyn Write) -> Result<(), Error> {
        let (mut complete, mut first) = (Vec::new(), None);
        for part in &self.parts {
            match completed(part) {
                Ok(found) => {
                    let shard =
                        found.shard.map_or_else(String::new, |shard| format!(", shard {}/{}", shard.number, shard.of));
                    writeln!(
                        out,
                        "{}: samples {}..{} of {}{shard}, complete; {}, {}",
                        part.display(),
                        found.from,
                        found.to,
                        found.of,
                        found.maker(),
                        found.rounding
                    )
                    .map_err(Error::StandardOutput)?;
                    complete.push(found);
                }
                Err(error) => {
                    writeln!(out, "{error}").map_err(Error::StandardOutput)?;
                    first.get_or_insert(error);
                }
            }
        }
        // A merge refuses a part that is not complete, whatever the others have.
        if let Some(error) = first {
            whole(&complete)?;
            return Err(error.into());
        }
        consistent(&self.parts, &complete, self.mixed)?;
        writeln!(out, "all samples are there").map_err(Error::StandardOutput)
    }
}
