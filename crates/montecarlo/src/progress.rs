//! Reports of the progress of a run.

use crate::MonteCarloError;

/// Progress of a run, in evaluations (one sample in one scene), for whoever wants to see it, and may want it to end. `()` ignores it.
pub trait Progress: Sync {
    /// Called before the first evaluation: `total` evaluations in the whole run, `done` of them by an earlier run that was interrupted. Work in
    /// several parts, as a preparation, calls it before each part, with the evaluations of that part.
    fn begin(&self, total: u64, done: u64);
    /// Called by the worker threads after some more `evaluations`.
    fn advance(&self, evaluations: u64);
    /// Called when the run, or the part, has ended.
    fn end(&self);
    /// Called where work goes another way than it seemed to: `news` says why, in a sentence.
    fn tell(&self, _news: &str) {}
    /// True if whoever is told wants the run to end now: asked between evaluations, and by a run after each block and twenty times a second.
    fn is_cancelled(&self) -> bool {
        false
    }
    /// An error if work is to end because it is cancelled.
    ///
    /// # Errors
    /// [`MonteCarloError::Cancelled`].
    fn go_on(&self) -> Result<(), MonteCarloError> {
        if self.is_cancelled() { Err(MonteCarloError::Cancelled) } else { Ok(()) }
    }
}

impl Progress for () {
    fn begin(&self, _total: u64, _done: u64) {}
    fn advance(&self, _evaluations: u64) {}
    fn end(&self) {}
}
