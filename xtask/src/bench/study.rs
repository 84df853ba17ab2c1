//! The time of the whole study of the paper's case.

use std::path::Path;

use brakes::LatticeBrake;
use cpu_time::ProcessTime;
use reproduction::draw_paper;
use serde::Serialize;
use squeal::results::Times;
use squeal::{RunOptions, run_study_with};
use squeal_cli::bar::RunBars;

use super::stages::{Stage, stages};
use crate::error::TaskError;

/// Times of the study, from its references to its figures.
#[derive(Debug, Clone, Serialize)]
pub struct StudyTimes {
    /// Number of complex eigenvalue analyses that the results represent.
    pub ceas: u64,
    /// Number of eigenvalue problems solved for these.
    pub solved: u64,
    /// Number of these that a certificate shows to be stable up to rounding, without a spectrum.
    pub certified: u64,
    /// Number of samples per scene.
    pub samples: u64,
    /// Wall-clock time of the whole study.
    pub seconds: f64,
    /// Processor time of all threads.
    pub processor_seconds: f64,
    /// Wall-clock time of the parts of the study.
    pub parts: Times,
    /// Largest memory of the process, megabytes; `null` where the operating system does not give it.
    pub peak_mb: Option<f64>,
    /// Number of worker threads.
    pub threads: usize,
    /// Time of the samples by stages, on one thread.
    pub stages: Vec<Stage>,
}

impl StudyTimes {
    /// Runs the study in `folder`, which is emptied first, and then one block of it by stages.
    ///
    /// # Errors
    /// Those of the study.
    pub fn measure(brake: &LatticeBrake, folder: &Path) -> Result<Self, TaskError> {
        // A finished study in the folder would not be run again.
        if folder.exists() {
            let failed = |source| TaskError::Remove { path: folder.to_owned(), source };
            std::fs::remove_dir_all(folder).map_err(failed)?;
        }
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let start = ProcessTime::now();
        let bars = RunBars::default();
        let options = RunOptions::default().with_threads(Some(threads)).with_progress(bars.progress());
        let manifest = run_study_with(brake, folder, options, &mut |_, results, dir| draw_paper(results, brake, dir))?;
        let (processor_seconds, peak_mb) = (start.elapsed().as_secs_f64(), peak_mb());
        let parts = manifest.seconds;
        Ok(Self {
            ceas: manifest.analyses,
            solved: manifest.solved,
            certified: manifest.certified,
            samples: manifest.samples,
            seconds: parts.references + parts.samples + parts.report,
            processor_seconds,
            parts,
            peak_mb,
            threads,
            stages: stages(brake)?,
        })
    }
}

/// The high-water mark of the resident memory, as Linux keeps it.
fn peak_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: f64 = line.trim().trim_end_matches(" kB").parse().ok()?;
    Some(kibibytes * 1024.0 / 1e6)
}
