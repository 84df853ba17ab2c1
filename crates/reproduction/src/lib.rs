//! The paper on 3 x 3 oscillators: its claims, each checked against a study of its case, its figures, and the product of all readings of
//! what it leaves open.
//!
//! For this project's own use: no user of `squeal` compiles it.

mod claims;
mod constrained;
mod error;
mod limits;
mod modes;
mod panels;
mod pictures;
mod printed;
pub mod readings;
mod robust_mode;
mod scenes;

use brakes::LatticeBrake;
pub use claims::{Claim, Holds, claims_json, claims_markdown};
use constrained::{after_corners, after_six, corners_reduce, none_at_six};
pub use error::Error;
pub use limits::Judgement;
pub(crate) use modes::{most_robust, paper_modes, shape, title};
use panels::{contact_number, laws, speeds};
pub use pictures::draw_paper;
use printed::{counted, natural_frequencies};
use robust_mode::{robust_mode, robust_shape, robust_work};
pub(crate) use scenes::{CORNERS_HELD, SIX_HELD, UNCONSTRAINED};
use squeal::results::Results;
use squeal::study::ModeNaming;

/// Modes that the claims C4 to C6, C8 and C10 are about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// Modes that the study finds where the paper does: the most robustly unstable one, and what is left with oscillators held.
    Found,
    /// Modes that have the paper's numbers when modes are counted in some way.
    Numbered(ModeNaming),
}

/// The scorecard of a study of the paper's case, judged by limits; empty for a case without a `[paper]` table.
///
/// # Errors
/// Those of statistics without data.
pub fn claims(results: &Results, brake: &LatticeBrake) -> Result<Vec<Claim>, Error> {
    claims_judged(results, brake, Judgement::ByLimits, Subject::Found)
}

/// [`claims`], judged as asked, of the modes that are asked for.
///
/// # Errors
/// As [`claims`].
pub fn claims_judged(
    results: &Results,
    brake: &LatticeBrake,
    judgement: Judgement,
    subject: Subject,
) -> Result<Vec<Claim>, Error> {
    let Some(paper) = &brake.case.paper else { return Ok(Vec::new()) };
    let robust = most_robust(results, UNCONSTRAINED, judgement)?;
    Ok(vec![
        contact_number(results, judgement),
        laws(results, judgement),
        speeds(results, judgement),
        robust_mode(results, paper, &robust, subject)?,
        robust_shape(results, paper, &robust, subject)?,
        robust_work(results, paper, &robust, judgement, subject)?,
        corners_reduce(results, judgement),
        after_corners(results, paper, judgement, subject)?,
        none_at_six(results, judgement),
        after_six(results, paper, judgement, subject)?,
        natural_frequencies(results, paper),
        counted(results, paper),
    ])
}
