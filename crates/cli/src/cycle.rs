//! `squeal cycle`: the motion that unstable modes grow into.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use brakes::case::{CaseFile, ChosenSpeed};
use brakes::{CaseBrake, Purpose};
use cea::QrSolver;
use montecarlo::Progress;
use output::{Table, printable};
use report::{branches_figure, cycle_figures, write_branches_page, write_cycle_page};
use serde_json::json;
use squeal::cycles::{Branches, CycleOptions, Cycles, Start, branches, contacts_digest, cycles};
use squeal::folder::RunFolder;
use squeal::identity::of_study;
use squeal::study::Study;
use squeal::sweep::Over;
use squeal::workers;

use super::mesh_shapes::geometry;
use super::options::{MemoryArgs, number};
use super::scene::{SceneArgs, counts_from, swept_in_words};
use super::sweep::over;
use super::{results_folder, sized};
use crate::Error;
use crate::bar::{Bar, PREPARED};
use crate::case_file::CaseArgs;

/// Name of the file in which motions are kept until the results are there.
const KEPT: &str = "cycle_motions.json";

/// Follow unstable modes into the motion that they grow to: contacts open, slide and stick, and mostly a limit cycle is reached.
///
/// At median parameters, from each unstable mode; over a parameter, the branches of cycles from each onset. A run with --out that was stopped is continued by the same
/// command.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: squeal cycle brake.toml --over mu=0.5:1.1")]
pub struct CycleArgs {
    /// The case
    #[command(flatten)]
    pub case: CaseArgs,
    /// The scene
    #[command(flatten)]
    pub scene: SceneArgs,
    /// A parameter and its range, as mu=0.3:0.6: branches of cycles from each onset in it
    #[arg(long, value_name = "NAME=FROM:TO", value_parser = over)]
    pub over: Option<Over>,
    /// Start: the rank of an unstable mode, as `squeal cea` counts it, or noise [default: each unstable mode]
    #[arg(long, value_name = "MODE|noise", value_parser = start, conflicts_with = "over")]
    pub from: Option<Start>,
    /// Harmonics of the harmonic balance
    #[arg(long, value_name = "H", default_value_t = CycleOptions::default().harmonics)]
    pub harmonics: usize,
    /// Equal steps of a period at which the balance evaluates the contacts
    #[arg(long, value_name = "N", default_value_t = CycleOptions::default().samples)]
    pub time_samples: usize,
    /// Part of the sliding speed below which the friction of the balance is smoothed, and a LuGre contact said to stick, above 0 and below 1
    #[arg(long, value_name = "EPS", default_value_t = CycleOptions::default().stick, allow_negative_numbers = true, value_parser = number)]
    pub stick: f64,
    /// Folder for tables, figures and a page: new, empty, or that of the same motion
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// JSON for machines: the rows of the table
    #[arg(long)]
    pub json: bool,
    /// Memory that may be taken
    #[command(flatten)]
    pub memory: MemoryArgs,
}

/// Refuses an option that asks for the motion after the onset of a brake that does not give its contacts, before its reduction, which would take
/// long.
///
/// # Errors
/// As [`brakes::check_motion`]; a case of matrices without a contact.
pub fn has_motion(case: &CaseFile, option: &'static str, value: &str) -> Result<(), Error> {
    match case {
        CaseFile::FiniteElements(case) => Ok(brakes::check_motion(case)?),
        CaseFile::Matrices(case) if case.system.channels().is_empty() => {
            let allowed = "a case with contacts: in this one is no contact that could open, slide or stick, and so its motion is linear";
            Err(Error::Option { option, value: value.to_owned(), allowed: allowed.into() })
        }
        _ => Ok(()),
    }
}

/// The rank of a mode, or `noise`.
fn start(text: &str) -> Result<Start, String> {
    match text {
        "noise" => Ok(Start::Noise),
        rank => rank.parse().map(Start::Mode).map_err(|_| "allowed: the rank of a mode, or noise".to_owned()),
    }
}

/// Motions from their starts, or branches over a parameter.
enum Found {
    Cycles(Box<Cycles>),
    Branches(Box<Branches>),
}

impl Found {
    fn tables(&self) -> Vec<Table> {
        match self {
            Self::Cycles(cycles) => vec![cycles.table(), cycles.contacts_table(), cycles.spectrum_table()],
            Self::Branches(branches) => vec![branches.table()],
        }
    }

    fn text(&self) -> String {
        match self {
            Self::Cycles(cycles) => cycles.text(),
            Self::Branches(branches) => branches.text(),
        }
    }

