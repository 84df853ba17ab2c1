//! `squeal check`: is the case valid, what would run, and how long would it take?

mod health;
mod names;

use std::io::Write;
use std::path::PathBuf;

use brakes::case::{CaseFile, FiniteElementCase, TakenMatrix};
use brakes::{FiniteElementBrake, LatticeBrake, MatricesBrake, Part};
use montecarlo::Progress;
use output::{bytes_in_words, in_words, printable};
use squeal::estimate;
use squeal::study::{Cost, UncertainBrake};

use super::options::{MemoryArgs, override_run, whole_number};
use super::sized;
use crate::Error;
use crate::bar::{Bar, EVALUATED, PREPARED};
use crate::case_file;

/// Longest preparation, s of processor time by its rate, that a check goes through to time some samples; chosen.
const LONGEST_PREPARATION: f64 = 300.0;

/// Check a case and say what its study would compute, and roughly how long that takes.
#[derive(Debug, clap::Args)]
pub struct CheckArgs {
    /// The case file (TOML)
    pub case: PathBuf,
    /// Samples per scene, instead of the case's
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole_number)]
    pub samples: Option<u64>,
    /// Memory that may be taken
    #[command(flatten)]
    pub memory: MemoryArgs,
}

impl CheckArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// What is wrong with the case.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        let text = match case_file::read(&self.case)? {
            CaseFile::Lattice(mut case) => {
                override_run((&mut case.samples, &mut case.seed), self.samples, None, None)?;
                self.lattice(&sized::lattice(*case, self.memory)?)?
            }
            CaseFile::Matrices(mut case) => {
                override_run((&mut case.samples, &mut case.seed), self.samples, None, None)?;
                self.matrices(&sized::matrices(*case, self.memory)?)?
            }
            CaseFile::FiniteElements(mut case) => {
                override_run((&mut case.samples, &mut case.seed), self.samples, None, None)?;
                // Said first, because a reduction of an unsound model may fail or take long; that the case is valid is not known before.
                let model = self.model(&case)?;
                out.write_all(model.as_bytes()).map_err(Error::StandardOutput)?;
                finite_elements(*case, self.memory)? + &format!("\n{}: valid\n", self.file())
            }
        };
        out.write_all(text.as_bytes()).map_err(Error::StandardOutput)
    }

    fn lattice(&self, brake: &LatticeBrake) -> Result<String, Error> {
        let (case, plan) = (&brake.case, &brake.plan);
        let grid = case.lattice.grid;
        let mut text = self.heading(&plan.name);
        text += &line("lattice", &format!("{} x {} oscillators and the plate", grid.rows(), grid.columns()));
        text += &line("laws", &listed(case.laws.iter().map(ToString::to_string)));
        text += &line(
            "arrangements",
            &listed(case.panels.iter().map(|(n, list)| format!("{} with {n} in contact", list.len()))),
        );
        text += &line("constraints", &plan.labels.constraints.join(", "));
        text += &health::of_plan(plan)?;
        let speeds = case.speeds.iter().map(|s| format!("{} ({} to {} m/s)", s.name, s.from, s.to));
        text += &line("speeds", &listed(speeds));
        text += &line("samples", &format!("{} per arrangement, law and speed range, seed {}", plan.samples, plan.seed));
        text += &line("CEAs", &(plan.analyses_per_sample() * plan.samples).to_string());
        let classes = "one per symmetry class; laws without speed in them once for all speeds";
        text += &line("to be solved", &format!("{} ({classes})", plan.scenes.len() as u64 * plan.samples));
        Ok(text + &cost(brake, 0.0)?)
    }

    fn matrices(&self, brake: &MatricesBrake) -> Result<String, Error> {
        let (case, plan) = (&brake.case, &brake.plan);
        let mut text = self.heading(&plan.name);
        text += &line("dofs", &case.dofs.len().to_string());
        let named = |name: &str, family: &str| if name == family { name.into() } else { format!("{name} ({family})") };
        text += &line("terms", &listed(case.system.terms().iter().map(|term| named(&term.name, &term.family))));
        text += &taken(&case.files);
        let contacts = case.system.channels().iter().map(|channel| named(&channel.name, &channel.family));
        text += &line("contacts", &if case.gains.is_empty() { "none".into() } else { listed(contacts) });
        let parameters = case.parameters.iter().map(|parameter| format!("{} [{}]", parameter.name, parameter.unit));
        text += &line("parameters", &listed(parameters));
        text += &line("bodies", &listed(case.bodies.iter().map(|body| body.name.clone())));
        text += &line("constraints", &plan.labels.constraints.join(", "));
        text += &health::of_plan(plan)?;
        text += &line("samples", &format!("{} per constraint set, seed {}", plan.samples, plan.seed));
        text += &line("CEAs", &(plan.analyses_per_sample() * plan.samples).to_string());
        Ok(text + &cost(brake, 0.0)?)
    }

    /// What a finite element case is made of, and whether its matrices are sound.
    fn model(&self, case: &FiniteElementCase) -> Result<String, Error> {
        let terms = listed(case.system.terms().iter().take(case.coefficients.len()).map(|term| term.name.clone()));
        let patches = case.contact.as_ref().map_or("none".into(), |contact| {
            listed(contact.patches.iter().map(|patch| format!("{} ({} pairs)", patch.name, patch.pairs.len())))
        });
        let mut text = line("study", &case.name);
        text += &line("dofs", &case.dofs.len().to_string());
        text += &line("terms", &terms);
        text += &taken(&case.files);
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
        Ok(text)
    }

    fn heading(&self, study: &str) -> String {
        format!("{}: valid\n\n{}", self.file(), line("study", study))
    }

    fn file(&self) -> String {
        printable(&self.case.display().to_string())
    }
}

