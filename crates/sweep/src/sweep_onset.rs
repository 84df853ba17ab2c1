//! Onsets: places where a mode begins or ceases to grow.

use num_complex::Complex;
use serde::Serialize;
use study::UncertainBrake;
use tracking::{Branches, Onset};

use super::change::{ChangeOf, by};
use super::family::Part;
use super::measure::Measure;
use crate::Error;

/// Largest number of corrections of an onset of a reduced brake; chosen: each wins as many digits as the reduced brake has.
const MOST_CORRECTIONS: usize = 8;

/// A change of the number of unstable modes: a mode that crosses the axis, a real eigenvalue that crosses zero (divergence), a growing
/// pair that becomes two real eigenvalues, or these a pair, or a growing mode that enters the band that is studied, or leaves it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepOnset {
    /// Value of the parameter.
    pub at: f64,
    /// Bound or estimate of the error of `at`, in units of the parameter: by rounding, of an onset at an opening the width of the opening, and of an onset
    /// that the reduced brake alone has its assumed error.
    pub error: f64,
    /// Frequency Im lambda, rad/s; 0 of divergence, and where a growing pair becomes real.
    pub omega: f64,
    /// Growth rate Re lambda, 1/s: the growth rate of the threshold, but where a growing pair becomes real or a growing mode enters or leaves the band.
    pub growth: f64,
    /// Start of an unstable mode: if true one more mode is unstable where the parameter is larger, if false one less; of a pair that
    /// becomes two real eigenvalues one more.
    pub starts: bool,
    /// Kind of the change.
    pub of: ChangeOf,
    /// Candidates for the name of the mode, or `divergence`.
    pub mode: String,
    /// Number of unstable modes just beyond the onset, of all sectors.
    pub unstable: usize,
    /// Shift of the onset of the full model from the onset of its reduction, in units of the parameter; `None` for a brake that is not
    /// reduced, and where the onset of the full model was not found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moved: Option<f64>,
    /// True if the onset is the onset of the reduced brake, because the onset of the full model was not found.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub is_reduced: bool,
    /// Growth rates just before and just beyond an opening at which the growth jumps over the threshold, 1/s; `None` where it crosses it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jump: Option<[f64; 2]>,
}

impl SweepOnset {
    /// Difference of the number of unstable modes beyond the onset from that before it.
    #[must_use]
    pub fn by(&self) -> i64 {
        by(self.starts)
    }
}

/// Onset of the full model, of which a brake is a reduction.
pub(super) enum WholeOnset {
    /// The brake is not reduced.
    NotReduced,
    /// The onset, with the number of eigenvalues of the full model that it took.
    Found(Onset, u64),
    /// The onset of the full model was not found; with the assumed error of the onset of the reduced brake, in fractions of the range.
    NotFound { error: f64 },
}

impl WholeOnset {
    /// The onset of the full model next to one of the reduced brake, in fractions of the range, by secants of the function that
    /// is zero there, `measure`, which begin with the slope that the branches of the reduced brake have; `there` is the eigenvalue of the reduced one.
    ///
    /// # Errors
    /// Those of the brake, but for eigenvalues of the full model that are not found.
    pub fn near<B: UncertainBrake>(
        part: &Part<'_, B>,
        onset: &Onset,
        (measure, there): (Measure, Complex<f64>),
        reduced: &mut impl Branches<Error = Error>,
    ) -> Result<Self, Error> {
        let whole = |at: f64, near| match part.whole_eigenvalue(&[at], near) {
            Err(Error::Study(study::Error::WholeEigenvalue(_) | study::Error::Cea(_))) => Ok(None),
            // Beyond the range a parameter may have a value that the brake does not allow.
            Err(Error::Study(error)) if !error.is_cancelled() && !(0.0..=1.0).contains(&at) => Ok(None),
            found => found.map(Some),
        };
        let Some(first) = whole(onset.at, there)? else {
            return Self::not_found(part, onset, (measure, there), reduced);
        };
        let Some(mut found) = first else { return Ok(Self::NotReduced) };
        let rate = reduced.refined(onset.at, there)?.rate;
        let (mut at, mut slope) = (onset.at, measure.rate(found.lambda, rate));
        for solved in 1..=MOST_CORRECTIONS {
            let (step, error) = (-measure.value(found.lambda) / slope, found.bound / slope.abs());
            if step.abs() <= error.max(2.0 * f64::EPSILON * at.abs()) {
                let onset = Onset { at, error: error + step.abs(), omega: found.lambda.im, ..*onset };
                return Ok(Self::Found(onset, solved as u64));
            }
            // Beyond an opening the brake is another one.
            if part.family.share < 1.0 && !(0.0..=1.0).contains(&(at + step)) {
                break;
            }
            let Some(next) = whole(at + step, found.lambda + rate * step)?.flatten() else { break };
            let change = measure.value(next.lambda) - measure.value(found.lambda);
            // Of a mode that runs along the axis the slope of the whole brake may be another one.
            if change.abs() > 2.0 * next.bound {
                slope = change / step;
            }
            (at, found) = (at + step, next);
        }
        Self::not_found(part, onset, (measure, there), reduced)
    }

    /// Not found, with the assumed error of the onset of the reduced brake: from the error of the eigenvalue, by the speed at which it crosses, in the
    /// function that is zero there.
    fn not_found<B: UncertainBrake>(
        part: &Part<'_, B>,
        onset: &Onset,
        (measure, there): (Measure, Complex<f64>),
        reduced: &mut impl Branches<Error = Error>,
    ) -> Result<Self, Error> {
        let rate = measure.rate(there, reduced.refined(onset.at, there)?.rate);
        Ok(Self::NotFound { error: onset.error + part.relative_error() * there.norm() / rate.abs() })
    }
}
