//! Working memory of one block, and what it was used for.

use std::time::Duration;

use cea::{CeaError, Counters, Spectrum, Workspace};
use cpu_time::ThreadTime;
use linsys::SecondOrder;

/// Working memory of one block.
#[derive(Default)]
pub struct Scratch {
    /// Of each sector, those of the samples.
    pub(super) systems: Vec<Vec<SecondOrder>>,
    pub(super) memory: Memory,
}

/// What solvers work with.
#[derive(Default)]
pub(super) struct Memory {
    pub spectra: Vec<Result<Spectrum, CeaError>>,
    pub work: Workspace,
    pub spent: Spent,
}

/// Processor time of the stages of a study.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Spent {
    /// Sliding states, and certificates looked up.
    pub states: Duration,
    /// Growing modes by secular equations.
    pub search: Duration,
    /// Matrices.
    pub assembly: Duration,
    /// Spectra and verdicts of what the secular equations leave.
    pub spectra: Duration,
    /// Shapes of growing modes.
    pub shapes: Duration,
    /// Their names, continuations included.
    pub names: Duration,
    /// Ranks and net work.
    pub outcomes: Duration,
}

impl Scratch {
    /// What was computed so far.
    pub fn counters(&self) -> Counters {
        self.memory.work.counters
    }

    /// What that took.
    pub fn spent(&self) -> Spent {
        self.memory.spent
    }
}

/// Adds the processor time that some work takes of this thread.
pub fn timed<T>(into: &mut Duration, work: impl FnOnce() -> T) -> T {
    let start = ThreadTime::now();
    let result = work();
    *into += start.elapsed();
    result
}
