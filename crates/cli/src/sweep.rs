//! `squeal sweep`: how modes move with one or two parameters.

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use brakes::case::{ChosenSpeed, parameter_of};
use brakes::{CaseBrake, Purpose};
use cea::QrSolver;
use output::printable;
use report::{sweep_figure, write_sweep_page};
use serde_json::json;
use squeal::folder::RunFolder;
use squeal::identity::of_study;
use squeal::study::Study;
use squeal::sweep::{BoundaryMode, Found, Over, boundary_modes, stability_map, sweep};
use squeal::workers;

use super::mesh_shapes::geometry;
use super::options::{MachineArgs, check_threads};
use super::scene::{SceneArgs, swept_in_words};
use super::{results_folder, sized};
use crate::Error;
use crate::bar::{Bar, PREPARED};
use crate::case_file::CaseArgs;

/// Sweep one or two parameters, all others at their medians: where squeal starts and stops, and what the modes do.
///
/// Over one: branches of the root locus, onsets, coalescences. Over two: the stability map with its boundary.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: squeal sweep brake.toml --over mu=0:1.3 --out sweep")]
pub struct SweepArgs {
    /// The case
    #[command(flatten)]
    pub case: CaseArgs,
    /// A parameter and its range, as mu=0:1; given twice, a map of two parameters
    #[arg(long, value_name = "NAME=FROM:TO", required = true, value_parser = over)]
    pub over: Vec<Over>,
    /// The scene
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Folder for tables and figures: new, empty, or that of the same sweep
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Growth that the root locus shows, 1/s, as -200:500 [default: what is about zero]
    #[arg(long, value_name = "FROM:TO", value_parser = growth, allow_hyphen_values = true, requires = "out")]
    pub growth: Option<[f64; 2]>,
    /// JSON for machines: what is found, frequencies in rad/s
    #[arg(long)]
    pub json: bool,
    /// Threads and memory
    #[command(flatten)]
    pub machine: MachineArgs,
}

/// `NAME=FROM:TO`.
pub(super) fn over(text: &str) -> Result<Over, String> {
    let parts = || {
        let (name, range) = text.split_once('=')?;
        let (from, to) = range.split_once(':')?;
        Some(Over {
            name: parameter_of(name.trim()).into(),
            from: from.trim().parse().ok()?,
            to: to.trim().parse().ok()?,
        })
    };
    parts().ok_or_else(|| "allowed: NAME=FROM:TO, as mu=0:1".to_owned())
}

/// `FROM:TO`, ascending.
fn growth(text: &str) -> Result<[f64; 2], String> {
    let ends = || {
        let (from, to) = text.split_once(':')?;
        let [from, to] = [from, to].map(|end| end.trim().parse::<f64>().ok().filter(|end| end.is_finite()));
        Some([from?, to?]).filter(|[from, to]| from < to)
    };
    ends().ok_or_else(|| "allowed: FROM:TO, two finite numbers, the lower one first, as -200:500".to_owned())
}

impl SweepArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// Faults of the case or of an option; a parameter that cannot be swept.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        check_threads(self.machine.threads)?;
        let case = self.scene.only(self.case.read()?, ChosenSpeed::Median)?;
        let brake = sized::brake(case, Purpose::Sweep(&self.over), self.machine, &self.case.prepared)?;
        sized::answer(out, &self.sweep(&brake)?, &brake, &self.case.case)
    }

    /// Sweeps the first scene of a brake, which need not be one of a case file, and says what was found.
    ///
    /// # Errors
    /// As [`SweepArgs::run`].
    pub fn sweep<B: CaseBrake>(&self, brake: &B) -> Result<String, Error> {
        let (plan, start) = (brake.plan(), Instant::now());
        if let (Some([from, to]), [_, _, ..]) = (self.growth, &self.over[..]) {
            let value = format!("{from}:{to}");
            return Err(Error::Option {
                option: "--growth",
                value,
                allowed: "with one --over, which makes a root locus".into(),
            });
        }
        let named: Vec<String> = self.over.iter().map(ToString::to_string).collect();
        let identity = of_study(brake).given("sweep", named.join(",")).into_line();
        if let Some(dir) = &self.out {
            RunFolder::check(dir, &identity)?;
        }
        let pool = workers(self.machine.threads)?;
        let (found, modes) = pool.install(|| -> Result<(Found, Vec<BoundaryMode>), Error> {
            let study = Study::with_progress(brake, &QrSolver, &Bar::of(PREPARED))?;
            let found = match &self.over[..] {
                [one] => Found::Branches(sweep(&study, 0, one, &QrSolver, &Bar::of("steps of the sweep"))?.into()),
                [a, b] => {
                    let both = [a.clone(), b.clone()];
                    Found::Map(stability_map(&study, 0, &both, &QrSolver, &Bar::of("lines"))?.into())
                }
                more => {
                    let (value, allowed) = (format!("given {} times", more.len()), "once or twice".into());
                    return Err(Error::Option { option: "--over", value, allowed });
                }
            };
            // For the page alone.
            let modes = match self.out {
                Some(_) => boundary_modes(&study, 0, &self.over, &QrSolver, &found, &Bar::of("modes at onsets"))?,
                None => Vec::new(),
            };
            Ok((found, modes))
        })?;
        let seconds = start.elapsed().as_secs_f64();
        let scene = swept_in_words(plan, &self.over);
        if let Some(dir) = &self.out {
            let folder = RunFolder::take(dir, &identity)?;
            folder.publish(|stage| -> Result<(), Error> {
                for table in found.tables() {
                    table.write(stage)?;
                }
                let title = format!("Sweep over {}", named.join(" and "));
                let figure = sweep_figure(&found, self.growth, &title, &scene)?;
                figure.save_pictures(stage, "sweep")?;
                Ok(write_sweep_page(plan, &found, &modes, &geometry(brake), &figure, &scene, stage)?)
            })?;
            let own = json!({
                "scene": plan.describe(&plan.scenes[0]),
                "over": named,
                "parameters": found.parameters(),
                "evaluations": found.evaluations(),
                "fine_grid": found.fine_grid(),
            });
            results_folder::write_manifest(&folder, plan, self.machine.threads, seconds, own)?;
        }
        if self.json {
            let mut all = found.json();
            all["scene"] = json!(scene);
            return Ok(format!("{all:#}\n"));
        }
        let place = results_folder::place(self.out.as_deref());
        Ok(format!("{}\n\n{}{seconds:.2} s{place}\n", printable(&scene), found.text()))
    }
}
