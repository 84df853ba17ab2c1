//! The claims of the 3 x 3 oscillator paper, each checked against a study of its case.

mod constrained;
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
pub(super) use modes::most_robust;
#[cfg(feature = "figures")]
pub(super) use modes::{paper_mode, shape, title};
use panels::{contact_number, laws, speeds};
use printed::{counted, natural_frequencies};
use robust_mode::{robust_mode, robust_shape, robust_work};
pub(super) use scenes::UNCONSTRAINED;
#[cfg(feature = "figures")]
pub(super) use scenes::{CORNERS_HELD, SIX_HELD};

/// The scorecard of a study of the paper's case; empty for a case without a `[paper]` table.
///
/// # Errors
/// Those of statistics without data.
pub fn claims(results: &Results<'_>, brake: &LatticeBrake) -> Result<Vec<Claim>, Error> {
    let Some(paper) = &brake.case.paper else { return Ok(Vec::new()) };
    let robust = most_robust(results, UNCONSTRAINED)?;
    let mode = robust.first().map(|(name, _)| *name);
    Ok(vec![
        contact_number(results),
        laws(results),
        speeds(results),
        robust_mode(results, paper, &robust),
        robust_shape(results, paper, mode),
        robust_work(results, paper, mode)?,
        corners_reduce(results),
        after_corners(results, paper)?,
        none_at_six(results)?,
        after_six(results, paper)?,
        natural_frequencies(results, paper),
        counted(results, paper),
    ])
}
