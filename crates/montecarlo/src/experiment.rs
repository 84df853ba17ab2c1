//! The traits of a user: what is sampled and computed ([`Experiment`]), and what is kept ([`Tally`]).

use std::fmt::Display;
use std::ops::Range;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::failures::Failures;
use crate::merge::Merge;
use crate::stream::StreamRng;

/// An experiment: what is sampled and computed.
///
/// A run is reproducible only if the results depend on the arguments alone, not on the order of calls or on earlier contents of
/// the scratch memory.
pub trait Experiment: Sync {
    /// A draw of the uncertain parameters, used in every scene.
    type Sample;
    /// The result of one evaluation.
    type Outcome;
    /// The reason why a draw or an evaluation failed; its text is listed in [`Failures`](crate::Failures).
    type Error: Display;
    /// Scratch memory. It is `default()` at the beginning of every block of samples, so that no data pass between blocks.
    type Scratch: Default;

    /// Number of scenes in which each sample is evaluated, at least 1; scenes are numbered from 0.
    fn scenes(&self) -> usize {
        1
    }

    /// Draws one sample from its own stream.
    ///
    /// # Errors
    /// A failed draw is counted, listed, and missing from every scene; the run continues.
    fn draw(&self, rng: &mut StreamRng) -> Result<Self::Sample, Self::Error>;

    /// Evaluates one sample in one scene.
    ///
    /// # Errors
    /// A failed evaluation is counted and listed; the run continues.
    fn evaluate(
        &self,
        scene: usize,
        sample: &Self::Sample,
        scratch: &mut Self::Scratch,
    ) -> Result<Self::Outcome, Self::Error>;

    /// Evaluates a block of samples in one scene and appends one result per sample to `out`, in order.
    ///
    /// The default calls [`evaluate`](Self::evaluate) for each sample. An experiment that can evaluate several samples at
    /// once (one per SIMD lane, for example) overrides it; a result must not depend on the other samples of the block.
    fn evaluate_block(
        &self,
        scene: usize,
        samples: &[&Self::Sample],
        scratch: &mut Self::Scratch,
        out: &mut Vec<Result<Self::Outcome, Self::Error>>,
    ) {
        out.extend(samples.iter().map(|sample| self.evaluate(scene, sample, scratch)));
    }
}

/// A sample with its results in all scenes.
pub struct Runs<'a, S: Experiment> {
    /// The sample's global index: the same in a run from 0, in a later part of it, and after a resume.
    pub index: u64,
    /// The sample.
    pub sample: &'a S::Sample,
    /// Results, one per scene, in order. Failed evaluations are already counted and listed.
    pub results: &'a [Result<S::Outcome, S::Error>],
}

/// The statistic that is kept of the samples of an experiment. Its size should not depend on the number of samples.
pub trait Tally<S: Experiment>: Merge + Serialize + DeserializeOwned + Send {
    /// Enters one sample. Called in the order of the indices, but not for a sample whose draw failed.
    fn record(&mut self, runs: &Runs<'_, S>);

    /// True if this can be the tally of the samples of these global indices, with these failures: asked of a checkpoint before it is
    /// continued.
    fn may_be_of(&self, _samples: Range<u64>, _failures: &Failures) -> bool {
        true
    }
}
