//! Where a mode begins or ceases to grow.

use num_complex::Complex;
use serde::Serialize;
use tracking::Onset;

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
    /// The onset next to one of the reduced brake, in parts of the range, by secants that begin with d lambda / d part = `rate` of the
    /// reduced brake there; `None` of a brake that is not reduced.
    ///
    /// # Errors
    /// [`Error::WholeOnset`] where it is not found within the range; those of the brake.
    pub fn near<B: UncertainBrake>(
        part: &Part<'_, B>,
        parameter: &SweptParameter,
        onset: &Onset,
        rate: Complex<f64>,
    ) -> Result<Option<Self>, Error> {
        let (mut at, mut near, mut slope) = (onset.at, Complex::new(0.0, onset.omega), rate.re);
        let mut last: Option<(f64, f64)> = None;
        for solved in 1..=MOST_CORRECTIONS {
            let Some(found) = part.whole_eigenvalue(&[at], near)? else { return Ok(None) };
            // Of a mode that runs along the axis the slope of the whole brake may be another one.
            if let Some((before, growth)) = last
                && (found.lambda.re - growth).abs() > 2.0 * found.bound
            {
                slope = (found.lambda.re - growth) / (at - before);
            }
            last = Some((at, found.lambda.re));
            let (step, error) = (-found.lambda.re / slope, found.bound / slope.abs());
            near = found.lambda + rate * step;
            if step.abs() <= error.max(2.0 * f64::EPSILON * at.abs()) {
                let onset = Onset { at, error: error + step.abs(), omega: found.lambda.im, ..*onset };
                return Ok(Some(Self { onset, solved: solved as u64 }));
            }
            at += step;
        }
        Err(Error::WholeOnset { name: parameter.name.clone(), near: parameter.at(onset.at), solved: MOST_CORRECTIONS })
    }
}
