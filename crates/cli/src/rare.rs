//! `squeal rare`: how probable squeal is that plain samples hardly ever show.

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use brakes::case::with_constants;
use brakes::{CaseBrake, Purpose};
use cea::BatchSolver;
use output::{printable, write};
use report::rare_figure;
use serde_json::json;
use squeal::folder::RunFolder;
use squeal::identity::of_study;
use squeal::rare::{Options, Rare, design_points_table, rare, rare_table};
use squeal::study::Study;
use squeal::workers;

use super::influence::with_units;
use super::options::{check_threads, number, whole_number};
use super::scene::{DrawnSceneArgs, SceneArgs};
use super::{results_folder, sized};
use crate::Error;
use crate::bar::{Bar, PREPARED};
use crate::case_file::CaseArgs;

/// Say how probable squeal is where it is rare, mode by mode, down to 1e-9, and which brakes are the likeliest to squeal.
///
/// Of one scene of the case: design points, line sampling, and points elsewhere that must not contradict them. Two thousand spectra do what
/// plain samples need millions for.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: squeal rare brake.toml --relative 0.1 --out rare")]
pub struct RareArgs {
    /// The scene with its draws
    #[command(flatten)]
    pub drawn: DrawnSceneArgs,
    /// Standard error to reach, relative to the probability, above 0 and below 1
    #[arg(long, value_name = "R", default_value_t = Options::default().relative, allow_negative_numbers = true, value_parser = number)]
    pub relative: f64,
    /// Spectra that may be spent; the search and the first lines take some thousand whatever it is
    #[arg(long, value_name = "N", default_value_t = Options::default().budget, allow_negative_numbers = true, value_parser = whole_number)]
    pub budget: u64,
    /// Random directions from which the likeliest squealing brakes are looked for, beside both of each input
    #[arg(long, value_name = "N", default_value_t = Options::default().directions as u64, allow_negative_numbers = true, value_parser = whole_number)]
    pub directions: u64,
    /// Folder for tables, a figure and the likeliest squealing brake as a case: new, empty, or that of the same question, which goes on if it was killed
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// JSON for machines: the rows of rare.csv and design_points.csv
    #[arg(long)]
    pub json: bool,
}

/// Name of the file in which answers at points are kept until there are results, so that a run that was stopped goes on.
const KEPT: &str = "rare_points.json";
/// Most directions; chosen: more are a study of their own.
const MOST_DIRECTIONS: u64 = 100_000;

