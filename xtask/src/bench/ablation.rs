//! What each accelerator gains: processor seconds of the studies of shipped cases, as shipped, with it and without.

use std::path::{Path, PathBuf};

use brakes::case::CaseFile;
use brakes::{FiniteElementBrake, LatticeBrake, MatricesBrake};
use cpu_time::ProcessTime;
use report::{Geometry, draw_occurrence, write_page};
use squeal::study::{StudyOptions, UncertainBrake};
use squeal::{RunOptions, run_study_with};
use squeal_cli::terminal::{note, say};

use crate::error::TaskError;

/// Cases, of which the last two take most of the time.
const CASES: [&str; 6] = [
    "two-by-two.toml",
    "hoffmann.toml",
    "wobbling-disc.toml",
    "paper.toml",
    "disk-brake100.toml",
    "disc-pad/disc-pad.toml",
];
/// The table that is the same whichever way a study is done, but for names that are open.
const COUNTS: &str = "occurrence.csv";

/// Runs the cases whose names contain one of `names`, all where there are none, in all ways, and prints a table.
///
/// # Errors
/// Those of the cases and their studies.
pub fn run(root: &Path, names: &[String]) -> Result<(), TaskError> {
    say("| case | way | s | times | samples by | counts |\n| --- | --- | --: | --: | --- | --- |\n")?;
    let is_asked = |case: &&str| names.is_empty() || names.iter().any(|name| case.contains(name.as_str()));
    for case in CASES.into_iter().filter(is_asked) {
        note(case);
        let start = ProcessTime::now();
        let file = CaseFile::read(&root.join("cases").join(case)).map_err(brakes::Error::from)?;
        let mut command = Command { case, folder: root.join("target/bench/ablation"), brake_seconds: 0.0, first: None };
        let mut with_options = |brake: &dyn Fn(&mut Command, StudyOptions, &str) -> Result<(), TaskError>| {
            command.brake_seconds = start.elapsed().as_secs_f64();
            let ways = [
                (true, true, "as shipped"),
                (false, true, "without certificates"),
                (true, false, "without secular equations"),
                (false, false, "spectra alone"),
            ];
            ways.into_iter().try_for_each(|(certificates, secular, way)| {
                let mut options = StudyOptions::default();
                (options.certificates, options.secular) = (certificates, secular);
                brake(&mut command, options, way)
            })
        };
        match file {
            CaseFile::Lattice(file) => {
                let brake = LatticeBrake::new(*file)?;
                with_options(&|command, options, way| command.study(&brake, options, way, None))?;
            }
            CaseFile::Matrices(file) => {
                let brake = MatricesBrake::new(*file)?;
                with_options(&|command, options, way| command.study(&brake, options, way, None))?;
            }
            CaseFile::FiniteElements(file) => {
                let brake = FiniteElementBrake::checked(*file, &())?;
                command.brake_seconds = start.elapsed().as_secs_f64();
                command.by_ways(brake)?;
            }
        }
    }
    Ok(())
}

/// The command that runs the study of a case.
struct Command {
    case: &'static str,
    folder: PathBuf,
    /// Processor time that the brake itself takes, s, which is made once.
    brake_seconds: f64,
    /// Of the study as shipped: processor time of the whole command, s, and its counts.
    first: Option<(f64, String)>,
}

impl Command {
    /// A reduced brake with and without ways to the modes of its samples.
    fn by_ways(&mut self, mut brake: FiniteElementBrake) -> Result<(), TaskError> {
        let routes = |brake: &FiniteElementBrake| {
            let found = brake.routes();
            move || format!("{} by coarse modes, {} by spectra", found.coarse, found.spectra)
        };
        self.study(&brake, StudyOptions::default(), "as shipped", Some(&|| routes(&brake)()))?;
        let before = brake.routes();
        brake.use_spectra_alone();
        let spectra = || format!("{} by spectra", brake.routes().spectra - before.spectra);
        self.study(&brake, StudyOptions::default(), "spectra alone", Some(&spectra))?;
        Ok(())
    }

