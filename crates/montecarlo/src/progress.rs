//! Who is told how far the run has come.

/// Is told how far a run has come, in evaluations (one sample in one scene). `()` is silent.
pub trait Progress: Sync {
    /// Called once, before the first evaluation: `total` evaluations in the whole run, `done` of them by a run that was
    /// broken off.
    fn begin(&self, total: u64, done: u64);
    /// Some more evaluations are done; called by the worker threads.
    fn advance(&self, evaluations: u64);
    /// The run has ended, well or badly.
    fn end(&self);
}

impl Progress for () {
    fn begin(&self, _total: u64, _done: u64) {}
    fn advance(&self, _evaluations: u64) {}
    fn end(&self) {}
}
