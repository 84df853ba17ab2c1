//! `squeal influence`: which input makes squeal vary, and by how much.

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use brakes::Purpose;
use output::{printable, write};
use report::influence_figure;
use serde_json::{Value, json};
use squeal::folder::RunFolder;
use squeal::identity::of_study;
use squeal::influence::{influence, influence_table};
use squeal::study::{Study, UncertainBrake};
use squeal::workers;

use super::options::{check_threads, whole_number};
use super::scene::DrawnSceneArgs;
use super::{results_folder, sized};
use crate::Error;
use crate::bar::{Bar, EVALUATED, PREPARED};

/// Fewest and most draws, and rows of a design; chosen: with fewer an interval has no information, and more take gigabytes.
const ALLOWED: std::ops::RangeInclusive<u64> = 100..=1_000_000;

/// Say which drawn parameter makes squeal vary, and by how much: Sobol' indices of growth and of instability, with 95 % intervals.
///
/// First-order indices are from the draws that a study of the case evaluates, in one of its scenes; total ones, with --total, from a
/// design of their own.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: squeal influence brake.toml --out influence")]
pub struct InfluenceArgs {
    /// The scene with its draws
    #[command(flatten)]
    pub drawn: DrawnSceneArgs,
    /// Draws, instead of the case's samples
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole_number)]
    pub samples: Option<u64>,
    /// Also total indices, from so many points, each of which takes as many analyses as there are inputs, and two
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole_number)]
    pub total: Option<u64>,
    /// Folder for influence.csv, summary.md and a figure: new, empty, or that of the same question
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// JSON for machines: the rows of influence.csv
    #[arg(long)]
    pub json: bool,
}

impl InfluenceArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// Faults of the case or of an option.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        check_threads(self.drawn.machine.threads)?;
        for (option, given) in [("--samples", self.samples), ("--total", self.total)] {
            if let Some(given) = given.filter(|given| !ALLOWED.contains(given)) {
                let allowed = format!("{} to {}", ALLOWED.start(), ALLOWED.end());
                return Err(Error::Option { option, value: given.to_string(), allowed });
            }
        }
        let brake = self.drawn.brake(self.samples, Purpose::Study)?;
        sized::answer(out, &self.influence(&brake)?, &brake, &self.drawn.case.case)
    }

    /// The influence of the inputs of the first scene of a brake, which need not be one of a case file.
    ///
    /// # Errors
    /// As [`InfluenceArgs::run`].
    pub fn influence<B: UncertainBrake>(&self, brake: &B) -> Result<String, Error> {
        let (plan, start) = (brake.plan(), Instant::now());
        let draws = plan.samples.clamp(*ALLOWED.start(), *ALLOWED.end());
        let total = self.total.map_or_else(|| "none".into(), |rows| rows.to_string());
        let identity = of_study(brake).given("influence", draws).given("total", total).into_line();
        if let Some(dir) = &self.out {
            RunFolder::check(dir, &identity)?;
        }
        let solver = cea::BatchSolver;
        let found = workers(self.drawn.machine.threads)?.install(|| {
            let study = Study::with_progress(brake, &solver, &Bar::of(PREPARED))?;
            influence(&study, 0, draws, self.total, &Bar::of(EVALUATED))
        })?;
        let seconds = start.elapsed().as_secs_f64();
        let scene = &plan.scenes[0];
        let asked = match plan.samples {
            few if few < draws => format!(" (not study.samples = {few}: an index needs {draws})"),
            many if many > draws => format!(" (not study.samples = {many}: {draws} are the most)"),
            _ => String::new(),
        };
        let heading = format!("{}: {}; {draws} draws{asked}, seed {}", plan.name, plan.describe(scene), plan.seed);
        let answer = found.text(plan);
        if let Some(dir) = &self.out {
            let folder = RunFolder::take(dir, &identity)?;
            folder.publish(|stage| -> Result<(), Error> {
                influence_table(plan, [(scene, &found)]).write(stage)?;
                write(&stage.join("summary.md"), summary(&heading, &answer).as_bytes())?;
                match influence_figure(&found, "What makes squeal vary", &heading)? {
                    Some(figure) => Ok(figure.save_pictures(stage, "influence")?),
                    None => Ok(()),
                }
            })?;
            let own = json!({
                "scene": plan.describe(scene),
                "seed": plan.seed,
                "samples": draws,
                "failures": found.failures,
                "undecided": found.undecided,
                "total": self.total,
                "evaluations": found.evaluations,
            });
            results_folder::write_manifest(&folder, plan, self.drawn.machine.threads, seconds, own)?;
        }
        if self.json {
            let rows = with_units(influence_table(plan, [(scene, &found)]).json());
            let document = json!({ "scene": plan.describe(scene), "warnings": found.doubts, "samples": draws, "failures": found.failures, "undecided": found.undecided, "rows": rows });
            return Ok(format!("{document:#}\n"));
        }
        let place = results_folder::place(self.out.as_deref());
        let evaluations = found.evaluations;
        Ok(format!("{}\n\n{answer}{evaluations} CEAs in {seconds:.2} s{place}\n", printable(&heading)))
    }
}

/// The answer as a page of text.
fn summary(heading: &str, answer: &str) -> String {
    let lines = answer.lines().map(|line| match line.strip_prefix("  ") {
        Some(item) => format!("- {item}\n"),
        None => format!("\n**{line}**\n\n"),
    });
    format!(
        "# What makes squeal vary\n\n{heading}. What an input explains alone is its first-order Sobol' index, from the draws by ranks; \
         in parentheses are 95 % intervals.\n{}",
        lines.collect::<String>()
    )
}

/// Rows for machines in which a unit is text, also the unit 1 of what has no dimension.
pub(crate) fn with_units(mut rows: Value) -> Value {
    for unit in rows.as_array_mut().into_iter().flatten().filter_map(|row| row.get_mut("unit")) {
        if unit.is_number() {
            *unit = Value::String(unit.to_string());
        }
    }
    rows
}
