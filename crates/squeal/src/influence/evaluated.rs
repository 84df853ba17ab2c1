//! Evaluated samples: their inputs, and the growth rates that were found.

use montecarlo::{Experiment as _, Progress};
use rayon::prelude::*;
use study::{DrawnInputs, KeptSample, KeptSamples, ModeLabel, Scene, Scratch, Study, UncertainBrake};

use crate::Error;

/// Number of samples evaluated together; chosen, so that batched solvers are filled again and again.
const SAMPLES_PER_BLOCK: u64 = 128;

/// Evaluated sample.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Evaluated {
    /// Values of the inputs.
    pub inputs: Vec<f64>,
    /// Largest growth rate of an unstable mode, 1/s; 0 without unstable modes.
    pub growth: f64,
    /// Growth rates of unstable modes that have one sure name.
    pub modes: Vec<(ModeLabel, f64)>,
    /// Another unstable mode has no sure name.
    pub is_open: bool,
    /// Nothing surely is unstable, and a verdict is undecided.
    pub is_undecided: bool,
}

impl Evaluated {
    /// The sample with these inputs, and the modes of `kept`; `None` is one in which everything surely is stable.
    fn new(inputs: Vec<f64>, kept: Option<&KeptSample>) -> Self {
        let Some(KeptSample { growth, modes, .. }) = kept else {
            return Self { inputs, growth: 0.0, modes: Vec::new(), is_open: false, is_undecided: false };
        };
        let named: Vec<(ModeLabel, f64)> = modes
            .iter()
            .filter_map(|mode| match mode.names[..] {
                [name] => Some((name, mode.growth)),
                _ => None,
            })
            .collect();
        let (is_open, is_undecided) = (named.len() < modes.len(), modes.is_empty());
        Self { inputs, growth: *growth, is_open, modes: named, is_undecided }
    }
}

/// The samples that a study has kept of a scene, in the order of their indices; `None` for one that failed.
pub(super) fn of_kept<S>(
    of: &dyn DrawnInputs<S>,
    scene: &Scene,
    drawn: &[Option<S>],
    kept: &KeptSamples,
) -> Vec<Option<Evaluated>> {
    let evaluated = |(sample, index): (&Option<S>, u64)| {
        let sample = sample.as_ref().filter(|_| !kept.has_failed(index))?;
        Some(Evaluated::new(of.input_values(scene, sample), kept.sample(index)))
    };
    drawn.iter().zip(0..).map(evaluated).collect()
}

/// Evaluates the samples of the first `count` indices in a scene, in the order of the indices whatever the threads; `None` for one that
/// fails.
pub(super) fn evaluate<B: UncertainBrake>(
    (study, of): (&Study<'_, B>, &dyn DrawnInputs<B::Sample>),
    scene: usize,
    count: u64,
    progress: &dyn Progress,
    sample: impl Fn(u64) -> Result<B::Sample, Error> + Sync,
) -> Result<Vec<Option<Evaluated>>, Error> {
    let of_block = |block: u64| {
        if progress.is_cancelled() {
            return Vec::new();
        }
        let indices = block * SAMPLES_PER_BLOCK..((block + 1) * SAMPLES_PER_BLOCK).min(count);
        let first = indices.start;
        let drawn: Vec<Option<B::Sample>> = indices.clone().map(|index| sample(index).ok()).collect();
        let samples: Vec<&B::Sample> = drawn.iter().flatten().collect();
        let mut outcomes = Vec::with_capacity(samples.len());
        study.evaluate_block(scene, &samples, &mut Scratch::default(), &mut outcomes);
        let mut outcomes = outcomes.into_iter();
        let of_scene = &study.plan().scenes[scene];
        let evaluated = |(sample, index): (&Option<B::Sample>, u64)| {
            let sample = sample.as_ref()?;
            let outcome = outcomes.next()?.ok()?;
            let kept = KeptSample::new(index, &outcome);
            Some(Evaluated::new(of.input_values(of_scene, sample), kept.as_ref()))
        };
        let found: Vec<Option<Evaluated>> = drawn.iter().zip(first..).map(evaluated).collect();
        progress.advance(indices.end - indices.start);
        found
    };
    let found = (0..count.div_ceil(SAMPLES_PER_BLOCK)).into_par_iter().flat_map_iter(of_block).collect();
    progress.go_on()?;
    Ok(found)
}