    /// Writes figures and page into a folder in which the tables stand.
    fn draw<B: CaseBrake>(&self, brake: &B, heading: &str, dir: &Path) -> Result<(), Error> {
        let (plan, geometry) = (brake.plan(), geometry(brake));
        match self {
            Self::Cycles(cycles) => {
                let figures = cycle_figures(cycles, &plan.name, heading)?;
                figures
                    .iter()
                    .try_for_each(|(stem, figure)| figure.save_pictures(dir, stem))
                    .map_err(report::Error::from)?;
                Ok(write_cycle_page(plan, cycles, &geometry, &figures, heading, dir)?)
            }
            Self::Branches(branches) => {
                let title = format!("{}: cycles over {}", plan.name, branches.sweep.parameter.name);
                let figure = branches_figure(branches, &title, heading)?;
                figure.save_pictures(dir, "cycle_branches").map_err(report::Error::from)?;
                Ok(write_branches_page(plan, branches, &geometry, figure, heading, dir)?)
            }
        }
    }
}

impl CycleArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// What is wrong with the case or an option, and what has no motion.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        let case = self.scene.only(self.case.read()?, ChosenSpeed::Median)?;
        has_motion(&case, "CASE", &self.case.case.display().to_string())?;
        let purpose = self.over.as_ref().map_or(Purpose::Analysis, |over| Purpose::Sweep(std::slice::from_ref(over)));
        let brake = sized::brake(case, purpose, self.memory.into(), &self.case.prepared)?;
        sized::answer(out, &self.motion(&brake)?, &brake, &self.case.case)
    }

    /// The motion of the first scene of a brake, which need not be one of a case file.
    ///
    /// # Errors
    /// As [`CycleArgs::run`].
    pub fn motion<B: CaseBrake>(&self, brake: &B) -> Result<String, Error> {
        let (plan, begin) = (brake.plan(), Instant::now());
        let options = CycleOptions {
            from: self.from.unwrap_or(Start::UnstableModes),
            harmonics: self.harmonics,
            samples: self.time_samples,
            stick: self.stick,
        };
        let contacts = contacts_digest(brake, &plan.scenes[0], &options)?;
        let over = self.over.as_ref().map_or_else(|| "medians".to_owned(), ToString::to_string);
        let asked = format!(
            "{over} from {:?}, {} harmonics, {} samples, stick {}, contacts {contacts}",
            options.from, options.harmonics, options.samples, options.stick
        );
        let identity = of_study(brake).given("cycle", asked).into_line();
        if let Some(dir) = &self.out {
            RunFolder::check(dir, &identity)?;
        }
        let folder = self.out.as_ref().map(|dir| RunFolder::take(dir, &identity)).transpose()?;
        let kept = self.out.as_ref().map(|dir| dir.join(KEPT));
        let kept = kept.as_deref();
        let find = || -> Result<Found, squeal::Error> {
            let Some(over) = &self.over else {
                let bar = Bar::of("periods of the modes at most");
                return Ok(Found::Cycles(cycles(brake, &plan.scenes[0], &options, kept, &bar)?.into()));
            };
            let study = Study::with_progress(brake, &QrSolver, &Bar::of(PREPARED))?;
            let bars: [&dyn Progress; 2] = [&Bar::of("steps of the sweep"), &Bar::of("steps of the branches")];
            Ok(Found::Branches(branches(&study, 0, over, &options, kept, bars)?.into()))
        };
        let (found, folder) = results_folder::or_given_back(workers(None)?.install(find), folder, KEPT)?;
        // A law that knows no speed has no range whose name says it.
        let speed =
            self.scene.speed.filter(|_| brake.finite_elements().is_some() && plan.scenes[0].key.speed.is_none());
        let speed = speed.map_or_else(String::new, |speed| format!("; sliding speed {speed} {}", plan.units.of("m/s")));
        let heading = match &self.over {
            None => brake.medians_in_words() + &counts_from(&plan.threshold) + &speed,
            Some(over) => swept_in_words(plan, std::slice::from_ref(over)) + &speed,
        };
        let tables = found.tables();
        let seconds = begin.elapsed().as_secs_f64();
        if let Some(folder) = folder {
            folder.publish(|stage| -> Result<(), Error> {
                tables.iter().try_for_each(|table| table.write(stage))?;
                found.draw(brake, &heading, stage)
            })?;
            let own = json!({
                "scene": plan.describe(&plan.scenes[0]),
                "over": self.over.as_ref().map(ToString::to_string),
                "from": self.from.map(|from| match from {
                    Start::UnstableModes => "each unstable mode".to_owned(),
                    Start::Mode(rank) => rank.to_string(),
                    Start::Noise => "noise".to_owned(),
                }),
                "harmonics": self.harmonics,
                "time_samples": self.time_samples,
                "stick": self.stick,
            });
            results_folder::write_manifest(&folder, plan, None, seconds, own)?;
            folder.remove(KEPT)?;
        }
        if self.json {
            return Ok(format!("{:#}\n", json!({ "scene": plan.describe(&plan.scenes[0]), "rows": tables[0].json() })));
        }
        let place = results_folder::place(self.out.as_deref());
        Ok(format!("{}\n\n{}{seconds:.2} s{place}\n", printable(&heading), found.text()))
    }
}
