//! Global sensitivity: Sobol' indices of growth and of instability, by the inputs of a scene.
//!
//! First-order indices come from the draws of the study by ranks, without a design; total ones, on demand, from a design of their own.
//! Outputs of a scene are the largest growth rate of an unstable mode, and whether any mode is unstable; outputs of each mode are its
//! growth rate and whether it is unstable. A growth rate is 0 where nothing is unstable: a study does not keep how fast damped modes decay.

mod evaluated;
mod output;
mod report;
mod samples;

use montecarlo::rand::RngExt as _;
use montecarlo::{Confidence, PickFreeze, Progress, SobolIndex, first_order_by_ranks, stream};
use rayon::prelude::*;
use study::{DrawnInputs, Input, KeptSamples, Scene, Study, UncertainBrake, doubts_of};

use crate::Error;
use evaluated::{Evaluated, evaluate, of_kept};

pub use output::{Output, OutputKind};
pub use report::influence_table;
pub use samples::write_kept_samples;

/// The influence of all inputs on an output.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct OutputInfluence {
    /// Output that is explained.
    pub output: Output,
    /// Mean of the output over the draws.
    pub mean: f64,
    /// Standard deviation of the output over the draws.
    pub deviation: f64,
    /// Number of draws in which the output is not 0.
    pub nonzero: u64,
    /// Number of draws in which the output departs from its most frequent value, on which the indices rest: of growth, those in which it is
    /// not 0; of instability, the unstable or the stable ones, whichever are fewer.
    pub unlike: u64,
    /// Number of rows of a design, where there is one, in which the output departs from its most frequent value.
    pub unlike_in_design: Option<u64>,
    /// Influence of each input, in the order of [`Influence::inputs`]; empty where the output hardly varies.
    pub inputs: Vec<InputInfluence>,
}

/// The influence of one input on an output.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct InputInfluence {
    /// First-order index: the part of the variance that would go if this input alone were known.
    pub first_order: SobolIndex,
    /// Total index: the part of the variance that would be left if all but this input were known.
    pub total: Option<SobolIndex>,
}

/// The influence of the inputs of a scene.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Influence {
    /// Sentences that speak against the results, as of a reduced brake that failed its checks; none of samples that a study has kept, which tells its own.
    pub doubts: Vec<String>,
    /// Inputs that are drawn and matter in the scene.
    pub inputs: Vec<Input>,
    /// Influences on the outputs: of the scene first, then of its modes.
    pub outputs: Vec<OutputInfluence>,
    /// Number of draws of the study, including draws that failed.
    pub draws: u64,
    /// Number of draws that failed and are left out.
    pub failures: u64,
    /// Reason why the first of these failed; `None` without failures, and of samples that a study has kept, which tells its own.
    pub first_failure: Option<String>,
    /// Number of draws in which nothing surely is unstable and a verdict is undecided; they count as stable.
    pub undecided: u64,
    /// Number of draws in which an unstable mode has a name that is open; it counts for the scene and for no mode.
    pub open: u64,
    /// Number of systems evaluated for the indices, including systems that a certificate covers.
    pub evaluations: u64,
}

/// The influence of the inputs of a scene on its outputs, from the first `draws` of the study, and total indices from `rows` rows of a
/// design of independent points, each of which takes as many evaluations as there are inputs, and two.
///
/// # Errors
/// A scene without inputs; total indices of inputs that are correlated, and of a brake that has no samples by quantiles; draws, or rows of a design, of which
/// each fails.
pub fn influence<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    draws: u64,
    rows: Option<u64>,
    progress: &dyn Progress,
) -> Result<Influence, Error> {
    let (brake, plan) = (study.brake(), study.plan());
    let asked = &plan.scenes[scene];
    let drawn = brake.drawn_inputs().ok_or(Error::NotGiven { capability: "drawn_inputs()", needed_by: "influence" })?;
    let inputs = drawn.inputs(asked);
    if inputs.is_empty() {
        return Err(Error::NoInputs { study: plan.source(), scene: plan.describe(asked) });
    }
    if let (Some(correlated), Some(rows)) = (inputs.iter().find(|input| input.is_correlated), rows) {
        let allowed = format!("inputs that are independent; {} is correlated with others", correlated.name);
        return Err(Error::Argument { argument: "total", value: rows.to_string(), allowed });
    }
    let of_design = rows.unwrap_or(0) * (inputs.len() as u64 + 2);
    progress.begin(draws + of_design, 0);
    let of_draws =
        evaluate((study, drawn), scene, draws, progress, |index| Ok(brake.draw(&mut stream(plan.seed, index))?))?;
    let design = match rows {
        Some(rows) => Some(design((study, drawn), scene, &inputs, rows, progress)?),
        None => None,
    };
    progress.end();
    let failed = of_draws.iter().find_map(|draw| draw.as_ref().err().map(ToString::to_string));
    let found = Influence::new(inputs, of_draws.into_iter().map(Result::ok).collect(), design.as_deref());
    let Some(found) = found else {
        let (scene, what, reason) = (plan.describe(asked), "draws", failed.unwrap_or_default());
        return Err(Error::EachFailed { scene, what, count: draws, reason });
    };
    Ok(Influence { doubts: doubts_of(brake), evaluations: draws + of_design, first_failure: failed, ..found })
}

