//! A control variate: occurrences from the mean of a cheap prediction, corrected by full solutions, with an interval.
//!
//! For the event Y that a mode is unstable and any prediction G of Y,
//!
//! ```text
//! P(Y) = P(G) + P(Y and not G) - P(G and not Y)
//! ```
//!
//! The first term is the mean of the prediction over scrambled Sobol points. The other two are counted over independent
//! samples that are solved in full; their result is called the reference. Samples with *clear* and with *uncertain* predictions
//! are strata, counted separately: a difference in an uncertain sample has little weight, because few samples are uncertain.
//!
//! In clear samples prediction and reference hardly ever differ. The limits of Clopper and Pearson (Biometrika 26, 1934) are
//! valid for every number n of samples, and with no difference in n samples their sum is below `-ln(tail) / n`. The mean of the
//! prediction and the differences in uncertain samples are sums of many small independent terms, with one common interval by
//! Student's t. A few thousand solutions give the accuracy of plain Monte Carlo with a million. A bad prediction makes the
//! interval wide, but not invalid.

use montecarlo::Experiment as _;

use super::evaluations::Evaluations;
use super::friction_points::{FrictionPoints, LeadingFriction};
use super::interval::{INTERIM_LOOKS, PredictionMeans, intervals, tails};
use super::kd_tree::ModeSet;
use super::stratum::Stratum;
use super::{ControlVariateEstimate, EstimatorError, Surrogate};
use crate::{ModeLabel, Scratch, Study, UncertainBrake};

/// Half width for which the samples of the first look are planned, as a fraction of the half width asked for; chosen: with 1, a further look is needed as often
/// as not.
const FIRST_LOOK_WIDTH: f64 = 0.95;
/// Fractions of the half width tried for Student's t, of which the cheapest is taken; chosen: with fewer, the division is less cheap.
const STUDENT_PARTS: [f64; 7] = [0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.85];
/// Cost of an uncertain sample over the cost of a clear sample, whose modes need not be followed; chosen: it decides how the half width is divided between the
/// two.
const UNCERTAIN_PRICE: f64 = 2.0;
/// Share of all samples in which a prediction is assumed to be wrong before any sample is solved; chosen.
const PRIOR_WRONG_OF_ALL: f64 = 3e-4;
/// Share of the uncertain samples in which a prediction is assumed to be wrong in addition; chosen.
const PRIOR_WRONG_OF_UNCERTAIN: f64 = 0.05;
/// Number of uncertain samples that estimate the share of wrong predictions where more than twice as many are needed; they have no other use. Chosen: with
/// fewer, the share is less certain; more are lost for the result.
const PILOT_SAMPLES: u64 = 400;
/// Standard error from uncertain samples for which a surrogate is refined, as a fraction of the half width; chosen: with less, more sample points are solved;
/// with more, more uncertain samples.
const SURROGATE_ERROR_PART: f64 = 0.13;
/// Least number of uncertain samples in the first look, so that Student's t applies; chosen.
const FEWEST_UNCERTAIN: f64 = 120.0;
/// Number of samples solved together; chosen large, so that the few whose modes have to be followed fill a batch.
const SAMPLES_PER_BLOCK: usize = 2048;
/// Most draws for one block; chosen. A block stays smaller where a surrogate has hardly any uncertain samples.
const MOST_DRAWS: usize = 4_000_000;

/// The occurrences of a scene to `half_width` at 95 %, or to the half width that the last look reaches.
///
/// # Errors
/// A sample that cannot be solved.
pub fn control_variate<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    points: &FrictionPoints,
    seed: u64,
    half_width: f64,
) -> Result<ControlVariateEstimate, EstimatorError> {
    let variance_allowed = (SURROGATE_ERROR_PART * half_width).powi(2);
    let samples_needed = |share: f64| variance(share, prior_wrong(share)) / variance_allowed;
    let surrogate = Surrogate::new(study, scene, points, samples_needed)?;
    let means = PredictionMeans::new(&surrogate, points);
    let mut samples = StratifiedSamples::new(study, scene, &surrogate, seed)?;
    corrected(&means, half_width, surrogate.sample_points(), |kind, size, stratum| samples.solve(kind, size, stratum))
}

/// The occurrences from the means of a prediction, corrected by samples to `half_width`, or as near as the last look gets.
/// `solve` brings a stratum of clear (0) or uncertain (1) samples to a number of them; `sample_points` were solved for the
/// prediction.
pub(super) fn corrected(
    means: &PredictionMeans,
    half_width: f64,
    sample_points: u64,
    mut solve: impl FnMut(usize, u64, &mut Stratum) -> Result<(), EstimatorError>,
) -> Result<ControlVariateEstimate, EstimatorError> {
    let mut first = first_sizes(means, prior_wrong(means.uncertain.mean), half_width);
    let mut pilots = Stratum::default();
    if first[1] > 2 * PILOT_SAMPLES {
        solve(1, PILOT_SAMPLES, &mut pilots)?;
        first = first_sizes(means, pilots.most_wrong(), half_width);
    }
    let mut strata = <[Stratum; 2]>::default();
    let mut look = 0;
    loop {
        let (tail, size_factor) = INTERIM_LOOKS[look];
        for (kind, (size, stratum)) in first.into_iter().zip(&mut strata).enumerate() {
            solve(kind, (size as f64 * size_factor).ceil() as u64, stratum)?;
        }
        let [clear, uncertain] = strata.each_ref().map(|stratum| stratum.samples);
        let evaluations = Evaluations { sample_points, pilots: pilots.samples, clear, uncertain };
        let found = intervals(means, &strata, tails(tail), look == 0, evaluations);
        look += 1;
        if found.half_width() <= half_width || look == INTERIM_LOOKS.len() {
            return Ok(found);
        }
    }
}

