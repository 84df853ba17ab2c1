//! Evaluated samples: their inputs, and the growth rates that were found.

use montecarlo::{Experiment as _, Progress};
use rayon::prelude::*;
use study::{DrawnInputs, KeptSample, KeptSamples, ModeLabel, Scene, Scratch, Study, UncertainBrake};

use crate::Error;

/// Number of samples evaluated together; chosen: many batches of a solver, so that a last one that is partly empty costs little.
const SAMPLES_PER_BLOCK: u64 = 128;

/// Evaluated sample.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Evaluated {
    /// Values of the inputs.
    pub inputs: Vec<f64>,
    /// Largest growth rate of an unstable mode or of a divergence, 1/s; 0 where nothing surely is unstable.
    pub growth: f64,
    /// Growth rates of unstable modes that have one sure name.
    pub modes: Vec<(ModeLabel, f64)>,
    /// Some unstable mode has no name, or several; it is not in `modes`, and counts for the scene alone.
    pub has_open_name: bool,
    /// Nothing surely is unstable, and a verdict is undecided.
    pub is_undecided: bool,
}

impl Evaluated {
    /// The sample with these inputs, and the modes of `kept`, among which is divergence; without `kept` nothing is unstable and no verdict is open.
    fn new(inputs: Vec<f64>, kept: Option<&KeptSample>) -> Self {
        let Some(KeptSample { growth, modes, .. }) = kept else {
            return Self { inputs, growth: 0.0, modes: Vec::new(), has_open_name: false, is_undecided: false };
        };
        let named: Vec<(ModeLabel, f64)> = modes
            .iter()
            .filter_map(|mode| match mode.names[..] {
                [name] => Some((name, mode.growth)),
                _ => None,
            })
            .collect();
        let (has_open_name, is_undecided) = (named.len() < modes.len(), modes.is_empty());
        Self { inputs, growth: *growth, has_open_name, modes: named, is_undecided }
    }
}

/// The samples that a study has kept of a scene, of all of its samples from 0 on, in the order of their indices; `None` for one that failed.
pub(super) fn of_kept<S>(
    inputs: &dyn DrawnInputs<S>,
    scene: &Scene,
    drawn: &[Option<S>],
    kept: &KeptSamples,
) -> Vec<Option<Evaluated>> {
    let evaluated = |(sample, index): (&Option<S>, u64)| {
        let sample = sample.as_ref().filter(|_| !kept.has_failed(index))?;
        Some(Evaluated::new(inputs.input_values(scene, sample), kept.sample(index)))
    };
    drawn.iter().zip(0..).map(evaluated).collect()
}

/// Evaluates the samples that `draw` makes of the first `count` indices in a scene: one entry for each index, in their order; the error where the draw or the
/// evaluation failed.
pub(super) fn evaluate<B: UncertainBrake>(
    (study, inputs): (&Study<'_, B>, &dyn DrawnInputs<B::Sample>),
    scene: usize,
    count: u64,
    progress: &dyn Progress,
    draw: impl Fn(u64) -> Result<B::Sample, Error> + Sync,
) -> Result<Vec<Result<Evaluated, Error>>, Error> {
    let of_block = |block: u64| {
        if progress.is_cancelled() {
            return Vec::new();
        }
        let indices = block * SAMPLES_PER_BLOCK..((block + 1) * SAMPLES_PER_BLOCK).min(count);
        let drawn: Vec<Result<B::Sample, Error>> = indices.clone().map(&draw).collect();
        let samples: Vec<&B::Sample> = drawn.iter().flatten().collect();
        let mut outcomes = Vec::with_capacity(samples.len());
        study.evaluate_block(scene, &samples, &mut Scratch::default(), &mut outcomes);
        let mut outcomes = outcomes.into_iter();
        let of_scene = &study.plan().scenes[scene];
        let evaluated = |(sample, index): (Result<B::Sample, Error>, u64)| {
            // One outcome for each sample that was drawn.
            let (sample, outcome) = (sample?, outcomes.next().transpose()?);
            let unstable = outcome.and_then(|outcome| KeptSample::new(index, &outcome));
            Ok(Evaluated::new(inputs.input_values(of_scene, &sample), unstable.as_ref()))
        };
        let found = drawn.into_iter().zip(indices.clone()).map(evaluated).collect();
        progress.advance(indices.end - indices.start);
        found
    };
    let blocks = (0..count.div_ceil(SAMPLES_PER_BLOCK)).into_par_iter();
    let found = blocks.flat_map_iter(|block| -> Vec<Result<Evaluated, Error>> { of_block(block) }).collect();
    progress.go_on()?;
    Ok(found)
}
