//! Where a mode begins or ceases to grow.

use serde::Serialize;
use tracking::{Branches, Onset};

use super::family::Part;
use super::parameter::SweptParameter;
use crate::Error;
use crate::study::UncertainBrake;

/// Most corrections of an onset of a reduced brake; chosen: each wins as many digits as the reduced brake has.
const MOST_CORRECTIONS: usize = 8;

/// An onset with the mode that crosses the axis, or of divergence, where a real eigenvalue crosses zero.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepOnset {
    /// The parameter.
    pub at: f64,
    /// Bound of the error of `at` by rounding.
    pub error: f64,
    /// Im lambda, rad/s; 0 of a divergence.
    pub omega: f64,
    /// Whether the mode starts to grow where the parameter grows, or stops.
    pub starts: bool,
    /// Candidates for the name of the mode, or `divergence`.
    pub mode: String,
    /// How far the onset of the brake is from that of its reduction, where the brake is reduced.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moved: Option<f64>,
}

/// An onset of the brake that a brake is a reduction of.
pub(super) struct WholeOnset {
    pub onset: Onset,
    /// Eigenvalues of the whole brake that were found.
    pub solved: u64,
}

impl WholeOnset {
    /// The onset next to one of the reduced brake, in parts of the range, by secants that begin with the slope that the branches of the
    /// reduced brake have there; `None` of a brake that is not reduced.
    ///
    /// # Errors
    /// [`Error::WholeOnset`] where it is not found; those of the brake.
    pub fn near<B: UncertainBrake>(
        part: &Part<'_, B>,
        parameter: &SweptParameter,
        onset: &Onset,
        reduced: &mut impl Branches<Error = Error>,
    ) -> Result<Option<Self>, Error> {
        let threshold = part.threshold();
        let there = threshold.at_margin(0.0, onset.omega);
        let Some(mut found) = part.whole_eigenvalue(&[onset.at], there)? else { return Ok(None) };
        let rate = reduced.refined(onset.at, there)?.rate;
        let (mut at, mut slope) = (onset.at, threshold.margin_rate(found.lambda, rate));
        for solved in 1..=MOST_CORRECTIONS {
            let (step, error) = (-threshold.margin(found.lambda) / slope, found.bound / slope.abs());
            if step.abs() <= error.max(2.0 * f64::EPSILON * at.abs()) {
                let onset = Onset { at, error: error + step.abs(), omega: found.lambda.im, ..*onset };
                return Ok(Some(Self { onset, solved: solved as u64 }));
            }
            let Some(next) = part.whole_eigenvalue(&[at + step], found.lambda + rate * step)? else { break };
            let growth = threshold.margin(next.lambda) - threshold.margin(found.lambda);
            // Of a mode that runs along the axis the slope of the whole brake may be another one.
            if growth.abs() > 2.0 * next.bound {
                slope = growth / step;
            }
            (at, found) = (at + step, next);
        }
        Err(Error::WholeOnset { name: parameter.name.clone(), near: parameter.at(onset.at), solved: MOST_CORRECTIONS })
    }
}