/// The influence of the inputs of each scene, from samples that its study has kept, all from 0 on: nothing is evaluated. `None` for a scene without inputs, and
/// for one in which each sample failed.
pub fn influence_of_kept<B: UncertainBrake>(brake: &B, samples: u64, kept: &[KeptSamples]) -> Vec<Option<Influence>> {
    let plan = brake.plan();
    let Some(of) = brake.drawn_inputs() else { return kept.iter().map(|_| None).collect() };
    let drawn = drawn_again(brake, samples);
    let of_scene = |(scene, kept): (&Scene, &KeptSamples)| {
        let inputs = of.inputs(scene);
        let all = (!inputs.is_empty()).then(|| of_kept(of, scene, &drawn, kept))?;
        Influence::new(inputs, all, None)
    };
    plan.scenes.par_iter().zip(kept).map(of_scene).collect()
}

/// The first samples of a study, `None` for one whose draw fails.
fn drawn_again<B: UncertainBrake>(brake: &B, samples: u64) -> Vec<Option<B::Sample>> {
    (0..samples).map(|index| brake.draw(&mut stream(brake.plan().seed, index)).ok()).collect()
}

impl OutputInfluence {
    fn new(output: Output, draws: &[Evaluated], columns: &[Vec<f64>], design: Option<&[Vec<Evaluated>]>) -> Self {
        let values = output.of_all(draws);
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let deviation = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt();
        let nonzero = values.iter().filter(|value| **value != 0.0).count() as u64;
        let unlike = |values: &mut dyn Iterator<Item = f64>| {
            let (nonzero, zero): (Vec<f64>, Vec<f64>) = values.partition(|value| *value != 0.0);
            match output.kind {
                OutputKind::Growth => nonzero.len() as u64,
                OutputKind::Instability => nonzero.len().min(zero.len()) as u64,
            }
        };
        let of_draws = unlike(&mut values.iter().copied());
        let of_design: Option<Vec<Vec<f64>>> =
            design.map(|columns| columns.iter().map(|column| output.of_all(column)).collect());
        let unlike_in_design = of_design.as_deref().map(|design| unlike(&mut design[..2].iter().flatten().copied()));
        let enough_of_design = of_design.filter(|_| unlike_in_design.is_some_and(|count| count >= Self::FEWEST_UNLIKE));
        let of_input = |(at, column): (usize, &Vec<f64>)| {
            let total = enough_of_design.as_deref().and_then(|design| {
                let [a, b, mixed] = [0, 1, at + 2].map(|column| &design[column][..]);
                PickFreeze { a, b, mixed }.total()
            });
            Some(InputInfluence { first_order: first_order_by_ranks(column, &values)?, total })
        };
        let all = columns.iter().enumerate().filter(|_| of_draws >= Self::FEWEST_UNLIKE);
        let inputs = all.map(of_input).collect::<Option<Vec<_>>>().unwrap_or_default();
        Self { output, mean, deviation, nonzero, unlike: of_draws, unlike_in_design, inputs }
    }

    /// Fewest draws, or rows of a design, in which an output departs from its most frequent value: with fewer its indices rest on those
    /// few. Chosen.
    pub const FEWEST_UNLIKE: u64 = 30;

