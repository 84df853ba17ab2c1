//! `squeal run`: the study of a case, from its file to tables and figures.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use brakes::case::{HALF_WIDTHS, is_half_width};
use brakes::{CaseBrake, Purpose};
use output::{OutputError, printable};
use report::{draw_damping, draw_motions, draw_occurrence, write_page};
use serde_json::{Value, json};
use squeal::cycles::{CycleOptions, CyclesOfDraws, check_contacts_of_draws};
use squeal::influence::write_kept_samples;
use squeal::parts::{Shard, merge_parts, run_part};
use squeal::results::{Estimates, Results, Stopped};
use squeal::study::{DivergenceCounts, FullChecks, Study};
use squeal::{RunOptions, RunProgress, run_study_with};

use super::cycle::has_motion;
use super::mesh_shapes::{geometry, write_mesh_shapes};
use super::options::{MachineArgs, number, override_run, samples, whole_number};
use super::parquet::{self, write_parquet};
use super::reduction::write_reduction;
use super::sized;
use crate::Error;
use crate::bar::{Bars, EVALUATED, PREPARED, REASONS, RunBars, Stages};
use crate::case_file::CaseArgs;

/// Panels whose occurrences are printed; more are for the tables. Chosen: a screen of lines.
const SUMMARISED_PANELS: usize = 4;

/// Run the study of a case: every draw in every scene, then tables and figures.
///
/// A run that was stopped, even killed, is continued by the same command; one that has finished, by a larger --samples.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: squeal run brake.toml --set mu=0.6 --samples 500 --out results")]
pub struct RunArgs {
    /// The case
    #[command(flatten)]
    pub case: CaseArgs,
    /// Folder for the results: new, empty, or that of the same study
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Samples per scene, instead of the case's; more than the folder holds extend its study to as many
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = samples)]
    pub samples: Option<u64>,
    /// Seed of the random streams, instead of the case's
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = whole_number)]
    pub seed: Option<u64>,
    /// Also every occurrence to this half width at 95 %, by the cheapest estimator, in estimates.csv
    #[arg(long, value_name = "H", allow_negative_numbers = true, value_parser = number)]
    pub half_width: Option<f64>,
    /// As many samples as it takes until every occurrence is known to this half width at 95 %, looks on the way accounted for
    #[arg(long, value_name = "H", allow_negative_numbers = true, value_parser = number, conflicts_with = "samples")]
    pub until_half_width: Option<f64>,
    /// Keep the samples: samples.csv has what was drawn and what grew, influence.csv which input makes squeal vary
    #[arg(long)]
    pub keep_samples: bool,
    /// Also every mode of every sample, stable ones too, in every_mode.csv: a whole spectrum each, for surrogates
    #[arg(long)]
    pub every_mode: bool,
    /// Also samples.parquet, unstable_modes.parquet and every_mode.parquet, of --keep-samples and --every-mode, beside the CSV
    #[arg(long, conflicts_with = "shard")]
    pub parquet: bool,
    /// Also the motion from each unstable mode of the first K unstable samples of each scene, in cycles_of_draws.csv; docs/cycles.md
    #[arg(long, value_name = "K", allow_negative_numbers = true, value_parser = samples)]
    pub cycles: Option<u64>,
    /// Only part I of N of the samples, from 1, into a folder of its own, for `squeal merge`; docs/clusters.md
    #[arg(long, value_name = "I/N", value_parser = shard, conflicts_with_all = ["half_width", "until_half_width", "cycles", "every_mode", "json"])]
    pub shard: Option<(u64, u64)>,
    /// With --shard: the first sample of all parts, where those before it are in parts already
    #[arg(long, value_name = "K", default_value_t = 0, requires = "shard", value_parser = whole_number)]
    pub from: u64,
    /// JSON for machines: how often what is unstable, with limits, and the manifest
    #[arg(long)]
    pub json: bool,
    /// Threads and memory
    #[command(flatten)]
    pub machine: MachineArgs,
}

/// `I/N`.
fn shard(text: &str) -> Result<(u64, u64), String> {
    let parts = || {
        let (number, of) = text.split_once('/')?;
        Some((number.parse().ok()?, of.parse().ok()?))
    };
    parts()
        .filter(|(number, of)| (1..=*of).contains(number))
        .ok_or_else(|| "allowed: I/N with I from 1 to N, as 3/8".into())
}

