//! The claims of the 3 x 3 oscillator paper, each checked against a study of its case.

mod constrained;
mod limits;
mod modes;
mod panels;
mod printed;
mod robust_mode;
mod scenes;

use super::claims::Claim;
use super::results::Results;
use crate::Error;
use crate::brakes::LatticeBrake;
use constrained::{after_corners, after_six, corners_reduce, none_at_six};
pub use limits::Judgement;
pub(super) use modes::most_robust;
#[cfg(feature = "figures")]
pub(super) use modes::{paper_mode, shape, title};
use panels::{contact_number, laws, speeds};
use printed::{counted, natural_frequencies};
use robust_mode::{robust_mode, robust_shape, robust_work};
pub(super) use scenes::UNCONSTRAINED;
#[cfg(feature = "figures")]
pub(super) use scenes::{CORNERS_HELD, SIX_HELD};

/// The scorecard of a study of the paper's case, judged by limits; empty for a case without a `[paper]` table.
///
/// # Errors
/// Those of statistics without data.
pub fn claims(results: &Results<'_>, brake: &LatticeBrake) -> Result<Vec<Claim>, Error> {
    claims_judged(results, brake, Judgement::ByLimits)
}

/// [`claims`], judged as asked.
///
/// # Errors
/// As [`claims`].
pub fn claims_judged(results: &Results<'_>, brake: &LatticeBrake, judgement: Judgement) -> Result<Vec<Claim>, Error> {
    let Some(paper) = &brake.case.paper else { return Ok(Vec::new()) };
    let robust = most_robust(results, UNCONSTRAINED, judgement)?;
    Ok(vec![
        contact_number(results, judgement),
        laws(results, judgement),
        speeds(results, judgement),
        robust_mode(results, paper, &robust),
        robust_shape(results, paper, &robust),
        robust_work(results, paper, &robust, judgement)?,
        corners_reduce(results, judgement),
        after_corners(results, paper, judgement)?,
        none_at_six(results, judgement),
        after_six(results, paper, judgement)?,
        natural_frequencies(results, paper),
        counted(results, paper),
    ])
}