impl RareArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// Faults of the case or of an option, a scene whose squeal is not rare, and estimates that contradict each other.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        check_threads(self.drawn.machine.threads)?;
        self.options(0)?;
        let brake = self.drawn.brake(None, Purpose::Analysis)?;
        sized::answer(out, &self.rare(&brake)?, &brake, &self.drawn.case.case)
    }

    fn options(&self, seed: u64) -> Result<Options, Error> {
        let refused = |option, value: String, allowed: String| Err(Error::Option { option, value, allowed });
        if !(self.relative > 0.0 && self.relative < 1.0) {
            return refused("--relative", self.relative.to_string(), "a number above 0 and below 1".into());
        }
        if !Options::BUDGETS.contains(&self.budget) {
            let (least, most) = (Options::BUDGETS.start(), Options::BUDGETS.end());
            return refused("--budget", self.budget.to_string(), format!("{least} to {most} spectra"));
        }
        if self.directions > MOST_DIRECTIONS {
            return refused("--directions", self.directions.to_string(), format!("0 to {MOST_DIRECTIONS}"));
        }
        Ok(Options { relative: self.relative, budget: self.budget, directions: self.directions as usize, seed })
    }

    /// The probability of squeal in the first scene of a brake, which need not be one of a case file.
    ///
    /// # Errors
    /// As [`RareArgs::run`].
    pub fn rare<B: CaseBrake>(&self, brake: &B) -> Result<String, Error> {
        let (plan, start) = (brake.plan(), Instant::now());
        let options = self.options(plan.seed)?;
        let asked = format!("{} of {} by {}", options.relative, options.budget, options.directions);
        let identity = of_study(brake).given("rare", asked).into_line();
        if let Some(dir) = &self.out {
            RunFolder::check(dir, &identity)?;
        }
        let workers = workers(self.drawn.machine.threads)?;
        let study = workers.install(|| Study::with_progress(brake, &BatchSolver, &Bar::of(PREPARED)))?;
        let folder = self.out.as_ref().map(|dir| RunFolder::take(dir, &identity)).transpose()?;
        let kept = self.out.as_ref().map(|dir| dir.join(KEPT));
        let found = workers.install(|| rare(&study, 0, &options, &BatchSolver, kept.as_deref(), &Bar::of("spectra")));
        let (found, folder) = results_folder::or_given_back(found, folder, KEPT)?;
        let seconds = start.elapsed().as_secs_f64();
        let scene = &plan.scenes[0];
        let heading = format!("{}: {}; seed {}", plan.name, plan.describe(scene), plan.seed);
        let answer = found.text(plan);
        if let Some(folder) = folder {
            folder.publish(|stage| -> Result<(), Error> {
                rare_table(plan, [(scene, &found)]).write(stage)?;
                design_points_table(plan, [(scene, &found)]).write(stage)?;
                let page = format!("# How probable squeal is\n\n{heading}\n\n```text\n{answer}```\n");
                write(&stage.join("summary.md"), page.as_bytes())?;
                if let Some(case) = self.likeliest(&found)? {
                    write(&stage.join("likeliest.toml"), case.as_bytes())?;
                }
                match rare_figure(&found, "What the likeliest squealing brakes are made by", &heading)? {
                    Some(figure) => Ok(figure.save_pictures(stage, "design_points")?),
                    None => Ok(()),
                }
            })?;
            let own = json!({
                "scene": plan.describe(scene),
                "seed": plan.seed,
                "relative": options.relative,
                "budget": options.budget,
                "directions": options.directions,
                "probability": found.probability,
                "certified": found.bound,
                "lines": found.lines,
                "elsewhere": found.elsewhere,
                "spectra": found.spectra,
            });
            results_folder::write_manifest(&folder, plan, self.drawn.machine.threads, seconds, own)?;
            folder.remove(KEPT)?;
        }
        if self.json {
            let points = with_units(design_points_table(plan, [(scene, &found)]).json());
            let rows = rare_table(plan, [(scene, &found)]).json();
            let document = json!({ "scene": plan.describe(scene), "warnings": found.doubts, "seed": plan.seed, "rows": rows, "design_points": points });
            return Ok(format!("{document:#}\n"));
        }
        let place = results_folder::place(self.out.as_deref());
        let spectra = found.spectra;
        Ok(format!("{}\n\n{answer}{spectra} spectra in {seconds:.2} s{place}\n", printable(&heading)))
    }

    /// The likeliest squealing brake as a case; `None` where no squeal was found, and where inputs have no field of a case of their own.
    fn likeliest(&self, found: &Rare) -> Result<Option<String>, Error> {
        // A brake of a user's own type has no case file.
        let DrawnSceneArgs { case: CaseArgs { case: path, set, .. }, scene, range, .. } = &self.drawn;
        let Some(point) = found.design_points.first().filter(|_| path.is_file()) else { return Ok(None) };
        let names = found.inputs.iter().map(|input| input.name.clone());
        let values: Vec<(String, f64)> = names.zip(point.squealing.iter().copied()).collect();
        let Some(case) = with_constants((path, set), &values, range.as_deref())? else {
            return Ok(None);
        };
        let SceneArgs { law, contact, constraints, speed } = scene;
        let mut command = "squeal cea likeliest.toml".to_owned();
        let contact = contact.as_ref().map(|all| all.iter().map(ToString::to_string).collect::<Vec<_>>().join(","));
        // Of a range that is not the first one its draw has to be said.
        let of_range = || values.iter().find(|(name, _)| range.is_some() && name == "v").map(|(_, value)| *value);
        let speed = speed.or_else(of_range).map(|speed| speed.to_string());
        let given = [("law", law), ("contact", &contact), ("constraints", constraints), ("speed", &speed)];
        for (option, value) in given.into_iter().filter_map(|(option, value)| Some((option, value.as_ref()?))) {
            command += &format!(" --{option} {value}");
        }
        Ok(Some(format!(
            "# The likeliest squealing brake of {}, just beyond its onset: {command}\n{case}",
            path.display()
        )))
    }
}