impl RunArgs {
    /// Runs the command; `out` gets a summary for people.
    ///
    /// # Errors
    /// One line for the user each.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        let (begin, mut case) = (Instant::now(), self.case.read()?);
        override_run(case.header_mut(), self.samples, self.seed, self.machine.threads)?;
        let half_width = self.half_width.or(case.header().half_width);
        if let Some(draws) = self.cycles {
            has_motion(&case, "--cycles", &draws.to_string())?;
        }
        if self.shard.is_some() {
            // A part has no report: what draws of the full model say belongs to the whole.
            return self.part(&sized::brake(case, Purpose::Study, self.machine, &self.case.prepared)?, out);
        }
        let brake = sized::brake(case, Purpose::Study, self.machine, &self.case.prepared)?;
        let found = self.run_brake(&brake, half_width, out).and_then(|()| sized::trusted(&brake, &self.out));
        if !self.json && matches!(found, Ok(()) | Err(Error::MostFailed { .. } | Error::NotTheWholeBrake { .. })) {
            let all = begin.elapsed().as_secs_f64();
            writeln!(out, "{all:.2} s in all, with preparation and report").map_err(Error::StandardOutput)?;
        }
        found
    }

    /// The complaint about a study of which more than half has failed: its results are written, but of the other half.
    fn most_failed(&self, results: &Results) -> Option<Error> {
        let (failures, scenes) = (&results.summary.failures, results.plan().scenes.len() as u64);
        let failed = failures.draws() * scenes + failures.by_scene().iter().sum::<u64>();
        let evaluations = results.summary.samples * scenes;
        let first = failures.listed().first()?.message.clone();
        (2 * failed > evaluations).then(|| Error::MostFailed { path: self.out.clone(), failed, evaluations, first })
    }

    /// Samples a part of the study of a brake.
    fn part<B: CaseBrake>(&self, brake: &B, out: &mut dyn Write) -> Result<(), Error> {
        let Some((number, of)) = self.shard else { return Ok(()) };
        let bars = RunBars::default();
        let options = RunOptions::default().with_threads(self.machine.threads).with_progress(bars.progress());
        let shard = Shard { number, of, from: self.from };
        let done = run_part(brake, shard, &self.out, options.keeping_samples(self.keep_samples))?;
        writeln!(
            out,
            "samples {}..{} of {}: {} evaluations in {:.2} s, {} failures; part {number} of {of} is complete in {}",
            done.from,
            done.to,
            done.of,
            done.evaluations,
            done.seconds,
            done.failures,
            printable(&self.out.display().to_string())
        )
        .map_err(Error::StandardOutput)
    }

    /// Runs the study of a brake, which need not be one of a case file.
    ///
    /// # Errors
    /// As [`RunArgs::run`].
    pub fn run_brake<B: CaseBrake>(
        &self,
        brake: &B,
        half_width: Option<f64>,
        out: &mut dyn Write,
    ) -> Result<(), Error> {
        self.study(brake, half_width, None, &Bars, out)
    }

    /// Runs the study of a brake, or puts it together from parts, mixed ones or not; the receiver of its progress can end it.
    ///
    /// # Errors
    /// As [`RunArgs::run`].
    pub fn study<B: CaseBrake>(
        &self,
        brake: &B,
        half_width: Option<f64>,
        parts: Option<(&[PathBuf], bool)>,
        told: &dyn Stages,
        out: &mut dyn Write,
    ) -> Result<(), Error> {
        for (option, given) in [("--half-width", half_width), ("--until-half-width", self.until_half_width)] {
            if let Some(half_width) = given.filter(|half_width| !is_half_width(*half_width)) {
                let (value, allowed) = (half_width.to_string(), HALF_WIDTHS.to_owned());
                return Err(Error::Option { option, value, allowed });
            }
        }
        if self.parquet && !(self.keep_samples || self.every_mode) {
            let (value, allowed) =
                ("no table".to_owned(), "with --keep-samples or --every-mode, whose tables it is of");
            return Err(Error::Option { option: "--parquet", value, allowed: allowed.into() });
        }
        if self.every_mode {
            squeal::check_real(brake, squeal::EVERY_MODE)?;
        }
        let stick = CycleOptions::default().stick;
        if self.cycles.is_some() {
            check_contacts_of_draws(brake, stick)?;
        }
        let (mut summary, mut estimates) = (String::new(), String::new());
        let mut document = Value::Null;
        let mut doubts = String::new();
        let mut most_failed = None;
        let (preparation, evaluation, reasons) = (told.stage(PREPARED), told.stage(EVALUATED), told.stage(REASONS));
        let progress = RunProgress { preparation: &*preparation, evaluation: &*evaluation, reasons: &*reasons };
        let options = RunOptions::default().with_threads(self.machine.threads).with_progress(progress);
        let options = options.until_half_width(self.until_half_width).keeping_samples(self.keep_samples);
        let mut draw = |study: &Study<'_, B>, results: &Results, dir: &Path| -> Result<(), Error> {
            remove_outdated(&self.out, results.summary.samples)?;
            draw_occurrence(results, dir)?;
            draw_damping(results, dir)?;
            write_kept_samples(brake, &results.summary, dir)?;
            if let Some(brake) = brake.finite_elements() {
                write_reduction(brake, dir)?;
                write_mesh_shapes(brake, results, dir)?;
            }
            if let Some(half_width) = half_width {
                estimates =
                    Estimates::run(study, results, half_width, &self.out, dir, &*told.stage("scenes estimated"))?
                        .text();
            }
            if self.every_mode {
                let told = told.stage("samples whose every mode is written");
                squeal::write_every_mode(study, results.summary.samples, dir, &*told)?;
            }
            if self.parquet {
                write_parquet(dir)?;
            }
            let mut motions = None;
            if let Some(draws) = self.cycles {
                let asked = (draws, stick);
                let progress = &*told.stage("draws whose motion is followed");
                let found = CyclesOfDraws::run(study, &results.summary, asked, &self.out, dir, progress)?;
                results.note(found.note(stick));
                draw_motions(results, &found, dir)?;
                found.add_to_summary(study.plan(), dir)?;
                estimates += &found.text(study.plan());
                motions = Some(found);
            }
            // Last: it shows the tables.
            write_page(results, motions.as_ref(), &geometry(brake), dir)?;
            most_failed = self.most_failed(results);
            if self.json {
                document = results.json()?;
            }
            doubts = results.doubts().iter().map(|doubt| format!("WARNING: {doubt}\n")).collect();
            summary = match results.panels().len() {
                0..=SUMMARISED_PANELS => results.text()?,
                _ => results.in_short(),
            };
            summary += &results.measured_text()?;
            Ok(())
        };
        let manifest = match parts {
            None => run_study_with(brake, &self.out, options, &mut draw)?,
            Some((parts, mixed)) => merge_parts(brake, parts, mixed, &self.out, options, &mut draw)?,
        };
        let found = match (most_failed, &manifest.full_checks) {
            (Some(failed), _) => Err(failed),
            (None, Some(checks)) if checks.has_other_modes() => Err(Error::NotTheWholeBrake { path: self.out.clone() }),
            (None, _) => Ok(()),
        };
        if self.json {
            document["folder"] = json!(self.out.display().to_string());
            document["manifest"] = json!(manifest);
            writeln!(out, "{document:#}").map_err(Error::StandardOutput)?;
            return found;
        }
        write!(out, "{doubts}").map_err(Error::StandardOutput)?;
        let checked = manifest.full_checks.as_ref().map_or_else(String::new, checks_in_words);
        let stopped = manifest.stopped.as_ref().map_or_else(String::new, |stopped| in_words(stopped, manifest.samples));
        writeln!(
            out,
            "{summary}{estimates}{checked}{stopped}{} CEAs ({} solved, {} of them by a certificate of stability) in {:.2} s, {} failures; results in {}",
            manifest.analyses,
            manifest.solved,
            manifest.certified,
            manifest.seconds.samples,
            manifest.failures,
            printable(&self.out.display().to_string())
        )
        .map_err(Error::StandardOutput)?;
        found
    }
}

