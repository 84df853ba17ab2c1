//! `squeal check`: is the case valid, what would run, and how long would it take?

mod contact_points;
mod health;
mod names;

use std::io::Write;
use std::path::PathBuf;

use brakes::case::{CaseFile, FiniteElementCase, TakenMatrix};
use brakes::{CaseBrake, FiniteElementBrake, Part, Purpose};
use montecarlo::Progress;
use output::{bytes_in_words, in_words, printable};
use squeal::study::{Cost, UncertainBrake};
use squeal::{ExpectedTime, estimate};

use super::options::{MemoryArgs, override_run, samples};
use super::sized;
use crate::Error;
use crate::bar::{Bar, EVALUATED, PREPARED};
use crate::case_file::CaseArgs;

/// Longest preparation, s of processor time by its rate, that a check goes through to time some samples; chosen.
const LONGEST_PREPARATION: f64 = 300.0;

/// Check a case and say what its study would compute, and roughly how long that takes.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: squeal check brake.toml --shards 64")]
pub struct CheckArgs {
    /// The case
    #[command(flatten)]
    pub case: CaseArgs,
    /// Samples per scene, instead of the case's
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = samples)]
    pub samples: Option<u64>,
    /// Also what so many shards of the study take, and how much of that is done by each of them anew
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = shards)]
    pub shards: Option<u64>,
    /// Folder for contact.vtu and mesh.vtu, pictures for ParaView of the contact of finite elements: normal, sliding, gap and load of each pair
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Memory that may be taken
    #[command(flatten)]
    pub memory: MemoryArgs,
}

/// A number of shards.
fn shards(text: &str) -> Result<u64, String> {
    let allowed = || format!("allowed: a whole number, 1 to {}", u64::MAX);
    text.parse().ok().filter(|number| *number > 0).ok_or_else(allowed)
}

impl CheckArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// Faults of the case.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        let mut case = self.case.read()?;
        override_run(case.header_mut(), self.samples, None, None)?;
        // Said first, because a reduction of an unsound model may fail or take long; that the case is valid is not known before.
        if let Some(dir) = &self.out {
            let contact = if let CaseFile::FiniteElements(case) = &case { case.contact.as_ref() } else { None };
            if contact.is_none() {
                let (value, allowed) = (dir.display().to_string(), "cases of finite elements with a contact".into());
                return Err(Error::Option { option: "--out", value, allowed });
            }
        }
        let model = if let CaseFile::FiniteElements(case) = &case { Some(self.model(case)?) } else { None };
        out.write_all(model.unwrap_or_default().as_bytes()).map_err(Error::StandardOutput)?;
        let text = self.check(&sized::brake(case, Purpose::Analysis, self.memory.into(), &self.case.prepared)?)?;
        out.write_all(text.as_bytes()).map_err(Error::StandardOutput)
    }

    /// Lines on the study of a brake, which need not be one of a case file: what it computes and what it takes.
    ///
    /// # Errors
    /// As [`CheckArgs::run`].
    pub fn check<B: CaseBrake>(&self, brake: &B) -> Result<String, Error> {
        let plan = brake.plan();
        let (mut text, of_bases) = match brake.finite_elements() {
            Some(brake) => {
                let cost = brake.cost_of_bases();
                (reduction(brake), (cost.bytes, cost.seconds_on_all_cores()))
            }
            None => {
                let lines: String = brake.contents().iter().map(|(name, value)| line(name, value)).collect();
                let heading = format!("{}: valid\n\n{}", self.file(), line("study", &plan.name));
                (heading + &lines + &health::of_plan(plan)?, (0.0, 0.0))
            }
        };
        let analyses = plan.analyses_per_sample() * plan.samples;
        let solved = plan.scenes.len() as u64 * plan.samples;
        text += &line("samples", &format!("{} per scene, seed {}", plan.samples, plan.seed));
        text += &line("CEAs", &analyses.to_string());
        if solved < analyses {
            let classes = "one per symmetry class; laws without speed in them once for all speeds";
            text += &line("to be solved", &format!("{solved} ({classes})"));
        }
        text += &cost(brake, of_bases, self.shards)?;
        Ok(if brake.finite_elements().is_some() { text + &format!("\n{}: valid\n", self.file()) } else { text })
    }

    /// Lines on a finite element case: what it is made of, and whether its matrices are sound.
    fn model(&self, case: &FiniteElementCase) -> Result<String, Error> {
        let terms = listed(case.system.terms().iter().take(case.coefficients.len()).map(|term| term.name.clone()));
        let patches = case.contact.as_ref().map_or("none".into(), |contact| {
            listed(contact.patches.iter().map(|patch| format!("{} ({} pairs)", patch.name, patch.pairs.len())))
        });
        let mut text = line("study", &case.header.name);
        text += &line("dofs", &case.dofs.len().to_string());
        text += &line("terms", &terms);
        for (at, taken) in TakenMatrix::in_words(&case.files).iter().enumerate() {
            text += &line(if at == 0 { "files" } else { "" }, &printable(taken));
        }
        text += &line("patches", &patches);
        text += &line("constraints", &listed(case.constraints.iter().map(|set| set.name.clone())));
        text += &names::of(case);
        let checked = Bar::of("health checks");
        checked.begin(case.constraints.len() as u64, 0);
        for set in &case.constraints {
            text += &health::of_finite_elements(case, set)?;
            checked.advance(1);
        }
        checked.end();
        if let Some((dir, contact)) = self.out.as_ref().zip(case.contact.as_ref()) {
            text += &contact_points::write_pictures(case, contact, dir)?;
        }
        Ok(text)
    }

    fn file(&self) -> String {
        printable(&self.case.case.display().to_string())
    }
}

