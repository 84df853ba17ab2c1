//! The header of a case of any kind: its file, and what it says of its study.

use std::path::PathBuf;

use cea::Threshold;
use study::{Measured, Plan, StudySource, Units};

use super::CaseError;
use super::check::{Accuracy, Check};
use super::heard::MeasuredTable;
use super::squeal::SquealTable;

/// The file of a case of any kind, and the study that it asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseHeader {
    /// The case file.
    pub path: PathBuf,
    /// The text of the case file, with what was set.
    pub text: String,
    /// Fields that were set from outside, each as `NAME=VALUE`.
    pub set: Vec<String>,
    /// Name of the study.
    pub name: String,
    /// Samples per scene, >= 1.
    pub samples: u64,
    /// Seed of the random streams.
    pub seed: u64,
    /// Half width to which every occurrence is also estimated, if asked for.
    pub half_width: Option<f64>,
    /// Threshold beyond which a growing mode counts as unstable.
    pub threshold: Threshold,
    /// Squeal that was measured, if the case has any.
    pub measured: Option<Measured>,
    /// Units of the numbers of the case.
    pub units: Units,
    /// Commit of the program that reads the case, for manifest and pages; `None` unless the program says it.
    pub commit: Option<&'static str>,
    /// Sentences on what reading the case leaves to be known: matrices that may be meant otherwise, what was left out.
    pub notes: Vec<String>,
}

impl CaseHeader {
    /// Most samples of a study; chosen, so that every count of a study fits in 64 bits.
    pub const MOST_SAMPLES: u64 = 1_000_000_000_000;

    /// The plan of the study, without scenes; `identity` as in [`Plan::identity`].
    pub fn plan(&self, identity: String) -> Plan {
        let mut plan = Plan::without_scenes(&self.name, identity, self.samples, self.seed);
        plan.source_file =
            Some(StudySource { path: self.path.clone(), text: self.text.clone(), set: self.set.clone() });
        (plan.threshold, plan.units, plan.commit) = (self.threshold, self.units, self.commit);
        plan.measured = self.measured.clone();
        plan
    }

    /// Path of the case file, for messages.
    #[must_use]
    pub fn source(&self) -> String {
        self.path.display().to_string()
    }
}

impl Check<'_> {
    /// The header of a case from the fields that every kind has; its notes are [`Check::notes`], once all is read.
    pub fn header(
        &self,
        text: String,
        (name, samples, seed): (String, u64, u64),
        accuracy: Option<Accuracy>,
        squeal: Option<SquealTable>,
        measured: Option<MeasuredTable>,
    ) -> Result<CaseHeader, CaseError> {
        self.line("study.name", &name)?;
        if !(1..=CaseHeader::MOST_SAMPLES).contains(&samples) {
            return Err(self.value("study.samples", samples, &format!("1 to {}", CaseHeader::MOST_SAMPLES)));
        }
        let (half_width, threshold) = (self.half_width(accuracy)?, self.threshold(squeal)?);
        Ok(CaseHeader {
            path: self.path.to_owned(),
            text,
            set: Vec::new(),
            name,
            samples,
            seed,
            half_width,
            threshold,
            measured: self.measured(measured)?,
            units: self.units,
            commit: None,
            notes: Vec::new(),
        })
    }
}
