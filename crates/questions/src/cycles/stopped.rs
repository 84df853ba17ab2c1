//! Work that looks at a flag, ended where whoever is told of its progress has enough.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use montecarlo::Progress;

use super::Following;
use crate::Error;

/// Settings by which motions are followed, with a flag that ends them soon after it is set.
pub(crate) type UntilStopped = (Following, Arc<AtomicBool>);

/// Time between two looks whether work is cancelled; chosen: no one notices so short a time.
const LOOK: Duration = Duration::from_millis(100);

/// The result of some work with a flag that is set when it is cancelled.
///
/// # Errors
/// Those of the work; of work that is cancelled, that it is.
pub(crate) fn when_cancelled<T>(
    progress: &dyn Progress,
    work: impl FnOnce(Arc<AtomicBool>) -> Result<T, Error>,
) -> Result<T, Error> {
    let stop = Arc::new(AtomicBool::new(progress.is_cancelled()));
    std::thread::scope(|scope| {
        let (done, is_done) = channel::<()>();
        let of_thread = Arc::clone(&stop);
        scope.spawn(move || {
            while is_done.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
                of_thread.fetch_or(progress.is_cancelled(), Ordering::Relaxed);
            }
        });
        let found = work(stop);
        drop(done);
        // A step that was stopped may look as if it had failed by itself.
        progress.go_on()?;
        found
    })
}
