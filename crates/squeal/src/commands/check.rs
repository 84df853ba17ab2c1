//! `squeal check`: is the case valid, what would run, and how long would it take?

use std::io::Write;
use std::path::PathBuf;

use super::run::overridden;
use crate::brakes::LatticeBrake;
use crate::case::{Draws, LatticeCase};
use crate::{Error, estimate};

/// Check a case and say what its study would compute, and roughly how long that takes.
#[derive(Debug, clap::Args)]
pub struct CheckArgs {
    /// The case file (TOML)
    pub case: PathBuf,
    /// Samples per scene, instead of the case's
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub samples: Option<u64>,
}

impl CheckArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// What is wrong with the case.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        let brake = LatticeBrake::new(overridden(LatticeCase::read(&self.case)?, self.samples, None, None)?)?;
        let (case, plan) = (&brake.case, &brake.plan);
        let mut text = format!("{}: valid\n\n  study         {}\n", self.case.display(), case.name);
        let mut line = |name: &str, value: String| text += &format!("  {name:<13} {value}\n");
        let grid = case.lattice.grid;
        line("lattice", format!("{} x {} oscillators and the plate", grid.rows(), grid.columns()));
        line("laws", case.laws.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "));
        let panels = case.panels.iter().map(|(n, list)| format!("{} with {n} in contact", list.len()));
        line("arrangements", panels.collect::<Vec<_>>().join(", "));
        line("constraints", case.constraints.iter().map(|set| set.name.clone()).collect::<Vec<_>>().join(", "));
        let speeds = case.speeds.iter().map(|s| format!("{} ({} to {} m/s)", s.name, s.from, s.to));
        line("speeds", speeds.collect::<Vec<_>>().join(", "));
        line("samples", format!("{} per arrangement, law and speed range, seed {}", case.samples, case.seed));
        line("CEAs", (plan.analyses_per_sample() * case.samples).to_string());
        let classes = match case.readings.draws {
            Draws::Shared => "one per symmetry class; laws without speed in them once for all speeds",
            Draws::Each => "every arrangement; laws without speed in them once for all speeds",
        };
        line("to be solved", format!("{} ({classes})", plan.scenes.len() as u64 * case.samples));
        let seconds = estimate(&brake)?.as_secs_f64();
        line("time", format!("roughly {} on this machine", in_words(seconds)));
        out.write_all(text.as_bytes()).map_err(|source| Error::Write { path: "standard output".into(), source })
    }
}

fn in_words(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => "a second".into(),
        s if s < 100.0 => format!("{s:.0} s"),
        s if s < 6000.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}
