//! The seam: what is sampled, what is computed from it, and what is kept.

use std::fmt::Display;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::failures::Failures;
use crate::stream::StreamRng;

/// What is sampled and computed.
///
/// The results must depend on the arguments alone, not on the order of calls or on earlier contents of the scratch: that
/// is what makes a run reproducible.
pub trait Experiment: Sync {
    /// One draw of the uncertain parameters, used in every scene.
    type Sample;
    /// What one evaluation gives.
    type Outcome;
    /// Why one draw or evaluation failed; its text is listed in [`Failures`](crate::Failures).
    type Error: Display;
    /// Working memory. It begins as `default()` in every block of samples, so nothing passes from block to block.
    type Scratch: Default;

    /// How many situations each sample is evaluated in, at least 1; they are numbered from 0.
    fn scenes(&self) -> usize {
        1
    }

    /// Draws one sample from its own stream.
    ///
    /// # Errors
    /// A failed draw is counted, listed, and missing from every scene; the run goes on.
    fn draw(&self, rng: &mut StreamRng) -> Result<Self::Sample, Self::Error>;

    /// Evaluates one sample in one scene.
    ///
    /// # Errors
    /// A failed evaluation is counted and listed; the run goes on.
    fn evaluate(
        &self,
        scene: usize,
        sample: &Self::Sample,
        scratch: &mut Self::Scratch,
    ) -> Result<Self::Outcome, Self::Error>;

    /// Evaluates a block of samples in one scene and appends one result per sample to `out`, in order.
    ///
    /// The default calls [`evaluate`](Self::evaluate) for each. An experiment that can treat several samples at
    /// once (one per SIMD lane, say) overrides it; a sample's result must not depend on which others share its block.
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

/// One sample with its results in all scenes.
pub struct Runs<'a, S: Experiment> {
    /// The sample's global index: the same in a run from 0, in a later part of it, and after a resume.
    pub index: u64,
    /// What was drawn.
    pub sample: &'a S::Sample,
    /// One result per scene, in order. The failed ones are already counted and listed.
    pub results: &'a [Result<S::Outcome, S::Error>],
}

/// Something that counts, and whose counts of two consecutive stretches of samples can be put together.
pub trait Merge {
    /// Adds what was counted from later samples.
    ///
    /// It must be associative: `(a + b) + c` equals `a + (b + c)` to the last bit. Integers are, floating-point sums are
    /// not; an [`IntegerMean`](crate::IntegerMean) or a [`QuantileSketch`](crate::QuantileSketch) does instead.
    fn merge(&mut self, later: Self);
}

/// Element by element; an element that one side lacks counts as empty there.
impl<M: Merge> Merge for Vec<M> {
    fn merge(&mut self, later: Self) {
        let mut later = later.into_iter();
        self.iter_mut().zip(&mut later).for_each(|(mine, more)| mine.merge(more));
        self.extend(later);
    }
}

/// What is kept of the samples of an experiment. Its size should not depend on their number.
pub trait Tally<S: Experiment>: Merge + Serialize + DeserializeOwned + Send {
    /// Enters one sample. Called in the order of the indices; a sample whose draw failed is not shown.
    fn record(&mut self, runs: &Runs<'_, S>);

    /// Whether these can be the counts of so many samples with these failures: asked of a checkpoint before it is continued.
    fn may_be_of(&self, _samples: u64, _failures: &Failures) -> bool {
        true
    }
}
