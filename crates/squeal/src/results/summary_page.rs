//! `summary.md`: the answer of a study in words, the links of its modes between sets of constraints, and the reasons of their growth.

use std::path::Path;

use output::{Block, write};
use study::SetLinks;

use super::Results;
use super::reasons::{SceneReasons, reasons_in_words};
use crate::Error;

/// Writes `summary.md`.
pub(super) fn write_summary(
    results: &Results,
    links: &[SetLinks],
    reasons: &[SceneReasons],
    dir: &Path,
) -> Result<(), Error> {
    let answer = results.answer()?.into_iter().chain(results.becoming(links)?);
    let words: String = answer.map(|block: Block| block.markdown()).collect();
    let text = format!("# {}\n{words}{}", results.plan().name, reasons_in_words(results.plan(), reasons));
    Ok(write(&dir.join("summary.md"), text.as_bytes())?)
}
