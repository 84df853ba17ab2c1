//! `squeal sweep`: how modes move with one or two parameters.

use std::io::Write;
use std::path::PathBuf;

use cea::QrSolver;

use super::run::threads;
use super::scene::{LatticeScene, SceneArgs};
use crate::Error;
use crate::brakes::{LatticeBrake, MatricesBrake};
use crate::case::{CaseFile, LatticeCase, MatricesCase, SpeedRange};
use crate::study::{Study, UncertainBrake};
use crate::sweep::{Over, sweep};

/// Sweep one or two parameters, all others at their medians: where squeal starts and stops, and what the modes do.
///
/// Over one: branches of the root locus, onsets, coalescences. Over two: the stability map with its boundary.
#[derive(Debug, clap::Args)]
pub struct SweepArgs {
    /// The case file (TOML)
    pub case: PathBuf,
    /// A parameter and its range, as mu=0:1; given twice, a map of two parameters
    #[arg(long, value_name = "NAME=FROM:TO", required = true, value_parser = over)]
    pub over: Vec<Over>,
    /// The scene
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Folder for tables and figures: new, empty, or that of the same sweep
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// JSON for machines: what is found, frequencies in rad/s
    #[arg(long)]
    pub json: bool,
    /// Worker threads [default: one per core]; the results do not depend on it
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = threads)]
    pub threads: Option<usize>,
}

/// `NAME=FROM:TO`.
fn over(text: &str) -> Result<Over, String> {
    let parts = || {
        let (name, range) = text.split_once('=')?;
        let (from, to) = range.split_once(':')?;
        Some(Over { name: name.trim().into(), from: from.trim().parse().ok()?, to: to.trim().parse().ok()? })
    };
    parts().ok_or_else(|| "allowed: NAME=FROM:TO, as mu=0:1".to_owned())
}

impl SweepArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// What is wrong with the case or an option, and what cannot be swept.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        let text = match CaseFile::read(&self.case)? {
            CaseFile::Lattice(case) => self.text(&LatticeBrake::new(self.lattice(*case)?)?)?,
            CaseFile::Matrices(case) => self.text(&MatricesBrake::new(self.matrices(*case)?)?)?,
        };
        out.write_all(text.as_bytes()).map_err(Error::StandardOutput)
    }

    /// The case with the one scene that is swept.
    fn lattice(&self, mut case: LatticeCase) -> Result<LatticeCase, Error> {
        let LatticeScene { law, constraints, arrangement, speed } = self.scene.lattice(&case)?;
        case.laws = vec![law];
        case.constraints = vec![case.constraints.swap_remove(constraints)];
        case.panels = vec![(arrangement.in_contact().len(), vec![arrangement])];
        case.speeds = vec![SpeedRange { name: format!("{speed} m/s"), from: speed, to: speed }];
        Ok(case)
    }

    fn matrices(&self, mut case: MatricesCase) -> Result<MatricesCase, Error> {
        let set = self.scene.matrices(&case)?;
        case.constraints = vec![case.constraints.swap_remove(set)];
        Ok(case)
    }

    fn text<B: UncertainBrake>(&self, brake: &B) -> Result<String, Error> {
        let start = std::time::Instant::now();
        let study = Study::new(brake, &QrSolver)?;
        eprintln!("study {:?}", start.elapsed());
        let start = std::time::Instant::now();
        if let [a, b] = &self.over[..] {
            let found = crate::sweep::stability_map(&study, 0, &[a.clone(), b.clone()], &QrSolver)?;
            eprintln!("map {:?}", start.elapsed());
            return Ok(format!("{:#?} {:?} {:?} {} {:?}", found.curves.iter().map(|c| (c.mode.clone(), c.ends, c.points.len(), c.points[0], c.points[c.points.len()-1])).collect::<Vec<_>>(), found.regions, found.contradicted, found.unresolved, found.evaluations));
        }
        let found = sweep(&study, 0, &self.over[0], &QrSolver)?;
        eprintln!("sweep {:?}", start.elapsed());
        Ok(format!("{:#?} {:#?} {:#?} {:?} {} {:?} {}", found.onsets, found.coalescences, found.ambiguities, found.evaluations, found.fine_grid,
            found.branches.iter().map(|b| (b.mode.clone(), b.points.len())).collect::<Vec<_>>(), found.unstable_at_start))
    }
}
