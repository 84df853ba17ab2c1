//! `squeal cea`: one deterministic complex eigenvalue analysis of a case.

mod finite_elements;
mod shapes;
mod table;
mod words;

use std::io::Write;

use brakes::case::ChosenSpeed;
use brakes::{CaseBrake, Purpose};
use squeal::why::Why;

use self::table::{analyse, json_text, table};
use super::options::MemoryArgs;
use super::reasons::{Whys, first_scene, place_of, reasons};
use super::scene::{SceneArgs, counts_from};
use super::sized;
use crate::Error;
use crate::case_file::CaseArgs;

/// One complex eigenvalue analysis at median parameters: a table of modes.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: squeal cea brake.toml --set mu=0.6 --why")]
pub struct CeaArgs {
    /// The case
    #[command(flatten)]
    pub case: CaseArgs,
    /// The scene
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Add mode shapes and the work of friction and damping per body
    #[arg(long)]
    pub modes: bool,
    /// Say why unstable modes grow: what changes them, who feeds them, of which modes of the structure they are made
    #[arg(long)]
    pub why: bool,
    /// JSON for machines: eigenvalues in rad/s
    #[arg(long)]
    pub json: bool,
    /// Memory that may be taken
    #[command(flatten)]
    pub memory: MemoryArgs,
}

impl CeaArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// Faults of the case or of an option.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        let case = self.scene.only(self.case.read()?, ChosenSpeed::Median)?;
        let brake = sized::brake(case, self.purpose(), self.memory.into(), &self.case.prepared)?;
        out.write_all(self.analysis(&brake)?.as_bytes()).map_err(Error::StandardOutput)?;
        // Eigenvalues of the whole brake are, whatever is known of a reduced one.
        if self.purpose() == Purpose::Point { Ok(()) } else { sized::trusted(&brake, &self.case.case) }
    }

    /// The purpose of a brake: shapes, work and reasons are those of a reduced one.
    #[must_use]
    pub fn purpose(&self) -> Purpose<'static> {
        if self.modes || self.why { Purpose::Analysis } else { Purpose::Point }
    }

    /// The analysis of the first scene of a brake, which need not be one of a case file, at its medians.
    ///
    /// # Errors
    /// As [`CeaArgs::run`].
    pub fn analysis<B: CaseBrake>(&self, brake: &B) -> Result<String, Error> {
        let (plan, heading) = (brake.plan(), brake.medians_in_words() + &counts_from(&brake.plan().threshold));
        if let Some(brake) = brake.finite_elements() {
            return self.finite_elements(brake, &heading);
        }
        let scene = &plan.scenes[0];
        let at = brake.operating_point(scene, &brake.median())?;
        let whys = if self.why { first_scene(brake)? } else { Whys::default() };
        let (rows, real, modes) = analyse(plan.brake(scene), &at, &plan.threshold, self.modes)?;
        Ok(match self.json {
            true => json_text(&brake.scene_json(), &rows, &real, &modes, &whys.of_modes),
            false => {
                let name = |why: &Why| {
                    let place = place_of(rows.iter().map(|row| row.lambda), &whys.of_modes, why);
                    place.map_or(String::new(), |place| format!(" {}", rows[place].rank))
                };
                format!("{heading}\n\n{}{}", table(&rows, &real, &modes, plan.brake(scene)), reasons(&whys, name))
            }
        })
    }
}
