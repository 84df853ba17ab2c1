//! Reports of the progress of a run.

/// Receives the progress of a run, in evaluations (one sample in one scene). `()` ignores it.
pub trait Progress: Sync {
    /// Called once, before the first evaluation: `total` evaluations in the whole run, `done` of them by an earlier run that
    /// was interrupted.
    fn begin(&self, total: u64, done: u64);
    /// Called by the worker threads after some more `evaluations`.
    fn advance(&self, evaluations: u64);
    /// Called once when the run has ended, with or without an error.
    fn end(&self);
}

impl Progress for () {
    fn begin(&self, _total: u64, _done: u64) {}
    fn advance(&self, _evaluations: u64) {}
    fn end(&self) {}
}