    /// Runs the study of a brake in a folder, which is emptied first, with its tables, figures and page, and prints its row.
    fn study<B: UncertainBrake>(
        &mut self,
        brake: &B,
        study: StudyOptions,
        way: &str,
        routes: Option<&dyn Fn() -> String>,
    ) -> Result<(), TaskError> {
        if self.folder.exists() {
            let failed = |source| TaskError::Remove { path: self.folder.clone(), source };
            std::fs::remove_dir_all(&self.folder).map_err(failed)?;
        }
        let start = ProcessTime::now();
        let options = RunOptions::default().with_study(study);
        let manifest = run_study_with::<_, TaskError>(brake, &self.folder, options, &mut |_, results, dir| {
            draw_occurrence(results, dir)?;
            Ok(write_page(results, None, &Geometry::bodies(brake.plan()), dir)?)
        })?;
        let seconds = self.brake_seconds + start.elapsed().as_secs_f64();
        let counts = std::fs::read_to_string(self.folder.join(COUNTS)).map_err(TaskError::Start)?;
        let by = match routes {
            Some(routes) => routes(),
            None => format!("{} of {} by certificates", manifest.certified, manifest.solved),
        };
        let (first, expected) = self.first.get_or_insert_with(|| (seconds, counts.clone()));
        let said = compared(expected, &counts);
        let case = self.case;
        say(&format!("| {case} | {way} | {seconds:.2} | {:.2} | {by} | {said} |\n", seconds / *first))?;
        Ok(())
    }
}

/// Difference of two tables of counts. A mode whose name is open counts in `open` in the place of `unstable`: tables agree where counts moved from one to the other alone.
fn compared(expected: &str, counts: &str) -> String {
    if expected == counts {
        return "same".into();
    }
    // Columns: those that say of what the row is, unstable, open, occurrence, lower, upper, failed.
    let parts = |line: &'_ str| -> Option<(String, [i64; 2])> {
        let cells: Vec<&str> = line.split(',').collect();
        let (own, numbers) = cells.split_at(cells.len().checked_sub(6)?);
        let failed = numbers[5];
        Some((format!("{own:?}, {failed}"), [numbers[0].parse().ok()?, numbers[1].parse().ok()?]))
    };
    if expected.lines().count() != counts.lines().count() {
        return "OTHER".into();
    }
    let mut more = 0;
    for (expected, counts) in expected.lines().zip(counts.lines()).filter(|(expected, counts)| expected != counts) {
        match (parts(expected), parts(counts)) {
            (Some((row, [unstable, open])), Some((same_row, own)))
                if row == same_row && unstable >= own[0] && unstable + open <= own[0] + own[1] =>
            {
                more += own[1] - open;
            }
            _ => return "OTHER".into(),
        }
    }
    format!("{more} more open")
}

#[cfg(test)]
mod tests {
    use super::compared;

    #[test]
    fn a_name_that_is_open_is_no_other_count() {
        let table = |unstable: u32, open: u32| format!("mode,unstable,open\n1,{unstable},{open},0.1,0.0,0.2,0\n");
        assert_eq!(compared(&table(7, 1), &table(7, 1)), "same");
        assert_eq!(compared(&table(7, 1), &table(6, 2)), "1 more open");
        assert_eq!(compared(&table(7, 1), &table(8, 1)), "OTHER");
        assert_eq!(compared(&table(7, 1), &table(6, 1)), "OTHER");
        // Another mode, a row less, other failures.
        assert_eq!(compared(&table(7, 1), &table(7, 1).replace("\n1,", "\n2,")), "OTHER");
        assert_eq!(compared(&table(7, 1), "mode,unstable,open\n"), "OTHER");
        assert_eq!(compared(&table(7, 1), &table(7, 1).replace(",0\n", ",5\n")), "OTHER");
    }
}
