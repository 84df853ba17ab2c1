//! Working memory of one block, and the processor time of the stages.

use std::time::Duration;

use cea::{CeaError, Counters, Spectrum, Workspace};
use cpu_time::ThreadTime;
use linsys::SecondOrder;

/// Working memory of one block.
#[derive(Default)]
pub struct Scratch {
    /// Systems of the samples of the block, by sector and sample.
    pub(super) systems: Vec<Vec<SecondOrder>>,
    pub(super) memory: Memory,
}

/// Working memory of the solvers of a scene's sectors.
#[derive(Default)]
pub(super) struct Memory {
    pub spectra: Vec<Result<Spectrum, CeaError>>,
    pub work: Workspace,
    pub spent: Spent,
}

/// Processor time of the stages of a study.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Spent {
    /// Operating points, and the test whether a certificate covers them.
    pub states: Duration,
    /// Search of growing modes by secular equations.
    pub search: Duration,
    /// Assembly of matrices.
    pub assembly: Duration,
    /// Spectra and verdicts of samples that the secular equations leave open.
    pub spectra: Duration,
    /// Shapes of growing modes.
    pub shapes: Duration,
    /// Names of growing modes, continuation included.
    pub names: Duration,
    /// Ranks and net work.
    pub outcomes: Duration,
}

impl Scratch {
    /// Counters of each kind of computation so far.
    pub fn counters(&self) -> Counters {
        self.memory.work.counters
    }

    /// The processor time of each stage so far.
    pub fn spent(&self) -> Spent {
        self.memory.spent
    }
}

/// Does `work`, and adds the processor time that this thread takes for it to the sum `into`.
pub fn timed<T>(into: &mut Duration, work: impl FnOnce() -> T) -> T {
    let start = ThreadTime::now();
    let result = work();
    *into += start.elapsed();
    result
}