/// Lines on the reduction of a finite element brake, one for each set of constraints: columns, and comparison with the whole brake.
fn reduction(brake: &FiniteElementBrake) -> String {
    let plan = &brake.plan;
    let mut text = String::new();
    for (at, (set, name)) in brake.sets.iter().zip(&plan.labels.constraints).enumerate() {
        let parts: Vec<&Part> = brake.parts.iter().filter(|part| part.set == at).collect();
        let columns = parts.iter().map(|part| part.within.basis.ncols());
        let sum = |of: &dyn Fn(&Part) -> usize| parts.iter().map(|part| of(part)).sum::<usize>();
        let not_reached = sum(&|part| usize::from(!part.within.is_reached));
        let reached = if not_reached == 0 {
            String::new()
        } else {
            format!(" (the error asked for NOT reached by {not_reached})")
        };
        let (least, most) = (columns.clone().min().unwrap_or(0), columns.max().unwrap_or(0));
        let size = if least == most { most.to_string() } else { format!("{least} to {most}") };
        let found = format!(
            "{name}: {} columns for all arrangements, {} within them of {size}{reached}; {} modes found missing on the way; at the medians {} of {} \
             modes of the whole brake, within {:.1e}",
            set.basis.ncols(),
            if parts.len() == 1 { "a basis".to_owned() } else { format!("{} bases", parts.len()) },
            sum(&|part| part.within.missed.len()),
            set.compared.pairs.len(),
            set.compared.pairs.len() + set.compared.missed.len(),
            set.compared.distance
        );
        text += &line("reduction", &found);
    }
    text
}

fn line(name: &str, value: &str) -> String {
    format!("  {name:<13} {value}\n")
}

fn listed(items: impl Iterator<Item = String>) -> String {
    items.collect::<Vec<_>>().join(", ")
}

/// Cost of a study in two lines: memory and preparation by their rates, the time in all by some samples, unless the preparation alone
/// takes too long for a check.
fn cost<B: UncertainBrake>(
    brake: &B,
    (bytes_of_bases, bases): (f64, f64),
    shards: Option<u64>,
) -> Result<String, Error> {
    let cost = Cost::of(brake.plan());
    let mut of_shards = String::new();
    let seconds = match cost.seconds {
        long if long > LONGEST_PREPARATION => {
            format!("more than {}: not measured, its preparation alone takes that", in_words(long))
        }
        _ => {
            let expected = estimate(brake, &Bar::of(PREPARED), &Bar::of(EVALUATED))?;
            if let Some(shards) = shards {
                of_shards = line("shards", &shards_in_words(shards, bases, &expected));
            }
            format!("roughly {} on this machine", in_words(expected.total().as_secs_f64() + bases))
        }
    };
    Ok(line("memory", &format!("roughly {}", bytes_in_words(cost.bytes + bytes_of_bases)))
        + &line("time", &seconds)
        + &of_shards)
}

/// Cost of each of some shards, and which part of all their time is preparation that one run would do once.
fn shards_in_words(shards: u64, bases: f64, expected: &ExpectedTime) -> String {
    let (preparation, samples) = (expected.preparation.as_secs_f64() + bases, expected.samples.as_secs_f64());
    let lost = (shards - 1) as f64 * preparation / (shards as f64 * preparation + samples);
    format!(
        "{shards}: each {} of preparation and {} of samples, {:.0} % lost",
        in_words(preparation),
        in_words(samples / shards as f64),
        100.0 * lost
    )
}
