//! Manifest: the origin of results, enough to make them again.

use std::collections::BTreeMap;

use serde::Serialize;
use study::fingerprint;
use study::{FullChecks, Plan};

use super::Results;
use crate::part_manifest::PartManifest;

/// Wall-clock times of the stages, s.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Times {
    /// Time for the reference modes of all scenes, s.
    pub references: f64,
    /// Time for the Monte Carlo run, s; after a resume, for the rest of it.
    pub samples: f64,
    /// Time for tables and figures, s.
    pub report: f64,
}

/// Stop of a run that had to know every occurrence to a half width.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Stopped {
    /// Half width asked for.
    pub half_width: f64,
    /// Half width reached, at the level of the look, with what failures and open verdicts leave open and without what open names do.
    pub reached: f64,
    /// Number of the look at which the run stopped, from 1.
    pub look: usize,
    /// Number of looks in all.
    pub looks: usize,
}

/// Source of results: the program, the case file and the study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Source {
    /// Version of this program.
    pub version: &'static str,
    /// Commit that it was built from, where the program says it.
    pub commit: Option<&'static str>,
    /// The case file as it was given; `null` for a brake that was not read from one.
    pub case: Option<String>,
    /// SHA-256 of the text of the case file, with what was set.
    pub case_sha256: Option<String>,
    /// Fields of the case file that were set from outside, each as `NAME=VALUE`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<String>,
    /// Name of the study.
    pub study: String,
}

/// The version of this program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

impl Source {
    /// The source of a plan, by this program.
    #[must_use]
    pub fn of(plan: &Plan) -> Self {
        Self {
            version: VERSION,
            commit: plan.commit,
            case: plan.source_file.as_ref().map(|file| file.path.display().to_string()),
            case_sha256: plan.source_file.as_ref().map(|file| fingerprint(&file.text)),
            set: plan.source_file.as_ref().map_or_else(Vec::new, |file| file.set.clone()),
            study: plan.name.clone(),
        }
    }
}

/// The manifest of a study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Manifest {
    /// Source of the results: program, case file and study.
    #[serde(flatten)]
    pub source: Source,
    /// Seed of the random streams.
    pub seed: u64,
    /// Number of samples drawn.
    pub samples: u64,
    /// Number of worker threads; `null` is one per core.
    pub threads: Option<usize>,
    /// Number of complex eigenvalue analyses that the results stand for: every arrangement, law, speed range and constraint set.
    pub analyses: u64,
    /// Number of eigenvalue problems solved for the analyses: one per symmetry class, and per law rather than per speed where no speed is
    /// in it.
    pub solved: u64,
    /// Number of the problems solved that a certificate covers: stable up to rounding, without a spectrum.
    pub certified: u64,
    /// Instability threshold of a mode, in words, where it is not the imaginary axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub threshold: Option<String>,
    /// Band in which the study finds modes, Hz; of a reduced brake alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub band_hz: Option<[f64; 2]>,
    /// Number in contact, and number of arrangements, of each panel.
    pub arrangements: Vec<(usize, usize)>,
    /// Number of samples or evaluations that failed; each is listed in failures.csv.
    pub failures: u64,
    /// Number of unstable modes whose name is open, near a coalescence.
    pub ambiguous_modes: u64,
    /// Number of unstable modes in all.
    pub unstable_modes: u64,
    /// Number of real eigenvalues that diverge.
    pub divergent: u64,
    /// Number of verdicts that the error bound leaves open.
    pub undecided: u64,
    /// Number of eigenvalues on the imaginary axis to within rounding of the matrices.
    pub marginal: u64,
    /// Number of unstable modes of a reduced brake that have a residual in the full model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residuals: Option<u64>,
    /// Number of unstable modes whose residual in the full model is above the one that the case asks for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residuals_above: Option<u64>,
    /// Largest residual of an unstable mode in the full model, relative to `|lambda|^2 |M| + |lambda| |C| + |K|`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_residual: Option<f64>,
    /// Counts of draws of a reduced brake checked against the full model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub full_checks: Option<FullChecks>,
    /// Notes on the way: estimates that were rejected, and why.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// Stop of a run that had to know every occurrence to a half width.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stopped: Option<Stopped>,
    /// Number of answers by the route on which they were found in this process: what a resumed run or parts had is not in it.
    pub routes: BTreeMap<&'static str, u64>,
    /// Parts of the study that were sampled elsewhere.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<PartManifest>,
    /// Wall-clock times, s.
    pub seconds: Times,
}

impl Manifest {
    /// The manifest of finished results.
    pub fn new(results: &Results, threads: Option<usize>, seconds: Times) -> Self {
        let (plan, summary) = (results.plan(), &results.summary);
        let panels = plan.labels.panels.iter().map(|panel| (panel.in_contact, panel.arrangements.len()));
        let sum = |of: fn(&study::SceneTally) -> u64| summary.tally.scenes.iter().map(of).sum();
        Self {
            source: Source::of(plan),
            seed: summary.seed,
            samples: summary.samples,
            threads,
            analyses: plan.analyses_per_sample() * summary.samples,
            solved: sum(|tally| tally.solved),
            certified: sum(|tally| tally.certified),
            threshold: (!plan.threshold.is_axis()).then(|| plan.threshold.to_string()),
            band_hz: plan.band.map(|band| band.map(|omega| omega / std::f64::consts::TAU)),
            arrangements: panels.collect(),
            failures: summary.failures.total(),
            ambiguous_modes: sum(|tally| tally.ambiguous_modes),
            unstable_modes: sum(|tally| tally.unstable_modes),
            divergent: sum(|tally| tally.divergent),
            undecided: sum(|tally| tally.undecided),
            marginal: sum(|tally| tally.marginal),
            residuals: plan.band.map(|_| sum(|tally| tally.residuals)),
            residuals_above: plan.band.map(|_| sum(|tally| tally.residuals_above)),
            largest_residual: plan
                .band
                .map(|_| summary.tally.scenes.iter().map(|tally| tally.largest_residual).fold(0.0, f64::max)),
            full_checks: results.full_checks.clone(),
            notes: results.notes(),
            stopped: None,
            routes: BTreeMap::new(),
            parts: Vec::new(),
            seconds,
        }
    }

    /// The manifest as JSON.
    pub fn json(&self) -> String {
        // Plain numbers and strings: there is nothing that could fail to serialise.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }
}