/// Removes the tables of samples that an option has made, where they are of another number of samples than the study has now: who extends it without
/// the option would find them beside its other tables.
fn remove_outdated(folder: &Path, samples: u64) -> Result<(), Error> {
    let manifest = std::fs::read(folder.join("manifest.json")).ok();
    let before = manifest.and_then(|text| serde_json::from_slice::<Value>(&text).ok()?["samples"].as_u64());
    if before.is_some_and(|before| before != samples) {
        let of_options = parquet::files().chain(["every_mode.csv".to_owned()]);
        for path in of_options.map(|name| folder.join(name)).filter(|path| path.exists()) {
            std::fs::remove_file(&path).map_err(|source| OutputError::Write { path, source })?;
        }
    }
    Ok(())
}

/// Line on the draws of the whole brake: how far the reduced one agrees with it.
fn checks_in_words(found: &FullChecks) -> String {
    let FullChecks { samples, failed, modes, missing, invented, other_verdicts, largest_distance, trained_on, .. } =
        found;
    let divergence = match found.divergence_where(|_| true) {
        DivergenceCounts { diverging: 0, open: open @ 1.., .. } => format!("whether {open} diverge could not be told"),
        DivergenceCounts { diverging: 0, .. } => "none diverges (samples are not looked at for that)".to_owned(),
        found @ DivergenceCounts { diverging, open, .. } => {
            let open = if open == 0 { String::new() } else { format!(", of {open} it could not be told") };
            format!("{diverging} DIVERGE, {}{open}", found.growth_in_words())
        }
    };
    let failed = if *failed == 0 { String::new() } else { format!(" ({failed} failed, as samples do)") };
    let trained = if *trained_on == 0 { String::new() } else { format!(", after training on {trained_on} times") };
    format!(
        "{samples} draws with the whole brake{failed}: {modes} modes in the band, {missing} missing and {invented} invented by the reduced one, \
         {other_verdicts} with another verdict, eigenvalues within {largest_distance:.1e}{trained}; {divergence}\n"
    )
}

/// Line on where a run stopped.
fn in_words(stopped: &Stopped, samples: u64) -> String {
    let Stopped { half_width, reached, look, looks } = *stopped;
    let verb = if reached <= half_width { "is within" } else { "is NOT within" };
    format!(
        "{samples} samples, look {look} of {looks}: every occurrence {verb} {half_width} of the truth ({reached:.2e}), at 95 % for each, \
         the looks accounted for, with what failures and open verdicts leave open and without what open names do\n"
    )
}
