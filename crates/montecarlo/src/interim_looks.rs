//! A run that stops when every proportion is known well enough: at which numbers of samples it looks, and what it asks there.

use crate::confidence::Confidence;
use crate::proportion::Proportion;

/// Looks: number of samples, as a fraction of the number at the last look, and error probability. Chosen: nearly all of the 5 % is for the last
/// look, as a table of many proportions mostly has one near one half; the probabilities sum to 0.05.
const LOOKS: [(f64, f64); 5] = [(0.0625, 0.002), (0.125, 0.003), (0.25, 0.005), (0.5, 0.01), (1.0, 0.03)];

/// A number of samples at which a run may stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InterimLook {
    /// Number of samples.
    pub samples: u64,
    /// The level of the intervals that have to be narrow enough here.
    pub confidence: Confidence,
}

/// The looks of a run that stops when no proportion can be farther than a half width, > 0, from its estimate, with 95 %.
///
/// Who looks again and again, and stops at the first look at which intervals of 95 % are narrow, is wrong more often than once in
/// twenty. So each look has an error probability of its own, and these sum to 5 % (Boole's inequality): if the run stops at the first look
/// at which the [`distance`] at its level is the half width or less for every proportion, then with 95 %, for each, the truth is within the half
/// width, whichever look that was. At the last one this is so for any proportion, as far as all samples were solved.
///
/// ```
/// let looks = montecarlo::interim_looks(0.01);
/// assert_eq!((looks[0].samples, looks.last().unwrap().samples), (737, 11_778));
/// ```
#[must_use]
pub fn interim_looks(half_width: f64) -> Vec<InterimLook> {
    let look = |(part, tail): (f64, f64)| {
        let confidence = Confidence::new(1.0 - tail).unwrap_or(Confidence::P95);
        InterimLook { samples: (part * last_samples(half_width)).ceil() as u64, confidence }
    };
    LOOKS.map(look).to_vec()
}

/// Samples at which the last look is narrow enough whatever was counted. The score interval of Wilson is widest at one half, where it
/// goes `z / 2 sqrt(n + z^2)` to both sides; a little beside it one side is longer by less than one more `z^2` makes up for.
fn last_samples(half_width: f64) -> f64 {
    let z = Confidence::new(1.0 - LOOKS[LOOKS.len() - 1].1).unwrap_or(Confidence::P95).z();
    (0.5 * z / half_width).powi(2) + z * z
}

/// The largest distance from an end of the estimate of a proportion to the limit of its interval beyond it: with the confidence, the truth is
/// at most so far from the estimate. What ambiguous trials leave between the ends is not in it. 1 without trials.
#[must_use]
pub fn distance(proportion: &Proportion, confidence: Confidence) -> f64 {
    let Some(estimate) = proportion.estimate() else { return 1.0 };
    let limits = proportion.interval(confidence);
    (estimate.lower - limits.lower).max(limits.upper - estimate.upper)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_probabilities_sum_to_five_percent() {
        assert!((LOOKS.iter().map(|look| look.1).sum::<f64>() - 0.05).abs() < 1e-15);
    }

    #[test]
    fn the_last_look_is_narrow_enough_whatever_is_counted() {
        for half_width in [0.25, 0.1, 0.03, 0.011] {
            let last = interim_looks(half_width)[4];
            let of = |hits| distance(&Proportion::of_counts(hits, 0, last.samples), last.confidence);
            let widest = (0..=last.samples).map(of).fold(0.0, f64::max);
            assert!(widest <= half_width && widest > 0.85 * half_width, "{half_width}: {widest}");
        }
    }

    /// The probability that the estimate is within the half width of the truth when the run stops, exactly: the distribution of the hits of the
    /// runs that are still going, look by look.
    fn probability_to_be_right(p: f64, half_width: f64, looks: &[InterimLook]) -> f64 {
        let mut going = vec![1.0];
        let (mut samples, mut right) = (0_u64, 0.0);
        for (at, look) in looks.iter().enumerate() {
            going.resize(look.samples as usize + 1, 0.0);
            for _ in samples..look.samples {
                for hits in (0..going.len()).rev() {
                    let from_below = if hits > 0 { p * going[hits - 1] } else { 0.0 };
                    going[hits] = (1.0 - p) * going[hits] + from_below;
                }
            }
            samples = look.samples;
            for (hits, probability) in going.iter_mut().enumerate() {
                let counts = Proportion::of_counts(hits as u64, 0, samples);
                if at + 1 == looks.len() || distance(&counts, look.confidence) <= half_width {
                    let is_right = (hits as f64 / samples as f64 - p).abs() <= half_width;
                    right += if is_right { *probability } else { 0.0 };
                    *probability = 0.0;
                }
            }
        }
        right
    }

    #[test]
    fn the_estimate_is_within_the_half_width_as_often_as_promised() {
        let half_width = 0.05;
        let ours = interim_looks(half_width);
        // The same looks with intervals of 95 % at each, and as many samples at the last as these need.
        let z = Confidence::P95.z();
        let naive: Vec<InterimLook> = LOOKS
            .iter()
            .map(|(part, _)| ((part * ((0.5 * z / half_width).powi(2) + z * z)).ceil() as u64, Confidence::P95))
            .map(|(samples, confidence)| InterimLook { samples, confidence })
            .collect();
        let probabilities = (0..=50).map(|k| f64::from(k) * 0.01).chain([0.002, 0.005, 0.025, 0.035]);
        let mut least = [1.0_f64; 2];
        for p in probabilities {
            for (least, looks) in least.iter_mut().zip([&ours, &naive]) {
                *least = least.min(probability_to_be_right(p, half_width, looks));
            }
        }
        println!("least probability to be right: {:.4}; with 95 % at every look {:.4}", least[0], least[1]);
        assert!(least[0] >= 0.95 && least[1] < least[0], "{least:?}");
    }
}
