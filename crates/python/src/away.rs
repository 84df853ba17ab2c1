//! Work away from the interpreter: on a thread of its own, while the calling thread looks for signals and tells of progress.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use pyo3::prelude::*;
use squeal::montecarlo::Progress;
use squeal_cli::Error;
use squeal_cli::bar::Stages;

use crate::errors;

/// Time between two looks for signals; chosen, so that an interrupt is taken within a tenth of a second.
const LOOK: Duration = Duration::from_millis(20);
/// Stack of the thread that works, bytes: as large as the stack of a main thread.
const STACK: usize = 8 << 20;

/// Messages between the thread that works and the calling thread.
#[derive(Default)]
pub(crate) struct Watch {
    cancelled: AtomicBool,
    /// Flag of work of which nothing is kept yet, so that an interrupt need not wait for it.
    prepares: AtomicBool,
    /// The exception that a callable of the user has raised.
    raised: Mutex<Option<PyErr>>,
    stages: Mutex<Vec<Counts>>,
}

/// Progress of a stage.
struct Counts {
    what: &'static str,
    done: u64,
    total: u64,
    is_told: bool,
}

impl Watch {
    /// Ends the work with an exception.
    pub(crate) fn raise(&self, error: PyErr) {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Does what nothing is kept of: an interrupt leaves it behind, and it ends where it looks next.
    pub(crate) fn preparing<T>(&self, work: impl FnOnce() -> T) -> T {
        self.prepares.store(true, Ordering::Relaxed);
        let done = work();
        self.prepares.store(false, Ordering::Relaxed);
        done
    }

    /// True if the work is to end.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    fn stages(&self) -> std::sync::MutexGuard<'_, Vec<Counts>> {
        self.stages.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Tells `progress` of the stages that have come further since the last time.
    fn tell(&self, progress: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let Some(progress) = progress else { return Ok(()) };
        let news: Vec<_> = {
            let mut stages = self.stages();
            let open = stages.iter_mut().filter(|stage| !stage.is_told);
            open.map(|stage| {
                stage.is_told = true;
                (stage.what, stage.done, stage.total)
            })
            .collect()
        };
        news.into_iter().try_for_each(|told| progress.call1(told).map(drop))
    }
}

impl Stages for Watch {
    fn stage<'s>(&'s self, what: &'static str) -> Box<dyn Progress + 's> {
        let mut stages = self.stages();
        stages.push(Counts { what, done: 0, total: 0, is_told: true });
        Box::new(Stage { watch: self, at: stages.len() - 1 })
    }
}

/// Receiver of the progress of one stage.
struct Stage<'w> {
    watch: &'w Watch,
    at: usize,
}

impl Stage<'_> {
    fn set(&self, change: impl FnOnce(&mut Counts)) {
        if let Some(counts) = self.watch.stages().get_mut(self.at) {
            change(counts);
            counts.is_told = false;
        }
    }
}

impl Progress for Stage<'_> {
    fn begin(&self, total: u64, done: u64) {
        self.set(|counts| (counts.total, counts.done) = (total, done));
    }

    fn advance(&self, evaluations: u64) {
        self.set(|counts| counts.done += evaluations);
    }

    fn end(&self) {}

    fn is_cancelled(&self) -> bool {
        self.watch.is_cancelled()
    }
}

/// End of work that is interrupted: by itself where it looks at [`Progress::is_cancelled`].
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ends {
    /// By itself, and it is waited for but while it prepares: what it keeps is written when an interrupt is raised.
    Itself,
    /// Never: it is left behind, and what it finds is dropped.
    LeftBehind,
}

/// Does `work` on a thread of its own with the interpreter free.
///
/// # Errors
/// Those of the work; what a signal, `progress` or a callable of the user has raised.
pub(crate) fn away<T: Send + 'static>(
    py: Python<'_>,
    ends: Ends,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Arc<Watch>) -> Result<T, Error> + Send + 'static,
) -> PyResult<T> {
    let watch = Arc::new(Watch::default());
    let (sender, receiver) = channel();
    let of_thread = Arc::clone(&watch);
    let working = move || {
        // Whoever waits may have left.
        let _ = sender.send(catch_unwind(AssertUnwindSafe(|| work(&of_thread))));
    };
    std::thread::Builder::new().stack_size(STACK).spawn(working)?;
    let receiver: Mutex<Receiver<_>> = Mutex::new(receiver);
    let mut raised = None;
    let found = loop {
        let waited = py.detach(|| receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(LOOK));
        match waited {
            Err(RecvTimeoutError::Timeout) if raised.is_none() => {
                let looked = py.check_signals().and_then(|()| watch.tell(progress));
                if let Err(error) = looked {
                    watch.cancelled.store(true, Ordering::Relaxed);
                    if ends == Ends::LeftBehind || watch.prepares.load(Ordering::Relaxed) {
                        return Err(error);
                    }
                    raised = Some(error);
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Err(errors::panicked(py, "a thread has ended early")),
            Ok(found) => break found,
        }
    };
    let of_callable = watch.raised.lock().unwrap_or_else(PoisonError::into_inner).take();
    if let Some(error) = raised.or(of_callable) {
        return Err(error);
    }
    watch.tell(progress)?;
    match found {
        Ok(Ok(found)) => Ok(found),
        Ok(Err(error)) => Err(errors::raised(py, &error)),
        Err(panic) => Err(errors::panicked(py, &in_words(&*panic))),
    }
}

fn in_words(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default()
}
