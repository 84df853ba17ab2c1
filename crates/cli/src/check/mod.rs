//! `squeal check`: is the case valid, what would run, and how long would it take?

mod contact_points;
mod health;
mod lines;
mod names;

use std::io::Write;
use std::path::PathBuf;

use brakes::case::{Branch, CaseFile, FiniteElementCase, TableFunction, TakenMatrix};
use brakes::{CaseBrake, FiniteElementBrake, Part, Purpose};
use montecarlo::Progress;
use output::{bytes_in_words, in_words, printable};
use serde_json::{Value, json};
use squeal::study::{Cost, UncertainBrake};
use squeal::{ExpectedTime, expected_time};

use lines::Lines;

use super::options::{MemoryArgs, override_run, samples};
use super::sized;
use crate::Error;
use crate::bar::{Bar, EVALUATED, PREPARED};
use crate::case_file::CaseArgs;

/// Longest preparation, s of processor time by its rate, that a check goes through to time a few samples; chosen.
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
    /// JSON for machines
    #[arg(long)]
    pub json: bool,
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
        sized::fitting(&case, Purpose::Analysis, self.memory)?;
        let model = if let CaseFile::FiniteElements(case) = &case { self.model(case)? } else { Lines::default() };
        if !self.json {
            out.write_all(model.text().as_bytes()).map_err(Error::StandardOutput)?;
        }
        let brake = sized::brake(case, Purpose::Analysis, self.memory.into(), &self.case.prepared)?;
        sized::answer(out, &self.said(model, &brake)?, &brake, &self.case.case)
    }

    /// Lines on the study of a brake, which need not be one of a case file: what it computes and what it takes.
    ///
    /// # Errors
    /// As [`CheckArgs::run`].
    pub fn check<B: CaseBrake>(&self, brake: &B) -> Result<String, Error> {
        self.said(Lines::default(), brake)
    }

    /// Lines on the study of a brake; the JSON has those on its model too.
    fn said<B: CaseBrake>(&self, model: Lines, brake: &B) -> Result<String, Error> {
        let plan = brake.plan();
        let is_reduced = brake.finite_elements().is_some();
        let (mut lines, of_bases) = match brake.finite_elements() {
            Some(brake) => {
                let cost = brake.cost_of_bases(self.memory.budget());
                // Of a prepared brake each shard reads them.
                let is_prepared = self.case.prepared.prepared.is_some();
                (reduction(brake), (cost.bytes, if is_prepared { 0.0 } else { cost.seconds_on_all_cores() }))
            }
            None => {
                let mut lines = Lines::default();
                lines.add("study", &plan.name);
                brake.contents().into_iter().for_each(|(name, value)| lines.add(name, value));
                lines.extend(health::of_plan(plan)?);
                (lines, (0.0, 0.0))
            }
        };
        let analyses = plan.analyses_per_sample() * plan.samples;
        let solved = plan.scenes.len() as u64 * plan.samples;
        lines.add("samples", format!("{} per scene, seed {}", plan.samples, plan.seed));
        lines.add("CEAs", analyses.to_string());
        if solved < analyses {
            let classes = "one per symmetry class; laws without speed in them once for all speeds";
            lines.add("to be solved", format!("{solved} ({classes})"));
        }
        let cost = cost(brake, of_bases, self.shards)?;
        lines.extend(cost.lines);
        if self.json {
            let all = model.and(lines);
            let first = || plan.scenes.first().map_or(0, |scene| plan.brake(scene).dofs.total());
            let dofs = brake.finite_elements().map_or_else(first, |brake| brake.case.dofs.len());
            let document = json!({
                "case": self.case.case.display().to_string(),
                "study": plan.name,
                "dofs": dofs,
                "scenes": plan.scenes.len(),
                "samples": plan.samples,
                "seed": plan.seed,
                "analyses": analyses,
                "solved": solved,
                "memory_bytes": cost.bytes,
                "seconds": cost.seconds,
                "shards": cost.shards,
                "doubts": plan.doubts,
                "warnings": all.warnings(),
                "lines": all.json(),
            });
            return Ok(format!("{document:#}\n"));
        }
        let valid = format!("{}: valid\n", self.file());
        Ok(if is_reduced { format!("{}\n{valid}", lines.text()) } else { format!("{valid}\n{}", lines.text()) })
    }

    /// Lines on a finite element case: what it is made of, and whether its matrices are sound.
    fn model(&self, case: &FiniteElementCase) -> Result<Lines, Error> {
        let terms = listed(case.system.terms().iter().take(case.coefficients.len()).map(|term| term.name.clone()));
        let patches = case.contact.as_ref().map_or("none".into(), |contact| {
            listed(contact.patches.iter().map(|patch| format!("{} ({} pairs)", patch.name, patch.pairs.len())))
        });
        let mut lines = Lines::default();
        lines.add("study", &case.header.name);
        lines.add("dofs", case.dofs.len().to_string());
        lines.add("terms", terms);
        for (at, taken) in TakenMatrix::in_words(&case.files).iter().enumerate() {
            lines.add(if at == 0 { "files" } else { "" }, printable(taken));
        }
        if !case.branches.is_empty() {
            let named = |branch: &Branch| branch.in_words(&case.system.terms()[branch.term].name);
            lines.add("viscoelastic", listed(case.branches.iter().map(named)));
        }
        TableFunction::in_words(&case.tables).into_iter().for_each(|words| lines.add("tables", words));
        lines.add("patches", patches);
        lines.add("constraints", listed(case.constraints.iter().map(|set| set.name.clone())));
        lines.extend(names::of(case));
        let checked = Bar::of("health checks");
        checked.begin(case.constraints.len() as u64, 0);
        for set in &case.constraints {
            lines.extend(health::of_finite_elements(case, set)?);
            checked.advance(1);
        }
        checked.end();
        if let Some((dir, contact)) = self.out.as_ref().zip(case.contact.as_ref()) {
            lines.extend(contact_points::write_pictures(case, contact, dir)?);
        }
        Ok(lines)
    }

    fn file(&self) -> String {
        printable(&self.case.case.display().to_string())
    }
}

