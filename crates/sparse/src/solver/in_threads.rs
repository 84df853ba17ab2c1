//! Work in threads of its own. Not those of a pool: one that waits there may be given another solution of the whole brake meanwhile, which takes its memory
//! and may wait for what this one holds.

use std::panic::resume_unwind;
use std::sync::{Mutex, PoisonError};
use std::thread::scope;

/// Results of `work` for each item, in their order, by at most as many threads.
pub(super) fn in_threads<T: Send, U: Send>(threads: usize, items: Vec<T>, work: impl Fn(T) -> U + Sync) -> Vec<U> {
    let threads = threads.min(items.len());
    if threads < 2 {
        return items.into_iter().map(work).collect();
    }
    let left = Mutex::new(items.into_iter().enumerate());
    let several = || -> Vec<(usize, U)> {
        let next = || left.lock().unwrap_or_else(PoisonError::into_inner).next();
        std::iter::from_fn(next).map(|(number, item)| (number, work(item))).collect()
    };
    let mut done: Vec<(usize, U)> = scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(several)).collect();
        let mut done = several();
        for other in others {
            done.extend(other.join().unwrap_or_else(|panic| resume_unwind(panic)));
        }
        done
    });
    done.sort_by_key(|(number, _)| *number);
    done.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::in_threads;

    #[test]
    fn results_are_in_order_whatever_the_number_of_threads_is() {
        for threads in [0, 1, 2, 7] {
            for count in [0, 1, 2, 50] {
                let squares: Vec<usize> = (0..count).map(|number| number * number).collect();
                assert_eq!(in_threads(threads, (0..count).collect(), |number| number * number), squares);
            }
        }
    }
}