/// The share of the uncertain samples in which the prediction is assumed to be wrong; uncertain samples are `share` of all.
fn prior_wrong(share: f64) -> f64 {
    (PRIOR_WRONG_OF_ALL / share + PRIOR_WRONG_OF_UNCERTAIN).min(0.5)
}

/// The variance of an occurrence from one uncertain sample; uncertain samples are `share` of all.
fn variance(share: f64, wrong: f64) -> f64 {
    share * share * wrong
}

/// The numbers of clear and uncertain samples for the half width if the prediction is right in every clear sample and wrong in a fraction `wrong` of the
/// uncertain ones, with the cheapest division of the half width between the two.
fn first_sizes(means: &PredictionMeans, wrong: f64, half_width: f64) -> [u64; 2] {
    let price = |sizes: &[f64; 2]| sizes[0] + UNCERTAIN_PRICE * sizes[1];
    let divided = STUDENT_PARTS.map(|part| sizes(means, wrong, FIRST_LOOK_WIDTH * half_width, part));
    let cheapest = divided.into_iter().min_by(|a, b| price(a).total_cmp(&price(b)));
    cheapest.unwrap_or_default().map(|size| size.ceil() as u64)
}

/// Numbers of samples as by [`first_sizes`], where Student's t has the fraction `part` of the half width.
fn sizes(means: &PredictionMeans, wrong: f64, half_width: f64, part: f64) -> [f64; 2] {
    let [clear, uncertain] = means.largest_shares();
    let [tail, of_student] = tails(INTERIM_LOOKS[0].0);
    let t = means.t(of_student);
    let of_means = means.modes.values().flatten().map(|mean| mean.standard_error).fold(0.0, f64::max).powi(2);
    // At least a tenth of the variance of the mean, where the mean alone uses up this fraction of the half width.
    let left = ((part * half_width / t).powi(2) - of_means).max(0.1 * of_means);
    let of_uncertain = (variance(uncertain, wrong) / left).max(FEWEST_UNCERTAIN);
    let by_student = t * (of_means + variance(uncertain, wrong) / of_uncertain).sqrt();
    let of_clear = -tail.ln() * clear / (half_width - by_student).max(0.1 * half_width);
    [of_clear, of_uncertain]
}

/// The samples of a scene in the order of the study, of which as many of each kind are solved as are asked for.
struct StratifiedSamples<'a, B: UncertainBrake> {
    study: &'a Study<'a, B>,
    friction: LeadingFriction<'a, B>,
    scene: usize,
    surrogate: &'a Surrogate,
    /// Names that occur in the scene.
    names: Vec<ModeLabel>,
    seed: u64,
    next: u64,
    /// Clear and uncertain samples that are drawn and not solved, with the predicted modes.
    waiting: [Vec<(B::Sample, ModeSet)>; 2],
    scratch: Scratch,
}

impl<'a, B: UncertainBrake> StratifiedSamples<'a, B> {
    fn new(study: &'a Study<'a, B>, scene: usize, surrogate: &'a Surrogate, seed: u64) -> Result<Self, EstimatorError> {
        let friction = LeadingFriction::new(study.brake(), &study.plan().scenes[scene])?;
        let (waiting, names) = ([Vec::new(), Vec::new()], study.references()[scene].all_names());
        Ok(Self { study, friction, scene, surrogate, names, seed, next: 0, waiting, scratch: Scratch::default() })
    }

    /// Solves clear (`kind` 0) or uncertain (1) samples until the stratum has `size` samples or no more are found.
    fn solve(&mut self, kind: usize, size: u64, stratum: &mut Stratum) -> Result<(), EstimatorError> {
        while stratum.samples < size {
            self.draw(kind, (size - stratum.samples).min(SAMPLES_PER_BLOCK as u64) as usize)?;
            let wanted = self.waiting[kind].len().min((size - stratum.samples) as usize);
            if wanted == 0 {
                break;
            }
            let block: Vec<_> = self.waiting[kind].drain(..wanted).collect();
            let samples: Vec<&B::Sample> = block.iter().map(|(sample, _)| sample).collect();
            let mut outcomes = Vec::with_capacity(SAMPLES_PER_BLOCK);
            self.study.evaluate_block(self.scene, &samples, &mut self.scratch, &mut outcomes);
            for (&(_, predicted), outcome) in block.iter().zip(outcomes) {
                stratum.enter(&self.surrogate.named(predicted), &outcome?.unstable_names(&self.names));
            }
        }
        Ok(())
    }

    /// Draws samples until `wanted` samples of a kind are waiting.
    fn draw(&mut self, kind: usize, wanted: usize) -> Result<(), EstimatorError> {
        for _ in 0..MOST_DRAWS {
            if self.waiting[kind].len() >= wanted {
                break;
            }
            let sample = self.study.brake().draw(&mut montecarlo::stream(self.seed, self.next))?;
            self.next += 1;
            let prediction = self.surrogate.predict(&self.friction.of(&sample)?);
            let waiting = &mut self.waiting[usize::from(prediction.is_uncertain)];
            // While samples of a rare kind are drawn, not all samples of the other kind are kept.
            if waiting.len() < SAMPLES_PER_BLOCK {
                waiting.push((sample, prediction.unstable));
            }
        }
        Ok(())
    }
}