/// Lines on the reduction of a finite element brake, one for each set of constraints: columns, and comparison with the whole brake.
fn reduction(brake: &FiniteElementBrake) -> Lines {
    let plan = &brake.plan;
    let mut lines = Lines::default();
    for (at, (set, name)) in brake.sets.iter().zip(&plan.labels.constraints).enumerate() {
        let parts: Vec<&Part> = brake.parts.iter().filter(|part| part.set == at).collect();
        let columns = parts.iter().map(|part| part.within.basis.ncols());
        let sum = |of: &dyn Fn(&Part) -> usize| parts.iter().map(|part| of(part)).sum::<usize>();
        let (least, most) = (columns.clone().min().unwrap_or(0), columns.max().unwrap_or(0));
        let size = if least == most { most.to_string() } else { format!("{least} to {most}") };
        let invented = match set.invented(&brake.case) {
            0 => String::new(),
            count => format!("; {count} modes that the whole brake does NOT HAVE"),
        };
        let found = format!(
            "{name}: {} columns for all arrangements, {} within them of {size}; {} modes found missing on the way; at the medians {} of {} \
             modes of the whole brake, within {:.1e}{invented}",
            set.basis.ncols(),
            if parts.len() == 1 { "a basis".to_owned() } else { format!("{} bases", parts.len()) },
            sum(&|part| part.within.missed.len()),
            set.compared.pairs.len(),
            set.compared.pairs.len() + set.compared.missed.len(),
            set.compared.distance
        );
        lines.add("reduction", found);
    }
    lines
}

fn listed(items: impl Iterator<Item = String>) -> String {
    items.collect::<Vec<_>>().join(", ")
}

/// Cost of a study.
struct CostFound {
    lines: Lines,
    /// Memory, bytes.
    bytes: f64,
    /// Time in all on this machine, s, where it was measured.
    seconds: Option<f64>,
    /// Cost of shards, where it was asked for and measured.
    shards: Option<Value>,
}

/// Cost of a study: memory and preparation by their rates, the time in all by a few samples, unless the preparation alone takes too long for a
/// check.
fn cost<B: UncertainBrake>(
    brake: &B,
    (bytes_of_bases, bases): (f64, f64),
    shards: Option<u64>,
) -> Result<CostFound, Error> {
    let cost = Cost::of(brake.plan());
    let bytes = cost.bytes + bytes_of_bases;
    let mut found = CostFound { lines: Lines::default(), bytes, seconds: None, shards: None };
    found.lines.add("memory", format!("roughly {}", bytes_in_words(bytes)));
    if cost.seconds > LONGEST_PREPARATION {
        let longer = format!("more than {}: not measured, its preparation alone takes that", in_words(cost.seconds));
        found.lines.add("time", longer);
        return Ok(found);
    }
    let expected = expected_time(brake, &Bar::of(PREPARED), &Bar::of(EVALUATED))?;
    let seconds = expected.total().as_secs_f64() + bases;
    found.lines.add("time", format!("roughly {} on this machine", in_words(seconds)));
    found.seconds = Some(seconds);
    if let Some(shards) = shards {
        let (words, numbers) = of_shards(shards, bases, &expected);
        found.lines.add("shards", words);
        found.shards = Some(numbers);
    }
    Ok(found)
}

/// Cost of each of `shards` shards, and which part of all their time is preparation that one run would do once: in words, and as JSON.
fn of_shards(shards: u64, bases: f64, expected: &ExpectedTime) -> (String, Value) {
    let (preparation, samples) = (expected.preparation.as_secs_f64() + bases, expected.samples.as_secs_f64());
    let lost = (shards - 1) as f64 * preparation / (shards as f64 * preparation + samples);
    let of_each = samples / shards as f64;
    let words = format!(
        "{shards}: each {} of preparation and {} of samples, {:.0} % lost",
        in_words(preparation),
        in_words(of_each),
        100.0 * lost
    );
    let numbers =
        json!({ "number": shards, "preparation_seconds": preparation, "samples_seconds": of_each, "lost": lost });
    (words, numbers)
}