/// What the reduction of a finite element brake took, and its study takes.
fn finite_elements(case: FiniteElementCase, memory: MemoryArgs) -> Result<String, Error> {
    let reduction = case.reduction;
    sized::bases(&case, memory)?;
    let brake = FiniteElementBrake::new(case, &Bar::of("reductions"))?;
    let plan = &brake.plan;
    let mut text = String::new();
    for (at, (set, name)) in brake.sets.iter().zip(&plan.labels.constraints).enumerate() {
        let parts: Vec<&Part> = brake.parts.iter().filter(|part| part.set == at).collect();
        let columns = parts.iter().map(|part| part.within.basis.ncols());
        let sum = |of: &dyn Fn(&Part) -> usize| parts.iter().map(|part| of(part)).sum::<usize>();
        let not_reached = sum(&|part| usize::from(!part.within.is_reached));
        let reached = if not_reached == 0 { String::new() } else { format!(", NOT reached by {not_reached}") };
        let found = format!(
            "{name}: {} columns for all arrangements, bases within them: {}, of {} to {} columns, from {} complete solutions (residual asked: \
             {:.0e}{reached}); {} modes found missing on the way; at the medians {} of {} modes of the whole brake, within {:.1e}",
            set.basis.ncols(),
            parts.len(),
            columns.clone().min().unwrap_or(0),
            columns.max().unwrap_or(0),
            sum(&|part| part.within.solved.len()),
            reduction.residual,
            sum(&|part| part.within.missed.len()),
            set.compared.pairs.len(),
            set.compared.pairs.len() + set.compared.missed.len(),
            set.compared.distance
        );
        text += &line("reduction", &found);
    }
    text += &line("samples", &format!("{} per scene, seed {}", plan.samples, plan.seed));
    text += &line("CEAs", &(plan.analyses_per_sample() * plan.samples).to_string());
    Ok(text + &cost(&brake, brake.cost_of_bases().bytes)?)
}

/// How the file of each matrix was taken: files that were taken alike in one line.
fn taken(files: &[TakenMatrix]) -> String {
    let mut alike: Vec<(&str, Vec<String>)> = Vec::new();
    for TakenMatrix { file, taken, .. } in files {
        let name = file.display().to_string();
        match alike.iter_mut().find(|(words, _)| words == taken) {
            Some((_, names)) if names.contains(&name) => {}
            Some((_, names)) => names.push(name),
            None => alike.push((taken, vec![name])),
        }
    }
    let lines = alike.into_iter().map(|(words, names)| format!("{}: {words}", printable(&names.join(", "))));
    lines.enumerate().map(|(at, text)| line(if at == 0 { "files" } else { "" }, &text)).collect()
}

fn line(name: &str, value: &str) -> String {
    format!("  {name:<13} {value}\n")
}

fn listed(items: impl Iterator<Item = String>) -> String {
    items.collect::<Vec<_>>().join(", ")
}

/// What the study takes: memory and preparation by their rates, the time in all by some samples, unless the preparation alone
/// takes too long for a check.
fn cost<B: UncertainBrake>(brake: &B, bytes_of_bases: f64) -> Result<String, Error> {
    let cost = Cost::of(brake.plan());
    let seconds = match cost.seconds {
        long if long > LONGEST_PREPARATION => {
            format!("more than {}: not measured, its preparation alone takes that", in_words(long))
        }
        _ => format!(
            "roughly {} on this machine",
            in_words(estimate(brake, &Bar::of(PREPARED), &Bar::of(EVALUATED))?.as_secs_f64())
        ),
    };
    Ok(line("memory", &format!("roughly {}", bytes_in_words(cost.bytes + bytes_of_bases))) + &line("time", &seconds))
}