    /// Inputs by their first-order indices, the largest first, with their indices in [`OutputInfluence::inputs`].
    #[must_use]
    pub fn ranked(&self) -> Vec<(usize, &InputInfluence)> {
        let mut ranked: Vec<(usize, &InputInfluence)> = self.inputs.iter().enumerate().collect();
        ranked.sort_by(|(_, a), (_, b)| b.first_order.value.total_cmp(&a.first_order.value));
        ranked
    }
}

impl Influence {
    /// The influence of `inputs` from the samples of the study, `None` for one that failed, and the columns of a design; `None` where each sample failed.
    fn new(inputs: Vec<Input>, of_draws: Vec<Option<Evaluated>>, design: Option<&[Vec<Evaluated>]>) -> Option<Self> {
        let draws = of_draws.len() as u64;
        let of_draws: Vec<Evaluated> = of_draws.into_iter().flatten().collect();
        if of_draws.is_empty() {
            return None;
        }
        let columns: Vec<Vec<f64>> =
            (0..inputs.len()).map(|input| of_draws.iter().map(|row| row.inputs[input]).collect()).collect();
        let of_output = |output: Output| OutputInfluence::new(output, &of_draws, &columns, design);
        Some(Self {
            doubts: Vec::new(),
            outputs: Output::all(&of_draws).into_iter().map(of_output).collect(),
            inputs,
            draws,
            failures: draws - of_draws.len() as u64,
            first_failure: None,
            undecided: of_draws.iter().filter(|row| row.is_undecided).count() as u64,
            open: of_draws.iter().filter(|row| row.has_open_name).count() as u64,
            evaluations: 0,
        })
    }

    /// Level of the intervals.
    pub const CONFIDENCE: Confidence = Confidence::P95;
}

/// Evaluated points of a design: at A, at B, and at A with each input from B.
fn design<B: UncertainBrake>(
    (study, drawn): (&Study<'_, B>, &dyn DrawnInputs<B::Sample>),
    scene: usize,
    inputs: &[Input],
    rows: u64,
    progress: &dyn Progress,
) -> Result<Vec<Vec<Evaluated>>, Error> {
    let plan = study.plan();
    let coordinates = inputs.iter().map(|input| input.coordinate + 1).max().unwrap_or(0) as usize;
    // Not the draws of the study: they are another estimate.
    let seed = plan.seed.wrapping_add(1);
    let point = |row: u64, side: usize| -> Vec<f64> {
        let mut rng = stream(seed, row);
        let mut both = [Vec::with_capacity(coordinates), Vec::with_capacity(coordinates)];
        for _ in 0..coordinates {
            // Quantiles at 0 may be infinite.
            both.iter_mut().for_each(|side| side.push(rng.random::<f64>().max(f64::EPSILON)));
        }
        std::mem::take(&mut both[side])
    };
    let column = |from_b: Option<u32>, side: usize| {
        evaluate((study, drawn), scene, rows, progress, |row| {
            let mut at = point(row, side);
            if let Some(coordinate) = from_b {
                at[coordinate as usize] = point(row, 1)[coordinate as usize];
            }
            let uniform = |coordinate: u32| at.get(coordinate as usize).copied().unwrap_or(0.5);
            Ok(drawn.quantile_sample(&plan.scenes[scene], &uniform))
        })
    };
    let mut columns = vec![column(None, 0)?, column(None, 1)?];
    for input in inputs {
        columns.push(column(Some(input.coordinate), 0)?);
    }
    // A row with a failure is left out as a whole.
    let is_whole = |row: &usize| columns.iter().all(|column| column[*row].is_ok());
    let whole: Vec<usize> = (0..rows as usize).filter(is_whole).collect();
    if whole.is_empty() {
        let reason = columns.iter().flatten().find_map(|row| row.as_ref().err().map(ToString::to_string));
        let (scene, reason) = (plan.describe(&plan.scenes[scene]), reason.unwrap_or_default());
        return Err(Error::EachFailed { scene, what: "rows of the design", count: rows, reason });
    }
    let kept = |column: Vec<Result<Evaluated, Error>>| {
        let mut rows: Vec<Option<Evaluated>> = column.into_iter().map(Result::ok).collect();
        whole.iter().filter_map(|&row| rows[row].take()).collect::<Vec<Evaluated>>()
    };
    Ok(columns.into_iter().map(kept).collect())
}
